//! A rig in a GLB file: nodes, one skin, morph targets and animations.
//!
//! Skinned meshes ignore their nodes' transforms, so where positions are on a grid, inverse bind matrices bring them
//! back. All levels of detail have one skin; weights of morph targets are animated for each level's node.

use super::binary::{Binary, Unit};
use super::quantise::Grid;
use super::write_nodes::{matrix, nodes_of};
use crate::{FileError, Place};
use parbake_model::glam::{DAffine3, Vec3};
use parbake_model::{Interpolation, Model, Morph, Property, Rig, Skeleton, Track};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;

/// The skeleton of these models, if they have one; all must have the same.
pub fn shared_skeleton<'m>(path: &Path, levels: &[&'m Model]) -> Result<Option<&'m Skeleton>, FileError> {
    let mut skeletons = levels.iter().map(|level| level.rig.as_ref().map(|rig| &*rig.skeleton));
    let first = skeletons.next().flatten();
    let is_same = |other: Option<&Skeleton>| match (first, other) {
        (Some(a), Some(b)) => std::ptr::eq(a, b) || a == b,
        (a, b) => a.is_none() && b.is_none(),
    };
    if !skeletons.all(is_same) {
        let reason = "levels of detail in one file need the same skeleton".into();
        return Err(FileError::Invalid { path: path.into(), place: Place::File, reason });
    }
    Ok(first)
}

/// Adds joints, weights and targets to all primitives of a mesh of so many vertices.
pub fn add_to_primitives(
    binary: &mut Binary,
    primitives: &mut [Value],
    rig: &Rig,
    vertices: usize,
    grid: Option<&Grid>,
) {
    if !rig.influences.is_empty() {
        let joints = rig.skeleton.joints.len();
        let [joints, weights] = binary.influences(&rig.influences, joints, grid.is_some());
        for primitive in &mut *primitives {
            primitive["attributes"]["JOINTS_0"] = joints.into();
            primitive["attributes"]["WEIGHTS_0"] = weights.into();
        }
    }
    if rig.morphs.is_empty() {
        return;
    }
    // Readers expect the same attributes of all targets.
    let turns = rig.morphs.iter().flat_map(|morph| &morph.normals).any(|normal| *normal != Vec3::ZERO);
    let target = |morph: &Morph| {
        let mut target = json!({ "POSITION": positions(binary, morph, vertices, grid) });
        if turns {
            let fits = grid.is_some() && morph.normals.iter().all(|n| n.abs().max_element() <= 1.0);
            let unit = if fits { Unit::NormalisedByte } else { Unit::Float };
            target["NORMAL"] = binary.displacements(vertices, &morph.vertices, &morph.normals, unit).into();
        }
        target
    };
    let targets: Vec<Value> = rig.morphs.iter().map(target).collect();
    for primitive in primitives {
        primitive["targets"] = targets.clone().into();
    }
}

fn positions(binary: &mut Binary, morph: &Morph, vertices: usize, grid: Option<&Grid>) -> usize {
    let mut values = morph.positions.clone();
    let mut unit = Unit::Float;
    if let Some(grid) = grid {
        values.iter_mut().for_each(|value| *value /= grid.unit());
        if values.iter().all(|value| value.abs().max_element() < f32::from(i16::MAX)) {
            values.iter_mut().for_each(|value| *value = value.round());
            unit = Unit::Short;
        }
    }
    let accessor = binary.displacements(vertices, &morph.vertices, &values, unit);
    // Vertices that stay count too.
    let rest = (values.len() < vertices).then_some(Vec3::ZERO);
    let all = || values.iter().copied().chain(rest);
    let (min, max) = (all().fold(Vec3::INFINITY, Vec3::min), all().fold(Vec3::NEG_INFINITY, Vec3::max));
    binary.accessors[accessor]["min"] = json!(min.to_array().map(f64::from));
    binary.accessors[accessor]["max"] = json!(max.to_array().map(f64::from));
    accessor
}

/// What a mesh says of its targets.
pub fn describe_targets(mesh: &mut Value, skeleton: &Skeleton) {
    if skeleton.targets.is_empty() {
        return;
    }
    let weights: Vec<f64> = skeleton.targets.iter().map(|target| target.weight.into()).collect();
    mesh["weights"] = json!(weights);
    if skeleton.targets.iter().any(|target| !target.name.is_empty()) {
        let names: Vec<&str> = skeleton.targets.iter().map(|target| target.name.as_str()).collect();
        mesh["extras"] = json!({ "targetNames": names });
    }
}

/// Adds nodes, skin and animations to the document, whose nodes so far are those of meshes. `grid` is that of skinned
/// positions.
pub fn add_to_document(document: &mut Value, binary: &mut Binary, skeleton: &Skeleton, grid: Option<&Grid>) {
    let first = document["nodes"].as_array().map_or(0, Vec::len);
    let is_mesh = |node: &Value| node.get("mesh").is_some();
    let nodes = document["nodes"].as_array().into_iter().flatten();
    let mesh_nodes: Vec<usize> =
        nodes.enumerate().filter(|(_, node)| is_mesh(node)).map(|(index, _)| index).collect();
    if !skeleton.joints.is_empty() {
        let inverse_binds: Vec<f32> = skeleton
            .joints
            .iter()
            .flat_map(|joint| {
                matrix(joint.inverse_bind * grid.map_or(DAffine3::IDENTITY, Grid::as_transform))
            })
            .map(|x| x as f32)
            .collect();
        let accessor = binary.blocks(&[("MAT4", 16, &inverse_binds)]);
        let joints: Vec<usize> = skeleton.joints.iter().map(|joint| first + joint.node).collect();
        document["skins"] = json!([{ "joints": joints, "inverseBindMatrices": accessor }]);
        for &node in &mesh_nodes {
            document["nodes"][node]["skin"] = 0.into();
        }
    }
    let (nodes, roots) = nodes_of(&skeleton.nodes, first);
    for (list, more) in [("/nodes", nodes), ("/scenes/0/nodes", roots)] {
        if let Some(list) = document.pointer_mut(list).and_then(Value::as_array_mut) {
            list.extend(more);
        }
    }
    let animations = animations(binary, skeleton, first, &mesh_nodes);
    if !animations.is_empty() {
        document["animations"] = animations.into();
    }
}

/// Numbers of accessors, of which each is written once.
#[derive(Default)]
struct Pool<'s> {
    blocks: Vec<(&'static str, usize, &'s [f32])>,
    places: HashMap<(&'static str, bool, Vec<u32>), usize>,
    /// Those that are times, which are never values as well.
    times: Vec<usize>,
}

impl<'s> Pool<'s> {
    fn place(&mut self, kind: &'static str, width: usize, numbers: &'s [f32], is_time: bool) -> usize {
        let key = (kind, is_time, numbers.iter().map(|x| x.to_bits()).collect());
        *self.places.entry(key).or_insert_with(|| {
            self.blocks.push((kind, width, numbers));
            if is_time {
                self.times.push(self.blocks.len() - 1);
            }
            self.blocks.len() - 1
        })
    }
}

fn animations(binary: &mut Binary, skeleton: &Skeleton, first: usize, meshes: &[usize]) -> Vec<Value> {
    let mut pool = Pool::default();
    let mut placed: Vec<[usize; 2]> = Vec::new();
    for track in skeleton.animations.iter().flat_map(|animation| &animation.tracks) {
        let times = pool.place("SCALAR", 1, &track.times, true);
        let (kind, width) = match track.property {
            Property::Translation(_) | Property::Scale(_) => ("VEC3", 3),
            Property::Rotation(_) => ("VEC4", 4),
            Property::MorphWeights => ("SCALAR", 1),
        };
        placed.push([times, pool.place(kind, width, &track.values, false)]);
    }
    if placed.is_empty() {
        return Vec::new();
    }
    let accessor = binary.blocks(&pool.blocks);
    for &times in &pool.times {
        let numbers = pool.blocks[times].2;
        let bounds = [("min", numbers.first()), ("max", numbers.last())];
        for (key, bound) in bounds {
            binary.accessors[accessor + times][key] = json!([f64::from(bound.copied().unwrap_or_default())]);
        }
    }
    let mut placed = placed.into_iter();
    let animation = |animation: &parbake_model::Animation| {
        let (mut samplers, mut channels): (Vec<Value>, Vec<Value>) = Default::default();
        for (track, [input, output]) in animation.tracks.iter().zip(placed.by_ref()) {
            let sampler = samplers.len();
            let mut channel = |node: usize| {
                let target = json!({ "node": node, "path": path(track) });
                channels.push(json!({ "sampler": sampler, "target": target }));
            };
            match track.property.node() {
                Some(node) => channel(first + node),
                None => meshes.iter().for_each(|&node| channel(node)),
            }
            samplers.push(json!({
                "input": accessor + input, "output": accessor + output, "interpolation": interpolation(track),
            }));
        }
        let mut out = json!({ "channels": channels, "samplers": samplers });
        if !animation.name.is_empty() {
            out["name"] = animation.name.clone().into();
        }
        out
    };
    skeleton.animations.iter().map(animation).collect()
}

fn path(track: &Track) -> &'static str {
    match track.property {
        Property::Translation(_) => "translation",
        Property::Rotation(_) => "rotation",
        Property::Scale(_) => "scale",
        Property::MorphWeights => "weights",
    }
}

fn interpolation(track: &Track) -> &'static str {
    match track.interpolation {
        Interpolation::Step => "STEP",
        Interpolation::Linear => "LINEAR",
        Interpolation::CubicSpline => "CUBICSPLINE",
    }
}
