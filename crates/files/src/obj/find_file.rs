//! Where the files are that an OBJ file and its libraries name.
//!
//! Contract: what is not there is no error; what is too large, or outside where reading is confined, is one.

use crate::context::Context;
use crate::search::is_refusal;
use crate::words::shown;
use crate::{FileError, Place};
use std::io;

/// `None` when there is no such file.
pub(super) fn read_beside(file: &str, context: &Context<'_>) -> Result<Option<Vec<u8>>, FileError> {
    found(context.read_there(file, context.limits.max_file_bytes), file, context)
}

/// Folders and forbidden files are as good as missing; what is too large, or outside where reading
/// is confined, is not.
pub(super) fn found<T>(
    read: io::Result<T>,
    file: &str,
    context: &Context<'_>,
) -> Result<Option<T>, FileError> {
    match read {
        Ok(read) => Ok(Some(read)),
        Err(source) if is_refusal(&source) => {
            let place = Place::Image(shown(file));
            Err(FileError::Read { path: context.path.into(), place, source })
        }
        Err(_) => Ok(None),
    }
}

/// A file at an absolute path, or, with a warning, the one of that name beside the model.
pub(super) fn read_absolute(
    file: &str,
    folder: &str,
    context: &Context<'_>,
) -> Result<Option<(String, Vec<u8>)>, FileError> {
    let most = context.limits.max_file_bytes;
    let there = context.read_there(file, most);
    if let Ok(bytes) = there {
        return Ok(Some((file.into(), bytes)));
    }
    match found(context.read_by_name(file, folder, most), file, context)?.flatten() {
        Some(read) => Ok(Some(read)),
        None => Ok(found(there, file, context)?.map(|bytes| (file.into(), bytes))),
    }
}
