//! What moves a model: joints with their weights, morph targets, and animations (glTF 2.0, 3.7.2.2, 3.7.3, 3.11).
//!
//! A model is one mesh, so it has one [`Skeleton`]: the nodes of the file that something moves, the joints that
//! vertices name, and the targets that all its vertices share. A vertex `v` of the mesh is shown at
//!
//! ```text
//! Σ weight · node · inverse_bind · (v + Σ target weight · delta)
//! ```
//!
//! with `node` the joint's node in the world. What stands still in a model of which other parts move has a joint that
//! nothing moves.
//!
//! Contract ([`Rig::fault`] checks it): there are at most 65,536 joints; nodes come after their parents and have no more
//! than one joint each; all indices are in range; weights of a vertex are not negative, sum to 1 and name no joint twice but with weight 0; all
//! numbers are finite; times increase.

use crate::Node;
use glam::{DAffine3, Vec3};
use std::sync::Arc;

/// Joints that a vertex may follow.
pub const MOST_INFLUENCES: usize = 4;

/// Joints that a rig may have: files name them by two bytes.
const MOST_JOINTS: usize = 1 << 16;

/// How the vertices of one mesh move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rig {
    /// What moves them; levels of detail of one model share it.
    pub skeleton: Arc<Skeleton>,
    /// V influences, or empty where there are no joints.
    pub influences: Vec<Influences>,
    /// For each target of the skeleton how far it moves vertices.
    pub morphs: Vec<Morph>,
}

/// Nodes, joints, targets and animations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// Nodes, parents first.
    pub nodes: Vec<Node>,
    /// Joints that vertices name.
    pub joints: Vec<Joint>,
    /// Morph targets.
    pub targets: Vec<MorphTarget>,
    /// Animations.
    pub animations: Vec<Animation>,
}

/// A node that vertices follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Index of the node.
    pub node: usize,
    /// From the mesh to the node's space.
    pub inverse_bind: DAffine3,
}

/// What a vertex follows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Influences {
    /// Indices of joints; 0 where the weight is 0.
    pub joints: [u32; MOST_INFLUENCES],
    /// Their weights, greatest first.
    pub weights: [f32; MOST_INFLUENCES],
}

/// What is said of a morph target once for all vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    /// Its name; may be empty.
    pub name: String,
    /// Its weight while nothing moves.
    pub weight: f32,
}

/// How far a morph target moves those vertices that it moves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Morph {
    /// N vertices, ascending.
    pub vertices: Vec<u32>,
    /// N displacements.
    pub positions: Vec<Vec3>,
    /// N changes of normals; zero where a normal stays.
    pub normals: Vec<Vec3>,
}

/// Tracks that play together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// Its name; may be empty.
    pub name: String,
    /// Its tracks.
    pub tracks: Vec<Track>,
}

/// What one property does over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// What it moves.
    pub property: Property,
    /// What is between two key times.
    pub interpolation: Interpolation,
    /// N key times in seconds.
    pub times: Arc<Vec<f32>>,
    /// N values of as many numbers as the property has; for cubic splines 3 N, each in-tangent, value, out-tangent.
    pub values: Arc<Vec<f32>>,
}

/// What a track moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Property {
    /// Translation of a node: 3 numbers.
    Translation(usize),
    /// Rotation of a node: 4 numbers, a quaternion x y z w.
    Rotation(usize),
    /// Scale of a node: 3 numbers.
    Scale(usize),
    /// Weights of all morph targets: one number each.
    MorphWeights,
}

/// What is between two key times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// The value before.
    Step,
    /// In a straight line; rotations on the shorter arc.
    #[default]
    Linear,
    /// A cubic Hermite spline.
    CubicSpline,
}

impl Influences {
    /// Of joints with weights of any sum: the strongest, of which weights sum to 1. A joint may come several times;
    /// `None` where no weight is positive and finite.
    pub fn strongest(all: &[(u32, f32)]) -> Option<Self> {
        let mut sums: Vec<(u32, f64)> = Vec::with_capacity(all.len());
        for &(joint, weight) in all.iter().filter(|(_, weight)| *weight > 0.0 && weight.is_finite()) {
            match sums.iter_mut().find(|(other, _)| *other == joint) {
                Some((_, sum)) => *sum += f64::from(weight),
                None => sums.push((joint, weight.into())),
            }
        }
        sums.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        sums.truncate(MOST_INFLUENCES);
        let total: f64 = sums.iter().map(|(_, weight)| weight).sum();
        let mut out = Self::default();
        for (k, (joint, weight)) in sums.iter().enumerate() {
            (out.joints[k], out.weights[k]) = (*joint, (weight / total) as f32);
        }
        (!sums.is_empty()).then_some(out)
    }

    /// All of one joint.
    pub fn of(joint: u32) -> Self {
        Self { joints: [joint, 0, 0, 0], weights: [1.0, 0.0, 0.0, 0.0] }
    }

    /// The joints with a weight.
    pub fn used(&self) -> impl Iterator<Item = (u32, f32)> + '_ {
        self.joints.iter().copied().zip(self.weights).filter(|(_, weight)| *weight > 0.0)
    }
}

impl Property {
    /// The node, where it is one's.
    pub fn node(&self) -> Option<usize> {
        match *self {
            Self::Translation(node) | Self::Rotation(node) | Self::Scale(node) => Some(node),
            Self::MorphWeights => None,
        }
    }

    /// Numbers of a value, of a model with so many morph targets.
    pub fn width(&self, targets: usize) -> usize {
        match self {
            Self::Translation(_) | Self::Scale(_) => 3,
            Self::Rotation(_) => 4,
            Self::MorphWeights => targets,
        }
    }
}

impl Morph {
    /// The entry of a vertex, if the target moves it.
    pub fn of(&self, vertex: u32) -> Option<(Vec3, Vec3)> {
        let at = self.vertices.binary_search(&vertex).ok()?;
        Some((*self.positions.get(at)?, *self.normals.get(at)?))
    }
}

impl Rig {
    /// The first thing that breaks the contract, for a mesh of so many vertices, in words that follow "the rig has".
    pub fn fault(&self, vertices: usize) -> Option<&'static str> {
        let Skeleton { nodes, joints, targets, animations } = &*self.skeleton;
        let is_late = |(index, node): (usize, &Node)| node.parent.is_some_and(|parent| parent >= index);
        if nodes.iter().enumerate().any(is_late) {
            return Some("a node before its parent");
        }
        if joints.len() > MOST_JOINTS {
            return Some("more joints than files can name");
        }
        let mut taken = vec![false; nodes.len()];
        let takes = |joint: &Joint| taken.get_mut(joint.node).is_some_and(|t| !std::mem::replace(t, true));
        if !joints.iter().all(takes) {
            return Some("a joint whose node is not there or has another joint");
        }
        let is_sound = |joint: &Joint| joint.inverse_bind.is_finite();
        if !nodes.iter().all(|node| node.rest.to_parent().is_finite()) || !joints.iter().all(is_sound) {
            return Some("a transform that is not finite");
        }
        let expected = if joints.is_empty() { 0 } else { vertices };
        if self.influences.len() != expected {
            return Some("not one set of weights for each vertex");
        }
        let is_weighed = |i: &Influences| {
            let sum: f32 = i.weights.iter().sum();
            i.weights.iter().all(|w| (0.0..=1.0001).contains(w))
                && (sum - 1.0).abs() < 1e-3
                && i.joints.iter().all(|&j| (j as usize) < joints.len())
        };
        if !self.influences.iter().all(is_weighed) {
            return Some("weights that do not sum to 1, or a joint that is not there");
        }
        let is_morph = |m: &Morph| {
            let count = m.vertices.len();
            (m.positions.len(), m.normals.len()) == (count, count)
                && m.vertices.windows(2).all(|w| w[0] < w[1])
                && m.vertices.last().is_none_or(|&last| (last as usize) < vertices)
                && m.positions.iter().chain(&m.normals).all(|d| d.is_finite())
        };
        if self.morphs.len() != targets.len() || !self.morphs.iter().all(is_morph) {
            return Some("a morph target that does not fit its vertices");
        }
        let is_track = |t: &Track| {
            let width = t.property.width(targets.len())
                * if t.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
            t.property.node().is_none_or(|node| node < nodes.len())
                && width > 0
                && !t.times.is_empty()
                && t.values.len() == width * t.times.len()
                && t.times.windows(2).all(|w| w[0] < w[1])
                && t.times.iter().chain(t.values.iter()).all(|x| x.is_finite())
        };
        if !animations.iter().flat_map(|a| &a.tracks).all(is_track) {
            return Some("an animation that does not fit its nodes");
        }
        None
    }

    /// The rig of a mesh each of whose vertices is the copy of one of this rig's: `sources` has these.
    pub fn picked(&self, sources: &[u32]) -> Self {
        let influences = match self.influences.is_empty() {
            true => Vec::new(),
            false => sources
                .iter()
                .map(|&s| self.influences.get(s as usize).copied().unwrap_or_else(|| Influences::of(0)))
                .collect(),
        };
        let morph = |morph: &Morph| {
            let mut out = Morph::default();
            for (vertex, &source) in (0..).zip(sources) {
                if let Some((position, normal)) = morph.of(source) {
                    out.push(vertex, position, normal);
                }
            }
            out
        };
        Self { skeleton: self.skeleton.clone(), influences, morphs: self.morphs.iter().map(morph).collect() }
    }
}

impl Morph {
    /// Adds a vertex beyond all that there are.
    pub fn push(&mut self, vertex: u32, position: Vec3, normal: Vec3) {
        self.vertices.push(vertex);
        self.positions.push(position);
        self.normals.push(normal);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NodeTransform;

    /// Protects weights: the four strongest are kept, a joint that comes twice counts once, and they sum to 1.
    #[test]
    fn the_strongest_influences_are_kept() {
        let all = [(7, 0.1), (3, 0.2), (7, 0.2), (1, f32::NAN), (9, 0.05), (4, 0.25), (5, 0.1)];
        let found = Influences::strongest(&all).unwrap_or_default();
        assert_eq!(found.joints, [7, 4, 3, 5]);
        assert!((found.weights[0] - 0.3 / 0.85).abs() < 1e-6);
        assert!((found.weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        assert_eq!(Influences::strongest(&[(1, 0.0), (2, -1.0)]), None);
    }

    /// Protects writers from rigs that do not fit.
    #[test]
    fn faults_are_found() {
        let node = |parent| Node { name: String::new(), parent, rest: NodeTransform::IDENTITY };
        let skeleton = Skeleton {
            nodes: vec![node(None), node(Some(0))],
            joints: vec![Joint { node: 1, inverse_bind: DAffine3::IDENTITY }],
            targets: vec![MorphTarget::default()],
            animations: Vec::new(),
        };
        let morph = Morph { vertices: vec![1], positions: vec![Vec3::X], normals: vec![Vec3::ZERO] };
        let rig = Rig {
            skeleton: Arc::new(skeleton.clone()),
            influences: vec![Influences::of(0); 2],
            morphs: vec![morph],
        };
        assert_eq!(rig.fault(2), None);
        assert!(rig.fault(3).is_some());
        let mut wrong = rig.clone();
        wrong.influences[1].weights = [0.4, 0.4, 0.0, 0.0];
        assert!(wrong.fault(2).is_some());
        let mut wrong = rig.clone();
        wrong.morphs[0].vertices[0] = 2;
        assert!(wrong.fault(2).is_some());
        let mut wrong = rig.clone();
        let joint = Joint { node: 1, inverse_bind: DAffine3::IDENTITY };
        wrong.skeleton = Arc::new(Skeleton { joints: vec![joint, joint], ..skeleton });
        assert!(wrong.fault(2).is_some());
        // Copies of vertices move alike.
        let picked = rig.picked(&[1, 0, 1]);
        assert_eq!((picked.fault(3), picked.morphs[0].vertices.as_slice()), (None, &[0, 2][..]));
    }
}
