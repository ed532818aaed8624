//! The one buffer of a GLB file that is being written, its views and its accessors.

use super::quantise::signed_byte;
use parbake_model::Influences;
use parbake_model::glam::Vec3;
use serde_json::{Value, json};

const BYTE: u32 = 5120;
const UNSIGNED_BYTE: u32 = 5121;
const SIGNED_SHORT: u32 = 5122;
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

/// In what displacements are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Floats.
    Float,
    /// Whole numbers of two bytes.
    Short,
    /// 127ths.
    NormalisedByte,
}

/// Four numbers of two bytes.
fn shorts(values: [u16; 4]) -> [u8; 8] {
    let [[a, b], [c, d], [e, f], [g, h]] = values.map(u16::to_le_bytes);
    [a, b, c, d, e, f, g, h]
}

/// Weights, greatest first, in whole parts that sum to `most`.
fn whole_parts(weights: [f32; 4], most: u16) -> [u16; 4] {
    let sum: f32 = weights.iter().sum();
    // Halves go down, so that the first one stays the greatest.
    let mut parts = weights.map(|w| (w / sum * f32::from(most) - 0.5).ceil() as u16);
    let rest: u32 = parts[1..].iter().map(|&part| u32::from(part)).sum();
    parts[0] = (u32::from(most).saturating_sub(rest)) as u16;
    parts
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

    /// Joints of vertices, in bytes where there are few enough, and their weights, in bytes where these need not be
    /// exact; weights of a vertex sum to 1 to the bit.
    pub fn influences(&mut self, influences: &[Influences], joints: usize, small: bool) -> [usize; 2] {
        let few = joints <= 1 + usize::from(u8::MAX);
        let most = if small { u16::from(u8::MAX) } else { u16::MAX };
        let parts: Vec<[u16; 4]> = influences.iter().map(|i| whole_parts(i.weights, most)).collect();
        // What is rounded to no weight names no joint.
        let named = influences.iter().zip(&parts).map(|(influences, parts)| {
            std::array::from_fn::<u32, 4, _>(|k| if parts[k] == 0 { 0 } else { influences.joints[k] })
        });
        let (joint_view, count) = match few {
            true => self.rows(named.map(|joints| joints.map(|joint| joint as u8))),
            false => self.rows(named.map(|joints| shorts(joints.map(|joint| joint as u16)))),
        };
        let joint_type = if few { UNSIGNED_BYTE } else { UNSIGNED_SHORT };
        let joints = self.accessor(json!({
            "bufferView": joint_view, "componentType": joint_type, "count": count, "type": "VEC4",
        }));
        let (weight_view, count) = match small {
            true => self.rows(parts.iter().map(|parts| parts.map(|part| part as u8))),
            false => self.rows(parts.iter().map(|&parts| shorts(parts))),
        };
        let weight_type = if small { UNSIGNED_BYTE } else { UNSIGNED_SHORT };
        let weights = self.accessor(json!({
            "bufferView": weight_view, "componentType": weight_type, "normalized": true, "count": count,
            "type": "VEC4",
        }));
        [joints, weights]
    }

    /// Displacements of `vertices` (ascending) among `count`; all others are zero.
    pub fn displacements(&mut self, count: usize, vertices: &[u32], values: &[Vec3], unit: Unit) -> usize {
        let (component, size, row) = match unit {
            Unit::Float => (FLOAT, 12, 12),
            Unit::Short => (SIGNED_SHORT, 6, 8),
            Unit::NormalisedByte => (BYTE, 3, 4),
        };
        let bytes = |value: &Vec3| -> Vec<u8> {
            match unit {
                Unit::Float => value.to_array().into_iter().flat_map(f32::to_le_bytes).collect(),
                Unit::Short => {
                    value.to_array().into_iter().flat_map(|x| (x.round() as i16).to_le_bytes()).collect()
                }
                Unit::NormalisedByte => value.to_array().into_iter().map(signed_byte).collect(),
            }
        };
        let mut accessor = json!({ "componentType": component, "count": count, "type": "VEC3" });
        if unit == Unit::NormalisedByte {
            accessor["normalized"] = true.into();
        }
        let index_size = if count <= SHORT { 2 } else { 4 };
        if vertices.len() * (size + index_size) < count * row {
            if !vertices.is_empty() {
                let indices: Vec<u8> = match index_size {
                    2 => vertices.iter().flat_map(|&v| (v as u16).to_le_bytes()).collect(),
                    _ => vertices.iter().flat_map(|v| v.to_le_bytes()).collect(),
                };
                let indices = self.view(&indices, None);
                let values: Vec<u8> = values.iter().flat_map(bytes).collect();
                let values = self.view(&values, None);
                let kind = if index_size == 2 { UNSIGNED_SHORT } else { UNSIGNED_INT };
                accessor["sparse"] = json!({
                    "count": vertices.len(),
                    "indices": { "bufferView": indices, "componentType": kind },
                    "values": { "bufferView": values },
                });
            }
            return self.accessor(accessor);
        }
        let mut all = vec![0; count * row];
        for (&vertex, value) in vertices.iter().zip(values) {
            all[vertex as usize * row..][..size].copy_from_slice(&bytes(value));
        }
        let view = self.stream(&all, ARRAY_BUFFER, row);
        self.views[view]["byteStride"] = row.into();
        accessor["bufferView"] = view.into();
        self.accessor(accessor)
    }

    /// Blocks of floats that are no vertices, in one view: for each the kind of its elements and how many numbers each
    /// has. Returns the first one's accessor; the others follow it.
    pub fn blocks(&mut self, blocks: &[(&str, usize, &[f32])]) -> usize {
        let (view, first) = (self.views.len(), self.accessors.len());
        let mut bytes: Vec<u8> = Vec::new();
        for (kind, width, numbers) in blocks {
            self.accessor(json!({
                "bufferView": view, "byteOffset": bytes.len(), "componentType": FLOAT,
                "count": numbers.len() / width, "type": kind,
            }));
            bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        }
        self.view(&bytes, None);
        first
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
