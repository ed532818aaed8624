//! What is kept of a finished job, as JSON beside its files.

use crate::digest::of_file;
use crate::error::BatchError;
use parbake_files::write_atomically;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;

/// The record's name in the job's folder.
pub const FILE: &str = "job.json";

/// Of the records; another one's are not taken.
const VERSION: u32 = 1;

/// A finished job.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Of this format.
    pub version: u32,
    /// The job's name.
    pub name: String,
    /// Digest of all that its files depend on.
    pub key: String,
    /// Arguments of the program.
    pub command_line: Vec<String>,
    /// Its files in the order of their names, without this one.
    pub files: Vec<RecordedFile>,
    /// Seconds from the worker's start to its end.
    pub seconds: f64,
    /// Peak memory of the worker in bytes, where the system tells.
    pub peak_memory: Option<u64>,
}

/// A file of a finished job.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordedFile {
    /// Its name.
    pub name: String,
    /// Its bytes.
    pub bytes: u64,
    /// SHA-256 of its content.
    pub sha256: String,
}

impl Record {
    /// A record with this key in a job's folder, whose files are there; none else.
    pub fn kept(folder: &Path, key: &str) -> Option<Self> {
        let record: Self = serde_json::from_slice(&fs::read(folder.join(FILE)).ok()?).ok()?;
        let is_there = |file: &RecordedFile| {
            fs::metadata(folder.join(&file.name)).is_ok_and(|data| data.is_file() && data.len() == file.bytes)
        };
        (record.version == VERSION && record.key == key && record.files.iter().all(is_there))
            .then_some(record)
    }

    /// The files of a folder that was made.
    ///
    /// # Errors
    /// When one cannot be read.
    pub fn files(folder: &Path) -> Result<Vec<RecordedFile>, BatchError> {
        let mut files = Vec::new();
        for entry in fs::read_dir(folder).map_err(BatchError::disk(folder))? {
            let path = entry.map_err(BatchError::disk(folder))?.path();
            if path.is_file() {
                let bytes = fs::metadata(&path).map_err(BatchError::disk(&path))?.len();
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                files.push(RecordedFile {
                    name,
                    bytes,
                    sha256: of_file(&path).map_err(BatchError::disk(&path))?,
                });
            }
        }
        files.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(files)
    }

    /// Writes it into a job's folder, whole or not at all.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn write(mut self, folder: &Path) -> Result<Self, BatchError> {
        self.version = VERSION;
        let text = serde_json::to_string_pretty(&self).unwrap_or_default();
        write_atomically(&folder.join(FILE), text.as_bytes())?;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects from taking for finished what is not: another key, a file that is gone or cut off, a record that
    /// does not read.
    #[test]
    fn only_what_is_whole_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a.glb"), "model").unwrap();
        let files = Record::files(folder.path()).unwrap();
        assert_eq!((files[0].name.as_str(), files[0].bytes, files[0].sha256.len()), ("a.glb", 5, 64));
        let record = Record { key: "k".into(), files, ..Record::default() }.write(folder.path()).unwrap();
        assert_eq!(Record::kept(folder.path(), "k"), Some(record));
        assert_eq!(Record::kept(folder.path(), "other"), None);
        fs::write(at("a.glb"), "mod").unwrap();
        assert_eq!(Record::kept(folder.path(), "k"), None);
        fs::write(at("a.glb"), "model").unwrap();
        fs::write(at(FILE), "{").unwrap();
        assert_eq!(Record::kept(folder.path(), "k"), None);
    }
}
