//! GLB out (glTF 2.0, sections 3 and 4): one mesh; pictures as PNG inside the file.
//!
//! The file passes the Khronos validator without errors, and the same model gives
//! the same bytes.

use super::binary::Binary;
use super::write_material::{EMISSIVE_STRENGTH, Materials, UNLIT};
use super::write_mesh::primitives;
use crate::image_out::pack_png;
use crate::{FileError, Place, write_atomically};
use parbake_model::Model;
use rayon::prelude::*;
use serde_json::json;
use std::path::Path;

/// Writes `model` as a GLB file, and returns its bytes' number.
///
/// # Errors
/// When the model breaks its contract, or the file cannot be written.
pub fn write_glb(path: &Path, model: &Model) -> Result<u64, FileError> {
    let bytes = to_bytes(path, model)?;
    write_atomically(path, &bytes)?;
    Ok(bytes.len() as u64)
}

/// The bytes of a GLB file of `model`. Errors name the model instead of a file.
///
/// # Errors
/// When the model breaks its contract.
pub fn glb_bytes(model: &Model) -> Result<Vec<u8>, FileError> {
    to_bytes(Path::new(&model.name), model)
}

fn to_bytes(path: &Path, model: &Model) -> Result<Vec<u8>, FileError> {
    crate::model_out::check(path, model)?;
    let mut binary = Binary::default();
    let materials = Materials::of(model);
    let primitives = primitives(&mut binary, model, &materials.used);
    let mut images = Vec::new();
    let encode = |&image: &usize| pack_png(&model.images[image]);
    let encoded: Vec<_> = materials.images.par_iter().map(encode).collect::<Result<_, _>>()?;
    for (&image, png) in materials.images.iter().zip(&encoded) {
        let view = binary.view(png, None);
        images.push(json!({ "name": model.images[image].name, "mimeType": "image/png", "bufferView": view }));
    }
    let mut document = json!({
        "asset": { "version": "2.0", "generator": concat!("Parbake ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": model.name }],
        "meshes": [{ "name": model.name, "primitives": primitives }],
        "materials": materials.json,
        "accessors": binary.accessors,
        "bufferViews": binary.views,
        "buffers": [{ "byteLength": binary.bytes.len() }],
    });
    // glTF has no empty arrays.
    for (key, values) in
        [("textures", materials.textures), ("samplers", materials.samplers), ("images", images)]
    {
        if !values.is_empty() {
            document[key] = values.into();
        }
    }
    let extensions = [
        (EMISSIVE_STRENGTH, materials.uses_emissive_strength),
        (UNLIT, materials.uses_unlit),
        ("KHR_texture_transform", materials.uses_transforms),
        (super::parallax::NAME, materials.uses_parallax),
    ];
    if extensions.iter().any(|e| e.1) {
        document["extensionsUsed"] = extensions.iter().filter(|e| e.1).map(|e| e.0).collect();
    }
    assemble(path, &document.to_string(), binary.bytes)
}

/// Header, JSON chunk, binary chunk; each padded to four bytes.
fn assemble(path: &Path, document: &str, mut binary: Vec<u8>) -> Result<Vec<u8>, FileError> {
    let mut text = document.as_bytes().to_vec();
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let total = 12 + 8 + text.len() + 8 + binary.len();
    let length = u32::try_from(total).map_err(|_| FileError::OverLimit {
        path: path.into(),
        place: Place::File,
        what: "bytes in a GLB file",
        found: total as u64,
        limit: u32::MAX.into(),
    })?;
    let mut out = Vec::with_capacity(total);
    out.extend_from_slice(super::MAGIC);
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&length.to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &binary)] {
        out.extend_from_slice(&(chunk.len() as u32).to_le_bytes());
        out.extend_from_slice(kind);
        out.extend_from_slice(chunk);
    }
    Ok(out)
}
