//! Vertices and indices out with `EXT_meshopt_compression`: each buffer view is encoded without loss,
//! and names a second buffer without bytes for readers to decode it into.
//!
//! Contract: vertices are encoded with version 0 of the codec, indices with version 1, which are those
//! that the extension knows.

use super::binary::{Binary, Stream};
use serde_json::{Value, json};

pub const NAME: &str = "EXT_meshopt_compression";
/// Of the vertex codec; the extension's.
const VERTEX_VERSION: i32 = 0;
/// The codec's best.
const LEVEL: i32 = 3;

/// Encodes the streams of `binary`, and returns the document's second buffer. A stream that the codec
/// does not take stays as it is.
pub fn compress(binary: &mut Binary) -> Value {
    let plain = std::mem::take(&mut binary.bytes);
    let mut decoded_length = 0;
    for (view, stream) in binary.views.iter_mut().zip(&binary.streams) {
        let range = |key: &str| view[key].as_u64().unwrap_or(0) as usize;
        let (from, length) = (range("byteOffset"), range("byteLength"));
        let bytes = &plain[from..from + length];
        let encoded = stream.as_ref().and_then(|stream| encode(bytes, stream).map(|e| (stream, e)));
        binary.bytes.resize(binary.bytes.len().next_multiple_of(4), 0);
        let offset = binary.bytes.len();
        let Some((stream, encoded)) = encoded else {
            binary.bytes.extend_from_slice(bytes);
            view["byteOffset"] = offset.into();
            continue;
        };
        binary.bytes.extend_from_slice(&encoded);
        view["buffer"] = 1.into();
        view["byteOffset"] = decoded_length.into();
        view["extensions"][NAME] = json!({
            "buffer": 0, "byteOffset": offset, "byteLength": encoded.len(),
            "byteStride": stream.stride, "count": length / stream.stride,
            "mode": if stream.triangles { "TRIANGLES" } else { "ATTRIBUTES" },
        });
        decoded_length = (decoded_length + length).next_multiple_of(4);
    }
    json!({ "byteLength": decoded_length, "extensions": { NAME: { "fallback": true } } })
}

fn encode(bytes: &[u8], stream: &Stream) -> Option<Vec<u8>> {
    match (stream.triangles, stream.stride) {
        (true, 2) => indices(bytes.chunks_exact(2).map(|b| u32::from(u16::from_le_bytes([b[0], b[1]])))),
        (true, _) => indices(bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
        (false, 4) => vertices::<4>(bytes),
        (false, 8) => vertices::<8>(bytes),
        (false, 12) => vertices::<12>(bytes),
        (false, 16) => vertices::<16>(bytes),
        _ => None,
    }
}

fn indices(corners: impl Iterator<Item = u32>) -> Option<Vec<u8>> {
    let corners: Vec<u32> = corners.collect();
    let vertices = corners.iter().max().map_or(0, |&last| last as usize + 1);
    meshopt::encode_index_buffer(&corners, vertices).ok()
}

fn vertices<const N: usize>(bytes: &[u8]) -> Option<Vec<u8>> {
    let vertices: Vec<[u8; N]> = bytes.chunks_exact(N).filter_map(|chunk| chunk.try_into().ok()).collect();
    meshopt::encode_vertex_buffer_level(&vertices, LEVEL, Some(VERTEX_VERSION)).ok()
}
