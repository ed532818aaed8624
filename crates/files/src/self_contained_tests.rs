//! Tests of `self_contained.rs`.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::encode_png;
use parbake_model::Image;
use serde_json::{Value, json};

fn triangle() -> Vec<u8> {
    [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes).as_flattened().to_vec()
}

fn document(picture: &str) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": 4, "uri": "data:;base64,AAAAAA==" }, { "byteLength": 36, "uri": "p.bin" }],
        "bufferViews": [{ "buffer": 1, "byteLength": 36 }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
        "nodes": [{ "mesh": 0, "extensions": { "MSFT_lod": { "ids": [1] } } }, { "mesh": 0 }],
        "scenes": [{ "nodes": [0] }], "scene": 0,
        "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
        "textures": [{ "source": 0 }], "images": [{ "uri": picture }],
    })
}

/// The JSON and the binary chunk of a GLB file.
fn chunks(glb: &[u8]) -> (Value, &[u8]) {
    let length = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    let text = length(12);
    (serde_json::from_slice(&glb[20..20 + text]).unwrap(), &glb[28 + text..])
}

/// Protects viewers of glTF files: buffers and pictures are taken in, where they are named by index, and what the
/// readers do not know stays.
#[test]
fn buffers_and_pictures_are_taken_in() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.gltf");
    let png = encode_png(&Image::solid("", 2, 1, [1, 2, 3, 255])).unwrap();
    std::fs::write(folder.path().join("p.bin"), triangle()).unwrap();
    std::fs::write(folder.path().join("a b.png"), &png).unwrap();
    let text = document("a%20b.png").to_string();
    std::fs::write(&path, &text).unwrap();
    let packed = read_self_contained(&path, &Limits::default()).unwrap();
    let (json, binary) = chunks(&packed.glb);
    assert_eq!(json["nodes"], document("")["nodes"]);
    let bytes = |view: &Value| {
        let (start, length) = (view["byteOffset"].as_u64().unwrap(), view["byteLength"].as_u64().unwrap());
        &binary[start as usize..(start + length) as usize]
    };
    assert_eq!(bytes(&json["bufferViews"][0]), triangle());
    assert_eq!(json["images"], json!([{ "bufferView": 1, "mimeType": "image/png" }]));
    assert_eq!(bytes(&json["bufferViews"][1]), png);
    assert_eq!(packed.bytes, (text.len() + 36 + png.len()) as u64);
    assert!(packed.warnings.is_empty(), "{:?}", packed.warnings);

    // A second time there is nothing to take in.
    let path = folder.path().join("again.glb");
    std::fs::write(&path, &packed.glb).unwrap();
    assert!(read_self_contained(&path, &Limits::default()).unwrap().glb == packed.glb);
}

/// Protects viewers from files elsewhere and from what is missing: a lost picture is a warning, an address is never
/// followed, a confined reading stays in the folder.
#[test]
fn what_is_missing_is_white() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.gltf");
    std::fs::write(folder.path().join("p.bin"), triangle()).unwrap();
    for picture in ["gone.png", "https://example.com/a.png"] {
        std::fs::write(&path, document(picture).to_string()).unwrap();
        let packed = read_self_contained(&path, &Limits::default()).unwrap();
        assert!(packed.warnings.iter().any(|w| w.text.contains(picture)), "{:?}", packed.warnings);
        assert!(!String::from_utf8_lossy(&packed.glb).contains(picture));
    }
    std::fs::write(&path, document("../a.png").to_string()).unwrap();
    let confined = Limits { confine: true, ..Limits::default() };
    let error = read_self_contained(&path, &confined).unwrap_err().to_string();
    assert!(error.contains("outside the model's folder"), "{error}");
}

/// Protects viewers of other formats.
#[test]
fn objs_are_converted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let packed = read_self_contained(&path, &Limits::default()).unwrap();
    let (json, _) = chunks(&packed.glb);
    assert_eq!(json["meshes"].as_array().unwrap().len(), 1);
}
