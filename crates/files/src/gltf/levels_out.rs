//! Levels of detail in one GLB file: `MSFT_lod` with `MSFT_screencoverage`.
//!
//! The node of the finest level is the one in the scene and names the nodes of the others. The extension's page
//! leaves open what a coverage is measured by; it is the share of the screen's height here, as UnityGLTF reads it.
//! There lower levels become children of the first one's node and keep their transforms: so nodes of levels have
//! none. Where positions are quantised, each has a child that places its mesh. Parts that stay apart hang below the node
//! of their level, with all nodes that are above them.
//!
//! Contract: a file of one model is the same as without levels.

use super::binary::Binary;
use super::material_lists::Materials;
use super::pieces::Piece;
use super::write_mesh::primitives;
use super::write_nodes::{add_children, hang, nodes_of};
use parbake_model::{Mesh, Model};
use serde_json::{Value, json};

pub const NAME: &str = "MSFT_lod";

/// All materials and images of all levels, in their order, and tangents to say that there are some.
pub fn together(levels: &[&Model]) -> Model {
    if let [only] = levels {
        return (*only).clone();
    }
    let mut all =
        Model { name: levels.first().map_or(String::new(), |l| l.name.clone()), ..Model::default() };
    for level in levels {
        let images = all.images.len();
        all.images.extend(level.images.iter().cloned());
        for material in &level.materials {
            let mut material = material.clone();
            material.for_each_image(|image| *image += images);
            all.materials.push(material);
        }
        let Mesh { tangents, .. } = &level.mesh;
        all.mesh.tangents.extend_from_slice(tangents);
    }
    all
}

/// The mesh of each piece; its materials, which `all` has of all levels, are added to those of the document. Grids are
/// `placed` by nodes, or by joints.
pub fn meshes(
    binary: &mut Binary,
    materials: &mut Materials,
    levels: &[&Model],
    all: &Model,
    pieces: &[Piece<'_>],
    placed: bool,
) -> Vec<Value> {
    let mesh = |piece: &Piece<'_>| {
        let before: usize = levels[..piece.level].iter().map(|level| level.materials.len()).sum();
        let model = &*piece.model;
        let is_used = |material: &usize| model.mesh.triangle_materials.contains(&(*material as u32));
        let used: Vec<usize> = (0..model.materials.len()).filter(is_used).collect();
        let unit = if placed { piece.unit() } else { piece.scale };
        let places: Vec<usize> =
            used.iter().map(|&material| materials.place_of(all, before + material, unit)).collect();
        let mut primitives = primitives(binary, model, &used, piece.grid.as_ref());
        for primitive in &mut primitives {
            let own = primitive["material"].as_u64().unwrap_or(0) as usize;
            primitive["material"] = places[own].into();
        }
        json!({ "name": model.name, "primitives": primitives })
    };
    pieces.iter().map(mesh).collect()
}

/// The nodes: one for each level, then what places the grids of its rest, then those of its parts. Grids are `placed` by
/// nodes, or by joints.
pub fn nodes(levels: &[&Model], coverages: Option<&[f64]>, pieces: &[Piece<'_>], placed: bool) -> Vec<Value> {
    let mut nodes: Vec<Value> = levels.iter().map(|level| json!({ "name": level.name })).collect();
    let numbered = || pieces.iter().enumerate();
    let grid = |piece: &'_ Piece<'_>| piece.grid.filter(|_| placed);
    for (mesh, piece) in numbered().filter(|(_, piece)| piece.node.is_none()) {
        let is_free = coverages.is_none() && levels[piece.level].parts.is_none();
        hang(&mut nodes, piece.level, mesh, grid(piece).as_ref(), is_free);
    }
    for (level, model) in levels.iter().enumerate() {
        let Some(parts) = &model.parts else { continue };
        let first = nodes.len();
        let (own, roots) = nodes_of(&parts.nodes, first);
        nodes.extend(own);
        add_children(&mut nodes[level], roots);
        for (mesh, piece) in numbered().filter(|(_, piece)| piece.level == level) {
            if let Some(node) = piece.node {
                hang(&mut nodes, first + node, mesh, grid(piece).as_ref(), false);
            }
        }
    }
    let Some(coverages) = coverages else { return nodes };
    if levels.len() > 1 {
        nodes[0]["extensions"][NAME] = json!({ "ids": (1..levels.len()).collect::<Vec<_>>() });
    }
    nodes[0]["extras"] = json!({ "MSFT_screencoverage": coverages });
    nodes
}
