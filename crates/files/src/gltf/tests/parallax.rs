//! Parallax maps, written, read back and read from broken documents.

use super::*;
use crate::{MeshCompression, WriteOptions, encode_png, quick_glb_bytes, write_obj};
use parbake_model::{
    Basis, CutoutMap, DepthMap, Image, Material, Mesh, ParallaxMap, TextureSlot, UvTransform, Wrap,
};

/// A triangle with a map of order 1: images 2 to 4, depth 5, cutout 6 to 8, own textures 9 and 1.
fn model() -> Model {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z; 3],
        uvs: vec![Vec2::ZERO; 3],
        uvs1: vec![Vec2::ONE; 3],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![0],
        ..Mesh::default()
    };
    let slot = |image| Some(TextureSlot { image, ..TextureSlot::default() });
    let transform = UvTransform { rotation: 0.7, ..UvTransform::default() };
    let map = ParallaxMap {
        basis: Basis::Harmonics(1),
        images: vec![2, 3, 4],
        scale: (0..8).map(|i| 0.1 / (i + 1) as f32).collect(),
        offset: (0..8).map(|i| -0.07 * (i + 1) as f32).collect(),
        limit: 0.1,
        depth: Some(DepthMap { image: 5, scale: 1.3, offset: -0.3 }),
        cutout: Some(CutoutMap {
            basis: Basis::Harmonics(2),
            images: vec![6, 7, 8],
            scale: (0..9).map(|i| 0.3 * (i + 1) as f32).collect(),
            offset: (0..9).map(|i| -0.7 / (i + 1) as f32).collect(),
        }),
        wrap: [Wrap::Clamp, Wrap::Mirror],
        fade: f32::INFINITY,
        base_color_texture: slot(9).map(|s| TextureSlot { uv_set: 1, transform, ..s }),
        normal_texture: slot(1),
    };
    let material = Material {
        name: "m".into(),
        base_color_texture: slot(0),
        normal_texture: slot(1),
        parallax: Some(map),
        ..Material::default()
    };
    let sizes = [(2, 3), (3, 2), (4, 4), (4, 4), (4, 4), (2, 2), (3, 3), (3, 3), (3, 3), (5, 1)];
    let image = |(i, (w, h))| Image::solid(&format!("i{i}"), w, h, [i as u8, 2, 3, 255]);
    let images = sizes.into_iter().enumerate().map(image).collect();
    Model { name: "x".into(), mesh, materials: vec![material], images, ..Model::default() }
}

/// The same triangle with a map in the tangent frame: images 2 and 3.
fn tangent_model() -> Model {
    let mut model = model();
    model.mesh.tangents = vec![Vec4::new(1.0, 0.0, 0.0, -1.0); 3];
    let map = ParallaxMap {
        basis: Basis::TangentShift,
        images: vec![2],
        scale: (0..8).map(|i| 0.1 / (i + 1) as f32).collect(),
        offset: (0..8).map(|i| -0.07 * (i + 1) as f32).collect(),
        limit: 0.2,
        fade: 0.03,
        cutout: Some(CutoutMap {
            basis: Basis::TangentCutout,
            images: vec![3],
            scale: (0..12).map(|i| 0.3 * (i + 1) as f32).collect(),
            offset: (0..12).map(|i| -0.7 / (i + 1) as f32).collect(),
        }),
        ..ParallaxMap::default()
    };
    let image = |i: u8, w, h| Image::solid(&format!("i{i}"), w, h, [i, 2, 3, 90]);
    model.images.truncate(2);
    model.images.extend([image(2, 4, 8), image(3, 4, 12)]);
    model.materials[0].parallax = Some(map);
    model
}

/// Protects every bit of a map in the tangent frame on its way through a file, alpha included; and that whatever
/// breaks one leaves the map out and keeps the model.
#[test]
fn maps_in_the_tangent_frame_come_back_the_same() {
    let model = tangent_model();
    let loaded = read_glb(&model);
    assert_eq!(loaded.warnings, [""; 0]);
    assert_eq!(loaded.model.materials, model.materials);
    assert_eq!(loaded.model.images, model.images);
    let document = written(&model);
    assert_eq!(document["extensionsUsed"], json!(["PARBAKE_materials_parallax"]));
    type Breakage = fn(&mut Value);
    let breakages: [(Breakage, &str); 5] = [
        (|map| map["version"] = 3.into(), "its version is 3, and this reads version 2"),
        (|map| _ = map.as_object_mut().unwrap().remove("version"), "it has no version"),
        (|map| map["scale"] = json!([1.0]), "it has 1 scales, and its functions ask for 8"),
        (|map| _ = map.as_object_mut().unwrap().remove("texture"), "a texture of it is missing"),
        (|map| map["cutout"]["offset"] = json!([1.0]), "its cutout is broken: it has 1 offsets"),
    ];
    for (breakage, expected) in breakages {
        let mut document = written(&model);
        breakage(&mut document["materials"][0]["extensions"]["PARBAKE_materials_parallax"]);
        let bytes = glb_of(&model, &document);
        let loaded = read_gltf_bytes(Path::new("x.glb"), &bytes, &NoResources, &Limits::default()).unwrap();
        assert!(loaded.model.materials[0].parallax.is_none());
        assert!(
            loaded.warnings.iter().any(|w| w.to_string().contains(expected)),
            "{expected}: {:?}",
            loaded.warnings
        );
    }
}

/// A GLB file of a model with another document.
fn glb_of(model: &Model, document: &Value) -> Vec<u8> {
    let bytes = glb_bytes(model).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let mut text = serde_json::to_vec(document).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let binary = &bytes[20 + length..];
    let total = 20 + text.len() + binary.len();
    let mut out = bytes[..8].to_vec();
    out.extend((total as u32).to_le_bytes());
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(&bytes[16..20]);
    out.extend(text);
    out.extend(binary);
    out
}

fn read_glb(model: &Model) -> Loaded {
    let bytes = glb_bytes(model).unwrap();
    assert_eq!(bytes, glb_bytes(model).unwrap(), "deterministic");
    read_gltf_bytes(Path::new("x.glb"), &bytes, &NoResources, &Limits::default()).unwrap()
}

/// The document inside a GLB file of a model.
fn written(model: &Model) -> Value {
    let bytes = glb_bytes(model).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

/// Protects every bit of a map on its way through a file, with and without what it may have.
#[test]
fn maps_come_back_the_same() {
    let full = model();
    let mut bare = model();
    let map = bare.materials[0].parallax.as_mut().unwrap();
    (map.depth, map.cutout, map.base_color_texture, map.normal_texture) = (None, None, None, None);
    bare.images.truncate(5);
    for model in [full, bare] {
        // All losslessly, what viewers without the extension see as well.
        let bytes = quick_glb_bytes(&model).unwrap();
        let loaded = read_gltf_bytes(Path::new("x.glb"), &bytes, &NoResources, &Limits::default()).unwrap();
        assert_eq!(loaded.warnings, [""; 0]);
        assert_eq!(Model { nodes: None, ..loaded.model }, model);
    }
}

/// Protects viewers without the extension, which must not be asked for it, and those with
/// it from mip levels of data.
#[test]
fn the_extension_is_used_but_not_required() {
    let document = written(&model());
    assert_eq!(document["extensionsUsed"], json!(["KHR_texture_transform", "PARBAKE_materials_parallax_sh"]));
    assert!(document.get("extensionsRequired").is_none());
    let extension = &document["materials"][0]["extensions"]["PARBAKE_materials_parallax_sh"];
    for textures in [&extension["coefficientTextures"], &extension["cutout"]["coefficientTextures"]] {
        let texture = &document["textures"][textures[0]["index"].as_u64().unwrap() as usize];
        let sampler = &document["samplers"][texture["sampler"].as_u64().unwrap() as usize];
        assert_eq!(*sampler, json!({ "magFilter": 9729, "minFilter": 9729, "wrapS": 33071, "wrapT": 33648 }));
    }
    assert!(
        written(&Model { materials: vec![Material::default()], ..model() }).get("extensionsUsed").is_none()
    );
}

/// A document with a map of order 0: one image, two channels.
fn small() -> Value {
    let mut document = document(&TRIANGLE);
    document["meshes"][0]["primitives"][0]["material"] = 0.into();
    document["materials"] = json!([{ "name": "m", "extensions": { "PARBAKE_materials_parallax_sh": {
        "order": 0, "coefficientTextures": [{ "index": 0 }], "scale": [0.5, 0.25], "offset": [0, -0.5],
    } } }]);
    document["samplers"] = json!([{ "wrapS": 33071, "wrapT": 33071 }]);
    document["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    let png = encode_png(&Image::solid("", 2, 2, [1, 2, 0, 255])).unwrap();
    document["images"] = json!([{ "name": "t", "uri": hex_uri(&png) }]);
    document
}

/// A cutout of order 0 with the same image.
fn small_cutout() -> Value {
    json!({ "order": 0, "coefficientTextures": [{ "index": 0 }], "scale": [2], "offset": [-0.5] })
}

/// Protects readers of other writers' files: what may be left out has the page's defaults.
#[test]
fn defaults_are_those_of_the_page() {
    let map = |document: &Value| {
        let loaded = read_value(document).unwrap();
        assert_eq!(loaded.warnings, [""; 0]);
        loaded.model.materials[0].parallax.clone().unwrap()
    };
    let mut document = small();
    let (scale, offset) = (vec![0.5, 0.25], vec![0.0, -0.5]);
    let expected = ParallaxMap { images: vec![0], scale, offset, ..ParallaxMap::default() };
    assert_eq!(map(&document), expected);
    document["nodes"][0]["scale"] = json!([3, 3, 3]);
    document["materials"][0]["extensions"]["PARBAKE_materials_parallax_sh"]["depthTexture"] =
        json!({ "index": 0 });
    let depth = Some(DepthMap { image: 0, scale: 1.0, offset: 0.0 });
    document["materials"][0]["extensions"]["PARBAKE_materials_parallax_sh"]["cutout"] = small_cutout();
    let cutout =
        CutoutMap { basis: Basis::Harmonics(0), images: vec![0], scale: vec![2.0], offset: vec![-0.5] };
    assert_eq!(map(&document), ParallaxMap { depth, cutout: Some(cutout), ..expected });
}

/// Protects models from broken maps: they are read without them, and the warning says why.
#[test]
fn broken_maps_are_left_out() {
    type Change = fn(&mut Value, &mut Value);
    let cases: [(Change, &str); 17] = [
        (|_, x| x["order"] = 9.into(), "its order is 9, and the highest is 7"),
        (|_, x| drop(x.as_object_mut().unwrap().remove("order")), "no order"),
        (|_, x| x["order"] = 1.into(), "1 images of coefficients, and its functions ask for 3"),
        (|_, x| x["scale"] = json!([1]), "1 scales"),
        (|_, x| drop(x.as_object_mut().unwrap().remove("offset")), "0 offsets"),
        (|_, x| x["offset"] = json!([1, 1e39]), "not finite"),
        (|_, x| x["limit"] = 0.into(), "limit is 0"),
        (|_, x| x["limit"] = (-1e39).into(), "limit is -inf"),
        (|_, x| x["coefficientTextures"][0]["index"] = 7.into(), "/coefficientTextures/0/index"),
        (|_, x| x["depthTexture"] = json!({ "index": 7 }), "/depthTexture/index"),
        (|_, x| x["baseColorTexture"] = json!({ "index": 7 }), "/baseColorTexture/index"),
        (|_, x| x["normalTexture"] = json!({ "index": 9, "texCoord": 5 }), "/normalTexture/index"),
        (|d, _| d["textures"] = json!([{ "source": 4 }]), "/textures/0/source"),
        (|d, _| d["textures"] = json!([{}]), "its picture is not there"),
        (
            |d, x| {
                d["textures"] = json!([{ "source": 0 }, { "source": 0, "sampler": 0 }]);
                x["depthTexture"] = json!({ "index": 1 });
            },
            "differ in their wrap modes",
        ),
        (|d, _| d["nodes"][0]["rotation"] = json!([0, 1, 0, 0]), "turns or stretches"),
        (|d, _| d["nodes"][0]["scale"] = json!([1, 2, 1]), "turns or stretches"),
    ];
    for (change, expected) in cases {
        let mut document = small();
        let mut extension = document["materials"][0]["extensions"]["PARBAKE_materials_parallax_sh"].take();
        change(&mut document, &mut extension);
        document["materials"][0]["extensions"]["PARBAKE_materials_parallax_sh"] = extension;
        let loaded = read_value(&document).unwrap();
        assert_eq!(loaded.model.materials[0].parallax, None, "{expected}");
        let said = loaded.warnings.iter().map(|w| w.text.as_str()).collect::<Vec<_>>().join("\n");
        assert!(
            said.contains("map of material \"m\" was left out") && said.contains(expected),
            "{expected}: {said}"
        );
    }
    let mut document = small();
    document["materials"][0]["extensions"]["PARBAKE_materials_parallax_sh"]["order"] = "two".into();
    assert!(read_value(&document).unwrap_err().contains("/extensions/PARBAKE_materials_parallax_sh/order"));
}

/// Protects models from broken cutouts: a surface with half of its holes would be worse than
/// one without parallax, so the whole map is left out, and the warning says why.
#[test]
fn broken_cutouts_take_the_map_along() {
    type Change = fn(&mut Value, &mut Value);
    let cases: [(Change, &str); 12] = [
        (|_, c| c["order"] = 8.into(), "its cutout is broken: its order is 8, and the highest is 7"),
        (|_, c| drop(c.as_object_mut().unwrap().remove("order")), "its cutout has no order"),
        (|_, c| *c = json!({}), "its cutout has no order"),
        (|_, c| c["order"] = 1.into(), "1 images of coefficients, and its functions ask for 2"),
        (|_, c| c["scale"] = json!([1, 2]), "its cutout is broken: it has 2 scales"),
        (|_, c| drop(c.as_object_mut().unwrap().remove("offset")), "its cutout is broken: it has 0 offsets"),
        (|_, c| c["offset"] = json!([-1e39]), "its cutout is broken: a scale or an offset is not finite"),
        (|_, c| c["coefficientTextures"] = json!([]), "it has 0 images"),
        (|_, c| c["coefficientTextures"][0]["index"] = 7.into(), "/cutout/coefficientTextures/0/index"),
        (|_, c| c["coefficientTextures"][0]["index"] = 1.into(), "differ in their wrap modes"),
        (|_, c| c["coefficientTextures"][0]["index"] = 2.into(), "its picture is not there"),
        (
            |d, c| {
                let png = encode_png(&Image::solid("", 2, 1, [1, 2, 0, 255])).unwrap();
                d["images"] = json!([d["images"][0], { "uri": hex_uri(&png) }]);
                d["textures"][1] = json!({ "source": 1, "sampler": 0 });
                *c = json!({ "order": 1, "coefficientTextures": [{ "index": 0 }, { "index": 1 }],
                    "scale": [1, 1, 1, 1], "offset": [0, 0, 0, 0] });
            },
            "its cutout is broken: its images differ in size",
        ),
    ];
    for (change, expected) in cases {
        let mut document = small();
        document["textures"] = json!([{ "source": 0, "sampler": 0 }, { "source": 0 }, { "sampler": 0 }]);
        let mut cutout = small_cutout();
        change(&mut document, &mut cutout);
        document["materials"][0]["extensions"]["PARBAKE_materials_parallax_sh"]["cutout"] = cutout;
        let loaded = read_value(&document).unwrap();
        assert_eq!(loaded.model.materials[0].parallax, None, "{expected}");
        let said = loaded.warnings.iter().map(|w| w.text.as_str()).collect::<Vec<_>>().join("\n");
        assert!(
            said.contains("map of material \"m\" was left out") && said.contains(expected),
            "{expected}: {said}"
        );
    }
    for wrong in [json!(3), json!({ "order": 0.5 }), json!({ "order": 0, "scale": "1" })] {
        let mut document = small();
        document["materials"][0]["extensions"]["PARBAKE_materials_parallax_sh"]["cutout"] = wrong;
        let error = read_value(&document).unwrap_err();
        assert!(error.contains("/extensions/PARBAKE_materials_parallax_sh/cutout"), "{error}");
    }
}

/// Protects memory: cutouts count as the maps that they are part of.
#[test]
fn cutouts_count_as_texels() {
    let mut document = small();
    document["materials"][0]["extensions"]["PARBAKE_materials_parallax_sh"]["cutout"] = small_cutout();
    let read = |most| {
        let limits = Limits { max_total_pixels: most, ..Limits::default() };
        read_limited(&document, &limits).unwrap().model.materials[0].parallax.is_some()
    };
    assert_eq!([read(8), read(7)], [true, false]);
}

/// Protects against images of different sizes, and memory against one image that serves
/// many maps.
#[test]
fn images_are_checked_together() {
    let mut document = small();
    let png = encode_png(&Image::solid("", 2, 1, [1, 2, 0, 255])).unwrap();
    document["images"] = json!([document["images"][0], { "uri": hex_uri(&png) }]);
    document["textures"] = json!([document["textures"][0], { "source": 1, "sampler": 0 }]);
    let extension = &mut document["materials"][0]["extensions"]["PARBAKE_materials_parallax_sh"];
    extension["order"] = 1.into();
    extension["scale"] = vec![0.5; 8].into();
    extension["offset"] = vec![0.5; 8].into();
    extension["coefficientTextures"] = json!([{ "index": 0 }, { "index": 1 }, { "index": 0 }]);
    let loaded = read_value(&document).unwrap();
    assert!(loaded.warnings[0].text.contains("2 × 2 and 2 × 1 texels"), "{:?}", loaded.warnings);
    document["textures"][1]["source"] = 0.into();
    let read = |most| {
        let loaded =
            read_limited(&document, &Limits { max_total_pixels: most, ..Limits::default() }).unwrap();
        (
            loaded.model.materials[0].parallax.is_some(),
            loaded.warnings.iter().map(|w| w.text.as_str()).collect::<Vec<_>>().join(""),
        )
    };
    assert!(read(12).0);
    assert!(!read(11).0 && read(11).1.contains("more than 11 texels"));
}

/// Protects the promise that geometry is read without a word about pictures, and users
/// from losing a map in a format that has none.
#[test]
fn geometry_and_obj_have_no_maps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    write_glb(&path, &model()).unwrap();
    let loaded = crate::read_geometry(&path, &Limits::default()).unwrap();
    assert_eq!((loaded.model.materials[0].parallax.as_ref(), loaded.warnings.len()), (None, 0));
    let error = write_obj(&folder.path().join("a.obj"), &model()).unwrap_err().to_string();
    assert!(error.contains("a parallax map") && error.contains(".glb"), "{error}");
}

/// Protects the surface that is cut: offsets come back to the bit, turn and grow with their node as positions do, stand
/// on the grid of quantised positions, and go with a map that is left out.
#[test]
fn offsets_follow_their_positions() {
    let mut model = tangent_model();
    let offsets = [Vec3::new(0.1, -0.2, 0.3), Vec3::ZERO, Vec3::new(-0.7, 0.0, 0.01)];
    model.mesh.parallax_offsets = offsets.to_vec();
    assert_eq!(read_glb(&model).model.mesh.parallax_offsets, offsets);

    let read = |document: &Value| {
        let bytes = glb_of(&model, document);
        read_gltf_bytes(Path::new("x.glb"), &bytes, &NoResources, &Limits::default()).unwrap()
    };
    let mut document = written(&model);
    assert!(document["meshes"][0]["primitives"][0]["attributes"]["_PARALLAX_OFFSET"].is_u64());
    document["nodes"][0]["rotation"] =
        json!([0, 0, std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2]);
    document["nodes"][0]["scale"] = json!([2, 2, 2]);
    document["nodes"][0]["translation"] = json!([5, 6, 7]);
    let turned = read(&document).model.mesh.parallax_offsets;
    for (turned, offset) in turned.iter().zip(offsets) {
        assert!(turned.distance(2.0 * Vec3::new(-offset.y, offset.x, offset.z)) < 1e-6, "{turned} {offset}");
    }

    let options = WriteOptions { mesh_compression: MeshCompression::Meshopt, ..WriteOptions::default() };
    let (bytes, _) = glb_bytes_with(&model, &options).unwrap();
    let loaded = read_gltf_bytes(Path::new("x.glb"), &bytes, &NoResources, &Limits::default()).unwrap();
    for (read, offset) in loaded.model.mesh.parallax_offsets.iter().zip(offsets) {
        assert!(read.distance(offset) < 1e-6, "{read} {offset}");
    }

    let mut document = written(&model);
    document["materials"][0]["extensions"]["PARBAKE_materials_parallax"]["version"] = json!(3);
    assert!(read(&document).model.mesh.parallax_offsets.is_empty());
}
