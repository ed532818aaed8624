//! Writing GLB, and reading it back.

use super::super::*;
use crate::NoResources;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{Image, Material, Mesh, TextureSlot, UvTransform, Wrap};

fn model() -> Model {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(0.1, 0.2, -0.3), Vec3::splat(3.3)],
        normals: vec![Vec3::Z, Vec3::X, Vec3::Y, Vec3::new(0.6, 0.8, 0.0)],
        tangents: vec![
            Vec4::new(1.0, 0.0, 0.0, -1.0),
            Vec4::Y + Vec4::W,
            Vec4::Z + Vec4::W,
            Vec4::Z + Vec4::W,
        ],
        uvs: vec![Vec2::new(0.1, -0.7), Vec2::ONE, Vec2::X, Vec2::Y],
        uvs1: vec![Vec2::new(0.3, 0.9); 4],
        colors: vec![Vec4::splat(0.3), Vec4::ONE, Vec4::W, Vec4::ONE],
        parallax_offsets: Vec::new(),
        triangles: vec![[0, 1, 2], [3, 2, 1]],
        triangle_materials: vec![0, 0],
    };
    let transform = UvTransform { offset: Vec2::X * 0.1, rotation: 0.7, scale: Vec2::new(2.0, 3.0) };
    let slot = TextureSlot { image: 0, uv_set: 1, wrap: [Wrap::Clamp, Wrap::Mirror], transform };
    let material = Material {
        name: "m".into(),
        base_color: [0.1, 0.2, 0.3, 1.0],
        base_color_texture: Some(slot),
        normal_texture: Some(TextureSlot { image: 1, ..TextureSlot::default() }),
        normal_scale: 0.3,
        ..Material::default()
    };
    let images = vec![Image::solid("a", 2, 3, [1, 2, 3, 4]), Image::solid("b", 3, 2, [5, 6, 7, 255])];
    Model { name: "x".into(), mesh, materials: vec![material], images, ..Model::default() }
}

/// Protects every bit of a model on its way through a GLB file.
#[test]
fn glb_comes_back_the_same() {
    let model = model();
    let bytes = glb_bytes(&model).unwrap();
    assert_eq!(bytes, glb_bytes(&model).unwrap(), "deterministic");
    let loaded = read_gltf_bytes(Path::new("x.glb"), &bytes, &NoResources, &Limits::default()).unwrap();
    assert_eq!(loaded.warnings, [""; 0]);
    assert_eq!(Model { nodes: None, ..loaded.model }, model);
}

/// Protects the file's validity where the model has faults that can be repaired.
#[test]
fn invalid_vectors_and_missing_uvs_are_repaired() {
    let mut broken = model();
    broken.mesh.normals[1] = Vec3::ZERO;
    broken.mesh.tangents[2] = Vec4::ZERO;
    broken.mesh.uvs.clear();
    broken.mesh.uvs1.clear();
    broken.mesh.triangle_materials[1] = 1;
    broken.materials.push(Material::default());
    let bytes = glb_bytes(&broken).unwrap();
    let loaded = read_gltf_bytes(Path::new("x.glb"), &bytes, &NoResources, &Limits::default()).unwrap();
    let mesh = &loaded.model.mesh;
    assert!(mesh.normals.iter().all(|n| n.is_normalized()));
    assert!(mesh.tangents.iter().all(|t| t.truncate().is_normalized() && t.w.abs() == 1.0));
    assert!(mesh.uvs.iter().chain(&mesh.uvs1).all(|&uv| uv == Vec2::ZERO) && !mesh.uvs1.is_empty());
    assert_eq!(loaded.model.materials.len(), 2);
}

/// Protects large meshes: from 65536 vertices on indices take four bytes.
#[test]
fn many_vertices_take_long_indices() {
    let mut large = model();
    let last = large.mesh.positions.len();
    large.mesh.positions.resize(65_536, Vec3::Z);
    large.mesh.positions[last..].iter_mut().enumerate().for_each(|(i, p)| p.x = i as f32);
    large.mesh = Mesh {
        positions: std::mem::take(&mut large.mesh.positions),
        triangles: (0..65_534).map(|i| [i, (i + 1) % 4, i + 2]).collect(),
        triangle_materials: vec![0; 65_534],
        ..Mesh::default()
    };
    let bytes = glb_bytes(&large).unwrap();
    let loaded = read_gltf_bytes(Path::new("x.glb"), &bytes, &NoResources, &Limits::default()).unwrap();
    assert_eq!(loaded.model.mesh.positions, large.mesh.positions);
    assert!(loaded.model.mesh.triangles.contains(&[65_533, 2, 65_535]));
}

/// Protects mip levels and quality: what a texture is, is read off all materials that have it.
#[test]
fn purposes_follow_from_slots() {
    use super::super::image_purpose::purpose_of;
    use crate::ktx2_out::Content;
    use crate::texture_out::{Purpose, Use};
    use parbake_model::{AlphaMode, ParallaxMap, Sheen};
    let slot = |image| Some(TextureSlot { image, ..TextureSlot::default() });
    let mut material = Material {
        base_color_texture: slot(0),
        base_color: [1.0, 1.0, 1.0, 0.5],
        alpha_mode: AlphaMode::Mask,
        alpha_cutoff: 0.3,
        normal_texture: slot(1),
        occlusion_texture: slot(2),
        emissive_texture: slot(3),
        ..Material::default()
    };
    // One image often has the colour and, in its alpha, the roughness.
    let sheen = Sheen { color: [1.0; 3], color_texture: slot(4), roughness: 1.0, roughness_texture: slot(4) };
    material.extensions.sheen = Some(sheen);
    let mut model = Model { materials: vec![material], ..model() };
    let purpose = |of, content, cutoff| Purpose { of, content, cutoff };
    let expected = [
        purpose(Use::Color, Content::Color, Some(0.6)),
        purpose(Use::Data, Content::Normal, None),
        purpose(Use::Data, Content::Values, None),
        purpose(Use::Color, Content::Color, None),
        purpose(Use::Data, Content::Color, None),
    ];
    assert_eq!([0, 1, 2, 3, 4].map(|image| purpose_of(&model, image)), expected);
    model.materials[0].alpha_mode = AlphaMode::Blend;
    assert_eq!(purpose_of(&model, 0).cutoff, None);
    // Without the extension only base colour 0 and the normals 1 are seen, with it 5 in the place of the colours.
    model.materials[0].parallax = Some(ParallaxMap { base_color_texture: slot(5), ..ParallaxMap::default() });
    let uses = |model: &Model| [0, 1, 3, 5].map(|image| purpose_of(model, image).of);
    assert_eq!(uses(&model), [Use::Fallback, Use::Data, Use::Color, Use::Color]);
    model.materials.push(Material { base_color_texture: slot(0), ..Material::default() });
    assert_eq!(uses(&model)[0], Use::Color, "another material shows it");
}
