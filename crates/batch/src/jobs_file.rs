//! A jobs file in TOML:
//!
//! ```toml
//! output = "results"                  # beside this file; --output wins over it
//!
//! [defaults]                          # of all jobs
//! command = "compress"
//! options = { preset = "fast" }
//!
//! [[job]]
//! name = "jar"                        # by default that of the last input
//! inputs = ["models/jar.glb"]
//! options = { texture-size = 512, strict = true }
//! arguments = ["--gutter", "2"]       # as typed
//! output = "jar.glb"                  # by default NAME.glb
//! ```
//!
//! Contract: relative paths start at the file's folder. A job's options win over the defaults; both are given in the
//! order of their names, then the arguments.

use crate::error::BatchError;
use crate::job::{Commands, Job, check_names, plain_name};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What a jobs file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobsFile {
    /// The jobs, in the file's order.
    pub jobs: Vec<Job>,
    /// Where results go, if it says so.
    pub output: Option<PathBuf>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Toml {
    output: Option<PathBuf>,
    #[serde(default)]
    defaults: Entry,
    #[serde(default)]
    job: Vec<Entry>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Entry {
    name: Option<String>,
    command: Option<String>,
    inputs: Vec<PathBuf>,
    output: Option<String>,
    options: BTreeMap<String, toml::Value>,
    arguments: Vec<String>,
}

/// Reads a jobs file.
///
/// # Errors
/// When it cannot be read, is no TOML, names what is unknown, or a job cannot be run.
pub fn read_jobs(path: &Path, commands: &dyn Commands) -> Result<JobsFile, BatchError> {
    let bytes = std::fs::read(path).map_err(BatchError::disk(path))?;
    let format = |reason: String| BatchError::Format { path: path.into(), reason };
    let text = String::from_utf8(bytes)
        .map_err(|_| format("this is not a text file; give a jobs file in TOML".into()))?;
    let file: Toml = toml::from_str(&text).map_err(|error| format(sentence(&error, &text)))?;
    if file.defaults.name.is_some() || file.defaults.output.is_some() || !file.defaults.inputs.is_empty() {
        return Err(format("[defaults] may have command, options and arguments only".into()));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let jobs: Result<Vec<Job>, BatchError> = (file.job.into_iter())
        .enumerate()
        .map(|(index, entry)| Job::new(job(entry, &file.defaults, index)?, folder, commands))
        .collect();
    let jobs = jobs?;
    if jobs.is_empty() {
        return Err(BatchError::Nothing {
            path: path.into(),
            advice: "each job is a [[job]] with command and inputs",
        });
    }
    check_names(&jobs)?;
    Ok(JobsFile { jobs, output: file.output.map(|output| folder.join(output)) })
}

/// What is wrong with a file, in one line with its place.
fn sentence(error: &toml::de::Error, text: &str) -> String {
    let reason = error.message().trim().replace('\n', ", ");
    let Some(before) = error.span().and_then(|span| text.get(..span.start)) else { return reason };
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    format!("line {}, column {column}: {reason}", before.matches('\n').count() + 1)
}

fn job(entry: Entry, defaults: &Entry, index: usize) -> Result<Job, BatchError> {
    let stem = entry.inputs.last().and_then(|path| path.file_stem());
    let name = match (entry.name, stem) {
        (Some(name), _) => name,
        (None, Some(stem)) => plain_name(&stem.to_string_lossy()),
        (None, None) => format!("job-{}", index + 1),
    };
    let wrong = |reason: String| BatchError::Job { name: name.clone(), reason };
    let command = entry.command.or_else(|| defaults.command.clone());
    let command = command.ok_or_else(|| wrong("it has no command; give it one, or [defaults] one".into()))?;
    let mut options = defaults.options.clone();
    options.extend(entry.options);
    let mut arguments = Vec::new();
    for (option, value) in options {
        let option = format!("--{}", option.replace('_', "-"));
        match value {
            toml::Value::Boolean(true) => arguments.push(option),
            toml::Value::Boolean(false) => {}
            // Joined, so that negative numbers are no options.
            toml::Value::String(text) => arguments.extend([option, text]),
            toml::Value::Integer(number) => arguments.push(format!("{option}={number}")),
            toml::Value::Float(number) => arguments.push(format!("{option}={number}")),
            _ => return Err(wrong(format!("{option} must be a text, a number, true or false"))),
        }
    }
    arguments.extend(defaults.arguments.iter().cloned());
    arguments.extend(entry.arguments);
    Ok(Job { name, command, inputs: entry.inputs, output: entry.output, arguments })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::tests::Two;

    fn read(text: &str) -> Result<JobsFile, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("jobs.toml");
        std::fs::write(&path, text).unwrap();
        let mut file = read_jobs(&path, &Two).map_err(|error| error.to_string())?;
        for input in file.jobs.iter_mut().flat_map(|job| &mut job.inputs) {
            *input = input.strip_prefix(folder.path()).unwrap().into();
        }
        file.output = file.output.map(|output| output.strip_prefix(folder.path()).unwrap().into());
        Ok(file)
    }

    /// Protects what people write: defaults, options by name, names from inputs.
    #[test]
    fn jobs_are_read_with_their_defaults() {
        let file = read(
            "output = 'out'\n[defaults]\ncommand = 'make'\noptions = { preset = 'fast', gutter = 1 }\n\
             [[job]]\ninputs = ['sub/my jar.glb']\noptions = { gutter = -2, strict = true, no_flip = false }\n\
             arguments = ['--seed', '7']\n[[job]]\nname = 'b'\ncommand = 'look'\ninputs = ['b.glb']\n",
        )
        .unwrap();
        assert_eq!(file.output, Some("out".into()));
        let [jar, b] = &file.jobs[..] else { panic!("{file:?}") };
        assert_eq!((jar.name.as_str(), jar.command.as_str()), ("my-jar", "make"));
        assert_eq!(jar.arguments, ["--gutter=-2", "--preset", "fast", "--strict", "--seed", "7"]);
        assert_eq!(
            (jar.inputs[0].as_path(), jar.output.as_deref()),
            (Path::new("sub/my jar.glb"), Some("my-jar.glb"))
        );
        assert_eq!((b.command.as_str(), b.arguments.len(), &b.output), ("look", 3, &None));
    }

    /// Protects from typing errors: each is named with its place.
    #[test]
    fn mistakes_are_named() {
        for (text, part) in [
            ("[[job]]\nimputs = ['a.glb']", "imputs"),
            ("[[job]\n", "line 1"),
            ("", "no job in it"),
            ("[[job]]\ninputs = ['a.glb']", "has no command"),
            ("[[job]]\ncommand = 'fly'\ninputs = ['a.glb']", "\"fly\" is no command"),
            ("[[job]]\ncommand = 'make'\ninputs = ['a.glb']\noptions = { bad = true }", "no option --bad"),
            ("[[job]]\ncommand = 'make'\noptions = { a = [1] }", "--a must be"),
            ("[defaults]\ninputs = ['a.glb']", "[defaults] may have"),
            (
                "[[job]]\ncommand='make'\ninputs=['a.glb']\n[[job]]\ncommand='make'\ninputs=['b/a.glb']",
                "another job",
            ),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
