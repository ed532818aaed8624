//! Material extensions: those that are converted, and those that are kept.

use super::*;
use parbake_model::{Clearcoat, Image, MaterialExtensions, Sheen, TextureSlot, Transmission, Volume};

/// The triangle with texture coordinates and these materials, the first of which it has.
fn with_materials(materials: Value, pictures: &[Image]) -> Value {
    let mut document = document(&TRIANGLE);
    let uvs = add(&mut document, "VEC2", 5126, 3, &floats(&[0.5; 6]));
    document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uvs.into();
    document["meshes"][0]["primitives"][0]["material"] = 0.into();
    document["materials"] = materials;
    let uri = |image: &Image| {
        hex_uri(&crate::encode_png(image).unwrap()).replace("application/octet-stream", "image/png")
    };
    document["images"] = pictures.iter().map(|image| json!({ "uri": uri(image) })).collect();
    document["textures"] = (0..pictures.len()).map(|source| json!({ "source": source })).collect();
    document
}

/// Protects what extensions say: factors in their ranges, and textures.
#[test]
fn factors_and_textures_are_kept() {
    let extensions = json!({
        "KHR_materials_clearcoat": {
            "clearcoatFactor": 0.5,
            "clearcoatNormalTexture": { "index": 0, "scale": 0.5 },
        },
        "KHR_materials_sheen": { "sheenColorFactor": [2, 0.5, -1], "sheenRoughnessFactor": 0.25 },
        "KHR_materials_transmission": { "transmissionFactor": 1, "transmissionTexture": { "index": 0 } },
        "KHR_materials_volume": { "thicknessFactor": 0.5, "attenuationColor": [1, 0, 0.5] },
        "KHR_materials_ior": { "ior": 1.5 },
        "KHR_materials_specular": {},
        "KHR_materials_iridescence": {},
        "KHR_materials_dispersion": { "dispersion": 1e39 },
    });
    let picture = Image::solid("p", 1, 1, [128, 128, 255, 255]);
    let materials = json!([{ "name": "glass", "extensions": extensions }]);
    let loaded = read_value(&with_materials(materials, &[picture])).unwrap();
    let read = &loaded.model.materials[0].extensions;
    let texture = Some(TextureSlot::default());
    let expected = MaterialExtensions {
        clearcoat: Some(Clearcoat {
            factor: 0.5,
            normal_texture: texture,
            normal_scale: 0.5,
            ..Clearcoat::default()
        }),
        sheen: Some(Sheen { color: [1.0, 0.5, 0.0], roughness: 0.25, ..Sheen::default() }),
        transmission: Some(Transmission { factor: 1.0, texture }),
        volume: Some(Volume { thickness: 0.5, attenuation_color: [1.0, 0.0, 0.5], ..Volume::default() }),
        ior: Some(1.5),
        specular: Some(Default::default()),
        iridescence: Some(Default::default()),
        dispersion: Some(0.0),
        ..MaterialExtensions::default()
    };
    assert_eq!(*read, expected);
    assert_eq!((loaded.model.images.len(), loaded.warnings.len()), (1, 0), "{:?}", loaded.warnings);
    let plain = read_value(&with_materials(json!([{}]), &[])).unwrap();
    assert!(plain.model.materials[0].extensions.is_empty() && plain.warnings.is_empty());
}

/// Protects the colour of thick glass: thickness is in the mesh's own unit, which nodes enlarge, and one
/// material on parts of two sizes is two.
#[test]
fn thickness_grows_with_its_node() {
    let mut document = with_materials(
        json!([{ "extensions": { "KHR_materials_volume": { "thicknessFactor": 0.5 } } }]),
        &[],
    );
    document["nodes"] = json!([{ "mesh": 0, "scale": [3, 3, 3] }, { "mesh": 0 }]);
    document["scenes"] = json!([{ "nodes": [0, 1] }]);
    let model = read_value(&document).unwrap().model;
    let thickness = |m: usize| model.materials[m].extensions.volume.unwrap().thickness;
    assert_eq!(model.materials.len(), 2);
    assert!((thickness(0) - 1.5).abs() < 1e-6 && thickness(1) == 0.5);
}

/// Protects the user's choice of a look: which one is taken is said.
#[test]
fn variants_are_told() {
    let mut document = document(&TRIANGLE);
    document["extensions"]["KHR_materials_variants"] =
        json!({ "variants": [{ "name": "Mango" }, { "name": "Peach" }] });
    let warnings = read_value(&document).unwrap().warnings;
    assert!(warnings.len() == 1 && warnings[0].text.contains("\"Mango\", \"Peach\""), "{warnings:?}");
}

fn glossy(value: Value) -> Value {
    json!([{ "name": "g", "extensions": { "KHR_materials_pbrSpecularGlossiness": value } }])
}

/// Protects specular-glossiness textures: each texel is converted with the texel of the other picture.
#[test]
fn specular_glossiness_is_converted_texel_by_texel() {
    let mut diffuse = Image::solid("d", 2, 1, [188, 100, 50, 128]);
    diffuse.pixels[1] = [0, 0, 0, 255];
    // A plastic, whose specular colour is 0.04 (56 in sRGB is 0.0395), and gold.
    let mut specular = Image::solid("s", 2, 1, [56, 56, 56, 51]);
    specular.pixels[1] = [255, 226, 155, 204];
    let value = json!({ "diffuseTexture": { "index": 0 }, "specularGlossinessTexture": { "index": 1 } });
    let model = read_value(&with_materials(glossy(value), &[diffuse, specular])).unwrap().model;
    assert_eq!(model.images.len(), 2, "the sources are gone");
    let material = &model.materials[0];
    let [color, metal] = [material.base_color_texture, material.metallic_roughness_texture]
        .map(|slot| &model.images[slot.unwrap().image].pixels);
    let near = |a: [u8; 4], b: [u8; 4]| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 2);
    assert!(near(color[0], [188, 100, 50, 128]) && near(color[1], [255, 226, 155, 255]), "{color:?}");
    assert!(near(metal[0], [255, 204, 0, 255]) && near(metal[1], [255, 51, 255, 255]), "{metal:?}");
    assert_eq!((material.metallic, material.roughness, material.base_color), (1.0, 1.0, [1.0; 4]));
}

/// Protects what is the same everywhere from becoming a texture, and textures that lie apart.
#[test]
fn constant_and_separate_maps() {
    let mut diffuse = Image::solid("d", 2, 1, [188, 100, 50, 255]);
    diffuse.pixels[1] = [90, 90, 90, 255];
    let value =
        json!({ "diffuseTexture": { "index": 0 }, "specularFactor": [0, 0, 0], "glossinessFactor": 0.6 });
    let model = read_value(&with_materials(glossy(value), std::slice::from_ref(&diffuse))).unwrap().model;
    let material = &model.materials[0];
    assert!(material.metallic_roughness_texture.is_none() && model.images.len() == 1);
    assert!(material.metallic == 0.0 && (material.roughness - 0.4).abs() < 1e-6);
    let value = json!({ "diffuseTexture": { "index": 0 }, "specularGlossinessTexture": {
        "index": 0, "extensions": { "KHR_texture_transform": { "scale": [2, 2] } } } });
    let loaded = read_value(&with_materials(glossy(value), &[diffuse])).unwrap();
    assert!(loaded.warnings[0].text.contains("mean of the other"), "{:?}", loaded.warnings);
    let material = &loaded.model.materials[0];
    assert_eq!(material.metallic_roughness_texture.unwrap().transform.scale, Vec2::splat(2.0));
    assert_eq!(material.base_color_texture.unwrap().transform.scale, Vec2::ONE);
}
