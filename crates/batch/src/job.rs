//! A job: one command line, by parts.
//!
//! Contract: the command line that is run follows from the job alone, and all that it writes lies in the folder that
//! it is run in. Options that name files to read are made absolute.

use crate::error::BatchError;
use std::path::{Path, PathBuf};

/// What a command of the program can do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Abilities {
    /// It writes a file, named by `--output`; else its figures are its result.
    pub output: bool,
    /// It writes figures, named by `--json`.
    pub json: bool,
    /// What its output ends in where a job does not say.
    pub ending: &'static str,
}

/// The program's commands, as its command line knows them.
pub trait Commands: Sync {
    /// What a command can do; none for what is no command, or none for a batch.
    fn abilities(&self, command: &str) -> Option<Abilities>;

    /// What is wrong with a command line, in a sentence; none where it can be run.
    fn fault(&self, arguments: &[String]) -> Option<String>;

    /// The command line that takes a picture of a job's output and writes it to this file; none where it is no model.
    fn picture(&self, output: &str, file: &str) -> Option<Vec<String>>;
}

/// Options whose value is a file that is read.
const READ: [&str; 3] = ["--options", "--against", "--record"];

/// The name of the file with a job's figures.
pub const FIGURES: &str = "figures.json";

/// One command line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Job {
    /// Names the job and its folder: letters, digits, `-`, `_`, `.` and blanks; the first is none of the last two.
    pub name: String,
    /// The command: `bake`, `compress`, …
    pub command: String,
    /// Files that go in, as paths that hold from anywhere.
    pub inputs: Vec<PathBuf>,
    /// The file that is written, a name without a folder; none where the command writes none.
    pub output: Option<String>,
    /// All other arguments.
    pub arguments: Vec<String>,
}

impl Job {
    /// A job whose relative paths start at `folder`; `output` is named after the job where it is none.
    ///
    /// # Errors
    /// Where the name is no folder's name, the command is none, or its arguments cannot be understood.
    pub fn new(mut job: Job, folder: &Path, commands: &dyn Commands) -> Result<Self, BatchError> {
        let wrong = |job: &Job, reason: String| Err(BatchError::Job { name: job.name.clone(), reason });
        if let Some(reason) = name_fault(&job.name) {
            return wrong(&job, reason);
        }
        let Some(abilities) = commands.abilities(&job.command) else {
            let reason = format!("{:?} is no command that a batch can run", job.command);
            return wrong(&job, reason);
        };
        if job.output.as_ref().is_some_and(|output| name_fault(output).is_some()) {
            return wrong(&job, "output must be a file's name without a folder".into());
        }
        job.output = match (abilities.output, job.output.take()) {
            (true, output) => Some(output.unwrap_or_else(|| format!("{}{}", job.name, abilities.ending))),
            (false, None) => None,
            (false, Some(_)) => {
                let reason = format!("{} writes no file; leave output out", job.command);
                return wrong(&job, reason);
            }
        };
        let from = |path: &Path| std::path::absolute(folder.join(path)).unwrap_or_else(|_| folder.join(path));
        job.inputs = job.inputs.iter().map(|path| from(path)).collect();
        let whole = |path: &str| from(Path::new(path)).to_string_lossy().into_owned();
        let mut is_file = false;
        for argument in &mut job.arguments {
            if is_file {
                *argument = whole(argument);
            }
            is_file = READ.contains(&argument.as_str());
            if let Some((option, path)) = argument.split_once('=').filter(|(option, _)| READ.contains(option))
            {
                *argument = format!("{option}={}", whole(path));
            }
        }
        match commands.fault(&job.command_line(abilities)) {
            Some(reason) => wrong(&job, reason),
            None => Ok(job),
        }
    }

    /// The arguments of the program.
    pub fn command_line(&self, abilities: Abilities) -> Vec<String> {
        let mut line = vec![self.command.clone()];
        line.extend(self.inputs.iter().map(|path| path.to_string_lossy().into_owned()));
        line.extend(self.arguments.iter().cloned());
        line.extend(self.output.iter().flat_map(|output| ["--output".to_string(), output.clone()]));
        if abilities.json {
            line.extend(["--json", FIGURES].map(String::from));
        }
        line.push("--quiet".into());
        line
    }

    /// Files that go in by way of options.
    pub fn option_files(&self) -> Vec<PathBuf> {
        let pairs = self.arguments.windows(2).filter(|pair| READ.contains(&pair[0].as_str()));
        let joined = self.arguments.iter().filter_map(|argument| argument.split_once('='));
        let joined = joined.filter(|(option, _)| READ.contains(option)).map(|(_, path)| path);
        pairs.map(|pair| pair[1].as_str()).chain(joined).map(PathBuf::from).collect()
    }
}

/// Why this cannot name a folder on every system.
fn name_fault(name: &str) -> Option<String> {
    let is_plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | ' ' | '(' | ')' | '+');
    let starts = name.chars().next().is_some_and(|c| c.is_alphanumeric() || c == '_');
    let is_good = starts && name.chars().all(is_plain) && !name.ends_with(['.', ' ']) && name.len() <= 200;
    (!is_good).then(|| {
        "a name is made of letters, digits, - _ . + and blanks, begins with a letter or digit and has at most 200 bytes"
            .into()
    })
}

/// A name made of anything.
pub fn plain_name(text: &str) -> String {
    let plain: String = text
        .chars()
        .map(|c| if c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | '+') { c } else { '-' })
        .collect();
    let plain = plain.trim_start_matches(['-', '.', '+']).trim_end_matches('.');
    let mut short: String = plain.to_string();
    while short.len() > 150 {
        short.pop();
    }
    if short.is_empty() { "model".into() } else { short }
}

/// Refuses two jobs of one name, also where only capitals differ, which many file systems do not tell apart.
///
/// # Errors
/// Names the job.
pub fn check_names(jobs: &[Job]) -> Result<(), BatchError> {
    let mut seen = std::collections::BTreeSet::new();
    match jobs.iter().find(|job| !seen.insert(job.name.to_lowercase())) {
        None => Ok(()),
        Some(job) => Err(BatchError::Job {
            name: job.name.clone(),
            reason: "another job has this name; give each a name of its own".into(),
        }),
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A program with two commands, which refuses `--bad`.
    pub struct Two;

    impl Commands for Two {
        fn abilities(&self, command: &str) -> Option<Abilities> {
            match command {
                "make" => Some(Abilities { output: true, json: true, ending: ".glb" }),
                "look" => Some(Abilities { output: false, json: true, ending: "" }),
                _ => None,
            }
        }

        fn fault(&self, arguments: &[String]) -> Option<String> {
            arguments.iter().any(|a| a == "--bad").then(|| "make has no option --bad".into())
        }

        fn picture(&self, _: &str, _: &str) -> Option<Vec<String>> {
            None
        }
    }

    fn job(name: &str, command: &str, arguments: &[&str]) -> Job {
        Job {
            name: name.into(),
            command: command.into(),
            inputs: vec!["a.glb".into()],
            arguments: arguments.iter().map(|a| (*a).into()).collect(),
            output: None,
        }
    }

    /// Protects what is run: files to read hold from anywhere, outputs are names in the job's own folder.
    #[test]
    fn a_command_line_is_whole() {
        let here = std::path::absolute("/x").unwrap();
        let made =
            Job::new(job("jar", "make", &["--options", "o.json", "--gutter", "2"]), &here, &Two).unwrap();
        let at = |name: &str| here.join(name).to_string_lossy().into_owned();
        let line = made.command_line(Two.abilities("make").unwrap());
        let wanted = [
            "make",
            &at("a.glb"),
            "--options",
            &at("o.json"),
            "--gutter",
            "2",
            "--output",
            "jar.glb",
            "--json",
            "figures.json",
            "--quiet",
        ];
        assert_eq!(line, wanted);
        assert_eq!(made.option_files(), [here.join("o.json")]);
        let joined = Job::new(job("jar", "look", &["--options=o.json"]), &here, &Two).unwrap();
        assert_eq!((joined.option_files(), joined.output), (vec![here.join("o.json")], None));
    }

    /// Protects from hours of work for nothing, and from files outside the output folder.
    #[test]
    fn what_cannot_run_is_refused_at_once() {
        let fault = |job: Job| Job::new(job, Path::new("."), &Two).unwrap_err().to_string();
        for name in ["", "../up", "a/b", ".hidden", "a\\b", "c:", "end.", "new\nline"] {
            assert!(fault(job(name, "make", &[])).contains("a name is made of"), "{name}");
        }
        assert!(fault(job("a", "batch", &[])).contains("\"batch\" is no command"));
        assert!(fault(job("a", "make", &["--bad"])).contains("no option --bad"));
        let output = |command, output: &str| Job { output: Some(output.into()), ..job("a", command, &[]) };
        assert!(fault(output("make", "../x.glb")).contains("without a folder"));
        assert!(fault(output("look", "x.glb")).contains("writes no file"));
        let [a, b] = ["jar", "JAR"].map(|name| job(name, "make", &[]));
        assert!(check_names(&[a.clone(), b]).unwrap_err().to_string().contains("another job"));
        assert!(check_names(&[a]).is_ok());
    }

    /// Protects names that are made of paths.
    #[test]
    fn any_text_becomes_a_name() {
        for (text, name) in [("a/b c.d", "a-b-c.d"), ("..", "model"), ("-x", "x"), ("Möbius", "Möbius")] {
            assert_eq!(plain_name(text), name);
            assert_eq!(name_fault(name), None);
        }
        assert_eq!(name_fault(&plain_name(&"ä".repeat(400))), None);
    }
}
