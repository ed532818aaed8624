//! `parbake batch`.

use crate::arguments::{BatchCommand, command};
use crate::failure::{Ending, Failure};
use crate::outputs::check_beside;
use crate::progress::{Console, interrupted};
use crate::typed;
use parbake::write_file;
use parbake_batch::{
    Abilities, BatchError, Commands, Event, Job, Observer, Outcome, TaskCommand, jobs_of_folder,
    openjd_template, read_jobs, run_batch, summary,
};
use std::path::{Path, PathBuf};

/// Where results go if nothing says where.
const OUTPUT: &str = "batch";

/// Commands that make many files of their own, or are of no use in a batch.
const NOT_IN_A_BATCH: [&str; 6] = ["batch", "reproduce", "demo", "thumbnail", "variants", "help"];

/// Runs the command.
pub fn run(arguments: &BatchCommand) -> Result<Ending, Failure> {
    arguments.batch.check()?;
    let grammar = Grammar;
    let (jobs, output) = jobs(arguments, &grammar)?;
    if let Some(path) = &arguments.openjd {
        return write_template(arguments, path, &jobs, &output);
    }
    let program = std::env::current_exe()
        .map_err(|e| Failure::Output(format!("this program cannot find its own file: {e}")))?;
    let console = Console::for_batch(arguments.talk);
    let batch = run_batch(jobs, &output, &program, &arguments.batch, &grammar, &Reporter(&console))?;
    console.finish();
    console.say(&summary(&batch));
    if let Some(page) = &batch.page {
        console.say(&format!("look at {}", page.display()));
    }
    if batch.stopped && interrupted() {
        return Ok(Ending::Interrupted);
    }
    let failures = batch.jobs.iter().filter_map(|ended| match &ended.outcome {
        Outcome::Failed(reason) => Some(format!("\n  {}: {reason}", ended.job.name)),
        _ => None,
    });
    let failures: Vec<String> = failures.collect();
    match failures.len() {
        0 => Ok(Ending::Finished),
        count => {
            Err(Failure::Output(format!("{count} of {} jobs failed:{}", batch.jobs.len(), failures.concat())))
        }
    }
}

/// The jobs of the file or folder, and where their results go.
fn jobs(arguments: &BatchCommand, grammar: &Grammar) -> Result<(Vec<Job>, PathBuf), Failure> {
    let output = || arguments.output.clone().unwrap_or(PathBuf::from(OUTPUT));
    if arguments.jobs.is_dir() {
        let Some(command) = &arguments.command else {
            return Err(Failure::Usage(format!(
                "{}: a folder needs --command, such as --command compress; options of it come after --",
                arguments.jobs.display()
            )));
        };
        let output = output();
        let jobs = jobs_of_folder(&arguments.jobs, command, &arguments.arguments, &output, grammar)?;
        return Ok((jobs, output));
    }
    if arguments.command.is_some() || !arguments.arguments.is_empty() {
        let path = arguments.jobs.display();
        return Err(Failure::Usage(format!(
            "{path}: --command and options after -- go with a folder; a jobs file has its own"
        )));
    }
    let file = read_jobs(&arguments.jobs, grammar)?;
    let output = arguments.output.clone().or(file.output).unwrap_or(PathBuf::from(OUTPUT));
    Ok((file.jobs, output))
}

/// Writes the template of a render farm, of which each task is this command for one job.
fn write_template(
    arguments: &BatchCommand,
    path: &Path,
    jobs: &[Job],
    output: &Path,
) -> Result<Ending, Failure> {
    check_beside(None, Some(&path.to_path_buf()), None, &[&arguments.jobs])?;
    let whole = |path: &Path| {
        std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()).to_string_lossy().into_owned()
    };
    let mut before = vec!["batch".into(), whole(&arguments.jobs), "--output".into(), whole(output)];
    before.extend(arguments.command.iter().flat_map(|command| ["--command".into(), command.clone()]));
    let mut after = Vec::new();
    if !arguments.arguments.is_empty() {
        after.push("--".to_string());
        after.extend(arguments.arguments.iter().cloned());
    }
    let name = arguments.jobs.file_stem().unwrap_or_default().to_string_lossy();
    let template = openjd_template(&format!("parbake {name}"), jobs, &TaskCommand { before, after })?;
    write_file(path, template.as_bytes())?;
    if !arguments.talk.quiet {
        let (path, tasks) = (path.display(), jobs.len());
        eprintln!("{path}: {tasks} tasks; run parbake batch again after them for the page");
    }
    Ok(Ending::Finished)
}

/// The program's commands by their command line itself, so that what is added there can be run in a batch.
struct Grammar;

impl Commands for Grammar {
    fn abilities(&self, name: &str) -> Option<Abilities> {
        let all = command();
        let found = all.get_subcommands().find(|sub| sub.get_name() == name)?;
        let has = |id: &str| found.get_arguments().any(|argument| argument.get_id() == id);
        let ending = if name == "turntable" { ".png" } else { ".glb" };
        let abilities = Abilities { output: has("output"), json: has("json"), ending };
        (!NOT_IN_A_BATCH.contains(&name)).then_some(abilities)
    }

    fn fault(&self, arguments: &[String]) -> Option<String> {
        let line = std::iter::once("parbake").chain(arguments.iter().map(String::as_str));
        let error = command().try_get_matches_from(line).err()?;
        let given = ["--output", "--json", "--quiet"];
        if let Some(name) = typed::conflicting(&error).filter(|name| given.contains(&name.as_str())) {
            return Some(format!("a batch gives {name} itself; leave it out, and what does not go with it"));
        }
        Some(typed::sentence(&error).unwrap_or_else(|| {
            let said = error.to_string();
            let first: Vec<&str> = said.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
            first.join(" ").trim_start_matches("error: ").to_string()
        }))
    }

    fn picture(&self, output: &str, file: &str) -> Option<Vec<String>> {
        let ending = Path::new(output).extension()?.to_ascii_lowercase();
        let is_model = ["glb", "obj"].iter().any(|model| ending == *model);
        is_model.then(|| ["thumbnail", output, file].map(String::from).to_vec())
    }
}

impl From<BatchError> for Failure {
    fn from(error: BatchError) -> Self {
        match error {
            BatchError::Job { .. } | BatchError::Option(_) | BatchError::Format { .. } => {
                Failure::Usage(error.to_string())
            }
            _ => Failure::Output(error.to_string()),
        }
    }
}

/// Shows events.
struct Reporter<'a>(&'a Console);

impl Observer for Reporter<'_> {
    fn event(&self, event: Event) {
        match event {
            Event::Running { done, total, names, seconds_left } => {
                self.0.show_run(done, total, &names.join(", "), seconds_left);
            }
            Event::Ended { done, total, name, outcome, kept, failed } => {
                let line =
                    format!("{done}/{total} {name}: {}{outcome}", if failed { "failed: " } else { "" });
                if kept { self.0.detail(&(line + ", kept")) } else { self.0.say(&line) }
            }
        }
    }

    fn stopped(&self) -> bool {
        interrupted()
    }
}
