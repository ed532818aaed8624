//! KHR_draco_mesh_compression: primitives whose attributes and indices are a Draco stream, which
//! the crate `draco-core` decodes.
//!
//! Contract: a stream's triangles name points that are there; its points and faces, and the bytes
//! of its attributes, are held against the limits while it is decoded. A stream that several
//! primitives name is decoded once.

use super::component::Component;
use crate::context::Context;
use crate::guard::guarded;
use crate::{FileError, Place};
use draco_core::draco_types::DataType;
use draco_core::geometry_attribute::PointAttribute;
use draco_core::geometry_indices::{FaceIndex, PointIndex};
use draco_core::{DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder};

/// Bytes that the attributes of a vertex may take, all together: tangents, colours and eight sets
/// of texture coordinates in floats are 120.
const VERTEX_BYTES: u64 = 128;

/// A decoded stream.
pub(super) struct Decoded {
    /// How many points each attribute has.
    pub points: usize,
    /// Its triangles; every corner is below `points`.
    pub triangles: Vec<[u32; 3]>,
    attributes: Vec<Attribute>,
}

/// One value for each point, tightly packed.
pub(super) struct Attribute {
    /// The stream's own number of it.
    id: u32,
    pub bytes: Vec<u8>,
    pub component: Component,
    pub width: usize,
    /// Whether its integers stand for fractions.
    pub normalized: bool,
}

impl Decoded {
    /// The attribute that the stream has under this number.
    pub fn attribute(&self, id: usize) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.id as usize == id)
    }
}

/// Decodes the stream in a buffer view; `here` is the pointer to the extension that names it, and
/// `already` points were decoded before.
pub(super) fn decode(
    context: &Context<'_>,
    stream: &[u8],
    here: &str,
    already: u64,
) -> Result<Decoded, FileError> {
    let limits = context.limits;
    let max_points = (limits.max_vertices as u64).saturating_sub(already);
    let mut decode_limits = DecodeLimits::default();
    decode_limits.max_points = max_points;
    decode_limits.max_faces = limits.max_triangles as u64;
    decode_limits.max_decoded_bytes = max_points.saturating_mul(VERTEX_BYTES);
    // The decoder keeps to these limits and promises errors; should it fail an assertion of its
    // own, that is the file's fault in this program's eyes.
    let decoded = guarded(|| {
        let mut buffer = DecoderBuffer::new(stream).with_limits(decode_limits);
        let mut mesh = Mesh::new();
        MeshDecoder::new().decode(&mut buffer, &mut mesh).map(|()| mesh)
    });
    let invalid = |reason: String| context.invalid(Place::Pointer(here.into()), reason);
    let mesh = match decoded {
        Some(Ok(mesh)) => mesh,
        Some(Err(error)) if error.kind() == ErrorKind::LimitExceeded => {
            return Err(invalid(format!("the Draco data is over the limits: {}", error.message())));
        }
        Some(Err(error)) => {
            return Err(invalid(format!("the Draco data cannot be decoded: {}", error.message())));
        }
        None => return Err(invalid("the Draco data is damaged and cannot be decoded".into())),
    };
    let points = mesh.num_points();
    within(context, here, already, points, mesh.num_faces())?;
    let mut triangles = Vec::with_capacity(mesh.num_faces());
    for face in 0..mesh.num_faces() {
        let corners = mesh.face(FaceIndex(face as u32)).map(|p| p.0);
        if let Some(bad) = corners.iter().find(|&&c| c as usize >= points) {
            return Err(invalid(format!("triangle {face} names point {bad}; there are {points}")));
        }
        triangles.push(corners);
    }
    let mut attributes = Vec::new();
    for k in 0..mesh.num_attributes() {
        let attribute = mesh.try_attribute(k).map_err(|e| invalid(e.message().to_string()))?;
        attributes.extend(packed(attribute, points));
    }
    Ok(Decoded { points, triangles, attributes })
}

fn within(
    context: &Context<'_>,
    here: &str,
    already: u64,
    points: usize,
    faces: usize,
) -> Result<(), FileError> {
    let place = || Place::Pointer(here.into());
    let all = already.saturating_add(points as u64);
    context.within(place(), "decoded vertices", all, context.limits.max_vertices as u64)?;
    context.within(place(), "triangles", faces as u64, context.limits.max_triangles as u64)
}

/// The values of all points in glTF's types; `None` for what glTF has no use for.
fn packed(attribute: &PointAttribute, points: usize) -> Option<Attribute> {
    let width = usize::from(attribute.num_components());
    if !(1..=4).contains(&width) {
        return None;
    }
    let component = match attribute.data_type() {
        DataType::Int8 => Component::I8,
        DataType::Uint8 => Component::U8,
        DataType::Int16 => Component::I16,
        DataType::Uint16 => Component::U16,
        _ => Component::F32,
    };
    let bytes = match component {
        Component::F32 => attribute.read_f32s(points, width).into_iter().flat_map(f32::to_le_bytes).collect(),
        _ => {
            let element = width * attribute.data_type().byte_length();
            let stride = usize::try_from(attribute.byte_stride()).ok()?;
            let data = attribute.buffer().data();
            let mut bytes = Vec::with_capacity(points * element);
            for point in 0..points {
                let value = attribute.mapped_index(PointIndex(point as u32)).0 as usize;
                let from = value.checked_mul(stride);
                let found = from.and_then(|from| data.get(from..)?.get(..element));
                match found {
                    Some(found) => bytes.extend_from_slice(found),
                    None => bytes.resize(bytes.len() + element, 0),
                }
            }
            bytes
        }
    };
    // What became floats is fractions already.
    let normalized = attribute.normalized() && component != Component::F32;
    Some(Attribute { id: attribute.unique_id(), bytes, component, width, normalized })
}
