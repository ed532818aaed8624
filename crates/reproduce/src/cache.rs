//! What was found out already: outcomes and their models, by the content of all that they
//! depend on.
//!
//! ```text
//! KEY = SHA-256 of (what to compare, recipe, files' bytes)
//! OUTPUT/cache/KEY/model.glb      the result, where it is a model
//!                 /outcome.json   written last: without it nothing counts
//! ```
//!
//! Contract: files are hashed once a run, with those beside them, since an OBJ's materials and
//! textures lie there. An outcome names the build that made it; another build's is taken only
//! where that was asked for.

use crate::catalogue::{file_name, has_ending, list};
use crate::error::ReproduceError;
use crate::experiment::Experiment;
use crate::outcome::Outcome;
use parbake::{EvaluateOptions, write_file};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Where outcomes are kept.
pub struct Cache {
    folder: PathBuf,
    build: String,
    any_build: bool,
    hashes: BTreeMap<PathBuf, String>,
}

impl Cache {
    /// The cache in an output folder, for a program with this digest.
    pub fn new(output: &Path, build: String, any_build: bool) -> Self {
        Self { folder: output.join("cache"), build, any_build, hashes: BTreeMap::new() }
    }

    /// The digest of the program that runs.
    pub fn build(&self) -> &str {
        &self.build
    }

    /// The folder of an experiment.
    ///
    /// # Errors
    /// Where a file cannot be read.
    pub fn place(
        &mut self,
        experiment: &Experiment,
        evaluate: &EvaluateOptions,
    ) -> Result<PathBuf, ReproduceError> {
        let mut hasher = Sha256::new();
        let said = serde_json::to_string(&(&experiment.recipe, evaluate)).unwrap_or_default();
        hasher.update(said);
        for file in experiment.subject.files() {
            hasher.update(self.content(file)?);
        }
        Ok(self.folder.join(hex(&hasher.finalize()[..16])))
    }

    /// The digest of a file and those beside it.
    fn content(&mut self, file: &Path) -> Result<String, ReproduceError> {
        if let Some(known) = self.hashes.get(file) {
            return Ok(known.clone());
        }
        let mut hasher = Sha256::new();
        hasher.update(file_name(file));
        // A GLB or a picture is whole by itself.
        let is_model = has_ending(file, &["obj", "gltf"]);
        let beside = match file.parent() {
            Some(folder) if is_model => list(folder)?,
            _ => vec![file.to_path_buf()],
        };
        for path in beside.iter().filter(|path| path.is_file()) {
            hasher.update(file_name(path));
            hasher.update(Sha256::digest(std::fs::read(path).map_err(ReproduceError::disk(path))?));
        }
        let digest = hex(&hasher.finalize());
        self.hashes.insert(file.to_path_buf(), digest.clone());
        Ok(digest)
    }

    /// An outcome that was kept and may be taken. One that does not read is none.
    pub fn kept(&self, place: &Path) -> Option<Outcome> {
        let text = std::fs::read(place.join("outcome.json")).ok()?;
        let outcome: Outcome = serde_json::from_slice(&text).ok()?;
        (self.any_build || outcome.build == self.build).then_some(outcome)
    }

    /// Keeps an outcome, once its model lies in `place`.
    ///
    /// # Errors
    /// Where the disk refuses.
    pub fn keep(&self, place: &Path, outcome: &Outcome) -> Result<(), ReproduceError> {
        let text = serde_json::to_string_pretty(outcome).unwrap_or_default();
        Ok(write_file(&place.join("outcome.json"), text.as_bytes())?)
    }
}

/// The digest of a program's file: any change of it makes another one.
///
/// # Errors
/// Where it cannot be read.
pub fn digest_of(program: &Path) -> Result<String, ReproduceError> {
    let bytes = std::fs::read(program).map_err(ReproduceError::disk(program))?;
    Ok(hex(&Sha256::digest(bytes)[..8]))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{Recipe, Subject};

    fn experiment(path: &Path, size: usize) -> Experiment {
        Experiment {
            subject: Subject::Picture { path: path.into() },
            recipe: Recipe::Downsample { texture_size: size },
            label: "x".into(),
        }
    }

    /// Protects from old results: other content, another recipe, other views or another build
    /// are other outcomes; the same again is the same.
    #[test]
    fn only_the_same_is_taken_for_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let picture = folder.path().join("p.png");
        std::fs::write(&picture, "one").unwrap();
        let evaluate = EvaluateOptions::default();
        let cache = |build: &str, any| Cache::new(folder.path(), build.into(), any);
        let place = |size, evaluate: &EvaluateOptions| {
            cache("a", false).place(&experiment(&picture, size), evaluate).unwrap()
        };
        let first = place(64, &evaluate);
        assert_eq!(first, place(64, &evaluate));
        assert_ne!(first, place(128, &evaluate));
        assert_ne!(first, place(64, &EvaluateOptions { views: 3, ..evaluate.clone() }));
        std::fs::create_dir_all(&first).unwrap();
        assert!(cache("a", false).kept(&first).is_none());
        let outcome = Outcome { build: "a".into(), seconds: 2.5, ..Outcome::default() };
        cache("a", false).keep(&first, &outcome).unwrap();
        assert_eq!(cache("a", false).kept(&first), Some(outcome.clone()));
        assert_eq!(cache("b", false).kept(&first), None);
        assert_eq!(cache("b", true).kept(&first), Some(outcome));
        std::fs::write(&picture, "two").unwrap();
        assert_ne!(first, place(64, &evaluate));
    }

    /// Protects an OBJ's results from a texture that was exchanged.
    #[test]
    fn what_lies_beside_a_model_counts() {
        let folder = tempfile::tempdir().unwrap();
        let model = folder.path().join("m.OBJ");
        std::fs::write(&model, "v 0 0 0").unwrap();
        let content = || Cache::new(folder.path(), "a".into(), false).content(&model).unwrap();
        let before = content();
        std::fs::write(folder.path().join("m.png"), "red").unwrap();
        assert_ne!(before, content());
    }
}
