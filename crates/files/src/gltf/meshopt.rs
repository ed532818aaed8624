//! EXT_meshopt_compression and KHR_meshopt_compression: buffer views that hold the streams of
//! meshoptimizer, which the crate `meshopt` decodes; filters are in `meshopt_filter.rs`.
//!
//! Contract: no more memory is reserved than a stream of this length can fill, which
//! [`Compression::bytes`] says, so that it can be held against the limits before.

use super::json::Meshopt;
use super::meshopt_filter::Filter;
use crate::context::Context;
use crate::guard::guarded;
use crate::{FileError, Place};

/// The most bytes that one byte of a stream of vertices can stand for: a control byte of format 1
/// says of four channels that 256 vertices do not differ in them.
const MOST_VERTEX_BYTES: u64 = 4 * 256;

/// A triangle takes at least a byte in a stream of triangles, an index in one of indices.
const TRIANGLE: u64 = 3;

/// What a stream holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

/// What the extension of a compressed buffer view says of its stream, held against the format.
pub(super) struct Compression<'a, 'c> {
    context: &'a Context<'c>,
    json: &'a Meshopt,
    /// The pointer to the extension.
    here: &'a str,
    mode: Mode,
    filter: Option<Filter>,
}

impl<'a, 'c> Compression<'a, 'c> {
    /// Of the extension at the pointer `here`.
    pub fn new(context: &'a Context<'c>, json: &'a Meshopt, here: &'a str) -> Result<Self, FileError> {
        let refuse = |part: &str, reason: String| {
            Err(context.invalid(Place::Pointer(format!("{here}/{part}")), reason))
        };
        let mode = match json.mode.as_str() {
            "ATTRIBUTES" => Mode::Attributes,
            "TRIANGLES" => Mode::Triangles,
            "INDICES" => Mode::Indices,
            other => return refuse("mode", format!("{other:?} is no mode of compression")),
        };
        let filter = match json.filter.as_deref().unwrap_or("NONE") {
            "NONE" => None,
            name => match (mode, Filter::of(name, json.byte_stride)) {
                (Mode::Attributes, Some(filter)) => Some(filter),
                _ => {
                    let stride = json.byte_stride;
                    return refuse(
                        "filter",
                        format!("{name:?} cannot be applied to elements of {stride} bytes"),
                    );
                }
            },
        };
        let fits = match mode {
            Mode::Attributes => json.byte_stride.is_multiple_of(4) && (4..=256).contains(&json.byte_stride),
            Mode::Triangles | Mode::Indices => matches!(json.byte_stride, 2 | 4),
        };
        if !fits {
            let (stride, mode) = (json.byte_stride, &json.mode);
            return refuse("byteStride", format!("{mode} cannot have elements of {stride} bytes"));
        }
        if mode == Mode::Triangles && !json.count.is_multiple_of(3) {
            return refuse("count", format!("{} indices are no whole number of triangles", json.count));
        }
        Ok(Self { context, json, here, mode, filter })
    }

    /// How many bytes the stream becomes, if one of its length can.
    pub fn bytes(&self, stream: &[u8]) -> Result<u64, FileError> {
        let bytes = (self.json.count as u64).saturating_mul(self.json.byte_stride as u64);
        let most = match self.mode {
            Mode::Attributes => MOST_VERTEX_BYTES,
            Mode::Triangles => TRIANGLE * self.json.byte_stride as u64,
            Mode::Indices => self.json.byte_stride as u64,
        };
        if bytes > most.saturating_mul(stream.len() as u64) {
            let length = stream.len();
            let reason = format!("{} elements cannot come from {length} bytes", self.json.count);
            return Err(self.context.invalid(Place::Pointer(format!("{}/count", self.here)), reason));
        }
        Ok(bytes)
    }

    /// The bytes of the buffer view.
    pub fn decode(&self, stream: &[u8]) -> Result<Vec<u8>, FileError> {
        // meshoptimizer's decoders are made for hostile input; the wall is for the wrapper around them.
        let decoded = guarded(|| match self.mode {
            Mode::Attributes => vertices(stream, self.json.count, self.json.byte_stride),
            Mode::Triangles => indices(stream, self.json.count, self.json.byte_stride, true),
            Mode::Indices => indices(stream, self.json.count, self.json.byte_stride, false),
        });
        match decoded.flatten() {
            Some(mut bytes) => {
                if let Some(filter) = self.filter {
                    filter.apply(&mut bytes);
                }
                Ok(bytes)
            }
            None => {
                let place = Place::Pointer(self.here.into());
                Err(self.context.invalid(place, "the compressed data is damaged and cannot be decoded"))
            }
        }
    }
}

fn indices(stream: &[u8], count: usize, size: usize, triangles: bool) -> Option<Vec<u8>> {
    // An empty list comes from meshoptimizer's encoder with a header, from others with nothing.
    if count == 0 {
        return Some(Vec::new());
    }
    if size == 2 {
        let decoded: Vec<u16> = match triangles {
            true => meshopt::decode_index_buffer(stream, count),
            false => meshopt::decode_index_sequence(stream, count),
        }
        .ok()?;
        return Some(decoded.into_iter().flat_map(u16::to_le_bytes).collect());
    }
    let decoded: Vec<u32> = match triangles {
        true => meshopt::decode_index_buffer(stream, count),
        false => meshopt::decode_index_sequence(stream, count),
    }
    .ok()?;
    Some(decoded.into_iter().flat_map(u32::to_le_bytes).collect())
}

/// An element of 4 N bytes: the decoder takes an element's size from its type.
#[derive(Clone)]
struct Element<const N: usize>([[u8; 4]; N]);

impl<const N: usize> Default for Element<N> {
    fn default() -> Self {
        Self([[0; 4]; N])
    }
}

fn vertices_of<const N: usize>(stream: &[u8], count: usize) -> Option<Vec<u8>> {
    let elements: Vec<Element<N>> = meshopt::decode_vertex_buffer(stream, count).ok()?;
    let mut bytes = Vec::with_capacity(4 * N * elements.len());
    for element in &elements {
        bytes.extend_from_slice(element.0.as_flattened());
    }
    Some(bytes)
}

fn vertices(stream: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    macro_rules! by_size {
        ($($n:literal)*) => {
            match stride / 4 {
                $($n => vertices_of::<$n>(stream, count),)*
                _ => None,
            }
        };
    }
    if count == 0 {
        return Some(Vec::new());
    }
    by_size!(
        1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
        33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63 64
    )
}
