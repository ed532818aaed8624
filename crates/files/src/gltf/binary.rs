//! The one buffer of a GLB file that is being written, its views and its accessors.

use serde_json::{Value, json};

const BYTE: u32 = 5120;
const UNSIGNED_BYTE: u32 = 5121;
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
    /// For each view what it holds, if that is a part of the mesh.
    pub streams: Vec<Option<Stream>>,
}

/// Vertices or indices in a buffer view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    /// Bytes of an element.
    pub stride: usize,
    /// Whether these are corners of triangles.
    pub triangles: bool,
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
        self.streams.push(None);
        self.views.len() - 1
    }

    /// A buffer view of vertices or indices.
    fn stream(&mut self, bytes: &[u8], target: u32, stride: usize) -> usize {
        let view = self.view(bytes, Some(target));
        self.streams[view] = Some(Stream { stride, triangles: target == ELEMENT_ARRAY_BUFFER });
        view
    }

    /// Vertices in rows of whole four bytes, of which an accessor may read fewer.
    fn rows<const N: usize>(&mut self, rows: impl Iterator<Item = [u8; N]>) -> (usize, usize) {
        let bytes: Vec<u8> = rows.flatten().collect();
        let view = self.stream(&bytes, ARRAY_BUFFER, N);
        self.views[view]["byteStride"] = N.into();
        (view, bytes.len() / N)
    }

    /// Positions in integers of two bytes.
    pub fn short_positions(&mut self, values: impl Iterator<Item = [u16; 3]>) -> usize {
        let row = |[x, y, z]: [u16; 3]| {
            let ([a, b], [c, d], [e, f]) = (x.to_le_bytes(), y.to_le_bytes(), z.to_le_bytes());
            [a, b, c, d, e, f, 0, 0]
        };
        let (view, count) = self.rows(values.map(row));
        self.accessor(
            json!({ "bufferView": view, "componentType": UNSIGNED_SHORT, "count": count, "type": "VEC3" }),
        )
    }

    /// Normalised bytes, signed or not, of which a VEC3 leaves the last out.
    pub fn normalised_bytes(
        &mut self,
        kind: &str,
        signed: bool,
        values: impl Iterator<Item = [u8; 4]>,
    ) -> usize {
        let (view, count) = self.rows(values);
        let component = if signed { BYTE } else { UNSIGNED_BYTE };
        self.accessor(json!({
            "bufferView": view, "componentType": component, "normalized": true, "count": count, "type": kind,
        }))
    }

    fn accessor(&mut self, value: Value) -> usize {
        self.accessors.push(value);
        self.accessors.len() - 1
    }

    /// A vertex attribute of N floats.
    pub fn floats<const N: usize>(&mut self, kind: &str, values: impl Iterator<Item = [f32; N]>) -> usize {
        let bytes: Vec<u8> = values.flatten().flat_map(f32::to_le_bytes).collect();
        let view = self.stream(&bytes, ARRAY_BUFFER, 4 * N);
        let count = bytes.len() / (4 * N);
        self.accessor(json!({ "bufferView": view, "componentType": FLOAT, "count": count, "type": kind }))
    }

    /// A vertex attribute of pairs from 0 to 1, which are 65535ths of their integers.
    pub fn normalised_shorts(&mut self, values: impl Iterator<Item = [u16; 2]>) -> usize {
        let bytes: Vec<u8> = values.flatten().flat_map(u16::to_le_bytes).collect();
        let view = self.stream(&bytes, ARRAY_BUFFER, 4);
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
        let stride = if kind == UNSIGNED_SHORT { 2 } else { 4 };
        let view = self.stream(&bytes, ELEMENT_ARRAY_BUFFER, stride);
        let count = 3 * triangles.len();
        self.accessor(json!({ "bufferView": view, "componentType": kind, "count": count, "type": "SCALAR" }))
    }
}
