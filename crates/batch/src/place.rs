//! Where a batch keeps what.
//!
//! ```text
//! OUTPUT/NAME/                 a finished job's files
//! OUTPUT/NAME/job.json         its record, written last
//! OUTPUT/batch.html, batch.json   all of them
//! OUTPUT/.batch/               what is being made, messages of jobs, and the lock
//! ```
//!
//! Contract: a folder that is being made is nobody else's: its name has the process's number and a counter. A whole
//! batch holds the folder alone and clears what others left; runs of single jobs hold it together.

use crate::error::BatchError;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

/// An output folder.
pub struct Place {
    output: PathBuf,
    /// Held for as long as this lives.
    _lock: File,
}

impl Place {
    /// Makes the folder where it is missing, and holds it; `alone` for a whole batch.
    ///
    /// # Errors
    /// When it cannot be made, or another batch holds it.
    pub fn hold(output: &Path, alone: bool) -> Result<Self, BatchError> {
        let own = output.join(".batch");
        fs::create_dir_all(&own).map_err(BatchError::disk(output))?;
        // Workers run in folders of their own.
        let output = output.canonicalize().map_err(BatchError::disk(output))?;
        let path = own.join("lock");
        let lock = File::create(&path).map_err(BatchError::disk(&path))?;
        let held = if alone { lock.try_lock() } else { lock.try_lock_shared() };
        match held {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(BatchError::Busy { path: output }),
            // File systems without locks: two batches at once are the user's care.
            Err(TryLockError::Error(_)) => {}
        }
        let place = Self { output, _lock: lock };
        if alone {
            place.clear();
        }
        Ok(place)
    }

    /// Takes away what runs that were killed have left half-made.
    fn clear(&self) {
        for entry in fs::read_dir(self.output.join(".batch")).into_iter().flatten().flatten() {
            if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                // What cannot be removed is in nobody's way.
                let _ = fs::remove_dir_all(entry.path());
            }
        }
    }

    /// The output folder.
    pub fn output(&self) -> &Path {
        &self.output
    }

    /// A finished job's folder.
    pub fn of(&self, name: &str) -> PathBuf {
        self.output.join(name)
    }

    /// The file with what a job said.
    pub fn messages(&self, name: &str) -> PathBuf {
        self.output.join(".batch").join(format!("{name}.log"))
    }

    /// A new folder for a job that begins.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn begin(&self, number: usize) -> Result<PathBuf, BatchError> {
        let path = self.output.join(".batch").join(format!("{}-{number}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir(&path).map_err(BatchError::disk(&path))?;
        Ok(path)
    }

    /// Puts a job's files in their place. What lay there before goes first, its record before all else.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn finish(&self, made: &Path, name: &str) -> Result<(), BatchError> {
        let target = self.of(name);
        if target.exists() {
            let record = target.join(crate::record::FILE);
            if record.exists() {
                fs::remove_file(&record).map_err(BatchError::disk(&record))?;
            }
            fs::remove_dir_all(&target).map_err(BatchError::disk(&target))?;
        }
        fs::rename(made, &target).map_err(BatchError::disk(&target))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects two batches from mixing their results, and single jobs of a farm from being kept out.
    #[test]
    fn a_whole_batch_is_alone() {
        let folder = tempfile::tempdir().unwrap();
        let hold = |alone| Place::hold(folder.path(), alone);
        let first = hold(true).unwrap();
        assert!(matches!(hold(true), Err(BatchError::Busy { .. })));
        assert!(matches!(hold(false), Err(BatchError::Busy { .. })));
        drop(first);
        let (_one, _two) = (hold(false).unwrap(), hold(false).unwrap());
        assert!(matches!(hold(true), Err(BatchError::Busy { .. })));
    }

    /// Protects finished results: half-made ones go, whole ones replace those of before.
    #[test]
    fn what_is_half_made_goes_and_what_is_whole_stays() {
        let folder = tempfile::tempdir().unwrap();
        let place = Place::hold(folder.path(), true).unwrap();
        for text in ["one", "two"] {
            let made = place.begin(0).unwrap();
            fs::write(made.join("a.txt"), text).unwrap();
            place.finish(&made, "jar").unwrap();
            assert_eq!(fs::read_to_string(place.of("jar").join("a.txt")).unwrap(), text);
        }
        let half = place.begin(1).unwrap();
        drop(place);
        let place = Place::hold(folder.path(), true).unwrap();
        assert!(!half.exists() && place.of("jar").join("a.txt").exists());
    }
}
