//! A job's key: what its results depend on, in one digest.
//!
//! ```text
//! KEY = SHA-256 of (program's bytes, command line without paths, for each file that goes in: its name and bytes,
//!                   for each file that it names: the same)
//! ```
//!
//! Contract: folders have no say, so that a data set that was moved is the same; a file is hashed once a run.

use crate::job::{Abilities, Job};
use parbake_files::named_files;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Hashes files and keeps what it found.
pub struct Digests {
    program: String,
    known: BTreeMap<PathBuf, String>,
}

impl Digests {
    /// For this program.
    ///
    /// # Errors
    /// When its file cannot be read.
    pub fn new(program: &Path) -> io::Result<Self> {
        Ok(Self { program: of_file(program)?, known: BTreeMap::new() })
    }

    /// A job's key.
    ///
    /// # Errors
    /// A sentence with the file that cannot be read.
    pub fn key(&mut self, job: &Job, abilities: Abilities) -> Result<String, String> {
        let option_files = job.option_files();
        let mut hasher = Sha256::new();
        let mut add = |text: &str| {
            hasher.update((text.len() as u64).to_le_bytes());
            hasher.update(text);
        };
        add(&self.program);
        let shown = |path: &Path| path.to_string_lossy().into_owned();
        let paths: Vec<String> = job.inputs.iter().chain(&option_files).map(|path| shown(path)).collect();
        for argument in job.command_line(abilities) {
            let is_whole = paths.contains(&argument);
            let joined = argument.split_once('=').filter(|_| !is_whole);
            let value = joined.map_or(argument.as_str(), |(_, value)| value);
            let is_path = is_whole || paths.iter().any(|path| path == value);
            add(if is_path { argument.strip_suffix(value).unwrap_or_default() } else { &argument });
        }
        for path in job.inputs.iter().chain(&option_files) {
            let failed = |error: io::Error| format!("{}: {error}", path.display());
            let folder = path.parent().unwrap_or(Path::new(""));
            add(&path.file_name().unwrap_or_default().to_string_lossy());
            add(&self.of(path).map_err(failed)?);
            for named in named_files(path).map_err(failed)? {
                add(&shown(named.strip_prefix(folder).unwrap_or(&named)));
                add(&self.of(&named).map_err(|error| format!("{}: {error}", named.display()))?);
            }
        }
        Ok(hex(&hasher.finalize()[..16]))
    }

    fn of(&mut self, path: &Path) -> io::Result<String> {
        if let Some(known) = self.known.get(path) {
            return Ok(known.clone());
        }
        let digest = of_file(path)?;
        self.known.insert(path.into(), digest.clone());
        Ok(digest)
    }
}

/// The digest of a file's bytes, in hexadecimal digits.
pub fn of_file(path: &Path) -> io::Result<String> {
    let mut file = File::open(path)?;
    let mut hasher = Sha256::new();
    let mut buffer = vec![0; 1 << 20];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hex(&hasher.finalize())),
            count => hasher.update(&buffer[..count]),
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Commands;
    use crate::job::tests::Two;

    /// Protects from old results: another program, another argument, another content of a model, of a texture that it
    /// names or of an options file is another key; another folder or a file that nobody names is not.
    #[test]
    fn a_key_is_of_all_that_goes_in_and_of_nothing_else() {
        let place = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = place.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        for folder in ["a", "b"] {
            write(&format!("{folder}/m.obj"), "mtllib m.mtl\n");
            write(&format!("{folder}/m.mtl"), "map_Kd t.png\n");
            write(&format!("{folder}/t.png"), "red");
            write(&format!("{folder}/o.json"), "{}");
        }
        write("program", "1");
        let key = |folder: &str, gutter: &str| {
            let job = Job {
                name: "m".into(),
                command: "make".into(),
                inputs: vec!["m.obj".into()],
                output: None,
                arguments: ["--options", "o.json", "--gutter", gutter].map(String::from).to_vec(),
            };
            let job = Job::new(job, &place.path().join(folder), &Two).unwrap();
            let mut digests = Digests::new(&place.path().join("program")).unwrap();
            digests.key(&job, Two.abilities("make").unwrap())
        };
        let first = key("a", "2").unwrap();
        assert_eq!(key("b", "2").unwrap(), first);
        assert_ne!(key("a", "3").unwrap(), first);
        write("a/unused.png", "new");
        assert_eq!(key("a", "2").unwrap(), first);
        for (name, before) in
            [("a/t.png", "red"), ("a/m.mtl", "map_Kd t.png\n"), ("a/o.json", "{}"), ("program", "1")]
        {
            write(name, "map_Kd t.png\n# changed\n");
            assert_ne!(key("a", "2").unwrap(), first, "{name}");
            write(name, before);
            assert_eq!(key("a", "2").unwrap(), first);
        }
        std::fs::remove_file(place.path().join("a/m.obj")).unwrap();
        assert!(key("a", "2").unwrap_err().contains("m.obj"));
    }
}
