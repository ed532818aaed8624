//! Materials and textures of tiny documents made by hand.

use super::*;
use crate::encode_png;
use parbake_model::TextureSlot;
use parbake_model::{AlphaMode, Image, Material, UvTransform, Wrap};

/// A textured triangle: one material, one texture, one image of a data URI.
fn textured() -> Value {
    let mut document = document(&TRIANGLE);
    let uvs = add(&mut document, "VEC2", 5126, 3, &floats(&[0.5; 6]));
    document["meshes"][0]["primitives"][0] =
        json!({ "attributes": { "POSITION": 0, "TEXCOORD_0": uvs, "TEXCOORD_1": uvs }, "material": 0 });
    document["materials"] =
        json!([{ "name": "m", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    document["textures"] = json!([{ "source": 0 }]);
    document["images"] = json!([{ "uri": hex_uri(&png([1, 2, 3, 255])) }]);
    document
}

fn png(rgba: [u8; 4]) -> Vec<u8> {
    encode_png(&Image::solid("", 2, 1, rgba)).unwrap()
}

fn material(document: &Value) -> Material {
    read_value(document).unwrap().model.materials.swap_remove(0)
}

fn base(document: &Value) -> TextureSlot {
    material(document).base_color_texture.unwrap()
}

/// Protects wrap modes: each axis has its own, and both repeat by default.
#[test]
fn wrap_modes() {
    let mut document = textured();
    assert_eq!(base(&document).wrap, [Wrap::Repeat; 2]);
    document["textures"][0]["sampler"] = 0.into();
    for (sampler, expected) in [
        (json!({}), [Wrap::Repeat, Wrap::Repeat]),
        (json!({ "wrapS": 33648, "wrapT": 33071 }), [Wrap::Mirror, Wrap::Clamp]),
        (json!({ "wrapS": 33071, "wrapT": 10497 }), [Wrap::Clamp, Wrap::Repeat]),
    ] {
        document["samplers"] = json!([sampler]);
        assert_eq!(base(&document).wrap, expected);
    }
    document["samplers"] = json!([]);
    assert!(read_value(&document).unwrap_err().contains("/textures/0/sampler: sampler 0"));
}

/// Protects texture transforms, their defaults and their own coordinate set.
#[test]
fn transforms_and_coordinate_sets() {
    let mut document = textured();
    let info =
        |value: Value| json!({ "index": 0, "texCoord": 1, "extensions": { "KHR_texture_transform": value } });
    let mut read = |value: Value| {
        document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = info(value);
        read_value(&document).map(|loaded| loaded.model.materials[0].base_color_texture.unwrap())
    };
    let slot = read(json!({})).unwrap();
    assert_eq!((slot.uv_set, slot.transform), (1, UvTransform::default()));
    let slot =
        read(json!({ "offset": [0.5, -1], "scale": [2, 3], "rotation": 0.25, "texCoord": 0 })).unwrap();
    let expected = UvTransform { offset: Vec2::new(0.5, -1.0), rotation: 0.25, scale: Vec2::new(2.0, 3.0) };
    assert_eq!((slot.uv_set, slot.transform), (0, expected));
    let error = read(json!({ "scale": [1e39, 1] })).unwrap_err();
    assert!(error.contains("baseColorTexture/extensions/KHR_texture_transform: the transform"), "{error}");
    // A set beyond the first two takes the place of one that is not asked for (`compressed.rs`).
    assert_eq!(read(json!({ "texCoord": 2 })).unwrap().uv_set, 1);
}

/// Protects factors, normal maps, alpha modes and the older way to give a colour.
#[test]
fn materials_are_understood() {
    let mut document = textured();
    document["materials"][0] = json!({
        "alphaMode": "MASK",
        "normalTexture": { "index": 0, "scale": 0.5 },
        "pbrMetallicRoughness": { "baseColorFactor": [0.5, 2, -1, 0.25] },
    });
    let read = material(&document);
    assert_eq!((read.name.as_str(), read.alpha_mode), ("material 0", AlphaMode::Mask));
    assert_eq!(read.base_color, [0.5, 1.0, 0.0, 0.25]);
    assert_eq!((read.normal_scale, read.normal_texture.map(|t| t.image)), (0.5, Some(0)));
    document["materials"][0]["extensions"] = json!({ "KHR_materials_pbrSpecularGlossiness": {
        "specularFactor": [0, 0, 0], "diffuseFactor": [0, 0, 0.96, 1], "diffuseTexture": { "index": 0 } } });
    let model = read_value(&document).unwrap().model;
    let slot = model.materials[0].base_color_texture.unwrap();
    assert_eq!(
        (model.materials[0].base_color, model.images[slot.image].pixels[0]),
        ([1.0; 4], [0, 0, 3, 255])
    );
}

/// Protects the rest of the material: glTF's defaults where it says nothing, and numbers out of
/// range, which are clamped.
#[test]
fn factors_have_defaults_and_ranges() {
    let mut document = textured();
    let said = |name: &str| Material { name: name.into(), ..Material::gltf_default() };
    document["materials"][0] = json!({ "name": "bare" });
    assert_eq!(material(&document), said("bare"));
    document["materials"][0] = json!({ "name": "in", "doubleSided": true, "alphaCutoff": 0.25,
        "pbrMetallicRoughness": { "metallicFactor": 0.25, "roughnessFactor": 0.75 },
        "emissiveFactor": [0.5, 0.25, 0.125], "occlusionTexture": { "index": 0, "strength": 0.5 },
        "extensions": { "KHR_materials_unlit": {},
            "KHR_materials_emissive_strength": { "emissiveStrength": 7.5 } } });
    let expected = Material {
        metallic: 0.25,
        roughness: 0.75,
        occlusion_texture: Some(TextureSlot::default()),
        occlusion_strength: 0.5,
        emissive: [0.5, 0.25, 0.125],
        emissive_strength: 7.5,
        alpha_cutoff: 0.25,
        double_sided: true,
        unlit: true,
        ..said("in")
    };
    assert_eq!(material(&document), expected);
    document["materials"][0] = json!({ "name": "out", "alphaCutoff": -1,
        "pbrMetallicRoughness": { "metallicFactor": -0.5, "roughnessFactor": 1e39 },
        "emissiveFactor": [-1, 2, 0.5], "occlusionTexture": { "index": 0, "strength": 3 },
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 1e39 } } });
    let expected = Material {
        metallic: 0.0,
        emissive: [0.0, 1.0, 0.5],
        occlusion_texture: Some(TextureSlot::default()),
        alpha_cutoff: 0.0,
        ..said("out")
    };
    assert_eq!(material(&document), expected);
    document["materials"][0] = json!({ "emissiveFactor": [1, 1] });
    assert!(read_value(&document).unwrap_err().contains("/materials/0/emissiveFactor"));
    // The older way to give a material has gloss instead of roughness; specular white is a metal.
    document["materials"][0] = json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": {
        "glossinessFactor": 0.75 } }, "pbrMetallicRoughness": { "roughnessFactor": 0.5 } });
    let read = material(&document);
    assert!(read.metallic > 0.999 && read.roughness == 0.25);
}

/// Protects textures that nothing renders yet: their images are read, and what is wrong with them is
/// told, as with a base colour.
#[test]
fn all_textures_are_read_alike() {
    type Slot = fn(&Material) -> Option<TextureSlot>;
    let slots: [(&str, Slot); 3] = [
        ("pbrMetallicRoughness/metallicRoughnessTexture", |m| m.metallic_roughness_texture),
        ("occlusionTexture", |m| m.occlusion_texture),
        ("emissiveTexture", |m| m.emissive_texture),
    ];
    for (place, slot) in slots {
        let mut document = textured();
        let mut read = |info: Value| {
            document["materials"][0] = match place.split_once('/') {
                Some((part, name)) => json!({ part: { name: info } }),
                None => json!({ place: info }),
            };
            read_value(&document)
        };
        let transform = json!({ "offset": [0.5, -1], "texCoord": 0 });
        let info = json!({ "index": 0, "texCoord": 1, "extensions": { "KHR_texture_transform": transform } });
        let model = read(info).unwrap().model;
        assert_eq!((model.images.len(), model.images[0].pixels[0]), (1, [1, 2, 3, 255]), "{place}");
        let transform = UvTransform { offset: Vec2::new(0.5, -1.0), ..UvTransform::default() };
        assert_eq!(slot(&model.materials[0]), Some(TextureSlot { transform, ..TextureSlot::default() }));
        let error = read(json!({ "index": 9 })).unwrap_err();
        assert!(error.contains(&format!("/materials/0/{place}/index: texture 9")), "{error}");
        let loaded = read(json!({ "index": 0, "texCoord": 2 })).unwrap();
        assert!(loaded.warnings[0].text.contains("coordinate set 2"), "{:?}", loaded.warnings);
        read(json!({ "index": 0 })).unwrap();
        document["images"] = json!([{ "uri": "gone.png" }]);
        let loaded = read_value(&document).unwrap();
        assert_eq!(slot(&loaded.model.materials[0]), None);
        assert!(loaded.warnings[0].text.contains("gone.png"), "{:?}", loaded.warnings);
        document["images"] = json!([{ "uri": "data:image/png;base64,AAAA" }]);
        assert!(read_value(&document).unwrap_err().contains("image \"image 0\""));
        document["meshes"] = json!([{ "primitives": [] }]);
        document["textures"] = json!([]);
        let error = read_value(&document).unwrap_err();
        assert!(error.contains(&format!("/materials/0/{place}/index: texture 0")), "{error}");
    }
}

/// Protects images in buffers, in base64 and of WebP, and that each is decoded once.
#[test]
fn images_of_all_kinds() {
    let mut document = textured();
    document["materials"][0]["normalTexture"] = json!({ "index": 0 });
    let model = read_value(&document).unwrap().model;
    assert_eq!((model.images.len(), model.images[0].pixels[0]), (1, [1, 2, 3, 255]));
    let inside = add(&mut document, "SCALAR", 5121, 1, &png([4, 5, 6, 7]));
    document["images"] = json!([{ "name": "inside", "mimeType": "image/png", "bufferView": inside }]);
    let image = read_value(&document).unwrap().model.images.swap_remove(0);
    assert_eq!((image.name.as_str(), image.pixels[0]), ("inside", [4, 5, 6, 7]));
    // One texel of (10, 20, 30).
    let webp = "data:image/webp;base64,UklGRh4AAABXRUJQVlA4TBEAAAAvAAAAAAdQiirUo/+BiOh/AAA=";
    document["images"] = json!([{ "uri": webp }]);
    document["textures"][0] = json!({ "extensions": { "EXT_texture_webp": { "source": 0 } } });
    document["extensionsRequired"] = json!(["EXT_texture_webp"]);
    assert_eq!(read_value(&document).unwrap().model.images[0].pixels, [[10, 20, 30, 255]]);
    document["textures"][0] = json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } });
    assert_eq!(read_value(&document).unwrap().model.images[0].pixels, [[10, 20, 30, 255]]);
    document["textures"][0] = json!({ "extensions": { "VENDOR_texture_x": { "source": 0 } } });
    let loaded = read_value(&document).unwrap();
    assert!(loaded.warnings[0].text.contains("no image that can be read"), "{:?}", loaded.warnings);
}

/// Protects models from being read as less than they are: what is not understood is refused.
#[test]
fn unknown_extensions_are_refused() {
    let mut document = textured();
    document["extensionsRequired"] = json!(["KHR_mesh_quantization", "VENDOR_something"]);
    let error = read_value(&document).unwrap_err();
    assert!(error.contains("/extensionsRequired/1: VENDOR_something is not supported; export"), "{error}");
    // Draco that is used without being required, and no data besides.
    let mut document = textured();
    document["meshes"][0]["primitives"][0]["extensions"] = json!({ "KHR_draco_mesh_compression": {} });
    assert!(read_value(&document).is_ok(), "the data is there uncompressed");
    document["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let error = read_value(&document).unwrap_err();
    assert!(error.contains("/primitives/0/extensions/KHR_draco_mesh_compression: it has no"), "{error}");
}

/// Protects models without their pictures: a warning, and no texture.
#[test]
fn missing_images_are_warnings() {
    let mut document = document(&TRIANGLE);
    document["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    document["textures"] = json!([{ "source": 0 }]);
    document["images"] = json!([{ "uri": "gone.png" }]);
    document["meshes"][0]["primitives"][0]["material"] = 0.into();
    let loaded = read_value(&document).unwrap();
    assert_eq!(loaded.model.materials[0].base_color_texture, None);
    assert!(loaded.warnings[0].text.contains("gone.png"), "{:?}", loaded.warnings);
    document["images"] = json!([{ "uri": "data:image/png;base64,AAAA" }]);
    assert!(read_value(&document).unwrap_err().contains("image \"image 0\""));
}
