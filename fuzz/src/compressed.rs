//! glTF documents around a compressed stream, which stands in a file beside them.

use crate::{Everywhere, LIMITS, check};
use parbake_files::read_gltf_bytes;
use std::path::Path;

/// Reads a document whose only external file is `stream`.
pub fn read(document: &str, stream: &[u8]) {
    check(read_gltf_bytes(Path::new("fuzz"), document.as_bytes(), &Everywhere(stream), &LIMITS));
}

/// A document with one primitive that is a Draco stream of so many bytes.
pub fn draco(length: usize) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"buffers":[{{"byteLength":{length},"uri":"s"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{length}}}],
        "accessors":[{{"componentType":5126,"count":3,"type":"VEC3"}},{{"componentType":5126,"count":3,"type":"VEC2"}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":0,"TEXCOORD_0":1}},"extensions":{{
        "KHR_draco_mesh_compression":{{"bufferView":0,"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}}}}}}}}]}}]}}"#
    )
}

/// A document whose positions, or indices, are a meshopt stream of so many bytes.
pub fn meshopt([mode, filter, stride, count]: [u8; 4], length: usize) -> String {
    let modes = ["ATTRIBUTES", "TRIANGLES", "INDICES"];
    let mode = modes[usize::from(mode) % modes.len()];
    let filters = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"];
    let filter = filters[usize::from(filter) % filters.len()];
    let (stride, count) = (4 * usize::from(stride % 65), 3 * usize::from(count));
    let compressed = format!(
        r#""extensions":{{"KHR_meshopt_compression":{{"buffer":0,"byteLength":{length},"byteStride":{stride},"count":{count},"mode":"{mode}","filter":"{filter}"}}}}"#
    );
    let bytes = stride * count;
    let view = format!(r#"{{"buffer":1,"byteLength":{bytes},"byteStride":{stride},{compressed}}}"#);
    let (component, kind) = if mode == "ATTRIBUTES" { (5122, "VEC3") } else { (5125, "SCALAR") };
    let used = if mode == "ATTRIBUTES" {
        r#""attributes":{"POSITION":0}"#
    } else {
        r#""attributes":{"POSITION":1},"indices":0"#
    };
    format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],
        "buffers":[{{"byteLength":{length},"uri":"s"}},{{"byteLength":{bytes}}}],"bufferViews":[{view}],
        "accessors":[{{"bufferView":0,"componentType":{component},"count":{count},"type":"{kind}"}},
        {{"componentType":5126,"count":64,"type":"VEC3"}}],
        "meshes":[{{"primitives":[{{{used}}}]}}]}}"#
    )
}
