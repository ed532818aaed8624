//! A model whose materials without textures have texels of their own, so that its layout can be kept in one texture.

use parbake_atlas::with_own_squares;
use parbake_mesh::material_uvs;
use parbake_model::{Material, Mesh, Model, UvTransform};

/// Whether a material has textures, whichever they are.
pub fn has_textures(material: &Material) -> bool {
    material.all_texture_slots().next().is_some() || material.parallax.is_some()
}

/// The triangles of a model whose materials have textures.
pub fn drawn_part(model: &Model) -> Mesh {
    let mut mesh = model.mesh.clone();
    let is_drawn = |own: &u32| model.materials.get(*own as usize).is_some_and(has_textures);
    let mut kept = model.mesh.triangle_materials.iter().map(is_drawn);
    mesh.triangles.retain(|_| kept.next().unwrap_or(false));
    mesh.triangle_materials.retain(|own| is_drawn(own));
    mesh
}

/// The model without images, with the texture coordinates by which its materials read base colours, in which each material
/// without textures has a square of a few texels that no other triangle lies on. Base colours are no longer moved by materials.
///
/// None where no material is without textures, where vertices have colours, and where there is no room.
pub fn with_plain_parts_apart(model: &Model, texture_size: usize) -> Option<Model> {
    let mesh = &model.mesh;
    let is_plain = |material: &Material| !has_textures(material);
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
    let read = Mesh { uvs: material_uvs(mesh, &model.materials), ..mesh.clone() };
    let uvs = with_own_squares(&read, &groups, texture_size)?;
    let mut apart = Model {
        name: model.name.clone(),
        mesh: Mesh { uvs, ..read },
        materials: model.materials.clone(),
        images: Vec::new(),
        rig: model.rig.clone(),
        nodes: model.nodes.clone(),
        painted: model.painted.clone(),
        parts: model.parts.clone(),
    };
    for slot in apart.materials.iter_mut().filter_map(|material| material.base_color_texture.as_mut()) {
        (slot.uv_set, slot.transform) = (0, UvTransform::default());
    }
    Some(apart)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parbake_model::TextureSlot;
    use parbake_model::glam::{Vec2, Vec3, vec2};

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
