//! Any model as the bytes of one GLB file, for viewers: what a glTF file holds is kept, other formats are converted.

use crate::context::{Context, Textures};
use crate::model_in::{is_gltf, name_model, opened, parsed};
use crate::{FileError, Limits, Warning, gltf};
use std::path::Path;

/// A model as one GLB file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SelfContained {
    /// The bytes of a GLB file that names no other file.
    pub glb: Vec<u8>,
    /// Bytes of the model's file and of all others that were read for it.
    pub bytes: u64,
    /// One sentence each, to show to people.
    pub warnings: Vec<Warning>,
}

/// Reads any model that [`read_model`](crate::read_model) reads, as one GLB file. A GLB file that names no other comes back to the
/// byte; a glTF file takes its buffers and pictures in and keeps everything else, animations and extensions too; an
/// OBJ is converted. Meshes are checked as [`read_geometry`](crate::read_geometry) checks them, pictures of glTF files are not.
///
/// # Errors
/// As [`read_model`](crate::read_model), but for those about pictures of glTF files.
pub fn read_self_contained(path: &Path, limits: &Limits) -> Result<SelfContained, FileError> {
    let (resources, file) = opened(path, limits)?;
    if !is_gltf(path, &file) {
        let loaded = parsed(path, &file, &resources, limits, Textures::Decode)?;
        return Ok(SelfContained {
            glb: gltf::quick_glb_bytes(&loaded.model)?,
            bytes: loaded.bytes,
            warnings: loaded.warnings,
        });
    }
    // What the readers warn of is what they leave out; here nothing is.
    parsed(path, &file, &resources, limits, Textures::Skip)?;
    let context = Context::new(path, &resources, limits, Textures::Skip);
    context.count_own(&file);
    let glb = gltf::pack(&context, &file)?;
    let (bytes, mut warnings) = (context.bytes(), context.into_warnings());
    name_model(path, &mut warnings);
    Ok(SelfContained { glb, bytes, warnings })
}

#[cfg(test)]
#[path = "self_contained_tests.rs"]
mod tests;
