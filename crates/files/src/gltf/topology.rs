//! Primitives' indices and modes to triangles (glTF 2.0, 3.7.2.1).

use super::accessor::Accessor;
use super::buffers::{Buffers, pointer};
use super::draco::Decoded;
use super::json::Primitive;
use crate::{FileError, Place};

/// Whether a primitive's mode is one of triangles.
pub(super) fn has_triangles(primitive: &Primitive) -> bool {
    primitive.mode.is_none_or(|mode| mode >= 4)
}

/// The triangles of a primitive at the pointer `here`, as element numbers below
/// `vertices`; those of its Draco `stream`, where that is what it is made from. `already` triangles were read before: all together are held against
/// the limit before any are made.
pub(super) fn triangles(
    buffers: &Buffers<'_>,
    primitive: &Primitive,
    here: &str,
    vertices: usize,
    already: usize,
    stream: Option<&Decoded>,
) -> Result<Vec<[u32; 3]>, FileError> {
    let context = buffers.context;
    let limit = context.limits.max_triangles as u64;
    if let Some(stream) = stream {
        let found = (already as u64).saturating_add(stream.triangles.len() as u64);
        context.within(pointer(here.into()), "triangles", found, limit)?;
        return Ok(stream.triangles.clone());
    }
    let from = format!("{here}/indices");
    let indices = match primitive.indices {
        Some(index) => Some(Accessor::new(buffers, index, &from, &[1])?),
        None => None,
    };
    if let Some(bad) = indices.as_ref().filter(|a| !a.is_index_like()) {
        return Err(context.invalid(pointer(bad.pointer.clone()), "indices are unsigned integers"));
    }
    let count = indices.as_ref().map_or(vertices, |a| a.count);
    let mode = primitive.mode.unwrap_or(4);
    let found = match mode {
        4 => count / 3,
        5 | 6 => count.saturating_sub(2),
        _ => {
            let reason = format!("{mode} is no primitive mode");
            return Err(context.invalid(pointer(format!("{here}/mode")), reason));
        }
    };
    if mode == 4 && count % 3 != 0 {
        context.warn(format!(
            "{here}: {count} corners are no whole number of triangles; the last are passed over"
        ));
    }
    context.within(
        pointer(here.into()),
        "triangles",
        (already as u64).saturating_add(found as u64),
        limit,
    )?;
    let vertex = |i: usize| -> Result<u32, FileError> {
        let Some(accessor) = &indices else { return Ok(i as u32) };
        let vertex = accessor.read_index(i);
        if (vertex as usize) < vertices {
            return Ok(vertex);
        }
        let reason = format!("index {vertex} names no vertex; there are {vertices}");
        Err(context.invalid(Place::Element(accessor.pointer.clone(), i), reason))
    };
    let mut out = Vec::with_capacity(found);
    for i in 0..found {
        let corners = match mode {
            4 => [3 * i, 3 * i + 1, 3 * i + 2],
            5 => [i, i + 1 + i % 2, i + 2 - i % 2],
            _ => [i + 1, i + 2, 0],
        };
        let [a, b, c] = corners.map(vertex);
        out.push([a?, b?, c?]);
    }
    Ok(out)
}
