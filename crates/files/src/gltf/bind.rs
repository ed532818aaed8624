//! The rig of the merged mesh: which joints each vertex follows, and where skinned vertices stand.
//!
//! All skins become one. A skinned vertex keeps its joints; a vertex of a rigid node that moves follows the next joint
//! above it, with inverse bind matrix = inverse of that node's rest transform, since the merged mesh is in the world;
//! what stands still follows a joint that nothing moves, if anything else of the model moves.
//!
//! Skinned meshes ignore their own node's transform (glTF 2.0, 3.7.3.3). For baking they have to stand somewhere: by
//! any matrix M, if the inverse bind matrices B become B · M⁻¹, since
//!
//! ```text
//! Σ w · J · B · v  =  Σ w · J · (B · M⁻¹) · (M · v)
//! ```
//!
//! M is the rest transform J · B of the joint nearest to the root among those that bend together: parts that do not
//! bend stand exactly where viewers show them, and what bends stands there as it was bound. Where J · B is the node's own
//! transform, that is taken to the bit.

use super::buffers::Buffers;
use super::motion::Motion;
use super::sources::Sources;
use parbake_model::glam::{DAffine3, DVec3};
use parbake_model::{Influences, Joint, Node, NodeTransform, Skeleton};
use std::collections::HashMap;

/// By how much two transforms may differ that are one, as a share of their size.
const SAME: f64 = 1e-5;
/// By how much the rest transform of joints may differ from their mesh's node's.
const AT_REST: f64 = 1e-4;
/// Name of the joint that nothing moves.
const STILL: &str = "still";

/// How the vertices of a primitive are placed.
pub(super) struct Placing {
    /// From the primitive's space to the world.
    pub matrices: Vec<DAffine3>,
    /// For each vertex one of these; all have the first where this is empty.
    of: Vec<u32>,
}

impl Placing {
    /// All by one matrix.
    pub fn whole(matrix: DAffine3) -> Self {
        Self { matrices: vec![matrix], of: Vec::new() }
    }

    /// The matrix of a vertex.
    pub fn of(&self, vertex: usize) -> usize {
        self.of.get(vertex).map_or(0, |&matrix| matrix as usize)
    }
}

/// The rig so far.
pub(super) struct Binding {
    pub motion: Motion,
    /// Joints: the document's node (none for what stands still), and the inverse bind matrix.
    joints: Vec<(Option<usize>, DAffine3)>,
    by_node: HashMap<Option<usize>, Vec<u32>>,
    /// One for each vertex so far.
    pub influences: Vec<Influences>,
    /// Which nodes bend together: each one's parent in a forest.
    together: Vec<usize>,
    /// For a skin and a root of this forest, M.
    placings: HashMap<(usize, usize), Option<DAffine3>>,
}

impl Binding {
    pub fn new(motion: Motion) -> Self {
        let together = (0..motion.seats.len()).collect();
        let (joints, by_node, influences, placings) = Default::default();
        Self { motion, joints, by_node, influences, together, placings }
    }

    fn root(&mut self, mut node: usize) -> usize {
        while self.together[node] != node {
            self.together[node] = self.together[self.together[node]];
            node = self.together[node];
        }
        node
    }

    /// Notes which joints of a skin bend a primitive's vertices together.
    pub fn note(&mut self, skin: usize, sources: &Sources<'_>) {
        let Some(count) = self.motion.skin(skin).map(|skin| skin.joints.len()) else { return };
        for element in 0..sources.position.count {
            let mut first = None;
            for (slot, _) in slots(sources, element, count) {
                let node = self.motion.skin(skin).map_or(0, |skin| skin.joints[slot]);
                let root = self.root(node);
                let first = *first.get_or_insert(root);
                self.together[root] = first;
            }
        }
    }

    /// Where the vertices of a skinned primitive stand; what they follow is noted. `world` is of their mesh's node.
    pub fn skinned(
        &mut self,
        skin: usize,
        sources: &Sources<'_>,
        elements: &[u32],
        world: &DAffine3,
        buffers: &Buffers<'_>,
    ) -> Placing {
        let mut placing = Placing { matrices: Vec::new(), of: Vec::with_capacity(elements.len()) };
        // For each root its matrix, and for each joint of the skin the rig's.
        let mut matrices: HashMap<usize, u32> = HashMap::new();
        let mut joints: HashMap<usize, u32> = HashMap::new();
        let count = self.motion.skin(skin).map_or(0, |skin| skin.joints.len());
        for &element in elements {
            let mut found = slots(sources, element as usize, count);
            if sources.influences.len() > 1 && found.len() > parbake_model::MOST_INFLUENCES {
                buffers.context.warn("vertices keep the four strongest of their joints");
            }
            if found.is_empty() {
                buffers
                    .context
                    .warn("vertices without a weight for any joint were given to their skin's first");
                found.push((0, 1.0));
            }
            let node = |this: &Self, slot: usize| this.motion.skin(skin).map_or(0, |skin| skin.joints[slot]);
            let root = self.root(node(self, found[0].0));
            let matrix = *matrices.entry(root).or_insert_with(|| {
                placing.matrices.push(self.placing(skin, root).map_or(*world, |m| snapped(m, world)));
                placing.matrices.len() as u32 - 1
            });
            placing.of.push(matrix);
            let inverse = placing.matrices[matrix as usize].inverse();
            let followed: Vec<(u32, f32)> = found
                .iter()
                .map(|&(slot, weight)| {
                    let joint = *joints.entry(slot).or_insert_with(|| {
                        let bind =
                            self.motion.skin(skin).map_or(DAffine3::IDENTITY, |s| s.inverse_binds[slot]);
                        self.joint(Some(node(self, slot)), bind * inverse)
                    });
                    (joint, weight)
                })
                .collect();
            self.influences
                .push(Influences::strongest(&followed).unwrap_or_else(|| Influences::of(followed[0].0)));
        }
        placing
    }

    /// So many more vertices follow the next joint above their node, if there is one.
    pub fn rigid(&mut self, node: Option<usize>, vertices: usize, buffers: &Buffers<'_>) {
        let mover = node.and_then(|node| self.motion.seat(node)?.mover);
        let inverse = mover.and_then(|mover| {
            let inverse = self.motion.seat(mover)?.world.inverse();
            inverse.is_finite().then_some(inverse)
        });
        if mover.is_some() && inverse.is_none() {
            buffers.context.warn("what hangs on a node without size stands still");
        }
        let joint = self.joint(mover.filter(|_| inverse.is_some()), inverse.unwrap_or(DAffine3::IDENTITY));
        self.influences.resize(self.influences.len() + vertices, Influences::of(joint));
    }

    /// The rest transform of what bends with this root, by the joint of the skin that is nearest to the scene's root.
    fn placing(&mut self, skin: usize, root: usize) -> Option<DAffine3> {
        if let Some(found) = self.placings.get(&(skin, root)) {
            return *found;
        }
        let joints = self.motion.skin(skin).map_or(Vec::new(), |skin| skin.joints.clone());
        let mut nearest: Option<(usize, DAffine3)> = None;
        for (slot, node) in joints.into_iter().enumerate() {
            if self.root(node) != root {
                continue;
            }
            let (Some(skin), Some(seat)) = (self.motion.skin(skin), self.motion.seat(node)) else { continue };
            let matrix = seat.world * skin.inverse_binds[slot];
            let is_usable = matrix.is_finite() && matrix.inverse().is_finite();
            if is_usable && nearest.is_none_or(|(depth, _)| seat.depth < depth) {
                nearest = Some((seat.depth, matrix));
            }
        }
        let found = nearest.map(|(_, matrix)| matrix);
        self.placings.insert((skin, root), found);
        found
    }

    fn joint(&mut self, node: Option<usize>, inverse_bind: DAffine3) -> u32 {
        let of_node = self.by_node.entry(node).or_default();
        let same = |&&joint: &&u32| is_same(&self.joints[joint as usize].1, &inverse_bind, SAME);
        if let Some(&joint) = of_node.iter().find(same) {
            return joint;
        }
        let joint = self.joints.len() as u32;
        of_node.push(joint);
        self.joints.push((node, inverse_bind));
        joint
    }

    /// Nodes and joints, and for each of the document's nodes the skeleton's. Where nothing follows a node that moves,
    /// there are none, and no influences any more.
    pub fn skeleton(&mut self, buffers: &Buffers<'_>) -> (Skeleton, Vec<Option<usize>>) {
        let document = buffers.document;
        let mut places: Vec<Option<usize>> = vec![None; document.nodes.len()];
        let mut skeleton = Skeleton::default();
        if self.joints.iter().all(|(node, _)| node.is_none()) {
            self.influences.clear();
            return (skeleton, places);
        }
        // What moves, and all above it.
        let mut kept = vec![false; document.nodes.len()];
        for &index in self.motion.order.iter().rev() {
            let Some(seat) = self.motion.seat(index) else { continue };
            kept[index] |= seat.mover.is_some();
            if let Some(parent) = seat.parent.filter(|_| kept[index]) {
                kept[parent] = true;
            }
        }
        for &index in self.motion.order.iter().filter(|&&index| kept[index]) {
            let parent =
                self.motion.seat(index).and_then(|seat| seat.parent).and_then(|parent| places[parent]);
            places[index] = Some(skeleton.nodes.len());
            let node = &document.nodes[index];
            skeleton.nodes.push(Node { name: node.name.clone(), parent, rest: super::scene::local(node) });
        }
        let mut taken = vec![false; skeleton.nodes.len()];
        for &(node, inverse_bind) in &self.joints {
            let place = node.and_then(|node| places[node]);
            // A skin names a node once: others stand beside it, as its children.
            let own =
                place.filter(|&place| !std::mem::replace(&mut taken[place], true)).unwrap_or_else(|| {
                    let name = place.map_or(STILL.into(), |place| skeleton.nodes[place].name.clone());
                    skeleton.nodes.push(Node { name, parent: place, rest: NodeTransform::IDENTITY });
                    taken.push(true);
                    skeleton.nodes.len() - 1
                });
            skeleton.joints.push(Joint { node: own, inverse_bind });
        }
        (skeleton, places)
    }
}

/// The joints of a vertex by their places in the skin, and their weights.
fn slots(sources: &Sources<'_>, element: usize, count: usize) -> Vec<(usize, f32)> {
    let mut found = Vec::with_capacity(4);
    for [joints, weights] in &sources.influences {
        let (joints, weights) = (joints.read(element, [0.0f32; 4]), weights.read(element, [0.0f32; 4]));
        let pairs = joints.into_iter().zip(weights).map(|(joint, weight)| (joint as usize, weight));
        found.extend(pairs.filter(|&(joint, weight)| joint < count && weight > 0.0 && weight.is_finite()));
    }
    found
}

/// The node's own transform where joints at rest leave the mesh there.
fn snapped(matrix: DAffine3, world: &DAffine3) -> DAffine3 {
    if is_same(&matrix, world, AT_REST) { *world } else { matrix }
}

fn is_same(a: &DAffine3, b: &DAffine3, tolerance: f64) -> bool {
    let largest = |m: &DAffine3| {
        let of = |v: DVec3| v.abs().max_element();
        let linear = [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis].map(of);
        [linear[0].max(linear[1]).max(linear[2]), of(m.translation)]
    };
    let difference = DAffine3 { matrix3: a.matrix3 - b.matrix3, translation: a.translation - b.translation };
    let ([linear, moved], [size, distance]) = (largest(&difference), largest(b));
    linear <= tolerance * size && moved <= tolerance * distance.max(size)
}
