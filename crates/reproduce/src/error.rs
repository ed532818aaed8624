//! What can keep a reproduction from going on.

use parbake::{BakeError, EvaluateError, FileError};
use std::path::PathBuf;

/// One clear sentence, and what to do next where there is something to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReproduceError {
    /// A folder cannot be listed, or a file cannot be read or written.
    #[error("{path}: {source}", path = path.display())]
    Disk {
        /// Which one.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// There is nothing to run.
    #[error(
        "{path}: there is nothing to reproduce here; it should hold pairs/NAME/high, pairs/NAME/low_simplygon50 \
         and so on, or images2d with pictures",
        path = path.display()
    )]
    Nothing {
        /// The data folder.
        path: PathBuf,
    },
    /// A file that this program wrote, or a record, does not read as one.
    #[error("{path}: this is no {what}: {reason}", path = path.display())]
    Format {
        /// Which file.
        path: PathBuf,
        /// What it should be.
        what: &'static str,
        /// Why not.
        reason: String,
    },
    /// A model cannot be baked, or an option is out of range.
    #[error("{experiment}: {source}")]
    Run {
        /// What was run.
        experiment: String,
        /// What went wrong.
        source: Box<BakeError>,
    },
    /// An option is out of range.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// Reading a model or writing a page.
    #[error(transparent)]
    File(#[from] FileError),
}

impl ReproduceError {
    /// A disk error's constructor for `map_err`.
    pub(crate) fn disk(path: &std::path::Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| Self::Disk { path, source }
    }
}

impl From<EvaluateError> for ReproduceError {
    fn from(error: EvaluateError) -> Self {
        Self::Bake(error.into())
    }
}
