//! The `parbake` command: reads arguments, draws progress, writes files. All work
//! is the library's.

mod arguments;
mod bake;
mod batch;
mod check;
mod compress;
mod demo;
mod document;
mod evaluate;
mod failure;
mod formats;
mod image;
mod leash;
mod lod;
mod lod_text;
mod options_file;
mod outputs;
mod pictures;
mod printed;
mod progress;
mod raycast;
mod reproduce;
mod rules;
mod simplify;
mod stage_times;
mod stats;
mod thumbnail;
mod turntable;
mod variants;
mod view;
mod watch;

use arguments::{Arguments, Command};
use clap::FromArgMatches;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::error::Error;
use std::num::{ParseFloatError, ParseIntError};
use std::process::ExitCode;

fn main() -> ExitCode {
    leash::heed();
    let matches = arguments::command().try_get_matches().unwrap_or_else(|error| typing_error(&error));
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| typing_error(&error));
    let given = matches.subcommand().map(|(_, m)| m);
    let outcome = match (&arguments.command, given) {
        (Command::Bake(command), Some(given)) => bake::run(command, given),
        (Command::Demo(command), Some(given)) => demo::run(command, given),
        (Command::Eval(command), Some(given)) => evaluate::run(command, given),
        (Command::Raycast(command), Some(given)) => raycast::run(command, given),
        (Command::Compress(command), Some(given)) => compress::run(command, given),
        (Command::Lod(command), Some(given)) => lod::run(command, given),
        (Command::Image(command), Some(given)) => image::run(command, given),
        (Command::Variants(command), _) => variants::run(command),
        (Command::Turntable(command), _) => turntable::run(command),
        (Command::View(command), _) => view::run(command),
        (Command::Reproduce(command), _) => reproduce::run(command),
        (Command::Check(command), _) => check::run(command),
        (Command::Simplify(command), Some(given)) => simplify::run(command, given),
        (Command::Stats(command), Some(given)) => stats::run(command, given),
        (Command::Batch(command), _) => batch::run(command),
        (Command::Thumbnail(command), _) => thumbnail::run(command),
        _ => Ok(failure::Ending::Finished),
    };
    match outcome {
        Ok(ending) => ending.exit_code(),
        Err(failure) => {
            eprintln!("error: {failure}");
            failure.exit_code()
        }
    }
}

/// Says what is wrong with what was typed, and ends. Of what is no number the standard library says how its parser
/// failed; people are told what to type.
fn typing_error(error: &clap::Error) -> ! {
    if lacks_low_poly(error) {
        eprintln!(
            "error: there is no low-poly to bake onto: give LOW, or --triangles COUNT, which makes one of HIGH"
        );
        std::process::exit(2)
    }
    let is_negative = matches!(
        error.get(ContextKind::InvalidValue),
        Some(ContextValue::String(value)) if value.starts_with('-')
    );
    let wanted = |source| Some((source, number_wanted(source, is_negative)?));
    let Some((source, wanted)) = error.source().and_then(wanted) else { error.exit() };
    eprint!("{}", error.render().to_string().replace(&source.to_string(), wanted));
    std::process::exit(2)
}

/// Whether `bake` was given a high-poly alone.
fn lacks_low_poly(error: &clap::Error) -> bool {
    let lacks = |name: &str| match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::Strings(names)) => *names == [name],
        _ => false,
    };
    let is_bake = || error.render().to_string().contains("parbake bake ");
    error.kind() == ErrorKind::MissingRequiredArgument && lacks("<LOW>") && is_bake()
}

fn number_wanted(source: &(dyn Error + 'static), is_negative: bool) -> Option<&'static str> {
    if source.is::<ParseFloatError>() {
        Some("give a number, such as 0.5")
    } else if source.is::<ParseIntError>() {
        Some(if is_negative { "give 0 or more" } else { "give a whole number, such as 8" })
    } else {
        None
    }
}
