//! What is written and read back is what it was: GLB to the bit, OBJ as far as it says
//! that it can.

use crate::LIMITS;
use parbake_files::{FileError, NoResources, glb_bytes, read_gltf_bytes, read_model, write_obj};
use parbake_model::glam::{Vec3, Vec4};
use parbake_model::{Material, Mesh, Model, TextureSlot};
use std::path::Path;

/// Writes a model as GLB, reads it, and compares; a model whose triangles have no area
/// is refused by the reader.
pub fn glb_comes_back(model: &Model) {
    let bytes = glb_bytes(model).unwrap();
    let result = read_gltf_bytes(Path::new("fuzz"), &bytes, &NoResources, &LIMITS);
    let kept = kept(&model.mesh);
    if kept.is_empty() {
        assert!(matches!(result, Err(FileError::Empty { .. })), "{result:?}");
        return;
    }
    let back = result.unwrap().model;
    // Triangles come in the order of their materials.
    let mut order = kept;
    order.sort_by_key(|&t| model.mesh.triangle_materials[t]);
    compare_all(model, &back, &order);
    // What was read comes back as well, in its order; what only triangles without an area
    // used is gone by then.
    let again = glb_bytes(&back).unwrap();
    let twice = read_gltf_bytes(Path::new("fuzz"), &again, &NoResources, &LIMITS).unwrap().model;
    compare_all(&back, &twice, &(0..back.mesh.triangles.len()).collect::<Vec<_>>());
}

/// Writes a model as OBJ into a folder, reads it, and compares what OBJ can say; a model
/// that says more is refused.
pub fn obj_comes_back(model: &Model, folder: &Path) {
    let path = folder.join("fuzz.obj");
    match write_obj(&path, model) {
        Ok(_) => {}
        Err(FileError::Unsupported { .. }) => return,
        Err(error) => panic!("{error}"),
    }
    let result = read_model(&path, &LIMITS);
    let kept = kept(&model.mesh);
    if kept.is_empty() {
        assert!(matches!(result, Err(FileError::Empty { .. })), "{result:?}");
        return;
    }
    // Files hold 1 - v, as a double.
    compare(model, &result.unwrap().model, &kept, f32::EPSILON * f32::EPSILON);
}

/// Triangles that have an area, which alone are read.
fn kept(mesh: &Mesh) -> Vec<usize> {
    let has_area = |&t: &usize| {
        let [a, b, c] = mesh.corners(t).map(Vec3::as_dvec3);
        let [i, j, k] = mesh.triangles[t];
        i != j && j != k && k != i && (b - a).cross(c - a) != Vec3::ZERO.as_dvec3()
    };
    (0..mesh.triangles.len()).filter(has_area).collect()
}

/// What glTF keeps beyond what [`compare`] looks at, and that.
fn compare_all(model: &Model, back: &Model, order: &[usize]) {
    compare(model, back, order, 0.0);
    let was =
        |values: &[Vec4], mesh: &Mesh, t: usize| mesh.triangles[t].map(|v| values.get(v as usize).copied());
    for (now, &before) in order.iter().enumerate() {
        let (a, b) = (&back.mesh, &model.mesh);
        assert_eq!(was(&a.tangents, a, now), was(&b.tangents, b, before));
        assert_eq!(was(&a.colors, a, now), was(&b.colors, b, before));
        let second = |mesh: &Mesh, t: usize| {
            mesh.triangles[t].map(|v| mesh.uvs1.get(v as usize).copied().unwrap_or_default())
        };
        assert_eq!(second(a, now), second(b, before));
        let (a, b) = materials(back, now, model, before);
        assert_eq!((a.base_color, a.alpha_mode), (b.base_color, b.alpha_mode));
        let transforms =
            |m: &Material| m.texture_slots().map(|s| (s.uv_set, s.wrap, s.transform)).collect::<Vec<_>>();
        assert_eq!(transforms(a), transforms(b));
    }
}

/// What every format keeps, triangle by triangle; `order` gives the places before.
fn compare(model: &Model, back: &Model, order: &[usize], uv_tolerance: f32) {
    let (a, b) = (&back.mesh, &model.mesh);
    assert_eq!(a.triangles.len(), order.len());
    for (now, &before) in order.iter().enumerate() {
        assert_eq!(a.corners(now), b.corners(before));
        for (a, b) in a.corner_uvs(now).into_iter().zip(b.corner_uvs(before)) {
            assert!((a - b).abs().max_element() <= uv_tolerance, "{a} {b}");
        }
        let normals = |m: &Mesh, t: usize| m.triangles[t].map(|v| m.normals.get(v as usize).copied());
        assert_eq!(normals(a, now), normals(b, before));
        let (a, b) = materials(back, now, model, before);
        let same = |now: Option<TextureSlot>, before: Option<TextureSlot>| {
            let pixels = |m: &Model, s: TextureSlot| {
                let image = &m.images[s.image];
                (image.width, image.height, image.pixels.clone())
            };
            assert_eq!(now.map(|s| pixels(back, s)), before.map(|s| pixels(model, s)));
        };
        same(a.base_color_texture, b.base_color_texture);
        same(a.normal_texture, b.normal_texture);
        if b.normal_texture.is_some() {
            assert_eq!(a.normal_scale, b.normal_scale);
        }
        for (a, b) in a.base_color.into_iter().zip(b.base_color) {
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
    }
}

fn materials<'a>(
    back: &'a Model,
    now: usize,
    model: &'a Model,
    before: usize,
) -> (&'a Material, &'a Material) {
    let of = |m: &'a Model, t: usize| &m.materials[m.mesh.triangle_materials[t] as usize];
    (of(back, now), of(model, before))
}
