//! The models of `$PARBAKE_DATA` are read without loss, survive a way through GLB
//! and OBJ bit by bit, or are refused with a way out.
//!
//! Where `$PARBAKE_GLB_OUT` names a folder, the GLB files stay there, for the
//! Khronos validator to look at (`tools/validate_gltf`).

use crate::common::{check_model, data_folder, files_below};
use parbake_files::{FileError, Limits, Loaded, read_geometry, read_model, write_glb, write_obj};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{AlphaMode, Image, Material, Mesh, Model, TextureSlot};
use std::path::{Path, PathBuf};

/// All models of a folder that can be read, after checking them; the others must
/// say what is not supported and what to do, or that they have no surface.
fn load_all(folder: &Path) -> Vec<(PathBuf, Loaded)> {
    let limits = Limits { max_triangles: 2_000_000, ..Limits::default() };
    let mut all = Vec::new();
    for path in files_below(folder) {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        if !["obj", "gltf", "glb"].iter().any(|e| extension == *e) {
            continue;
        }
        match read_model(&path, &limits) {
            Ok(mut loaded) => {
                check_model(&path, &loaded);
                loaded.model.images.iter_mut().for_each(shorten);
                all.push((path, loaded));
            }
            Err(FileError::Unsupported { .. } | FileError::Empty { .. } | FileError::OverLimit { .. }) => {}
            Err(error) => panic!("{error}"),
        }
    }
    assert!(!all.is_empty(), "{}", folder.display());
    all
}

/// Keeps a picture's first rows: they say whether bits survive, and all of them take minutes to compress.
fn shorten(image: &mut Image) {
    image.height = image.height.min(64);
    image.pixels.truncate(image.width * image.height);
}

/// Everything that a mesh says at the three corners of a triangle.
type Corners = [(Vec3, Option<Vec3>, Option<Vec4>, Vec2, Vec2, Vec4); 3];

fn corners(mesh: &Mesh, triangle: usize) -> Corners {
    mesh.triangles[triangle].map(|i| {
        let i = i as usize;
        let uv = |uvs: &[Vec2]| uvs.get(i).copied().unwrap_or_default();
        let color = mesh.colors.get(i).copied().unwrap_or(Vec4::ONE);
        let (normal, tangent) = (mesh.normals.get(i).copied(), mesh.tangents.get(i).copied());
        (mesh.positions[i], normal, tangent, uv(&mesh.uvs), uv(&mesh.uvs1), color)
    })
}

/// The model's triangles as a GLB file has them: by material.
fn by_material(mesh: &Mesh) -> Vec<usize> {
    let mut order: Vec<usize> = (0..mesh.triangles.len()).collect();
    order.sort_by_key(|&i| mesh.triangle_materials[i]);
    order
}

/// The texels that a slot shows, and how.
fn shown(model: &Model, slot: Option<TextureSlot>) -> Option<(&[[u8; 4]], TextureSlot)> {
    slot.map(|s| (model.images[s.image].pixels.as_slice(), TextureSlot { image: 0, ..s }))
}

const SLOTS: [fn(&Material) -> Option<TextureSlot>; 5] = [
    |m| m.base_color_texture,
    |m| m.normal_texture,
    |m| m.metallic_roughness_texture,
    |m| m.occlusion_texture,
    |m| m.emissive_texture,
];

/// A material without its textures, and without what has no effect.
fn factors(material: &Material) -> Material {
    let mut factors = material.clone();
    factors.base_color_texture = None;
    factors.normal_texture = None;
    factors.metallic_roughness_texture = None;
    factors.occlusion_texture = None;
    factors.emissive_texture = None;
    factors.parallax = None;
    factors.extensions = Default::default();
    if material.alpha_mode != AlphaMode::Mask {
        factors.alpha_cutoff = 0.5;
    }
    if material.emissive == [0.0; 3] || material.unlit {
        factors.emissive_strength = 1.0;
    }
    factors
}

/// Protects every bit of real models on the way through a GLB file.
#[test]
fn real_models_survive_glb() {
    let Some(data) = data_folder() else { return };
    let folder = tempfile::tempdir().unwrap();
    let keep = std::env::var_os("PARBAKE_GLB_OUT").map(PathBuf::from);
    if let Some(keep) = &keep {
        std::fs::create_dir_all(keep).unwrap();
    }
    let sources = ["pbr", "pairs", "feature", "extreme", "bad"];
    let sources = sources.map(|s| if s == "bad" { data.join("bad/trimesh") } else { data.join(s) });
    for (number, (path, Loaded { model, .. })) in sources.iter().flat_map(|s| load_all(s)).enumerate() {
        let name = path.display();
        let glb = keep.as_deref().unwrap_or(folder.path()).join(format!("{number:03}-{}.glb", model.name));
        write_glb(&glb, &model).unwrap();
        let back = read_model(&glb, &Limits::default()).unwrap().model;
        let order = by_material(&model.mesh);
        assert_eq!(back.mesh.triangles.len(), order.len(), "{name}");
        for (i, &original) in order.iter().enumerate() {
            assert_eq!(corners(&back.mesh, i), corners(&model.mesh, original), "{name}, triangle {original}");
            let (a, b) = (back.mesh.triangle_materials[i], model.mesh.triangle_materials[original]);
            let (a, b) = (&back.materials[a as usize], &model.materials[b as usize]);
            assert_eq!(&a.name, &b.name, "{name}");
        }
        for (a, b) in back.materials.iter().zip(&model.materials) {
            assert_eq!(factors(a), factors(b), "{name}");
            for slot in SLOTS {
                assert_eq!(shown(&back, slot(a)), shown(&model, slot(b)), "{name}");
            }
        }
        if keep.is_none() {
            std::fs::remove_file(&glb).unwrap();
        }
    }
}

/// Protects every bit that OBJ can say on the way through an OBJ file with pictures.
#[test]
fn real_models_survive_obj() {
    let Some(data) = data_folder() else { return };
    let folder = tempfile::tempdir().unwrap();
    let obj = folder.path().join("a.obj");
    for (path, Loaded { model, .. }) in ["pbr", "pairs"].iter().flat_map(|s| load_all(&data.join(s))) {
        match write_obj(&obj, &model) {
            Ok(_) => {}
            Err(FileError::Unsupported { .. }) => continue,
            Err(error) => panic!("{error}"),
        }
        let back = read_model(&obj, &Limits::default()).unwrap().model;
        let what = |mesh: &Mesh, i| corners(mesh, i).map(|(p, n, _, uv, ..)| (p, n, uv));
        for i in 0..model.mesh.triangles.len() {
            assert_eq!(what(&back.mesh, i), what(&model.mesh, i), "{}", path.display());
        }
        for (a, b) in back.materials.iter().zip(&model.materials) {
            assert_eq!(shown(&back, a.base_color_texture), shown(&model, b.base_color_texture));
            assert_eq!(shown(&back, a.normal_texture), shown(&model, b.normal_texture));
        }
    }
}

/// Protects the counts that the data's own notes give.
#[test]
fn real_models_have_the_known_counts() {
    let Some(data) = data_folder() else { return };
    for (path, triangles, materials) in [
        ("pbr/Avocado-Quantized/Avocado.gltf", 682, 1),
        ("pbr/CesiumMan/CesiumMan.glb", 4672, 1),
        ("pbr/EgyptianCatWebp/cat.glb", 4622, 1),
        ("pbr/ExplodingBarrel/ExplodingBarrel.glb", 8150, 1),
        ("pbr/GlassVaseFlowers/GlassVaseFlowers.glb", 14_036, 3),
        ("pbr/GreySnapper/greySnapper_vertColor.glb", 2754, 1),
        ("pbr/LowPolyTree/low-poly-tree.glb", 1126, 1),
        ("pbr/PlasticChair/plastic_monobloc_chair_01_1k.gltf", 3356, 1),
        ("pbr/ToyCar/ToyCar.gltf", 108_936, 3),
        ("pbr/TransmissionTest/TransmissionTest.glb", 128_775, 14),
        ("pbr/VintageFan/vintageFan_animated.gltf", 21_080, 1),
        ("pairs/lego_figure/high/hp.obj", 3680, 1),
        ("pairs/koala/koala.obj", 99_994, 1),
        // Thirteen polygons, some of them concave and one around a hole.
        ("bad/trimesh/wallhole.obj", 66, 1),
    ] {
        let loaded = read_geometry(&data.join(path), &Limits::default()).unwrap();
        assert_eq!(loaded.model.mesh.triangles.len(), triangles, "{path}");
        assert_eq!(loaded.model.materials.len(), materials, "{path}");
    }
}
