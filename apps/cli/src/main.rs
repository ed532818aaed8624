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
mod typed;
mod variants;
mod view;
mod watch;

use arguments::{Arguments, Command};
use clap::FromArgMatches;
use std::process::ExitCode;

fn main() -> ExitCode {
    leash::heed();
    let matches = arguments::command().try_get_matches().unwrap_or_else(|error| typed::end(&error));
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| typed::end(&error));
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
