//! `parbake reproduce`.

use crate::arguments::ReproduceCommand;
use crate::failure::{Ending, Failure};
use crate::outputs::check_place;
use crate::printed::print;
use crate::progress::{Console, interrupted};
use parbake::{with_threads, write_file};
use parbake_reproduce::{Event, Fall, Observer, Record, Reproduced, reproduce};
use std::path::{Path, PathBuf};

/// Runs the command.
pub fn run(command: &ReproduceCommand) -> Result<Ending, Failure> {
    let data = data(command)?;
    command.options.check()?;
    let recorded = recorded(command)?;
    let program = std::env::current_exe()
        .map_err(|e| Failure::Output(format!("this program cannot find its own file: {e}")))?;
    let console = Console::for_many(command.talk);
    let found = with_threads(command.options.threads, || {
        reproduce(&data, &command.output, &program, &command.options, &Reporter(&console))
    })??;
    console.finish();
    if !command.talk.quiet {
        print(&found.terminal)?;
    }
    let [made, kept] = found.made;
    let page = command.output.join("report.html");
    console.say(&format!("{made} made, {kept} kept; look at {}", page.display()));
    if found.stopped && interrupted() {
        return Ok(Ending::Interrupted);
    }
    let ending = judged(command, &console, recorded, &found)?;
    match found.failed.len() {
        0 => Ok(ending),
        failed => Err(Failure::Output(format!("{failed} experiments failed; {} names them", page.display()))),
    }
}

/// The folder of data: as given, or as the environment says.
fn data(command: &ReproduceCommand) -> Result<PathBuf, Failure> {
    let given = command.data.clone().or_else(|| std::env::var_os("PARBAKE_DATA").map(PathBuf::from));
    given.ok_or_else(|| {
        Failure::Usage("reproduce needs a folder of data: name one, or set PARBAKE_DATA to it".into())
    })
}

/// What is on record, read before any work is done.
fn recorded(command: &ReproduceCommand) -> Result<Option<Record>, Failure> {
    match &command.record {
        Some(path) if command.update_record => check_place(path).map(|()| None),
        Some(path) => Ok(Some(Record::read(path)?)),
        None if command.update_record => Err(Failure::Usage(
            "--update-record does nothing without --record FILE; add that or leave it out".into(),
        )),
        None => Ok(None),
    }
}

/// Compares gains with the record, or changes it.
fn judged(
    command: &ReproduceCommand,
    console: &Console,
    recorded: Option<Record>,
    found: &Reproduced,
) -> Result<Ending, Failure> {
    if let (Some(path), true) = (&command.record, command.update_record) {
        write_file(path, found.gains.text().as_bytes())?;
        console.say(&format!("{} gains are on record in {}", found.gains.0.len(), path.display()));
        return Ok(Ending::Finished);
    }
    let Some(recorded) = recorded else { return Ok(Ending::Finished) };
    let (missing, falls): (Vec<Fall>, Vec<Fall>) =
        recorded.falls(&found.gains).into_iter().partition(|fall| fall.measured.is_none());
    for fall in &missing {
        console.say(&format!("note: {}", sentence(fall)));
    }
    if falls.is_empty() {
        let held = recorded.0.len() - missing.len();
        console.say(&format!("none of {held} gains fell below the record"));
        return Ok(Ending::Finished);
    }
    for fall in &falls {
        eprintln!("{}", sentence(fall));
    }
    let path = command.record.as_deref().unwrap_or(Path::new(""));
    let gains = if falls.len() == 1 { "1 gain".to_string() } else { format!("{} gains", falls.len()) };
    eprintln!("{gains} fell below {}; if that is on purpose, run again with --update-record", path.display());
    Ok(Ending::Fallen)
}

fn sentence(fall: &Fall) -> String {
    match fall.measured {
        Some(now) => format!("{}: {now:+.2} dB, {:+.2} dB on record", fall.name, fall.recorded),
        None => format!("{}: not made, {:+.2} dB on record", fall.name, fall.recorded),
    }
}

/// Shows events.
struct Reporter<'a>(&'a Console);

impl Observer for Reporter<'_> {
    fn event(&self, event: Event) {
        match event {
            Event::Begin { done, total, title, seconds_left } => {
                self.0.show_run(done, total, &title, seconds_left);
            }
            Event::End { done, total, title, outcome, kept } => {
                self.0.show_run(done, total, &title, None);
                let line = format!("{done}/{total} {title}: {outcome}");
                if kept { self.0.detail(&(line + ", kept")) } else { self.0.say(&line) }
            }
            Event::Note(note) => self.0.say(&format!("note: {note}")),
            Event::Drawing => self.0.say("drawing tables and figures"),
        }
    }

    fn stopped(&self) -> bool {
        interrupted()
    }
}
