//! The files that a model refers to: buffers, material libraries, pictures.
//!
//! Readers never open files themselves but ask a [`Resources`]; so they also work
//! on memory alone, and one place decides what a model may reach.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

/// Gives readers the files that a model names.
pub trait Resources {
    /// The bytes of the file `relative` (separated by `/`, relative to the model's folder).
    ///
    /// # Errors
    /// `NotFound` when there is none, `PermissionDenied` when the path is not a
    /// plain relative one, `FileTooLarge` when it has more than `max_bytes`.
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

/// The files of one folder. `..` is followed, as textures often lie beside the
/// model's folder; absolute paths are refused, as a model that carries them was
/// not made for this machine.
#[derive(Clone, Debug)]
pub struct Folder {
    root: PathBuf,
}

impl Folder {
    /// The folder in which `model` lies.
    pub fn beside(model: &Path) -> Self {
        Self { root: model.parent().map(Path::to_path_buf).unwrap_or_default() }
    }
}

impl Resources for Folder {
    fn read(&self, relative: &str, max_bytes: u64) -> io::Result<Vec<u8>> {
        let relative = Path::new(relative);
        let plain = |c| matches!(c, Component::Normal(_) | Component::CurDir | Component::ParentDir);
        if relative.as_os_str().is_empty() || !relative.components().all(plain) {
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, "only relative paths are followed"));
        }
        read_file(&self.root.join(relative), max_bytes)
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

    /// Protects the machine from models that name files elsewhere on it.
    #[test]
    fn absolute_paths_are_refused() {
        let folder = Folder::beside(Path::new("nowhere/model.obj"));
        let error = folder.read("/etc/hostname", 1 << 20).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::PermissionDenied);
        assert_eq!(folder.read("", 9).unwrap_err().kind(), io::ErrorKind::PermissionDenied);
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
