//! What is painted on triangles in a vertex attribute: a number, or the red of a colour, from 0 to 1.
//!
//! Contract: a triangle has the mean of its corners; what has no such attribute, or no number there, has a half.

use super::buffers::Buffers;
use super::sources::Sources;
use crate::{FileError, Place};
use std::collections::BTreeSet;

/// Of what nothing is painted on.
const UNPAINTED: f32 = 0.5;

/// So far.
#[derive(Default)]
pub(super) struct Painted {
    /// For each triangle.
    values: Vec<f32>,
    /// Whether any primitive has the attribute.
    is_found: bool,
}

impl Painted {
    /// Adds the triangles of a primitive, whose corners are places in `elements`.
    pub fn add(&mut self, sources: &Sources<'_>, elements: &[u32], triangles: &[[u32; 3]]) {
        let Some(source) = &sources.painted else {
            self.values.resize(self.values.len() + triangles.len(), UNPAINTED);
            return;
        };
        self.is_found = true;
        let value = |place: u32| {
            let [red, ..] = source.read(elements[place as usize] as usize, [UNPAINTED; 4]);
            if red.is_nan() { UNPAINTED } else { red.clamp(0.0, 1.0) }
        };
        self.values.extend(triangles.iter().map(|triangle| triangle.map(value).iter().sum::<f32>() / 3.0));
    }

    /// One number for each triangle; nothing where no attribute is asked for.
    ///
    /// # Errors
    /// An attribute that no mesh has.
    pub fn values(self, buffers: &Buffers<'_>) -> Result<Vec<f32>, FileError> {
        let Some(name) = buffers.context.attribute.filter(|_| !self.is_found) else { return Ok(self.values) };
        let primitives = buffers.document.meshes.iter().flat_map(|mesh| &mesh.primitives);
        let names: BTreeSet<&str> = primitives.flat_map(|primitive| primitive.attributes.painted()).collect();
        let names: Vec<&str> = names.into_iter().collect();
        let there = if names.is_empty() { "none that can be painted".into() } else { names.join(", ") };
        let reason = format!("no mesh has the vertex attribute {name}; there is {there}");
        Err(buffers.context.invalid(Place::File, reason))
    }
}
