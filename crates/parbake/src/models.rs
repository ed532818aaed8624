//! Models made from models, and from nothing.

use crate::error::BakeError;
use crate::options::{BakeOptions, UvMode};
use parbake_mesh::demo::{demo_low, demo_model, wall_low, wall_model};
use parbake_mesh::simplify::{SimplifyOptions, simplify};
use parbake_mesh::subdivide::subdivide;
use parbake_model::{Material, Mesh, Model};
use parbake_uv::surface::{RepairedLowPoly, repair_uvs};

/// A coarser copy of about this many triangles, with the same materials.
pub fn simplified(model: &Model, triangles: usize) -> Model {
    let options = SimplifyOptions { target_triangles: triangles, ..SimplifyOptions::default() };
    Model { mesh: simplify(&model.mesh, options), ..model.clone() }
}

/// A copy of a model whose texture coordinates are repaired or made anew as the mode asks, for a
/// texture of this size, and not moved.
///
/// # Errors
/// Where charts do not fit into the texture.
pub fn laid_out(low: &Model, mode: UvMode, texture_size: usize) -> Result<Model, BakeError> {
    let options = BakeOptions { texture_size, ..BakeOptions::default() };
    let RepairedLowPoly { name, mut mesh, .. } = repair_uvs(low, &options.uv_stage_as(mode))?;
    mesh.triangle_materials.fill(0);
    Ok(Model { name, mesh, materials: vec![Material::default()], images: Vec::new() })
}

/// A copy with four times the triangles and the same shape.
pub fn subdivided(model: &Model) -> Model {
    Model { mesh: subdivide(&model.mesh), ..model.clone() }
}

/// The built-in detailed model, an ornate jar, and its coarse counterpart.
pub fn demo_pair() -> (Model, Model) {
    let high = demo_model();
    let low = plain("demo jar", demo_low(&high));
    (high, low)
}

/// The other built-in pair: a cube of brick walls, and the plain cube.
pub fn wall_pair() -> (Model, Model) {
    (wall_model(), plain("demo wall", wall_low()))
}

/// A model without textures.
fn plain(name: &str, mesh: Mesh) -> Model {
    Model { name: name.into(), mesh, materials: vec![Material::default()], images: Vec::new() }
}
