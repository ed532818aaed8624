//! The files that a model refers to: buffers, material libraries, pictures.
//!
//! Readers never open files themselves but ask a [`Resources`]; so they also work
//! on memory alone, and one place decides what a model may reach.

use crate::search::{is_absolute, leaves, outside};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Gives readers the files that a model names.
pub trait Resources {
    /// The bytes of the file `relative` (separated by `/`, relative to the model's folder; or an
    /// absolute path of this system, unless [`Limits::confine`](crate::Limits::confine) is set).
    ///
    /// # Errors
    /// `NotFound` when there is none, `PermissionDenied` when the path is one that is not followed,
    /// `FileTooLarge` when it has more than `max_bytes`.
    fn read(&self, relative: &str, max_bytes: u64) -> io::Result<Vec<u8>>;
}

/// No files at all: whatever is asked for is not found.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoResources;

impl Resources for NoResources {
    fn read(&self, _relative: &str, _max_bytes: u64) -> io::Result<Vec<u8>> {
        Err(io::Error::from(io::ErrorKind::NotFound))
    }
}

/// The files that a model names, from the folder in which it lies. `..` and absolute paths are
/// followed: these are one's own files. A [confined](Folder::confined) one keeps every reading inside
/// the folder.
#[derive(Clone, Debug)]
pub struct Folder {
    root: PathBuf,
    confined: bool,
}

impl Folder {
    /// The folder in which `model` lies.
    pub fn beside(model: &Path) -> Self {
        Self { root: model.parent().map(Path::to_path_buf).unwrap_or_default(), confined: false }
    }

    /// The same folder; if `confined`, no file outside it is read, whatever leads there: `..`, an
    /// absolute path or a link.
    pub fn confined(self, confined: bool) -> Self {
        Self { confined, ..self }
    }

    /// The file without links and `..`, if it lies in the folder.
    fn inside(&self, path: &Path) -> io::Result<PathBuf> {
        let root = if self.root.as_os_str().is_empty() { Path::new(".") } else { &self.root };
        let (root, path) = (root.canonicalize()?, path.canonicalize()?);
        if path.starts_with(&root) { Ok(path) } else { Err(outside()) }
    }

    /// The model's own file, which may not be a link to elsewhere either.
    pub(crate) fn model(&self, path: &Path) -> io::Result<PathBuf> {
        if self.confined { self.inside(path) } else { Ok(path.to_path_buf()) }
    }
}

impl Resources for Folder {
    fn read(&self, relative: &str, max_bytes: u64) -> io::Result<Vec<u8>> {
        if relative.is_empty() {
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the path is empty"));
        }
        if !self.confined {
            return read_file(&self.root.join(relative), max_bytes);
        }
        if is_absolute(relative) || leaves(relative) {
            return Err(outside());
        }
        read_file(&self.inside(&self.root.join(relative))?, max_bytes)
    }
}

/// The length of a regular file; an error for anything else. To be asked before
/// opening: opening a pipe would wait for its writer.
fn length(path: &Path) -> io::Result<u64> {
    match std::fs::metadata(path)? {
        m if m.is_file() => Ok(m.len()),
        m if m.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory)),
        _ => Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file")),
    }
}

/// Whether a file begins with these bytes.
pub(crate) fn begins_with(path: &Path, magic: &[u8]) -> io::Result<bool> {
    length(path)?;
    let mut bytes = Vec::new();
    File::open(path)?.take(magic.len() as u64).read_to_end(&mut bytes)?;
    Ok(bytes == magic)
}

/// A whole file, if it is a regular one of at most `max_bytes`.
pub(crate) fn read_file(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    let length = length(path)?;
    let too_large =
        |n: u64| io::Error::new(io::ErrorKind::FileTooLarge, format!("{n} bytes, the limit is {max_bytes}"));
    if length > max_bytes {
        return Err(too_large(length));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(usize::try_from(length).unwrap_or(usize::MAX))?;
    File::open(path)?.take(max_bytes.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max_bytes {
        return Err(too_large(bytes.len() as u64));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects a service's machine from models that name files elsewhere on it, and one's own files
    /// from being out of reach.
    #[test]
    fn confined_folders_are_not_left() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("model");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(place.path().join("secret"), b"secret").unwrap();
        std::fs::write(folder.join("own"), b"own").unwrap();
        let open = Folder::beside(&folder.join("model.obj"));
        let confined = open.clone().confined(true);
        let absolute = place.path().join("secret").to_string_lossy().into_owned();
        for path in ["../secret", "../model/../secret", absolute.as_str()] {
            assert_eq!(open.read(path, 99).unwrap(), b"secret", "{path}");
            let error = confined.read(path, 99).unwrap_err();
            assert!(crate::search::is_refusal(&error), "{path}: {error}");
        }
        assert_eq!(confined.read("./own", 99).unwrap(), b"own");
        assert_eq!(confined.read("gone", 99).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert_eq!(open.read("", 9).unwrap_err().kind(), io::ErrorKind::PermissionDenied);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(place.path().join("secret"), folder.join("link")).unwrap();
            std::os::unix::fs::symlink(place.path(), folder.join("up")).unwrap();
            std::os::unix::fs::symlink("own", folder.join("alias")).unwrap();
            for path in ["link", "up/secret"] {
                assert_eq!(open.read(path, 99).unwrap(), b"secret", "{path}");
                assert!(crate::search::is_refusal(&confined.read(path, 99).unwrap_err()), "{path}");
            }
            assert_eq!(confined.read("alias", 99).unwrap(), b"own");
            assert!(
                confined.model(&folder.join("link")).is_err() && open.model(&folder.join("link")).is_ok()
            );
        }
    }

    /// Protects the memory bound on single files.
    #[test]
    fn large_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.bin"), [0; 100]).unwrap();
        let resources = Folder::beside(&folder.path().join("model.obj"));
        assert_eq!(resources.read("a.bin", 100).unwrap().len(), 100);
        assert_eq!(resources.read("a.bin", 99).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    }
}
