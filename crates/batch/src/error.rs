//! What can keep a batch from being run at all. What goes wrong in one job is a sentence in its outcome.

use std::path::{Path, PathBuf};

/// One clear sentence, and what to do next where there is something to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// A folder cannot be listed or made, or a file cannot be read.
    #[error("{path}: {source}", path = path.display())]
    Disk {
        /// Which one.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The jobs file is no TOML, or has what no jobs file has.
    #[error("{path}: {reason}", path = path.display())]
    Format {
        /// Which file.
        path: PathBuf,
        /// What is wrong, with the line.
        reason: String,
    },
    /// A job cannot be run as it stands.
    #[error("job {name:?}: {reason}")]
    Job {
        /// Its name.
        name: String,
        /// What is wrong, and what to do.
        reason: String,
    },
    /// There is nothing to do.
    #[error("{path}: there is no job in it; {advice}", path = path.display())]
    Nothing {
        /// The jobs file or folder.
        path: PathBuf,
        /// What should be there.
        advice: &'static str,
    },
    /// An option is out of range or names nothing.
    #[error("{0}")]
    Option(String),
    /// Another batch writes to the same folder.
    #[error("{path}: another batch is writing to this folder; wait for its end, or choose another --output", path = path.display())]
    Busy {
        /// The output folder.
        path: PathBuf,
    },
    /// Writing the page or a record.
    #[error(transparent)]
    File(#[from] parbake_files::FileError),
}

impl BatchError {
    /// A disk error's constructor for `map_err`.
    pub(crate) fn disk(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| Self::Disk { path, source }
    }
}
