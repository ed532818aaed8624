//! Materials on the way through files: every field of a metallic-roughness material comes back from
//! a GLB file as it went in, and what MTL can say from an OBJ file.
//!
//! Where `$PARBAKE_GLB_OUT` names a folder, the GLB files stay there, for the
//! Khronos validator to look at (`tools/validate_gltf`).

use crate::common::keep;
use parbake_files::{Limits, Loaded, glb_bytes, read_model, write_glb, write_obj};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{
    AlphaMode, Anisotropy, Clearcoat, DiffuseTransmission, Image, Iridescence, Material, MaterialExtensions,
    Mesh, Model, Sheen, Specular, TextureSlot, Transmission, UvTransform, Volume, Wrap,
};
use serde_json::{Value, json};
use std::path::Path;

/// A triangle for each material, with both sets of texture coordinates, and six images.
fn model(materials: Vec<Material>) -> Model {
    let mut mesh = Mesh::default();
    for (i, corner) in (0..materials.len()).flat_map(|i| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|c| (i, c))) {
        mesh.positions.push(corner + Vec3::Z * i as f32);
        mesh.normals.push(Vec3::Z);
        mesh.tangents.push(Vec4::new(1.0, 0.0, 0.0, -1.0));
        mesh.uvs.push(corner.truncate());
        mesh.uvs1.push(Vec2::splat(0.3) + corner.truncate() * 0.2);
    }
    let triangles = 0..materials.len() as u32;
    mesh.triangles = triangles.clone().map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    mesh.triangle_materials = triangles.collect();
    let image = |i: u8| Image::solid(&format!("image {i}"), 4, 2 + usize::from(i), [i, 10 * i, 128, 255]);
    Model { name: "m".into(), mesh, materials, images: (0..6).map(image).collect(), ..Model::default() }
}

/// Images, sets, wrap modes and transforms that no two textures of a material share.
fn slot(image: usize) -> Option<TextureSlot> {
    let x = image as f32;
    let transform =
        UvTransform { offset: Vec2::new(0.1 * x, -x), rotation: 0.3 + x, scale: Vec2::new(2.0, 0.7 - x) };
    let modes = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    let wrap = [modes[image % 3], modes[(image + 1) % 3]];
    Some(TextureSlot { image, uv_set: (1 - image % 2) as u8, wrap, transform })
}

/// A material in which nothing is what glTF takes for granted, but that it is lit: strong emission
/// has no effect where it is not, and is not written there.
fn rich() -> Material {
    Material {
        name: "rich".into(),
        base_color: [0.1, 0.2, 0.3, 0.4],
        base_color_texture: slot(0),
        metallic: 0.15,
        roughness: 0.35,
        metallic_roughness_texture: slot(1),
        normal_texture: slot(2),
        normal_scale: -1.5,
        occlusion_texture: slot(3),
        occlusion_strength: 0.85,
        emissive: [0.9, 1.0, 0.05],
        emissive_texture: slot(4),
        emissive_strength: 12.7,
        alpha_mode: AlphaMode::Mask,
        alpha_cutoff: 0.07,
        double_sided: true,
        unlit: false,
        parallax: None,
        extensions: extensions(),
    }
}

/// Extensions in which nothing is what it is where the extension says nothing.
fn extensions() -> MaterialExtensions {
    MaterialExtensions {
        clearcoat: Some(Clearcoat {
            factor: 0.8,
            texture: slot(0),
            roughness: 0.1,
            roughness_texture: slot(1),
            normal_texture: slot(2),
            normal_scale: 0.7,
        }),
        sheen: Some(Sheen {
            color: [0.1, 0.2, 0.3],
            color_texture: slot(3),
            roughness: 0.4,
            roughness_texture: slot(4),
        }),
        transmission: Some(Transmission { factor: 0.9, texture: slot(5) }),
        diffuse_transmission: Some(DiffuseTransmission {
            factor: 0.3,
            texture: slot(0),
            color: [0.5, 0.6, 0.7],
            color_texture: slot(1),
        }),
        volume: Some(Volume {
            thickness: 0.25,
            texture: slot(2),
            attenuation_distance: 3.0,
            attenuation_color: [0.2, 0.9, 0.4],
        }),
        iridescence: Some(Iridescence {
            factor: 0.6,
            texture: slot(3),
            ior: 1.8,
            thickness: [50.0, 700.0],
            thickness_texture: slot(4),
        }),
        anisotropy: Some(Anisotropy { strength: 0.5, rotation: -1.2, texture: slot(5) }),
        specular: Some(Specular {
            factor: 0.5,
            texture: slot(0),
            color: [2.0, 0.5, 0.25],
            color_texture: slot(1),
        }),
        ior: Some(1.33),
        dispersion: Some(0.1),
    }
}

fn through_glb(model: &Model, name: &str) -> Loaded {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("m.glb");
    write_glb(&path, model).expect(name);
    keep(&path, &format!("material-{name}.glb")).expect(name);
    read_model(&path, &Limits::default()).expect(name)
}

fn document(materials: Vec<Material>) -> Value {
    let bytes = glb_bytes(&model(materials)).expect("a whole model");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).expect("JSON")
}

/// Protects every field of a material, textures on either set and their transforms on the way
/// through a GLB file.
#[test]
fn glb_keeps_whole_materials() {
    let (rich, bare) = (rich(), Material::gltf_default());
    // All fields by name: one that is added must be looked at here.
    let Material {
        name: _,
        base_color,
        base_color_texture: _,
        normal_texture: _,
        normal_scale,
        metallic,
        roughness,
        metallic_roughness_texture: _,
        occlusion_texture: _,
        occlusion_strength,
        emissive,
        emissive_texture: _,
        emissive_strength,
        alpha_mode,
        alpha_cutoff,
        double_sided,
        unlit,
        parallax: _,
        extensions: _,
    } = bare;
    assert!(rich.base_color.iter().zip(base_color).all(|(a, b)| *a != b));
    assert!(rich.emissive.iter().zip(emissive).all(|(a, b)| *a != b));
    assert!(![metallic, 0.0].contains(&rich.metallic) && rich.roughness != roughness);
    assert!(rich.normal_scale != normal_scale && rich.occlusion_strength != occlusion_strength);
    assert!(rich.emissive_strength != emissive_strength && rich.alpha_cutoff != alpha_cutoff);
    assert!(rich.alpha_mode != alpha_mode && rich.double_sided != double_sided && !unlit);
    assert_eq!(rich.all_texture_slots().count(), 5 + 14);
    let unlit = Material {
        name: "unlit".into(),
        double_sided: false,
        alpha_mode: AlphaMode::Blend,
        alpha_cutoff: 0.5,
        emissive_texture: slot(5),
        emissive_strength: 1.0,
        unlit: true,
        // The validator warns of others beside this one.
        extensions: MaterialExtensions::default(),
        ..rich.clone()
    };
    let bare = Material { name: "bare".into(), ..bare };
    let baked = Material { name: "baked".into(), ..Material::default() };
    let model = model(vec![rich, unlit, bare, baked]);
    let loaded = through_glb(&model, "rich");
    assert_eq!(loaded.warnings, [""; 0]);
    assert_eq!(Model { nodes: None, ..loaded.model }, model);
}

/// Protects each field by itself: alone, it is written, brings its extension along, and comes back.
#[test]
fn glb_keeps_each_field_alone() {
    let bare = || Material { name: "m".into(), ..Material::gltf_default() };
    type Change = fn(&mut Material);
    let changes: [(&str, Change, &[&str]); 16] = [
        ("nothing", |_| {}, &[]),
        ("metallic", |m| m.metallic = 0.0, &[]),
        ("roughness", |m| m.roughness = 0.0, &[]),
        ("metallic-roughness", |m| m.metallic_roughness_texture = slot(0), &["KHR_texture_transform"]),
        ("occlusion", |m| m.occlusion_texture = Some(TextureSlot::default()), &[]),
        ("emissive", |m| m.emissive[2] = 0.5, &[]),
        ("emissive-texture", |m| m.emissive_texture = slot(0), &["KHR_texture_transform"]),
        (
            "emissive-strength",
            |m| (m.emissive, m.emissive_strength) = ([1.0; 3], 0.5),
            &["KHR_materials_emissive_strength"],
        ),
        ("mask", |m| m.alpha_mode = AlphaMode::Mask, &[]),
        ("cutoff", |m| (m.alpha_mode, m.alpha_cutoff) = (AlphaMode::Mask, 1.5), &[]),
        ("blend", |m| m.alpha_mode = AlphaMode::Blend, &[]),
        ("double-sided", |m| m.double_sided = true, &[]),
        ("unlit", |m| m.unlit = true, &["KHR_materials_unlit"]),
        ("ior", |m| m.extensions.ior = Some(0.0), &["KHR_materials_ior"]),
        (
            "glass",
            |m| m.extensions.transmission = Some(Transmission::default()),
            &["KHR_materials_transmission"],
        ),
        ("sheen", |m| m.extensions.sheen = Some(Sheen::default()), &["KHR_materials_sheen"]),
    ];
    for (name, change, extensions) in changes {
        let mut material = bare();
        change(&mut material);
        let back = through_glb(&model(vec![material.clone()]), name);
        assert_eq!(back.model.materials, [material.clone()], "{name}");
        assert_eq!(back.warnings, [""; 0], "{name}");
        let used = document(vec![material])["extensionsUsed"].clone();
        assert_eq!(used, if extensions.is_empty() { Value::Null } else { json!(extensions) }, "{name}");
    }
}

/// Protects small files, and the bytes that bakes have had: glTF's defaults are not written.
#[test]
fn defaults_are_not_written() {
    let bare = Material { name: "bare".into(), ..Material::gltf_default() };
    let baked =
        Material { name: "baked".into(), base_color_texture: Some(TextureSlot::default()), ..bare.clone() };
    let baked = Material { metallic: 0.0, roughness: 1.0, double_sided: true, ..baked };
    let without_effect =
        Material { alpha_cutoff: 0.1, emissive_strength: 9.0, occlusion_strength: 0.5, ..bare.clone() };
    let document = document(vec![bare, baked.clone(), without_effect]);
    let expected = r#"[{"name":"bare"},{"doubleSided":true,"name":"baked","pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0,"roughnessFactor":1}},{"name":"bare"}]"#;
    assert_eq!(document["materials"].to_string(), expected);
    assert_eq!(
        baked,
        Material {
            name: "baked".into(),
            base_color_texture: baked.base_color_texture,
            ..Material::default()
        }
    );
}

/// Protects validity where factors are out of range.
#[test]
fn factors_are_clamped_on_writing() {
    let wild = Material {
        metallic: f32::NAN,
        roughness: 7.0,
        occlusion_texture: Some(TextureSlot::default()),
        occlusion_strength: -1.0,
        emissive: [f32::NAN, 2.0, -1.0],
        emissive_strength: f32::INFINITY,
        alpha_mode: AlphaMode::Mask,
        alpha_cutoff: f32::NAN,
        ..Material::gltf_default()
    };
    let back = through_glb(&model(vec![wild.clone()]), "clamped").model.materials.remove(0);
    let expected = Material {
        name: "material 0".into(),
        metallic: 1.0,
        roughness: 1.0,
        occlusion_strength: 0.0,
        emissive: [0.0, 1.0, 0.0],
        emissive_strength: 1.0,
        alpha_cutoff: 0.5,
        ..wild
    };
    assert_eq!(back, expected);
}

/// What MTL can say of metal, roughness and emission.
fn for_obj() -> Vec<Material> {
    let at = |image| Some(TextureSlot { image, wrap: [Wrap::Clamp; 2], ..TextureSlot::default() });
    let named = |name: &str| Material { name: name.into(), ..Material::default() };
    vec![
        Material { metallic: 0.25, roughness: 0.75, emissive: [0.5, 0.25, 0.0], ..named("factors") },
        Material { metallic: 1.0, metallic_roughness_texture: at(0), ..named("metal") },
        Material { metallic_roughness_texture: at(1), ..named("rough") },
        Material { emissive: [1.0; 3], emissive_texture: at(2), ..named("lamp") },
        Material { emissive: [1.0, 0.5, 0.0], emissive_strength: 6.0, ..named("sun") },
        named("plain"),
    ]
}

/// Protects what MTL can say of metal, roughness and emission; images come in order of use.
#[test]
fn obj_keeps_what_mtl_can_say() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.obj");
    let mut model = model(for_obj());
    model.mesh.uvs1.clear();
    write_obj(&path, &model).unwrap();
    let loaded = read_model(&path, &Limits::default()).unwrap();
    assert_eq!(loaded.warnings, [""; 0]);
    assert_eq!(loaded.model.materials.len(), 6);
    for (mut back, material) in loaded.model.materials.into_iter().zip(model.materials) {
        let near = |a: f32, b: f32| (a - b).abs() < 1e-6 * b.max(1.0);
        assert!(back.emissive.iter().zip(material.emissive).all(|(a, b)| near(*a, b)), "{back:?}");
        assert!(near(back.emissive_strength, material.emissive_strength), "{back:?}");
        (back.emissive, back.emissive_strength) = (material.emissive, material.emissive_strength);
        assert_eq!(back, material);
    }
    for (a, b) in loaded.model.images.iter().zip(&model.images) {
        assert_eq!(a.pixels, b.pixels);
    }
    let names = ["metallic_roughness", "metallic_roughness_2", "emissive"];
    assert!(names.iter().all(|name| folder.path().join(format!("m_{name}.png")).exists()));
    let library = std::fs::read_to_string(folder.path().join("m.mtl")).unwrap();
    let (_, plain) = library.split_once("newmtl plain").unwrap();
    assert!(plain.ends_with("\nKs 0 0 0\n"), "defaults are not written: {plain}");
}

/// Protects users from silently losing what MTL cannot say.
#[test]
fn what_mtl_cannot_say_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    type Change = fn(&mut Material);
    let changes: [(&str, Change); 5] = [
        ("an occlusion map", |m| m.occlusion_texture = Some(TextureSlot::default())),
        ("without lighting", |m| m.unlit = true),
        ("metal or roughness on a texture", |m| m.roughness = 0.5),
        ("metal or roughness on a texture", |m| m.metallic = 0.5),
        ("emission on a texture", |m| m.emissive[1] = 0.5),
    ];
    let good = Material {
        metallic_roughness_texture: Some(TextureSlot::default()),
        emissive_texture: Some(TextureSlot::default()),
        emissive: [1.0; 3],
        ..Material::default()
    };
    assert!(write_obj(&folder.path().join("good.obj"), &model(vec![good.clone()])).is_ok());
    let before = std::fs::read_dir(folder.path()).unwrap().count();
    for (what, change) in changes {
        let mut material = good.clone();
        change(&mut material);
        let error = write_obj(Path::new("no folder/a.obj"), &model(vec![material])).unwrap_err().to_string();
        assert!(error.contains(what) && error.contains(".glb"), "{error}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), before);
}
