//! What can go wrong at the doors, said in one sentence each.
//!
//! Contract: every variant names the file; where a place inside it is known, it
//! names that too ([`Place`]).

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Where in a file something is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    #[default]
    File,
    /// A line of a text file, counted from 1.
    Line(usize),
    /// A JSON pointer (RFC 6901) into a glTF document, such as `/accessors/3/count`.
    Pointer(String),
    /// One element of a glTF accessor: the accessor's pointer and the element, counted from 0.
    Element(String, usize),
    /// A picture inside or beside a model, by name.
    Image(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(number) => write!(f, ", line {number}"),
            Self::Pointer(pointer) => write!(f, ", at {pointer}"),
            Self::Element(pointer, element) => write!(f, ", at {pointer}, element {element}"),
            Self::Image(name) => write!(f, ", image {name:?}"),
        }
    }
}

/// Why a file could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The operating system did not hand the bytes over.
    #[error("{}{place}: cannot be read: {source}", .path.display())]
    Read {
        /// The file that was asked for.
        path: PathBuf,
        /// Which part of it, or of what it refers to.
        place: Place,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The operating system did not take the bytes.
    #[error("{}: cannot be written: {source}", .path.display())]
    Write {
        /// The file that was to be written.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// Neither the extension nor the first bytes are of a format that is read.
    #[error("{}: this kind of file is not known; {supported} can be read", .path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// What could have been read, to show to people.
        supported: &'static str,
    },
    /// The file breaks its format's rules.
    #[error("{}{place}: {reason}", .path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// What is wrong, and where it helps what to do.
        reason: String,
    },
    /// The file keeps the rules but is larger than the [`Limits`](crate::Limits) allow.
    #[error("{}{place}: {what}: {found}, and the limit is {limit}", .path.display())]
    OverLimit {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// What was counted.
        what: &'static str,
        /// How much of it there is.
        found: u64,
        /// How much is allowed.
        limit: u64,
    },
    /// The file needs something that is not implemented.
    #[error("{}{place}: {feature} is not supported; {advice}", .path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// What would be needed.
        feature: String,
        /// What to do instead.
        advice: String,
    },
    /// The model has no triangle with an area.
    #[error("{}: the model has no triangles{detail}", .path.display())]
    Empty {
        /// The file.
        path: PathBuf,
        /// What it has instead, with the words that join it to the sentence; or nothing.
        detail: String,
    },
}

impl FileError {
    /// The file that this is about.
    pub fn path(&self) -> &Path {
        match self {
            Self::Read { path, .. }
            | Self::Write { path, .. }
            | Self::UnknownFormat { path, .. }
            | Self::Invalid { path, .. }
            | Self::OverLimit { path, .. }
            | Self::Unsupported { path, .. }
            | Self::Empty { path, .. } => path,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the messages' form: file first, then the place, then the reason.
    #[test]
    fn messages_name_file_and_place() {
        let error = FileError::Invalid {
            path: "a.obj".into(),
            place: Place::Line(3),
            reason: "the number \"x\" cannot be read".into(),
        };
        assert_eq!(error.to_string(), "a.obj, line 3: the number \"x\" cannot be read");
        assert_eq!(error.path(), Path::new("a.obj"));
        let place = Place::Element("/accessors/3".into(), 7);
        assert_eq!(place.to_string(), ", at /accessors/3, element 7");
    }
}
