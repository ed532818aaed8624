//! Tangent frames as viewers make them up for models that have none: those of each triangle by itself.
//!
//! ```text
//! t = s ∇u, b = −s ∇v, s = 1 / max(|∇u|, |∇v|), across the vertex's normal n, for coordinates u and v of the normal map
//! ```
//!
//! as three.js has it (after Schüler 2006, "Normal Mapping Without Precomputed Tangents"): a map that is stretched along one side
//! tilts normals less along it. What ∇u and ∇v lack of a right angle is left out, since b = w · n × t here.
//!
//! glTF asks for MikkTSpace there, and bakes are fitted for it and written with tangents. A level with its model's own maps gets
//! no tangents, so in a viewer it differs from its model no more than its triangles do.
//!
//! Contract: for pictures alone, since tangents are at most 1 long and w may be any number. A model that has tangents, no normals or
//! no normal map stays as it is.

use parbake_mesh::ensure_normals;
use parbake_model::glam::Vec4;
use parbake_model::{Material, Mesh, Model};
use std::borrow::Cow;

/// The model with three vertices of its own for each triangle, and the tangents of its triangles. It has no rig any more.
pub fn with_face_tangents(model: &Model) -> Cow<'_, Model> {
    let needs = model.materials.iter().any(Material::has_normal_map);
    if !needs || !model.mesh.tangents.is_empty() || model.mesh.normals.is_empty() {
        return Cow::Borrowed(model);
    }
    let mut model = model.clone();
    model.rig = None;
    // Renderers make up their own tangents where they have to mend normals.
    ensure_normals(&mut model.mesh);
    let mesh = &model.mesh;
    let corners: Vec<usize> = mesh.triangles.as_flattened().iter().map(|&v| v as usize).collect();
    fn of<T: Copy>(values: &[T], corners: &[usize]) -> Vec<T> {
        if values.is_empty() { Vec::new() } else { corners.iter().map(|&v| values[v]).collect() }
    }
    model.mesh = Mesh {
        positions: of(&mesh.positions, &corners),
        normals: of(&mesh.normals, &corners),
        tangents: (0..mesh.triangles.len()).flat_map(|triangle| tangents(&model, triangle)).collect(),
        uvs: of(&mesh.uvs, &corners),
        uvs1: of(&mesh.uvs1, &corners),
        colors: of(&mesh.colors, &corners),
        parallax_offsets: of(&mesh.parallax_offsets, &corners),
        triangles: (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        triangle_materials: mesh.triangle_materials.clone(),
    };
    Cow::Owned(model)
}

/// Gradients of coordinates that are shorter beside the other one's say nothing.
const LEAST: f32 = 1e-3;

/// The tangents at the corners of a triangle; of a map without extent there they are 0, so that it tilts nothing.
fn tangents(model: &Model, triangle: usize) -> [Vec4; 3] {
    let mesh = &model.mesh;
    let corners = mesh.triangles[triangle].map(|v| v as usize);
    let material = model.materials.get(mesh.triangle_materials[triangle] as usize);
    let slot = material.and_then(|own| own.normal_texture).unwrap_or_default();
    let set = if slot.uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
    let [a, b, c] = corners.map(|v| slot.transform.apply(set.get(v).copied().unwrap_or_default()));
    let [p, q, r] = mesh.corners(triangle);
    let (first, second) = (q - p, r - p);
    corners.map(|corner| {
        let normal = mesh.normals[corner];
        // Both gradients times the same number.
        let (along, across) = (second.cross(normal), normal.cross(first));
        let [u, v] = [0, 1].map(|k| along * (b - a)[k] + across * (c - a)[k]);
        let longest = u.length().max(v.length());
        if !(longest > 0.0 && u.length() > LEAST * longest) {
            return Vec4::ZERO;
        }
        let (t, b) = (u / longest, -v / longest);
        t.extend(normal.cross(t).dot(b) / t.length_squared())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_mesh::compute_tangents;
    use parbake_model::TextureSlot;
    use parbake_model::glam::{Vec2, Vec3, vec2};

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

    /// Protects light on flat surfaces, mirrored and turned ones too: where maps are not stretched, MikkTSpace and viewers agree.
    #[test]
    fn flat_surfaces_have_the_frames_of_mikktspace() {
        let ways: [fn(Vec3) -> Vec2; 3] = [
            |p| vec2(p.x, 1.0 - p.y),
            |p| vec2(1.0 - p.x, 1.0 - p.y),
            |p| vec2(p.y + 0.3 * p.x, p.x - 0.3 * p.y),
        ];
        for uv in ways {
            let model = sheet(uv);
            let mut wanted = model.mesh.clone();
            compute_tangents(&mut wanted);
            let own = with_face_tangents(&model);
            let wanted = wanted.triangles.as_flattened().iter().map(|&v| wanted.tangents[v as usize]);
            for (own, wanted) in own.mesh.tangents.iter().zip(wanted) {
                assert!((*own - wanted).length() < 1e-4, "{own} {wanted}");
            }
            assert_eq!((own.mesh.tangents.len(), own.mesh.positions.len()), (6, 6));
        }
    }

    /// Protects the strength of relief: of a map that is stretched along one side it is less along that side, never more than what
    /// the map says. Maps without extent tilt nothing.
    #[test]
    fn stretched_maps_tilt_less() {
        for (scale, tangent, w) in [
            (vec2(2.0, -1.0), Vec3::X, 0.5),
            (vec2(1.0, -4.0), 0.25 * Vec3::X, 4.0),
            (vec2(0.0, 0.0), Vec3::ZERO, 0.0),
        ] {
            let model = sheet(|p| scale * p.truncate());
            let own = with_face_tangents(&model);
            for found in &own.mesh.tangents {
                assert!((*found - tangent.extend(w)).length() < 1e-5, "{found}");
            }
        }
    }

    /// Protects models that say how their normal maps are meant, and memory where there are none.
    #[test]
    fn delivered_tangents_stay() {
        let mut model = sheet(|p| vec2(p.x, p.y));
        compute_tangents(&mut model.mesh);
        assert!(matches!(with_face_tangents(&model), Cow::Borrowed(_)));
        model.mesh.tangents.clear();
        model.materials[0].normal_texture = None;
        assert!(matches!(with_face_tangents(&model), Cow::Borrowed(_)));
    }
}
