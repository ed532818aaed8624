//! Morph targets of all meshes as targets of the merged one.
//!
//! Each node has weights of its own, so its targets are its own too, unless they have the same name and weight as
//! another node's and no animation tells them apart.

use super::accessor::Accessor;
use super::buffers::{Buffers, pointer};
use super::json::Primitive;
use crate::FileError;
use parbake_model::glam::{DAffine3, DMat3, Vec3};
use parbake_model::{Morph, MorphTarget};
use std::collections::{HashMap, HashSet};

/// Bytes of a vertex of a target.
const ENTRY: u64 = 28;

/// The targets so far.
#[derive(Default)]
pub(super) struct Morphs {
    pub targets: Vec<MorphTarget>,
    pub morphs: Vec<Morph>,
    /// For each node that has some its targets' indices.
    pub of_nodes: HashMap<usize, Vec<usize>>,
    shared: HashMap<(String, u32), usize>,
    /// Nodes whose weights are animated.
    animated: Option<HashSet<usize>>,
}

/// The part of the merged mesh that a primitive became.
pub(super) struct Part<'m> {
    /// The first vertex.
    pub first: usize,
    /// For each vertex from there on the primitive's.
    pub elements: &'m [u32],
    /// Where each stands.
    pub matrix: &'m dyn Fn(usize) -> (DAffine3, DMat3),
    /// Normals of the merged mesh; none where the primitive has none.
    pub normals: Option<&'m [Vec3]>,
    /// Unmoved normals of the primitive.
    pub source_normal: &'m dyn Fn(u32) -> Vec3,
}

impl Morphs {
    /// The targets of a node, by what is read first.
    pub fn ids(&mut self, buffers: &Buffers<'_>, node: Option<usize>, mesh: usize) -> Vec<usize> {
        let document = buffers.document;
        let key = node.unwrap_or(usize::MAX);
        if let Some(ids) = self.of_nodes.get(&key) {
            return ids.clone();
        }
        let json = &document.meshes[mesh];
        let count = json.primitives.iter().map(|p| p.targets.len()).max().unwrap_or(0);
        let own = node.map(|node| &document.nodes[node].weights).filter(|weights| !weights.is_empty());
        let weights = own.unwrap_or(&json.weights);
        let animated = self.animated.get_or_insert_with(|| {
            let channels = document.animations.iter().flat_map(|animation| &animation.channels);
            channels.filter(|c| c.target.path == "weights").filter_map(|c| c.target.node).collect()
        });
        let is_animated = node.is_some_and(|node| animated.contains(&node));
        let mut ids: Vec<usize> = Vec::with_capacity(count);
        for k in 0..count {
            let name = json.target_names.0.get(k).cloned().unwrap_or_default();
            let weight = weights.get(k).copied().filter(|w| w.is_finite()).unwrap_or(0.0);
            let alike = (!name.is_empty() && !is_animated).then(|| (name.clone(), weight.to_bits()));
            let same = alike.as_ref().and_then(|alike| self.shared.get(alike)).copied();
            // A mesh may call two of its targets the same.
            if let Some(id) = same.filter(|id| !ids.contains(id)) {
                ids.push(id);
                continue;
            }
            let id = self.targets.len();
            self.targets.push(MorphTarget { name, weight });
            self.morphs.push(Morph::default());
            if let Some(alike) = alike {
                self.shared.entry(alike).or_insert(id);
            }
            ids.push(id);
        }
        self.of_nodes.insert(key, ids.clone());
        ids
    }

    /// Adds a primitive's targets; `ids` are their indices here.
    pub fn add(
        &mut self,
        buffers: &Buffers<'_>,
        primitive: &Primitive,
        here: &str,
        ids: &[usize],
        part: &Part<'_>,
        count: usize,
    ) -> Result<(), FileError> {
        for (k, (target, &id)) in primitive.targets.iter().zip(ids).enumerate() {
            let here = format!("{here}/targets/{k}");
            buffers.add_bytes(ENTRY * part.elements.len() as u64, pointer(here.clone()))?;
            let open = |index: Option<usize>, name: &str| {
                let from = format!("{here}/{name}");
                let accessor = index.map(|index| Accessor::new(buffers, index, &from, &[3])).transpose();
                match accessor {
                    Ok(Some(accessor)) if accessor.count != count => {
                        let found = accessor.count;
                        let context = buffers.context;
                        context.warn(format!(
                            "{from} was left out: there are {count} positions, but it has {found}"
                        ));
                        None
                    }
                    Ok(accessor) => accessor,
                    Err(error) => {
                        buffers.context.warn(format!("a morph target was left out: {error}"));
                        None
                    }
                }
            };
            let (position, normal) = (open(target.position, "POSITION"), open(target.normal, "NORMAL"));
            let read = |source: &Option<Accessor<'_>>, element: u32| {
                let delta = source.as_ref().map_or([0.0; 3], |s| s.read(element as usize, [0.0; 3]));
                Some(Vec3::from_array(delta)).filter(|d| d.is_finite()).unwrap_or_default()
            };
            for (i, &element) in part.elements.iter().enumerate() {
                let (delta, turned) = (read(&position, element), read(&normal, element));
                if delta == Vec3::ZERO && turned == Vec3::ZERO {
                    continue;
                }
                let (matrix, cofactors) = (part.matrix)(i);
                let vertex = part.first + i;
                let normal_delta =
                    part.normals.filter(|_| turned != Vec3::ZERO).map_or(Vec3::ZERO, |normals| {
                        let moved = cofactors * ((part.source_normal)(element) + turned).as_dvec3();
                        let before = normals.get(vertex).copied().unwrap_or_default();
                        moved.try_normalize().map_or(Vec3::ZERO, |moved| moved.as_vec3() - before)
                    });
                let delta = (matrix.matrix3 * delta.as_dvec3()).as_vec3();
                if delta.is_finite() && normal_delta.is_finite() {
                    self.push(id, vertex as u32, delta, normal_delta);
                }
            }
        }
        Ok(())
    }

    fn push(&mut self, id: usize, vertex: u32, position: Vec3, normal: Vec3) {
        self.morphs[id].push(vertex, position, normal);
    }
}
