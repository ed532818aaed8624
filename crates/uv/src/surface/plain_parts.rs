//! A model whose materials without textures have texels of their own, so that its layout can be kept in one texture.

use parbake_atlas::with_own_squares;
use parbake_mesh::material_uvs;
use parbake_model::{Material, Model, UvTransform};

/// The model with texture coordinates as its materials read them, in which each material without textures has a square of a few
/// texels that no other triangle lies on. Its materials no longer move coordinates.
///
/// None where no material is without textures, where vertices have colours, and where there is no room.
pub fn with_plain_parts_apart(model: &Model, texture_size: usize) -> Option<Model> {
    let mesh = &model.mesh;
    let is_plain =
        |material: &Material| material.all_texture_slots().next().is_none() && material.parallax.is_none();
    if !mesh.colors.is_empty() || !model.materials.iter().any(is_plain) {
        return None;
    }
    let mut group_of = vec![None; model.materials.len()];
    let mut count = 0;
    for &own in &mesh.triangle_materials {
        let own = own as usize;
        if is_plain(&model.materials[own]) && group_of[own].is_none() {
            group_of[own] = Some(count);
            count += 1;
        }
    }
    let groups: Vec<Option<usize>> =
        mesh.triangle_materials.iter().map(|&own| group_of[own as usize]).collect();
    let mut apart = model.clone();
    apart.mesh.uvs = material_uvs(mesh, &model.materials);
    apart.mesh.uvs = with_own_squares(&apart.mesh, &groups, texture_size)?;
    for slot in apart.materials.iter_mut().filter_map(|material| material.base_color_texture.as_mut()) {
        (slot.uv_set, slot.transform) = (0, UvTransform::default());
    }
    Some(apart)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parbake_model::glam::{Vec2, Vec3, vec2};
    use parbake_model::{Mesh, TextureSlot};

    /// Protects texels of a drawing that a material without textures would lie on, and where that drawing is read.
    #[test]
    fn plain_materials_leave_the_drawing() {
        let triangle = [vec2(0.0, 0.0), vec2(0.0, 0.5), vec2(0.5, 0.0)];
        let mesh = Mesh {
            positions: (0..9).map(|v| Vec3::new(v as f32, (v * v) as f32, 1.0)).collect(),
            uvs: [triangle; 3].concat(),
            triangles: vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]],
            triangle_materials: vec![2, 0, 1],
            ..Mesh::default()
        };
        let transform = UvTransform { offset: Vec2::splat(0.25), ..UvTransform::default() };
        let drawn = Material {
            base_color_texture: Some(TextureSlot { transform, ..TextureSlot::default() }),
            ..Material::default()
        };
        let materials = vec![Material::default(), Material::default(), drawn];
        let model = Model { mesh, materials, ..Model::default() };
        let apart = with_plain_parts_apart(&model, 128).unwrap();
        assert_eq!(material_uvs(&apart.mesh, &apart.materials)[..3], triangle.map(|uv| uv + 0.25));
        let of = |t: usize| apart.mesh.uvs[3 * t];
        assert!(of(1).distance(of(2)) > 3.0 / 128.0);
        assert_eq!(apart.mesh.triangle_materials, model.mesh.triangle_materials);

        let mut colored = model.clone();
        colored.mesh.colors = vec![parbake_model::glam::Vec4::ONE; 9];
        assert!(with_plain_parts_apart(&colored, 128).is_none());
        let all_drawn = Model { materials: vec![model.materials[2].clone(); 3], ..model };
        assert!(with_plain_parts_apart(&all_drawn, 128).is_none());
    }
}
