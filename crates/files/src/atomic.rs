//! Writes files whole or not at all: temporary files beside the targets, synced,
//! then renamed onto them. Readers see the old file or the new one, never half, and
//! of several files that belong together all or none.

use crate::FileError;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Replaces `path` by a file of these bytes. The folder must exist.
///
/// # Errors
/// When the file cannot be written; then `path` is as it was, and nothing is left
/// beside it.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_together(&[(path.to_path_buf(), bytes)])
}

/// Replaces `path` by whatever `work` writes, which need not fit into memory. The folder must exist.
///
/// # Errors
/// When the file cannot be written, and `work`'s own; then `path` is as it was, and nothing is left
/// beside it.
pub fn write_streamed<E: From<FileError>>(
    path: &Path,
    work: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), E>,
) -> Result<(), E> {
    let failed = |source| E::from(FileError::Write { path: path.into(), source });
    let (temporary, file) = Temporary::beside(path).map_err(failed)?;
    let mut file = BufWriter::new(file);
    work(&mut file)?;
    file.flush().and_then(|()| file.get_ref().sync_all()).map_err(failed)?;
    drop(file);
    temporary.rename_to(path).map_err(failed)?;
    sync_folder(path);
    Ok(())
}

/// Replaces all these files, in this order. No target changes before every byte is
/// on the disk, so that only a rename can fail half-way: then the targets before
/// it are new already.
pub(crate) fn write_together(files: &[(PathBuf, &[u8])]) -> Result<(), FileError> {
    let mut waiting = Vec::with_capacity(files.len());
    for (path, bytes) in files {
        let written = Temporary::beside(path).and_then(|(temporary, mut file)| {
            file.write_all(bytes)?;
            file.sync_all()?;
            Ok(temporary)
        });
        waiting.push(written.map_err(|source| FileError::Write { path: path.into(), source })?);
    }
    for (temporary, (path, _)) in waiting.into_iter().zip(files) {
        temporary.rename_to(path).map_err(|source| FileError::Write { path: path.into(), source })?;
    }
    if let Some((path, _)) = files.last() {
        sync_folder(path);
    }
    Ok(())
}

/// A file that is deleted again unless it is renamed.
struct Temporary {
    path: PathBuf,
    renamed: bool,
}

impl Temporary {
    fn beside(target: &Path) -> io::Result<(Self, File)> {
        static COUNTER: AtomicU64 = AtomicU64::new(0);
        let name = target
            .file_name()
            .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"))?;
        // The one thing that would stop the rename later, when others are done.
        if target.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        loop {
            let unique = format!(".{}-{}.tmp", std::process::id(), COUNTER.fetch_add(1, Ordering::Relaxed));
            let mut temporary = OsString::from(".");
            temporary.push(name);
            temporary.push(unique);
            let path = target.with_file_name(temporary);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
                Ok(file) => return Ok((Self { path, renamed: false }, file)),
            }
        }
    }

    fn rename_to(mut self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)?;
        self.renamed = true;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // The first error is the one to tell; that the clean-up failed too adds nothing.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Makes the rename itself survive a power cut. Not every system can; the file's
/// bytes are safe without it.
fn sync_folder(path: &Path) {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the replacement of an existing file.
    #[test]
    fn writes_and_replaces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        write_atomically(&path, b"one").unwrap();
        write_atomically(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// Protects films that are written as they come: nothing shows before the end, and work that is
    /// given up leaves no trace.
    #[test]
    fn a_stream_is_written_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        let result: Result<(), FileError> = write_streamed(&path, |file| {
            file.write_all(b"whole").unwrap();
            assert!(!path.exists());
            Ok(())
        });
        result.unwrap();
        let given_up = FileError::Write { path: path.clone(), source: io::ErrorKind::Other.into() };
        let result: Result<(), FileError> = write_streamed(&path, |file| {
            file.write_all(b"half").unwrap();
            Err(given_up)
        });
        assert!(result.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// Protects the folder from litter, and files from being replaced by a part of
    /// what belongs together.
    #[test]
    fn a_failure_leaves_everything_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let (old, taken) = (folder.path().join("old"), folder.path().join("taken"));
        fs::write(&old, b"old").unwrap();
        fs::create_dir(&taken).unwrap();
        let error = write_atomically(&taken, b"x").unwrap_err();
        assert_eq!(error.path(), taken);
        let new = folder.path().join("new");
        for bad in [taken.clone(), folder.path().join("no/such/folder"), "/".into()] {
            let files = [(old.clone(), b"1".as_slice()), (new.clone(), b"2"), (bad.clone(), b"3")];
            assert_eq!(write_together(&files).unwrap_err().path(), bad);
            assert_eq!(fs::read(&old).unwrap(), b"old");
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        }
        write_together(&[(old.clone(), b"1".as_slice()), (new.clone(), b"2")]).unwrap();
        assert_eq!((fs::read(&old).unwrap(), fs::read(&new).unwrap()), (b"1".to_vec(), b"2".to_vec()));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    }
}
