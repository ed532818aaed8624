//! The one buffer of a GLB file that is being written, its views and its accessors.

use serde_json::{Value, json};

const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Vertices that indices of two bytes can name: 65535 is kept free, for it restarts strips.
pub const SHORT: usize = 65_535;

/// The buffer, and what lies where in it.
#[derive(Default)]
pub struct Binary {
    /// The buffer's bytes.
    pub bytes: Vec<u8>,
    /// The document's buffer views.
    pub views: Vec<Value>,
    /// The document's accessors.
    pub accessors: Vec<Value>,
}

impl Binary {
    /// Adds a buffer view, four-aligned as accessors need it.
    pub fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
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
    pub fn floats<const N: usize>(&mut self, kind: &str, values: impl Iterator<Item = [f32; N]>) -> usize {
        let bytes: Vec<u8> = values.flatten().flat_map(f32::to_le_bytes).collect();
        let view = self.view(&bytes, Some(ARRAY_BUFFER));
        let count = bytes.len() / (4 * N);
        self.accessor(json!({ "bufferView": view, "componentType": FLOAT, "count": count, "type": kind }))
    }

    /// A vertex attribute of pairs from 0 to 1, which are 65535ths of their integers.
    pub fn normalised_shorts(&mut self, values: impl Iterator<Item = [u16; 2]>) -> usize {
        let bytes: Vec<u8> = values.flatten().flat_map(u16::to_le_bytes).collect();
        let view = self.view(&bytes, Some(ARRAY_BUFFER));
        self.accessor(json!({
            "bufferView": view, "componentType": UNSIGNED_SHORT, "normalized": true,
            "count": bytes.len() / 4, "type": "VEC2",
        }))
    }

    /// Corners of triangles among `vertices` vertices, in two bytes each where that is enough.
    pub fn indices(&mut self, triangles: &[[u32; 3]], vertices: usize) -> usize {
        let corners = triangles.iter().flatten();
        let (kind, bytes): (u32, Vec<u8>) = if vertices <= SHORT {
            (UNSIGNED_SHORT, corners.flat_map(|&i| (i as u16).to_le_bytes()).collect())
        } else {
            (UNSIGNED_INT, corners.flat_map(|i| i.to_le_bytes()).collect())
        };
        let view = self.view(&bytes, Some(ELEMENT_ARRAY_BUFFER));
        let count = 3 * triangles.len();
        self.accessor(json!({ "bufferView": view, "componentType": kind, "count": count, "type": "SCALAR" }))
    }
}
