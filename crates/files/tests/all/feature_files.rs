//! The conformance models of `$PARBAKE_DATA/feature` and `extreme` are not only read
//! but read right: each is held against what its makers say that it shows.

use crate::common::data_folder;
use parbake_files::{Limits, read_geometry, read_model};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{AlphaMode, Bounds, Image, Material, Model, TextureSlot};
use std::path::Path;

/// Reads a model that must have nothing odd about it, but for what is not fitted.
fn load(data: &Path, name: &str) -> Model {
    let mut loaded = read_model(&data.join(name), &Limits::default()).expect(name);
    loaded.warnings.retain(|warning| !warning.text.contains("is not fitted"));
    assert_eq!(loaded.warnings, [""; 0], "{name}");
    loaded.model
}

/// Texture coordinates of the triangles' corners that have the material, as the
/// slot's set and transform give them.
fn fetched(model: &Model, material: usize, slot: &TextureSlot) -> Vec<Vec2> {
    let uvs = if slot.uv_set == 0 { &model.mesh.uvs } else { &model.mesh.uvs1 };
    let ours = model.mesh.triangles.iter().zip(&model.mesh.triangle_materials);
    ours.filter(|(_, m)| **m as usize == material)
        .flat_map(|(t, _)| t.map(|i| slot.transform.apply(uvs[i as usize])))
        .collect()
}

fn texel(image: &Image, uv: Vec2) -> [u8; 4] {
    let at = |x: f32, size: usize| ((x - x.floor()) * size as f32) as usize % size;
    image.pixels[at(uv.y, image.height) * image.width + at(uv.x, image.width)]
}

fn named<'m>(model: &'m Model, name: &str) -> (usize, &'m Material) {
    model.materials.iter().enumerate().find(|(_, m)| m.name == name).expect(name)
}

/// Protects KHR_texture_transform, its direction of turning and its own texCoord:
/// the test quads must show the tick, which lies in the upper right ninth.
#[test]
fn texture_transforms() {
    let Some(data) = data_folder() else { return };
    let model = load(&data, "feature/TextureTransformMultiTest/TextureTransformMultiTest.glb");
    for (name, set) in [("BaseColorTest0Mat", 0), ("BaseColorTest1Mat", 1), ("UnlitTest1Mat", 1)] {
        let (index, material) = named(&model, name);
        let slot = material.base_color_texture.unwrap();
        assert_eq!(slot.uv_set, set, "{name}");
        let uvs = fetched(&model, index, &slot);
        assert!(uvs.iter().all(|uv| uv.x > 0.76 && uv.x < 1.0 && uv.y > 0.0 && uv.y < 0.24), "{uvs:?}");
        // The tick as the face shows it: both ends of its long leg are black.
        for (place, black) in
            [((0.85, 0.10), true), ((0.38, 0.85), true), ((0.1, 0.1), false), ((0.9, 0.9), false)]
        {
            let uv = Vec2::splat(0.1884) + Vec2::from(place) * 0.6231;
            let texel = texel(&model.images[slot.image], slot.transform.apply(uv));
            assert_eq!(texel[0] < 128, black, "{name}, {place:?}");
        }
    }
    let (index, material) = named(&model, "NormalTest1Mat");
    let uvs = fetched(&model, index, &material.normal_texture.unwrap());
    assert!(uvs.iter().all(|uv| uv.x > 0.76 && uv.y < 0.24), "{uvs:?}");
    assert!(named(&model, "UnlitTest0Mat").1.unlit && !material.unlit);
    type Slot = fn(&Material) -> Option<TextureSlot>;
    let slots: [(&str, Slot); 3] = [
        ("EmissionTest", |m| m.emissive_texture),
        ("MetalRoughTest", |m| m.metallic_roughness_texture),
        ("OcclusionTest", |m| m.occlusion_texture),
    ];
    for ((name, slot), set) in slots.into_iter().flat_map(|slot| [(slot, 0), (slot, 1)]) {
        let (index, material) = named(&model, &format!("{name}{set}Mat"));
        let slot = slot(material).expect(name);
        assert_eq!(slot.uv_set, set, "{name}");
        let uvs = fetched(&model, index, &slot);
        assert!(uvs.iter().all(|uv| uv.x > 0.76 && uv.x < 1.0 && uv.y > 0.0 && uv.y < 0.24), "{uvs:?}");
    }
}

/// Protects the direction of v, for which this model has one quad at each corner.
#[test]
fn texture_coordinates() {
    let Some(data) = data_folder() else { return };
    let model = load(&data, "feature/TextureCoordinateTest/TextureCoordinateTest.glb");
    for (name, corner) in [
        ("TopLeftMat", Vec2::new(0.0, 0.0)),
        ("TopRightMat", Vec2::new(0.6, 0.0)),
        ("BottomLeftMat", Vec2::new(0.0, 0.6)),
        ("BottomRightMat", Vec2::new(0.6, 0.6)),
    ] {
        let (index, material) = named(&model, name);
        let uvs = fetched(&model, index, &material.base_color_texture.unwrap());
        let inside =
            |uv: &Vec2| (*uv - corner).min_element() > -1e-4 && (*uv - corner).max_element() < 0.4001;
        assert!(uvs.iter().all(inside), "{name}: {uvs:?}");
        let low = uvs.iter().copied().reduce(Vec2::min).unwrap();
        assert!(low.distance(corner) < 1e-4, "{name}: {low}");
    }
}

/// Protects vertex colours of all types, with and without alpha.
#[test]
fn vertex_colours() {
    let Some(data) = data_folder() else { return };
    let folder = "extreme/asset-generator/Mesh_PrimitiveVertexColor/Mesh_PrimitiveVertexColor";
    for (number, alpha) in [("00", 1.0), ("02", 1.0), ("04", 0.2)] {
        let model = load(&data, &format!("{folder}_{number}.gltf"));
        let expected = [Vec3::Y, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Z].map(|c| c.extend(alpha));
        assert_eq!(model.mesh.colors, expected, "{number}");
    }
    let model = load(&data, "feature/VertexColorTest/VertexColorTest.glb");
    assert!(model.mesh.colors.iter().all(|c| c.cmpge(Vec4::ZERO).all() && c.cmple(Vec4::ONE).all()));
    for primary in [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(0.0, 1.0, 0.0, 1.0)] {
        assert!(model.mesh.colors.contains(&primary), "{primary}");
    }
}

/// Protects interleaved buffers and normalised integers: three ways to write one quad.
#[test]
fn interleaved_and_normalised() {
    let Some(data) = data_folder() else { return };
    let load = |number: &str| {
        load(&data, &format!("extreme/asset-generator/Buffer_Interleaved/Buffer_Interleaved_{number}.gltf"))
    };
    let model = load("00");
    assert_eq!(model.mesh.uvs, [Vec2::ONE, Vec2::Y, Vec2::ZERO, Vec2::X]);
    for number in ["02", "04"] {
        assert_eq!(load(number).mesh, model.mesh, "{number}");
    }
}

/// Protects sparse accessors on top of a base.
#[test]
fn sparse_accessors() {
    let Some(data) = data_folder() else { return };
    let mesh = load(&data, "feature/SimpleSparseAccessor/SimpleSparseAccessor.gltf").mesh;
    let heights: Vec<f32> = mesh.positions.iter().map(|p| p.y).collect();
    assert_eq!(heights, [0., 0., 0., 0., 0., 0., 0., 1., 2., 1., 3., 1., 4., 1.]);
    assert_eq!(mesh.triangles.len(), 12);
}

/// Protects mirrored nodes: every triangle still faces where its normals point.
#[test]
fn negative_scales() {
    let Some(data) = data_folder() else { return };
    let mesh = load(&data, "feature/NegativeScaleTest/NegativeScaleTest.glb").mesh;
    assert_eq!(mesh.triangles.len(), 7724);
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        let normal: Vec3 = triangle.iter().map(|&v| mesh.normals[v as usize]).sum();
        assert!(mesh.area_normal(i).dot(normal) > 0.0, "triangle {i}");
    }
}

/// Protects strips, fans and unindexed triangles, which all draw the same shapes.
#[test]
fn primitive_modes() {
    let Some(data) = data_folder() else { return };
    let folder = "extreme/asset-generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode";
    for number in ["04", "06", "12", "14"] {
        let mesh = load(&data, &format!("{folder}_{number}.gltf")).mesh;
        assert_eq!(mesh.triangles.len(), 2, "{number}");
        let normals: Vec3 = (0..2).map(|i| mesh.area_normal(i)).sum();
        assert!(normals.distance(Vec3::Z * 2.0 * 0.5) < 1e-6 || normals.z > 0.0, "{number}: {normals}");
    }
    let loaded =
        read_model(&data.join("feature/MeshPrimitiveModes/MeshPrimitiveModes.gltf"), &Limits::default());
    let loaded = loaded.unwrap();
    assert_eq!(loaded.model.mesh.triangles.len(), 16);
    assert_eq!(loaded.warnings, ["MeshPrimitiveModes.gltf: points and lines were left out"]);
}

/// Protects alpha modes and cutoffs, sides, and pictures whose URIs have encoded blanks.
#[test]
fn alpha_modes_and_encoded_names() {
    let Some(data) = data_folder() else { return };
    let model = load(&data, "feature/AlphaBlendModeTest/AlphaBlendModeTest.glb");
    for (name, mode) in
        [("MatBed", AlphaMode::Opaque), ("MatBlend", AlphaMode::Blend), ("MatCutoff25", AlphaMode::Mask)]
    {
        assert_eq!(named(&model, name).1.alpha_mode, mode, "{name}");
    }
    for (name, cutoff) in [("MatCutoff25", 0.25), ("MatCutoff75", 0.75), ("MatCutoffDefault", 0.5)] {
        let material = named(&model, name).1;
        assert_eq!((material.alpha_cutoff, material.metallic, material.roughness), (cutoff, 0.0, 0.8));
        assert!(material.double_sided);
    }
    let (_, bed) = named(&model, "MatBed");
    assert!(!bed.double_sided && bed.all_texture_slots().count() == 4 && bed.metallic == 1.0);
    let model = load(&data, "feature/Box With Spaces/Box With Spaces.gltf");
    assert_eq!((model.images.len(), model.materials[0].all_texture_slots().count()), (3, 3));
}

/// Protects quantised coordinates, which mean nothing without their transform, and
/// the size that only the nodes give.
#[test]
fn quantised_meshes() {
    let Some(data) = data_folder() else { return };
    let model = load(&data, "pbr/Avocado-Quantized/Avocado.gltf");
    let size = Bounds::of(&model.mesh).unwrap().size();
    assert!((size.y - 0.0627).abs() < 1e-3, "{size}");
    let uvs = fetched(&model, 0, &model.materials[0].base_color_texture.unwrap());
    let low = uvs.iter().copied().reduce(Vec2::min).unwrap();
    let high = uvs.iter().copied().reduce(Vec2::max).unwrap();
    assert!(low.min_element() >= 0.0 && high.max_element() <= 1.0 && (high - low).min_element() > 0.9);
}

/// Protects GPU instancing: the notes count 4034 triangles, placed many times.
#[test]
fn instances() {
    let Some(data) = data_folder() else { return };
    let mesh = load(&data, "feature/TeapotsInstanced/teapots_galore.gltf").mesh;
    assert_eq!(mesh.triangles.len(), 7_656_770);
}

/// Protects Draco: the models' notes count their triangles, placed, of which some have no area; normals
/// look where triangles face, and texture coordinates are those of the picture.
#[test]
fn draco_models() {
    let Some(data) = data_folder() else { return };
    for (name, triangles) in [
        ("pbr/CesiumMilkTruck-Draco/CesiumMilkTruck.gltf", 3624),
        ("pbr/GuitarDraco/model.gltf", 67_718 - 12_290),
        ("pbr/JetFighter/jet-fighter.glb", 36_446 - 6),
    ] {
        let mesh = read_geometry(&data.join(name), &Limits::default()).unwrap().model.mesh;
        assert_eq!(mesh.triangles.len(), triangles, "{name}");
        let facing = (0..triangles).filter(|&i| {
            let normal: Vec3 = mesh.triangles[i].iter().map(|&v| mesh.normals[v as usize]).sum();
            mesh.area_normal(i).dot(normal) > 0.0
        });
        assert!(facing.count() > triangles * 97 / 100, "{name}");
        let (low, high) = mesh.uvs.iter().fold((Vec2::MAX, Vec2::MIN), |(a, b), &uv| (a.min(uv), b.max(uv)));
        assert!(
            low.min_element() > -3.0 && high.max_element() < 3.0 && (high - low).min_element() > 0.4,
            "{name}"
        );
    }
}

/// Protects meshopt and its filters: a model that was packed by gltfpack is the model, within the bits
/// that its numbers were given.
#[test]
fn meshopt_models() {
    let Some(data) = data_folder() else { return };
    let plain = load(&data, "pbr/GreySnapper/greySnapper_vertColor.glb").mesh;
    let packed = load(&data, "derived/GreySnapper-meshopt.glb");
    let mesh = packed.mesh;
    assert_eq!(mesh.triangles.len(), plain.triangles.len());
    let (a, b) = (Bounds::of(&plain).unwrap(), Bounds::of(&mesh).unwrap());
    let size = a.size().length();
    assert!(a.size().distance(b.size()) < 2e-3 * size);
    // Each packed vertex is near one of the model's that looks the same way and has the same colour.
    for (i, position) in mesh.positions.iter().enumerate().step_by(37) {
        let near =
            (0..plain.positions.len()).filter(|&k| plain.positions[k].distance(*position) < 1e-3 * size);
        let alike = |k: &usize| {
            let color = plain.colors.get(*k).copied().unwrap_or(Vec4::ONE)
                - mesh.colors.get(i).copied().unwrap_or(Vec4::ONE);
            plain.normals[*k].dot(mesh.normals[i]) > 0.98 && color.abs().max_element() < 0.02
        };
        assert!(near.clone().any(|k| alike(&k)), "vertex {i} at {position}");
    }
    let small = load(&data, "feature/MeshoptNoFallback/meshopt-no-fallback.gltf");
    assert_eq!((small.mesh.triangles.len(), small.materials.len()), (60, 2));
}

/// Protects KTX2 (ETC1S): the jet's three pictures of 4096² look like what they are.
#[test]
fn basis_universal_textures() {
    let Some(data) = data_folder() else { return };
    let model = read_model(&data.join("pbr/JetFighter/jet-fighter.glb"), &Limits::default()).unwrap().model;
    assert_eq!(model.images.len(), 3);
    assert!(model.images.iter().all(|i| (i.width, i.height) == (4096, 4096)));
    let material = named(&model, "F-2-airframe").1;
    let mean = |slot: Option<TextureSlot>| {
        let image = &model.images[slot.unwrap().image];
        let sum =
            image.pixels.iter().fold([0u64; 4], |sum, p| std::array::from_fn(|c| sum[c] + u64::from(p[c])));
        sum.map(|s| s as f64 / image.pixels.len() as f64)
    };
    let [r, g, b, _] = mean(material.normal_texture);
    assert!((r - 127.5).abs() < 4.0 && (g - 127.5).abs() < 4.0 && b > 245.0, "{r} {g} {b}");
    let [r, g, b, a] = mean(material.base_color_texture);
    assert!(r > 40.0 && (r - b).abs() < 60.0 && g > 40.0 && a == 255.0, "{r} {g} {b} {a}");
}
