//! Texture coordinates as a model's materials read them.

use parbake_model::glam::Vec2;
use parbake_model::{Material, Mesh};

/// Where each vertex falls on the low-poly's own texture: its first material's set
/// of coordinates, moved as that material says. What is written is read without.
///
/// A mesh without coordinates has none.
pub fn material_uvs(mesh: &Mesh, materials: &[Material]) -> Vec<Vec2> {
    let mut uvs = if mesh.uvs.is_empty() { vec![Vec2::ZERO; mesh.uvs1.len()] } else { mesh.uvs.clone() };
    if uvs.is_empty() {
        return uvs;
    }
    let mut moved = vec![false; uvs.len()];
    for (triangle, &material) in mesh.triangles.iter().zip(&mesh.triangle_materials) {
        let slot = materials.get(material as usize).and_then(|m| m.base_color_texture);
        let Some(slot) = slot else { continue };
        for corner in triangle.map(|i| i as usize) {
            if !std::mem::replace(&mut moved[corner], true) {
                let own = if slot.uv_set == 1 { mesh.uvs1.get(corner) } else { mesh.uvs.get(corner) };
                uvs[corner] = slot.transform.apply(own.copied().unwrap_or_default());
            }
        }
    }
    uvs
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::{TextureSlot, UvTransform};

    /// Protects quantised files, whose raw coordinates lie far outside the texture,
    /// and files that keep their unwrapped layout in the second set.
    #[test]
    fn the_materials_coordinates_are_baked_on() {
        let transform = UvTransform { scale: Vec2::splat(0.5), ..UvTransform::default() };
        let slot = TextureSlot { uv_set: 1, transform, ..TextureSlot::default() };
        let mesh = Mesh {
            uvs: vec![Vec2::ZERO; 4],
            uvs1: vec![Vec2::ONE, Vec2::X, Vec2::Y, Vec2::ONE],
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![0],
            ..Mesh::default()
        };
        let material = Material { base_color_texture: Some(slot), ..Material::default() };
        let half = Vec2::splat(0.5);
        let materials = [material];
        let wanted = [half, Vec2::X * 0.5, Vec2::Y * 0.5, Vec2::ZERO];
        assert_eq!(material_uvs(&mesh, &materials), wanted);
        let second_alone = Mesh { uvs: Vec::new(), ..mesh };
        assert_eq!(material_uvs(&second_alone, &materials), wanted);
        assert!(material_uvs(&Mesh { uvs1: Vec::new(), ..second_alone }, &materials).is_empty());
    }
}
