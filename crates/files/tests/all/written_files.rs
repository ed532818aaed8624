//! What the writers leave on the disk: whole files, nothing else, and nothing at
//! all when they fail.
//!
//! Where `$PARBAKE_GLB_OUT` names a folder, the GLB files stay there, for the
//! Khronos validator to look at (`tools/validate_gltf`).

use crate::common::keep;
use parbake_files::{
    Limits, MeshCompression, TextureFormat, WriteOptions, read_model, write_glb, write_glb_with, write_obj,
};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{
    AlphaMode, Basis, CutoutMap, DepthMap, Image, Material, Mesh, Model, ParallaxMap, TextureSlot,
    UvTransform, Wrap,
};
use std::path::Path;

/// A grid of `side`² vertices with every attribute and two textures.
fn grid(side: u32) -> Model {
    let mut mesh = Mesh::default();
    for i in 0..side * side {
        let (x, y) = ((i % side) as f32 / side as f32, (i / side) as f32 / side as f32);
        let normal = Vec3::new(x - 0.5, y - 0.5, 1.0).normalize();
        mesh.positions.push(Vec3::new(x, y, (x * 7.0).sin() * y));
        mesh.normals.push(normal);
        mesh.tangents.push(normal.any_orthonormal_vector().extend(if i % 3 == 0 { -1.0 } else { 1.0 }));
        mesh.uvs.push(Vec2::new(x * 3.0 - 1.0, y));
        mesh.uvs1.push(Vec2::new(y, x));
        mesh.colors.push(Vec4::new(x, y, 0.5, 1.0));
        if i % side + 1 < side && i / side + 1 < side {
            mesh.triangles.extend([[i, i + 1, i + side], [i + 1, i + side + 1, i + side]]);
        }
    }
    mesh.triangle_materials = (0..mesh.triangles.len()).map(|i| u32::from(i > 3)).collect();
    let slot = |image, wrap| TextureSlot { image, wrap, ..TextureSlot::default() };
    let base = Material {
        name: "base \"quoted\" ü".into(),
        base_color_texture: Some(slot(0, [Wrap::Clamp; 2])),
        normal_texture: Some(slot(1, [Wrap::Clamp; 2])),
        normal_scale: 0.5,
        ..Material::default()
    };
    let plain = Material { name: "plain".into(), base_color: [0.2, 0.4, 0.6, 1.0], ..Material::default() };
    let texels = |f: fn(usize) -> [u8; 4]| (0..64).map(f).collect();
    let colour = Image { name: "c".into(), width: 16, height: 4, pixels: texels(|i| [i as u8, 9, 255, 7]) };
    let normal =
        Image { name: "n".into(), width: 4, height: 16, pixels: texels(|i| [128, i as u8, 255, 255]) };
    Model {
        name: "grid".into(),
        mesh,
        materials: vec![base, plain],
        images: vec![colour, normal],
        ..Model::default()
    }
}

/// What OBJ cannot say, added to the grid.
fn rich(side: u32) -> Model {
    let mut model = grid(side);
    let transform = UvTransform { offset: Vec2::new(0.1, -2.0), rotation: 0.5, scale: Vec2::new(2.0, -3.0) };
    let [base, plain] = &mut model.materials[..] else { unreachable!() };
    base.alpha_mode = AlphaMode::Mask;
    base.base_color = [0.5, 0.5, 0.5, 0.5];
    plain.alpha_mode = AlphaMode::Blend;
    plain.base_color_texture =
        Some(TextureSlot { image: 0, uv_set: 1, wrap: [Wrap::Mirror, Wrap::Repeat], transform });
    base.parallax = Some(ParallaxMap {
        basis: Basis::Harmonics(2),
        images: (2..8).collect(),
        scale: (0..18).map(|i| 0.01 * i as f32).collect(),
        offset: vec![-0.05; 18],
        depth: Some(DepthMap { image: 8, scale: 2.0, offset: 0.5 }),
        cutout: Some(CutoutMap {
            basis: Basis::Harmonics(1),
            images: vec![9, 10],
            scale: vec![0.1, 0.0, 6.5, 1e-7],
            offset: vec![3.544_907_7, 0.0, -1.0 / 3.0, 1e7],
        }),
        base_color_texture: plain.base_color_texture,
        ..ParallaxMap::default()
    });
    let data = |i| Image::solid(&format!("parallax {i}"), 8, 8, [i, 2 * i, 3 * i, 255]);
    model.images.extend((2..11).map(data));
    model
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<_> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Protects every bit of a model in a GLB file, around the size where indices grow,
/// and the folder from leftovers.
#[test]
fn glb_comes_back_whole() {
    let folder = tempfile::tempdir().unwrap();
    for side in [3, 255, 256] {
        let model = rich(side);
        let path = folder.path().join("model.glb");
        write_glb(&path, &model).unwrap();
        let loaded = read_model(&path, &Limits::default()).unwrap();
        assert_eq!(loaded.warnings, [""; 0]);
        // Both materials use vertices in common, of which each primitive has its own.
        assert_eq!(loaded.model.materials, model.materials);
        assert_eq!(loaded.model.images, model.images);
        assert_eq!(loaded.model.mesh.triangle_materials, model.mesh.triangle_materials);
        for (back, triangle) in loaded.model.mesh.triangles.iter().zip(&model.mesh.triangles) {
            for (&b, &t) in back.iter().zip(triangle) {
                let (b, t, back, mesh) = (b as usize, t as usize, &loaded.model.mesh, &model.mesh);
                assert_eq!((back.positions[b], back.normals[b]), (mesh.positions[t], mesh.normals[t]));
                assert_eq!((back.tangents[b], back.colors[b]), (mesh.tangents[t], mesh.colors[t]));
                assert_eq!((back.uvs[b], back.uvs1[b]), (mesh.uvs[t], mesh.uvs1[t]));
            }
        }
        assert_eq!(names(folder.path()), ["model.glb"]);
        keep(&path, &format!("grid-{side}.glb")).unwrap();
    }
}

/// Protects what is written small: it comes back within what the writer says that it lost.
#[test]
fn quantised_meshes_and_other_pictures_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let formats = [
        (TextureFormat::Png, "png"),
        (TextureFormat::Jpeg, "jpeg"),
        (TextureFormat::Webp, "webp"),
        (TextureFormat::WebpLossless, "webp-lossless"),
        (TextureFormat::Ktx2, "ktx2"),
        (TextureFormat::Ktx2Etc1s, "ktx2-etc1s"),
    ];
    for (format, name) in formats {
        let model = rich(9);
        let path = folder.path().join(format!("{name}.glb"));
        let options = WriteOptions {
            texture_format: format,
            mesh_compression: MeshCompression::Quantized,
            ..WriteOptions::default()
        };
        let written = write_glb_with(&path, &model, &options).unwrap();
        keep(&path, &format!("quantised-{name}.glb")).unwrap();
        assert_eq!(written.bytes, std::fs::metadata(&path).unwrap().len());
        assert!(written.mesh.position_error > 0.0 && written.mesh.position_error < 3e-5, "{written:?}");
        let loaded = read_model(&path, &Limits::default()).unwrap();
        assert_eq!(loaded.warnings, [""; 0]);
        let (back, mesh) = (&loaded.model.mesh, &model.mesh);
        for (back_triangle, triangle) in back.triangles.iter().zip(&mesh.triangles) {
            for (&b, &t) in back_triangle.iter().zip(triangle) {
                let (b, t) = (b as usize, t as usize);
                let moved = (back.positions[b] - mesh.positions[t]).length();
                assert!(f64::from(moved) < written.mesh.position_error + 1e-6);
                assert!(back.normals[b].dot(mesh.normals[t]) > 0.999);
                assert!(back.tangents[b].dot(mesh.tangents[t]) > 1.998);
                assert!((back.uvs[b] - mesh.uvs[t]).length() < 2e-5);
                assert!((back.uvs1[b] - mesh.uvs1[t]).length() < 2e-5);
                assert!((back.colors[b] - mesh.colors[t]).length() < 8e-3);
            }
        }
        for ((image, own), texture) in loaded.model.images.iter().zip(&model.images).zip(&written.textures) {
            assert_eq!(
                (image.width, image.height, &image.name, &texture.name),
                (own.width, own.height, &own.name, &own.name)
            );
            assert_eq!(image.pixels == own.pixels, texture.psnr.is_none(), "{name} {texture:?}");
            assert!(texture.psnr.is_none_or(|psnr| psnr > 20.0), "{name} {texture:?}");
        }
    }
}

/// Protects compressed files: they are smaller, and the same bytes each time. The Khronos validator and
/// viewers see what is kept.
#[test]
fn meshopt_files_are_small_and_repeatable() {
    let folder = tempfile::tempdir().unwrap();
    let model = rich(60);
    let bytes = |compression| {
        let path = folder.path().join("model.glb");
        let options = WriteOptions { mesh_compression: compression, ..WriteOptions::default() };
        let written = write_glb_with(&path, &model, &options).unwrap();
        keep(&path, &format!("mesh-{compression:?}.glb")).unwrap();
        (written.mesh.bytes, std::fs::read(&path).unwrap())
    };
    let [none, quantised, meshopt] =
        [MeshCompression::None, MeshCompression::Quantized, MeshCompression::Meshopt].map(bytes);
    assert!(2 * quantised.0 < none.0 + none.0 / 2 && 2 * meshopt.0 < quantised.0);
    assert_eq!(bytes(MeshCompression::Meshopt).1, meshopt.1);
}

/// Protects planes of pictures: a grid comes back as it was though its rows share their indices and its
/// coordinates take two bytes each.
#[test]
fn grids_take_few_bytes_and_come_back_whole() {
    let Model { mut mesh, .. } = grid(121);
    mesh.uvs = mesh.uvs1.iter().map(|&uv| parbake_model::short_uv(uv)).collect();
    (mesh.normals, mesh.tangents, mesh.uvs1, mesh.colors) = Default::default();
    mesh.triangle_materials.fill(0);
    let model = Model { mesh, materials: vec![Material::default()], ..Model::default() };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.glb");
    write_glb(&path, &model).unwrap();
    keep(&path, "grid-in-runs.glb").unwrap();
    let written = std::fs::metadata(&path).unwrap().len() as usize;
    let whole = model.mesh.positions.len() * 20 + model.mesh.triangles.len() * 6;
    assert!(written * 10 < whole * 7, "{written} bytes in place of {whole}");
    let back = read_model(&path, &Limits::default()).unwrap().model.mesh;
    for i in 0..model.mesh.triangles.len() {
        assert_eq!(back.corners(i), model.mesh.corners(i));
        assert_eq!(back.corner_uvs(i), model.mesh.corner_uvs(i));
    }
}

/// Protects every bit of a mesh that OBJ can say, its pictures, and the folder.
#[test]
fn obj_comes_back_whole() {
    let folder = tempfile::tempdir().unwrap();
    let mut model = grid(5);
    model.mesh.colors.clear();
    let path = folder.path().join("my model.obj");
    write_obj(&path, &model).unwrap();
    let files = ["my model.obj", "my_model.mtl", "my_model_base_color.png", "my_model_normal.png"];
    assert_eq!(names(folder.path()), files);
    let loaded = read_model(&path, &Limits::default()).unwrap();
    assert_eq!(loaded.warnings, [""; 0]);
    for (i, triangle) in model.mesh.triangles.iter().enumerate() {
        assert_eq!(loaded.model.mesh.corners(i), model.mesh.corners(i));
        assert_eq!(loaded.model.mesh.corner_uvs(i), model.mesh.corner_uvs(i));
        let normals = |mesh: &Mesh, t: &[u32; 3]| t.map(|v| mesh.normals[v as usize]);
        assert_eq!(
            normals(&loaded.model.mesh, &loaded.model.mesh.triangles[i]),
            normals(&model.mesh, triangle)
        );
    }
    let (back, base) = (&loaded.model.materials[0], &model.materials[0]);
    assert_eq!((&back.name, back.normal_scale), (&base.name, base.normal_scale));
    for (a, b) in loaded.model.images.iter().zip(&model.images) {
        assert_eq!(a.pixels, b.pixels);
    }
}

/// Protects folders, and what is in them, from writers that cannot do their work.
#[test]
fn failures_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let inside = |name: &str| folder.path().join(name);
    std::fs::create_dir(inside("taken.glb")).unwrap();
    std::fs::create_dir(inside("taken.obj")).unwrap();
    std::fs::create_dir(inside("half.mtl")).unwrap();
    std::fs::write(inside("old.glb"), b"old").unwrap();
    let before = names(folder.path());
    let mut broken = grid(3);
    broken.mesh.positions[4].x = f32::NAN;
    for (result, path) in [
        (write_glb(&inside("taken.glb"), &grid(3)), "taken.glb"),
        (write_obj(&inside("taken.obj"), &grid(3)), "taken.obj"),
        (write_obj(&inside("half.obj"), &grid(3)), "half.mtl"),
        (write_glb(&inside("none/a.glb"), &grid(3)), "a.glb"),
        (write_glb(&inside("old.glb"), &broken), "old.glb"),
        (write_obj(&inside("new.obj"), &broken), "new.obj"),
        (write_obj(&inside("new.obj"), &rich(3)), "new.obj"),
    ] {
        let error = result.unwrap_err();
        assert!(error.path().ends_with(path), "{error}");
        assert_eq!(names(folder.path()), before, "{error}");
    }
    assert_eq!(std::fs::read(inside("old.glb")).unwrap(), b"old");
}
