//! Levels of detail in one GLB file: `MSFT_lod` with `MSFT_screencoverage`.
//!
//! The node of the finest level is the one in the scene and names the nodes of the others. The extension's page
//! leaves open what a coverage is measured by; it is the share of the screen's height here, as UnityGLTF reads it.
//! There lower levels become children of the first one's node and keep their transforms: so nodes of levels have
//! none. Where positions are quantised, each has a child that places its mesh.
//!
//! Contract: a file of one model is the same as without levels.

use super::binary::Binary;
use super::quantise::Grid;
use super::write_mesh::primitives;
use parbake_model::{Mesh, Model};
use serde_json::{Value, json};

pub const NAME: &str = "MSFT_lod";

/// All materials and images of all levels, and of their meshes as much as says which are used.
pub fn together(levels: &[&Model]) -> Model {
    if let [only] = levels {
        return (*only).clone();
    }
    let mut all =
        Model { name: levels.first().map_or(String::new(), |l| l.name.clone()), ..Model::default() };
    for level in levels {
        let (images, materials) = (all.images.len(), all.materials.len() as u32);
        all.images.extend(level.images.iter().cloned());
        for material in &level.materials {
            let mut material = material.clone();
            material.for_each_image(|image| *image += images);
            all.materials.push(material);
        }
        let Mesh { tangents, triangle_materials, .. } = &level.mesh;
        all.mesh.tangents.extend_from_slice(tangents);
        all.mesh.triangle_materials.extend(triangle_materials.iter().map(|m| m + materials));
    }
    all
}

/// The mesh of each level; its primitives name materials by their places among those that are used.
pub fn meshes(binary: &mut Binary, levels: &[&Model], grid: Option<&Grid>) -> Vec<Value> {
    let mut places = 0;
    let mesh = |level: &&Model| {
        let is_used = |material: &usize| level.mesh.triangle_materials.contains(&(*material as u32));
        let used: Vec<usize> = (0..level.materials.len()).filter(is_used).collect();
        let mut primitives = primitives(binary, level, &used, grid);
        for primitive in &mut primitives {
            let own = primitive["material"].as_u64().unwrap_or(0) as usize;
            primitive["material"] = (places + own).into();
        }
        places += used.len();
        json!({ "name": level.name, "primitives": primitives })
    };
    levels.iter().map(mesh).collect()
}

/// The nodes: one for each level, and where positions are on a grid one below each.
pub fn nodes(levels: &[&Model], coverages: Option<&[f64]>, grid: Option<&Grid>) -> Vec<Value> {
    let Some(coverages) = coverages else {
        let mut node = json!({ "mesh": 0, "name": levels.first().map_or("", |level| &level.name) });
        if let Some(grid) = grid {
            grid.place(&mut node);
        }
        return vec![node];
    };
    let count = levels.len();
    let mut nodes: Vec<Value> = (levels.iter().enumerate())
        .map(|(index, level)| match grid {
            None => json!({ "mesh": index, "name": level.name }),
            Some(_) => json!({ "children": [count + index], "name": level.name }),
        })
        .collect();
    if count > 1 {
        nodes[0]["extensions"][NAME] = json!({ "ids": (1..count).collect::<Vec<_>>() });
    }
    nodes[0]["extras"] = json!({ "MSFT_screencoverage": coverages });
    if let Some(grid) = grid {
        nodes.extend((0..count).map(|index| {
            let mut node = json!({ "mesh": index });
            grid.place(&mut node);
            node
        }));
    }
    nodes
}
