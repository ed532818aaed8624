//! GLB out (glTF 2.0, sections 3 and 4): one mesh, one primitive for each material
//! in use, all on the same vertices; pictures as PNG inside the file.
//!
//! The file passes the Khronos validator without errors, and the same model gives
//! the same bytes. Normals and tangents are brought to unit length where they are
//! not; texture coordinates that a material needs and the mesh lacks are zeros, as
//! [`Mesh::corner_uvs`](parbake_model::Mesh::corner_uvs) has them.

use super::write_material::Materials;
use crate::unit::{unit, unit_tangent};
use crate::{FileError, Place, encode_png, write_atomically};
use parbake_model::glam::{Vec2, Vec3};
use parbake_model::{Mesh, Model};
use serde_json::{Value, json};
use std::path::Path;

const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Writes `model` as a GLB file.
///
/// # Errors
/// When the model breaks its contract, or the file cannot be written.
pub fn write_glb(path: &Path, model: &Model) -> Result<(), FileError> {
    write_atomically(path, &to_bytes(path, model)?)
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
    let attributes = attributes(&mut binary, model);
    let primitives = primitives(&mut binary, &model.mesh, &materials.used, &attributes);
    let mut images = Vec::new();
    for &image in &materials.images {
        let image = &model.images[image];
        let view = binary.view(&encode_png(image)?, None);
        images.push(json!({ "name": image.name, "mimeType": "image/png", "bufferView": view }));
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

/// The one buffer, and what lies where in it.
#[derive(Default)]
struct Binary {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Binary {
    /// Adds a buffer view, four-aligned as accessors need it.
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, value: Value) -> usize {
        self.accessors.push(value);
        self.accessors.len() - 1
    }

    /// A vertex attribute of N floats.
    fn floats<const N: usize>(&mut self, kind: &str, values: impl Iterator<Item = [f32; N]>) -> usize {
        let bytes: Vec<u8> = values.flatten().flat_map(f32::to_le_bytes).collect();
        let view = self.view(&bytes, Some(ARRAY_BUFFER));
        let count = bytes.len() / (4 * N);
        self.accessor(json!({ "bufferView": view, "componentType": FLOAT, "count": count, "type": kind }))
    }
}

fn attributes(binary: &mut Binary, model: &Model) -> Value {
    let mesh = &model.mesh;
    let mut attributes = json!({ "POSITION": positions(binary, &mesh.positions) });
    let normals: Vec<Vec3> = mesh.normals.iter().map(|&n| unit(n).unwrap_or(Vec3::Y)).collect();
    if !normals.is_empty() {
        attributes["NORMAL"] = binary.floats("VEC3", normals.iter().map(|n| n.to_array())).into();
        // Tangents without normals mean nothing.
        if !mesh.tangents.is_empty() {
            let tangents = mesh.tangents.iter().zip(&normals).map(|(&t, &n)| unit_tangent(t, n).to_array());
            attributes["TANGENT"] = binary.floats("VEC4", tangents).into();
        }
    }
    let zeros = vec![Vec2::ZERO; mesh.positions.len()];
    let needed = |set: u8| model.materials.iter().flat_map(|m| m.texture_slots()).any(|s| s.uv_set >= set);
    for (set, uvs) in [(0, &mesh.uvs), (1, &mesh.uvs1)] {
        // Sets are numbered without gaps, so that set 1 brings set 0 along.
        let uvs = match uvs.is_empty() {
            true if needed(set) || set == 0 && !mesh.uvs1.is_empty() => &zeros,
            _ => uvs,
        };
        if !uvs.is_empty() {
            let accessor = binary.floats("VEC2", uvs.iter().map(|uv| uv.to_array()));
            attributes[format!("TEXCOORD_{set}")] = accessor.into();
        }
    }
    if !mesh.colors.is_empty() {
        let colors = mesh.colors.iter().map(|c| c.to_array().map(|x| x.clamp(0.0, 1.0)));
        attributes["COLOR_0"] = binary.floats("VEC4", colors).into();
    }
    attributes
}

/// Positions, which alone must have their bounds said.
fn positions(binary: &mut Binary, positions: &[Vec3]) -> usize {
    let accessor = binary.floats("VEC3", positions.iter().map(|p| p.to_array()));
    let bounds = |start: f32, fold: fn(Vec3, Vec3) -> Vec3| {
        let bound = positions.iter().fold(Vec3::splat(start), |a, &b| fold(a, b));
        // As doubles they are the very numbers in the buffer.
        json!(bound.to_array().map(f64::from))
    };
    let (min, max) = (bounds(f32::INFINITY, Vec3::min), bounds(f32::NEG_INFINITY, Vec3::max));
    binary.accessors[accessor]["min"] = min;
    binary.accessors[accessor]["max"] = max;
    accessor
}

/// One primitive for each used material, on the same attributes.
fn primitives(binary: &mut Binary, mesh: &Mesh, used: &[usize], attributes: &Value) -> Vec<Value> {
    let mut by_material: Vec<Vec<u8>> = vec![Vec::new(); used.len()];
    let mut places = vec![0; used.iter().max().map_or(0, |m| m + 1)];
    for (place, &material) in used.iter().enumerate() {
        places[material] = place;
    }
    // Index 65535 is kept free in the short form: it restarts strips.
    let short = mesh.positions.len() <= 65535;
    for (triangle, &material) in mesh.triangles.iter().zip(&mesh.triangle_materials) {
        let bytes = &mut by_material[places[material as usize]];
        for &index in triangle {
            if short {
                bytes.extend_from_slice(&(index as u16).to_le_bytes());
            } else {
                bytes.extend_from_slice(&index.to_le_bytes());
            }
        }
    }
    let (kind, size) = if short { (5123, 2) } else { (5125, 4) };
    let mut primitives = Vec::with_capacity(used.len());
    for (material, bytes) in by_material.iter().enumerate() {
        let view = binary.view(bytes, Some(ELEMENT_ARRAY_BUFFER));
        let count = bytes.len() / size;
        let indices = binary
            .accessor(json!({ "bufferView": view, "componentType": kind, "count": count, "type": "SCALAR" }));
        primitives.push(json!({ "attributes": attributes, "indices": indices, "material": material }));
    }
    primitives
}
