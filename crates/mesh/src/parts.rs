//! Parts of a model that no triangle may join: what moves by itself (`rig_parts.rs`), or nodes that stay apart
//! (`--keep-parts`).
//!
//! Named nodes without triangles, sockets and markers, stay where they are.
//!
//! While triangles are chosen, parts are told by their materials: each material is of one part. Stages after that leave
//! triangles in their order, so that a triangle of the result is of the part that it came from.

use crate::named_nodes::{NodeError, all_named_nodes};
use crate::rig_parts::rig_parts;
use parbake_model::glam::DAffine3;
use parbake_model::{Hierarchy, Material, Mesh, Model};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// No part: of materials that no triangle has.
const NONE: u32 = u32::MAX;

/// What can keep parts from staying apart.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PartsError {
    /// A pattern that fits no node.
    #[error(transparent)]
    Node(#[from] NodeError),
    /// Parts of a model that moves.
    #[error(
        "--keep-parts: {model} has skins, morph targets or animations, and so becomes one mesh with a skeleton, in which \
         nodes that move stay as joints; leave --keep-parts out, or take a copy of the model that nothing moves"
    )]
    OfRig {
        /// The model.
        model: String,
    },
    /// A node of which positions cannot be told in its own space.
    #[error(
        "--keep-parts: node {node:?} of {model} is scaled to nothing along an axis, so that it cannot keep its pivot; \
         apply its scale to its mesh"
    )]
    Flat {
        /// The model.
        model: String,
        /// The node.
        node: String,
    },
}

/// A part of a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PartReport {
    /// Its node's name.
    pub name: String,
    /// Triangles.
    pub triangles: usize,
}

/// The model in which all nodes that patterns name stay apart, each with what hangs below it and is not named itself;
/// those without triangles stay, too.
///
/// # Errors
/// A pattern that names no node; a model that moves; a node that is flat.
pub fn with_kept_parts<'m>(model: &'m Model, patterns: &[String]) -> Result<Cow<'m, Model>, PartsError> {
    if patterns.is_empty() {
        return Ok(Cow::Borrowed(model));
    }
    if model.rig.is_some() {
        return Err(PartsError::OfRig { model: model.name.clone() });
    }
    let mut is_named: Vec<bool> = Vec::new();
    for pattern in patterns {
        let more = all_named_nodes(model, pattern, "keep-parts")?;
        is_named.resize(more.len(), false);
        is_named.iter_mut().zip(more).for_each(|(named, more)| *named |= more);
    }
    let Some(all) = &model.nodes else { return Ok(Cow::Borrowed(model)) };
    // For each node the named one that it is a part of.
    let mut owners: Vec<u32> = Vec::with_capacity(all.nodes.len());
    for (index, node) in (0..).zip(&all.nodes) {
        let above = node.parent.map_or(Hierarchy::NONE, |parent| owners[parent]);
        owners.push(if is_named[index as usize] { index } else { above });
    }
    let owner = |&node: &u32| owners.get(node as usize).copied().unwrap_or(Hierarchy::NONE);
    let of_triangles = all.of_triangles.iter().map(owner).collect();
    let parts = pruned(&Hierarchy { nodes: all.nodes.clone(), of_triangles }, &is_named);
    let counts = parts.counts();
    let is_flat = |world: &DAffine3| !world.inverse().is_finite();
    if let Some(flat) = (0..counts.len()).find(|&node| counts[node] > 0 && is_flat(&parts.worlds()[node])) {
        return Err(PartsError::Flat { model: model.name.clone(), node: parts.nodes[flat].name.clone() });
    }
    Ok(Cow::Owned(Model { parts: Some(parts), ..model.clone() }))
}

/// The nodes that have triangles or are named, and those above them.
fn pruned(hierarchy: &Hierarchy, is_named: &[bool]) -> Hierarchy {
    let counts = hierarchy.counts();
    let mut is_kept: Vec<bool> =
        counts.iter().zip(is_named).map(|(&count, &named)| count > 0 || named).collect();
    for (index, node) in hierarchy.nodes.iter().enumerate().rev() {
        if let Some(parent) = node.parent.filter(|_| is_kept[index]) {
            is_kept[parent] = true;
        }
    }
    let mut places = vec![NONE; is_kept.len()];
    let mut nodes = Vec::new();
    for (index, node) in hierarchy.nodes.iter().enumerate().filter(|(index, _)| is_kept[*index]) {
        let parent = node.parent.map(|parent| places[parent] as usize);
        places[index] = nodes.len() as u32;
        nodes.push(parbake_model::Node { parent, ..node.clone() });
    }
    let place = |&node: &u32| places.get(node as usize).copied().unwrap_or(Hierarchy::NONE);
    Hierarchy { nodes, of_triangles: hierarchy.of_triangles.iter().map(place).collect() }
}

/// The part of each triangle: 0 for the rest, and 1 and more for nodes that stay apart; or by what moves. Nothing where
/// there is one part.
fn parts_of_triangles(model: &Model) -> Vec<u32> {
    let parts = match (&model.parts, &model.rig) {
        (Some(parts), _) => parts.of_triangles.iter().map(|&node| node.wrapping_add(1)).collect(),
        (None, Some(rig)) => rig_parts(&model.mesh, rig),
        (None, None) => Vec::new(),
    };
    if parts.iter().all(|&part| part == 0) { Vec::new() } else { parts }
}

/// The model with materials that are each of one part. What is made of its triangles then tells by its materials which
/// part it belongs to.
pub fn with_parted_materials(model: &Model) -> Cow<'_, Model> {
    let parts = parts_of_triangles(model);
    if parts.is_empty() {
        return Cow::Borrowed(model);
    }
    let mut parted = model.clone();
    let mut indices: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let mut first = vec![NONE; model.materials.len()];
    for (material, &part) in parted.mesh.triangle_materials.iter_mut().zip(&parts) {
        let own = &mut first[*material as usize];
        if *own == NONE {
            *own = part;
        }
        // A material of its first part stays where it is.
        if *own != part {
            *material = *indices.entry((*material, part)).or_insert_with(|| {
                parted.materials.push(model.materials[*material as usize].clone());
                parted.materials.len() as u32 - 1
            });
        }
    }
    Cow::Owned(parted)
}

/// The part of each material; nothing where there is one part, or where a material is of several.
pub fn parts_of_materials(model: &Model) -> Vec<u32> {
    let parts = parts_of_triangles(model);
    if parts.is_empty() {
        return Vec::new();
    }
    let mut of = vec![NONE; model.materials.len()];
    for (&material, &part) in model.mesh.triangle_materials.iter().zip(&parts) {
        let own = &mut of[material as usize];
        if *own != NONE && *own != part {
            return Vec::new();
        }
        *own = part;
    }
    of
}

/// The parts of a surface whose materials are those of a model with parted materials; none where no node of it stays
/// apart. `parts` is what [`parts_of_materials`] says of the model.
pub fn kept_parts_of(model: &Model, mesh: &Mesh, parts: &[u32]) -> Option<Hierarchy> {
    let nodes = model.parts.as_ref()?.nodes.clone();
    let node = |&material: &u32| parts.get(material as usize).map_or(Hierarchy::NONE, |p| p.wrapping_sub(1));
    Some(Hierarchy { nodes, of_triangles: mesh.triangle_materials.iter().map(node).collect() })
}

/// What was baked onto a low-poly, with the parts of that. Each part has materials of its own, which share the maps of
/// the rest; they have the name of the low-poly's material that most of the part has.
pub fn with_parts(mut model: Model, low: &Model) -> Model {
    let count = model.mesh.triangles.len();
    let Some(parts) = low.parts.as_ref().filter(|parts| parts.of_triangles.len() == count) else {
        return model;
    };
    let mut areas: BTreeMap<(u32, u32), BTreeMap<&str, f64>> = BTreeMap::new();
    for (triangle, (&layer, &node)) in
        model.mesh.triangle_materials.iter().zip(&parts.of_triangles).enumerate()
    {
        let material = low.mesh.triangle_materials.get(triangle).and_then(|&m| low.materials.get(m as usize));
        let name = material.map_or("", |material| &material.name);
        let area = f64::from(model.mesh.area_normal(triangle).length());
        *areas.entry((layer, node)).or_default().entry(name).or_default() += area;
    }
    let mut places: BTreeMap<(u32, &str), u32> = BTreeMap::new();
    let mut of_part: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for (&(layer, node), names) in areas.iter().filter(|((_, node), _)| *node != Hierarchy::NONE) {
        let largest = names.iter().max_by(|a, b| a.1.total_cmp(b.1)).map_or("", |(name, _)| name);
        let place = *places.entry((layer, largest)).or_insert_with(|| {
            let material = model.materials[layer as usize].clone();
            let name = if largest.is_empty() { material.name.clone() } else { largest.into() };
            model.materials.push(Material { name, ..material });
            model.materials.len() as u32 - 1
        });
        of_part.insert((layer, node), place);
    }
    for (material, &node) in model.mesh.triangle_materials.iter_mut().zip(&parts.of_triangles) {
        *material = of_part.get(&(*material, node)).copied().unwrap_or(*material);
    }
    model.parts = Some(parts.clone());
    model
}

/// Draw calls of a model's file: one for each material of each part and of the rest.
pub fn draw_calls(model: &Model) -> usize {
    let node = |triangle: usize| model.parts.as_ref().map(|parts| parts.of_triangles.get(triangle));
    let materials = model.mesh.triangle_materials.iter().enumerate();
    materials.map(|(triangle, &material)| (node(triangle), material)).collect::<BTreeSet<_>>().len()
}

/// What there is to say of a model's parts, in the order of their nodes.
pub fn part_reports(model: &Model) -> Vec<PartReport> {
    let Some(parts) = &model.parts else { return Vec::new() };
    let report =
        |(node, triangles): (&parbake_model::Node, usize)| PartReport { name: node.name.clone(), triangles };
    parts.nodes.iter().zip(parts.counts()).filter(|(_, count)| *count > 0).map(report).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parbake_model::glam::{DVec3, Vec3};
    use parbake_model::{Node, NodeTransform, Rig};

    /// Five triangles: on a car's body, on a wheel of two materials and its hub below, and on a lamp without one above it.
    fn car() -> Model {
        let node = |name: &str, parent| Node { name: name.into(), parent, rest: NodeTransform::IDENTITY };
        let nodes = vec![
            node("scene", None),
            node("body", Some(0)),
            node("wheel", Some(1)),
            node("hub", Some(2)),
            node("lamp", None),
        ];
        let sizes = [1.0, 1.0, 2.0, 1.0, 1.0f32];
        let mesh = Mesh {
            positions: sizes.iter().flat_map(|&s| [Vec3::ZERO, Vec3::X * s, Vec3::Y * s]).collect(),
            triangles: (0..5).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            triangle_materials: vec![0, 1, 2, 1, 0],
            ..Mesh::default()
        };
        let material = |name: &str| Material { name: name.into(), ..Material::default() };
        Model {
            name: "car".into(),
            mesh,
            materials: vec![material("paint"), material("rubber"), material("steel")],
            nodes: Some(Hierarchy { nodes, of_triangles: vec![1, 2, 2, 3, 4] }),
            ..Model::default()
        }
    }

    fn kept(model: &Model, patterns: &[&str]) -> Result<Model, String> {
        let patterns: Vec<String> = patterns.iter().map(ToString::to_string).collect();
        with_kept_parts(model, &patterns).map(Cow::into_owned).map_err(|error| error.to_string())
    }

    /// Protects pivots: a part takes along what hangs below it, but for parts of their own; nodes above it stay, others go.
    #[test]
    fn parts_are_nodes_with_what_hangs_below() {
        let names = |model: &Model| -> Vec<String> {
            model.parts.as_ref().unwrap().nodes.iter().map(|node| node.name.clone()).collect()
        };
        let whole = kept(&car(), &["wheel"]).unwrap();
        assert_eq!(names(&whole), ["scene", "body", "wheel"]);
        let none = Hierarchy::NONE;
        assert_eq!(whole.parts.as_ref().unwrap().of_triangles, [none, 2, 2, 2, none]);
        let apart = kept(&car(), &["hub", "whe*", "lamp"]).unwrap();
        assert_eq!(names(&apart), ["scene", "body", "wheel", "hub", "lamp"]);
        assert_eq!(apart.parts.as_ref().unwrap().of_triangles, [none, 2, 2, 3, 4]);
        let told: Vec<(String, usize)> =
            part_reports(&apart).into_iter().map(|p| (p.name, p.triangles)).collect();
        assert_eq!(told, [("wheel".to_string(), 2), ("hub".into(), 1), ("lamp".into(), 1)]);
    }

    /// Protects sockets and markers, which engines look up by name: they keep their node and its place, if they are named.
    #[test]
    fn nodes_without_triangles_stay() {
        let mut model = car();
        let nodes = &mut model.nodes.as_mut().unwrap().nodes;
        nodes.extend(
            ["socket_hook", "socket_light"].map(|name| Node { name: name.into(), ..nodes[2].clone() }),
        );
        let kept = kept(&model, &["lamp", "*_hook"]).unwrap().parts.unwrap();
        let names: Vec<&str> = kept.nodes.iter().map(|node| node.name.as_str()).collect();
        assert_eq!(names, ["scene", "body", "lamp", "socket_hook"]);
        assert_eq!((kept.nodes[3].parent, kept.counts()), (Some(1), vec![0, 0, 1, 0]));
    }

    /// Protects who asks for what cannot be: the model moves, or the node has no size.
    #[test]
    fn parts_that_cannot_stay_apart_are_refused() {
        let moving = Model { rig: Some(Rig::default()), ..car() };
        assert!(kept(&moving, &["wheel"]).unwrap_err().contains("nodes that move stay as joints"));
        let mut flat = car();
        flat.nodes.as_mut().unwrap().nodes[1].rest =
            NodeTransform::Matrix(DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)));
        assert!(kept(&flat, &["hub"]).unwrap_err().contains("node \"hub\" of car is scaled to nothing"));
        assert!(kept(&flat, &["lamp"]).is_ok());
    }

    /// Protects names of materials: a part of a result has the name of the material that most of it had, on the maps of
    /// all; the rest keeps its own. Parts of one material share it and are a draw call each.
    #[test]
    fn parts_have_the_names_of_their_materials() {
        let kept = kept(&car(), &["wheel", "lamp", "hub"]).unwrap();
        let low = with_parted_materials(&kept).into_owned();
        let parts = parts_of_materials(&low);
        let low = Model { parts: kept_parts_of(&low, &low.mesh, &parts), ..low };
        assert_eq!(low.parts, kept.parts);
        let mesh = Mesh { triangle_materials: vec![0; 5], ..low.mesh.clone() };
        let baked = Model {
            mesh,
            materials: vec![Material { name: "low".into(), ..Material::default() }],
            ..Model::default()
        };
        let baked = with_parts(baked, &low);
        let names: Vec<&str> = (baked.mesh.triangle_materials.iter())
            .map(|&material| baked.materials[material as usize].name.as_str())
            .collect();
        assert_eq!(names, ["low", "steel", "steel", "rubber", "paint"]);
        assert_eq!(draw_calls(&baked), 4);
        assert_eq!(draw_calls(&Model { parts: None, ..baked }), 4);
    }
}
