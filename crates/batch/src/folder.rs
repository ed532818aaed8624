//! A folder of models: each becomes a job of one command.
//!
//! Contract: models are all `.glb`, `.gltf` and `.obj` in the folder and below, in the order of their paths; links to
//! folders are not followed, nor folders whose names begin with a dot. A job is named after its model's path, and with
//! the model's ending where two would have one name.

use crate::error::BatchError;
use crate::job::{Commands, Job, plain_name};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const MODELS: [&str; 3] = ["glb", "gltf", "obj"];

/// The jobs of a folder; none for models in `without`, where results go.
///
/// # Errors
/// When the folder cannot be listed, holds no models, or the command cannot be run.
pub fn jobs_of_folder(
    folder: &Path,
    command: &str,
    arguments: &[String],
    without: &Path,
    commands: &dyn Commands,
) -> Result<Vec<Job>, BatchError> {
    let mut models = Vec::new();
    find(folder, &std::path::absolute(without).unwrap_or_default(), &mut models)?;
    models.sort();
    let plain = |path: &Path| {
        let path = path.strip_prefix(folder).unwrap_or(path);
        plain_name(&path.to_string_lossy())
    };
    let mut stems: Vec<String> =
        models.iter().map(|path| plain(&path.with_extension("")).to_lowercase()).collect();
    stems.sort();
    let here = std::env::current_dir().map_err(BatchError::disk(Path::new(".")))?;
    let mut taken = BTreeSet::new();
    let mut jobs = Vec::with_capacity(models.len());
    for path in &models {
        let stem = plain(&path.with_extension(""));
        let lower = stem.to_lowercase();
        let is_alone = stems.iter().filter(|other| **other == lower).count() == 1;
        let wanted = if is_alone { stem } else { plain(path) };
        // Paths that differ may still be one name, as a/b.glb and a-b.glb are.
        let numbered = (2..).map(|number| format!("{wanted}-{number}"));
        let mut names = std::iter::once(wanted.clone()).chain(numbered);
        let name = names.find(|name| taken.insert(name.to_lowercase())).unwrap_or_default();
        let arguments = arguments.to_vec();
        let job = Job { name, command: command.into(), inputs: vec![path.clone()], output: None, arguments };
        jobs.push(Job::new(job, &here, commands)?);
    }
    if jobs.is_empty() {
        return Err(BatchError::Nothing {
            path: folder.into(),
            advice: "it should hold .glb, .gltf or .obj files",
        });
    }
    Ok(jobs)
}

fn find(folder: &Path, without: &Path, models: &mut Vec<PathBuf>) -> Result<(), BatchError> {
    for entry in std::fs::read_dir(folder).map_err(BatchError::disk(folder))? {
        let entry = entry.map_err(BatchError::disk(folder))?;
        let path = entry.path();
        let kind = entry.file_type().map_err(BatchError::disk(&path))?;
        if kind.is_dir() {
            let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
            if !is_hidden && std::path::absolute(&path).unwrap_or_default() != without {
                find(&path, without, models)?;
            }
            continue;
        }
        let ending = path.extension().map(|e| e.to_ascii_lowercase()).unwrap_or_default();
        if MODELS.iter().any(|model| ending == *model) && path.is_file() {
            models.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::tests::Two;

    /// Protects the walk: models of all kinds below, each with a name of its own, results left out.
    #[test]
    fn models_below_become_jobs() {
        let place = tempfile::tempdir().unwrap();
        let models = [
            "b/x.glb",
            "b/x.obj",
            "a.GLTF",
            "b.glb",
            "b-x.glb",
            "out/done.glb",
            ".hidden/y.glb",
            "b/readme.txt",
        ];
        for name in models {
            let path = place.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
        let jobs = jobs_of_folder(
            place.path(),
            "make",
            &["--gutter".into(), "1".into()],
            &place.path().join("out"),
            &Two,
        )
        .unwrap();
        let names: Vec<&str> = jobs.iter().map(|job| job.name.as_str()).collect();
        assert_eq!(names, ["a", "b-x.glb", "b-x.obj", "b-x.glb-2", "b"]);
        assert!(jobs.iter().all(|job| job.arguments == ["--gutter", "1"] && job.inputs[0].is_absolute()));
        let empty = place.path().join("none");
        std::fs::create_dir(&empty).unwrap();
        let error = jobs_of_folder(&empty, "make", &[], Path::new("out"), &Two).unwrap_err().to_string();
        assert!(error.contains("no job in it"), "{error}");
    }
}
