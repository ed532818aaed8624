//! Why a picture could not be had, whatever its format.
//!
//! Decoders know neither the file nor the place that a picture is from; who called them makes a [`FileError`] of it.

use crate::{FileError, Limits, Place};
use std::path::Path;

/// Why a picture could not be had, before it is known whose picture it is.
#[derive(Debug)]
pub(crate) enum ImageTrouble {
    /// It is of none of these formats, in words.
    UnknownFormat(&'static str),
    Side(u64),
    Pixels(u64),
    Damaged(String),
}

impl ImageTrouble {
    pub fn into_error(self, path: &Path, place: Place, limits: &Limits) -> FileError {
        let path = path.to_path_buf();
        match self {
            Self::UnknownFormat(supported) if place == Place::File => {
                FileError::UnknownFormat { path, supported }
            }
            Self::UnknownFormat(supported) => FileError::Unsupported {
                path,
                place,
                feature: "this picture's format".into(),
                advice: format!("convert it to one of {supported}"),
            },
            Self::Side(found) => FileError::OverLimit {
                path,
                place,
                what: "texels along the image's longer side",
                found,
                limit: limits.max_image_side.into(),
            },
            Self::Pixels(found) => FileError::OverLimit {
                path,
                place,
                what: "texels of the image",
                found,
                limit: limits.max_image_pixels,
            },
            Self::Damaged(reason) => FileError::Invalid { path, place, reason },
        }
    }
}
