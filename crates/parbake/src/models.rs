//! Models made from models, and from nothing.

use crate::error::BakeError;
use crate::options::{BakeOptions, UvMode};
use parbake_mesh::compute_tangents;
use parbake_mesh::demo::{demo_low, demo_model, wall_low, wall_model};
use parbake_mesh::rigs::{carried, transferred};
use parbake_mesh::subdivide::subdivide;
use parbake_model::{Material, Mesh, Model};
use parbake_uv::surface::{RepairedLowPoly, repair_uvs};

/// The model with MikkTSpace tangents, where its materials need some and it has none, so that viewers need
/// not each make up their own (glTF 2.0, 3.7.2.1).
pub fn with_tangents(mut model: Model) -> Model {
    let needs = model.materials.iter().any(Material::has_normal_map);
    if !needs || !model.mesh.tangents.is_empty() || model.mesh.positions.is_empty() {
        return model;
    }
    // Along the coordinates at which most materials' normals are fetched.
    let normals = model.materials.iter().filter_map(|m| m.normal_texture);
    let second = normals.map(|slot| if slot.uv_set == 1 { 1 } else { -1 }).sum::<i32>() > 0;
    let is_second = second && !model.mesh.uvs1.is_empty();
    let before = model.rig.is_some().then(|| model.clone());
    let mesh = &mut model.mesh;
    if is_second {
        std::mem::swap(&mut mesh.uvs, &mut mesh.uvs1);
    }
    compute_tangents(mesh);
    if is_second {
        std::mem::swap(&mut mesh.uvs, &mut mesh.uvs1);
    }
    model.rig = before.and_then(|before| carried(&before, &model.mesh));
    model
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
    Ok(Model { name, mesh, materials: vec![Material::default()], ..Model::default() })
}

/// A copy with four times the triangles and the same shape.
pub fn subdivided(model: &Model) -> Model {
    let mesh = subdivide(&model.mesh);
    let rig = transferred(model, &mesh, &[]);
    with_tangents(Model { mesh, rig, nodes: None, painted: Vec::new(), parts: None, ..model.clone() })
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
    Model { name: name.into(), mesh, materials: vec![Material::default()], ..Model::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::TextureSlot;
    use parbake_model::glam::{Vec2, Vec3};

    /// Protects normal maps on the second set of coordinates.
    #[test]
    fn tangents_follow_the_coordinates_of_the_normal_map() {
        let slot = TextureSlot { uv_set: 1, ..TextureSlot::default() };
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            uvs1: vec![Vec2::ZERO, Vec2::Y, Vec2::X],
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![0],
            ..Mesh::default()
        };
        let materials = vec![Material { normal_texture: Some(slot), ..Material::default() }];
        let model = with_tangents(Model { mesh: mesh.clone(), materials, ..Model::default() });
        assert!(model.mesh.tangents.iter().all(|t| t.truncate().dot(Vec3::Y) > 0.99));
        assert_eq!((model.mesh.uvs, model.mesh.uvs1), (mesh.uvs, mesh.uvs1));
    }
}
