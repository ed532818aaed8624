//! A level as its file holds it: figures are of that.

use crate::error::BakeError;
use parbake_files::{Limits, MeshCompression, NoResources, WriteOptions, glb_bytes_with, read_gltf_bytes};
use parbake_files::{NormalY, with_normal_y};
use parbake_model::Model;
use std::borrow::Cow;
use std::path::Path;

/// What a reader of a file finds.
pub(crate) struct AsWritten<'a> {
    /// The model, with normal maps as glTF has them.
    pub model: Cow<'a, Model>,
    /// Bytes of the file.
    pub bytes: u64,
}

/// Writes a model to memory, and reads it again where the formats lose anything.
///
/// # Errors
/// As of writing and reading files.
pub(crate) fn as_written<'a>(
    model: &'a Model,
    write: &WriteOptions,
    normal_y: NormalY,
) -> Result<AsWritten<'a>, BakeError> {
    let turned = with_normal_y(model, normal_y);
    let (file, written) = glb_bytes_with(&turned, write)?;
    let keeps_texels = write.texture_format.is_lossless();
    if keeps_texels && write.mesh_compression == MeshCompression::None {
        return Ok(AsWritten { model: Cow::Borrowed(model), bytes: written.bytes });
    }
    let read = read_gltf_bytes(Path::new(&model.name), &file, &NoResources, &Limits::default())?.model;
    // Turning them twice gives what was written.
    let model = with_normal_y(&read, normal_y).into_owned();
    Ok(AsWritten { model: Cow::Owned(model), bytes: written.bytes })
}
