//! Tangent frames as viewers make them up for models that have none: those of each triangle by itself.
//!
//! ```text
//! t = ∂p/∂u, b = −∂p/∂v of the normal map's coordinates, constant on a triangle (Mikkelsen 2010, as three.js has it)
//! ```
//!
//! glTF asks for MikkTSpace there, and bakes are fitted for it and written with tangents. A level with its model's own maps gets
//! no tangents, so in a viewer it differs from its model no more than its triangles do.
//!
//! Contract: a model that has tangents, no normals or no normal map stays as it is.

use parbake_model::glam::{Vec3, Vec4};
use parbake_model::{Material, Mesh, Model};
use std::borrow::Cow;

/// The model with three vertices of its own for each triangle, and the tangents of its triangles. It has no rig any more.
pub(crate) fn with_face_tangents(model: Cow<'_, Model>) -> Cow<'_, Model> {
    let mesh = &model.mesh;
    let needs = model.materials.iter().any(Material::has_normal_map);
    if !needs || !mesh.tangents.is_empty() || mesh.normals.is_empty() {
        return model;
    }
    let corners: Vec<usize> = mesh.triangles.as_flattened().iter().map(|&v| v as usize).collect();
    fn of<T: Copy>(values: &[T], corners: &[usize]) -> Vec<T> {
        if values.is_empty() { Vec::new() } else { corners.iter().map(|&v| values[v]).collect() }
    }
    let tangents = (0..mesh.triangles.len()).flat_map(|triangle| tangents(&model, triangle)).collect();
    let split = Mesh {
        positions: of(&mesh.positions, &corners),
        normals: of(&mesh.normals, &corners),
        tangents,
        uvs: of(&mesh.uvs, &corners),
        uvs1: of(&mesh.uvs1, &corners),
        colors: of(&mesh.colors, &corners),
        parallax_offsets: of(&mesh.parallax_offsets, &corners),
        triangles: (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        triangle_materials: mesh.triangle_materials.clone(),
    };
    Cow::Owned(Model { mesh: split, rig: None, ..model.into_owned() })
}

/// The tangents at the corners of a triangle.
fn tangents(model: &Model, triangle: usize) -> [Vec4; 3] {
    let mesh = &model.mesh;
    let corners = mesh.triangles[triangle].map(|v| v as usize);
    let material = model.materials.get(mesh.triangle_materials[triangle] as usize);
    let slot = material.and_then(|own| own.normal_texture).unwrap_or_default();
    let set = if slot.uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
    let [a, b, c] = corners.map(|v| slot.transform.apply(set.get(v).copied().unwrap_or_default()));
    let [p, q, r] = mesh.corners(triangle);
    let (first, second) = (b - a, c - a);
    // Both times the same positive number, which says nothing about directions.
    let side = first.perp_dot(second).signum();
    let along_u = ((q - p) * second.y - (r - p) * first.y) * side;
    let against_v = ((q - p) * second.x - (r - p) * first.x) * side;
    corners.map(|v| {
        let normal = mesh.normals[v];
        let tangent = along_u - normal * normal.dot(along_u);
        let tangent = tangent.try_normalize().unwrap_or_else(|| normal.any_orthogonal_vector());
        let is_turned = normal.cross(tangent).dot(against_v) < 0.0;
        Vec3::normalize_or(tangent, Vec3::X).extend(if is_turned { -1.0 } else { 1.0 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_mesh::compute_tangents;
    use parbake_model::TextureSlot;
    use parbake_model::glam::{Vec2, vec2};

    /// Two triangles in a plane, with coordinates that `uv` gives.
    fn sheet(uv: impl Fn(Vec3) -> Vec2) -> Model {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let mesh = Mesh {
            uvs: positions.iter().map(|&p| uv(p)).collect(),
            normals: vec![Vec3::Z; 4],
            positions,
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        };
        let material = Material { normal_texture: Some(TextureSlot::default()), ..Material::default() };
        Model { mesh, materials: vec![material], ..Model::default() }
    }

    /// Protects light on flat surfaces, mirrored and turned ones too: there MikkTSpace and viewers agree.
    #[test]
    fn flat_surfaces_have_the_frames_of_mikktspace() {
        let ways: [fn(Vec3) -> Vec2; 3] =
            [|p| vec2(p.x, 1.0 - p.y), |p| vec2(1.0 - p.x, 1.0 - p.y), |p| vec2(p.y + 0.3 * p.x, p.x)];
        for uv in ways {
            let model = sheet(uv);
            let mut wanted = model.mesh.clone();
            compute_tangents(&mut wanted);
            let own = with_face_tangents(Cow::Borrowed(&model));
            let wanted = wanted.triangles.as_flattened().iter().map(|&v| wanted.tangents[v as usize]);
            for (own, wanted) in own.mesh.tangents.iter().zip(wanted) {
                assert!((*own - wanted).length() < 1e-4, "{own} {wanted}");
            }
            assert_eq!((own.mesh.tangents.len(), own.mesh.positions.len()), (6, 6));
        }
    }

    /// Protects models that say how their normal maps are meant, and memory where there are none.
    #[test]
    fn delivered_tangents_stay() {
        let mut model = sheet(|p| vec2(p.x, p.y));
        compute_tangents(&mut model.mesh);
        assert!(matches!(with_face_tangents(Cow::Borrowed(&model)), Cow::Borrowed(_)));
        model.mesh.tangents.clear();
        model.materials[0].normal_texture = None;
        assert!(matches!(with_face_tangents(Cow::Borrowed(&model)), Cow::Borrowed(_)));
    }
}
