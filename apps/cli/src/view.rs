//! `parbake view`.

use crate::arguments::ViewCommand;
use crate::bake::check_input;
use crate::failure::{Ending, Failure};
use crate::printed::print;
use crate::progress::Console;
use parbake_viewer::{Server, View, ViewError, open_browser};
use std::path::Path;

/// Runs the command, until Ctrl-C.
pub fn run(command: &ViewCommand) -> Result<Ending, Failure> {
    // A name that leads nowhere is said here; what is wrong inside a file, on the page.
    for path in command.models.iter().chain(&command.compare) {
        check_input(path)?;
        check_file(path)?;
    }
    let console = Console::new(command.talk).confined(command.reading);
    let view = View {
        levels: command.models.clone(),
        compare: command.compare.clone(),
        live: None,
        port: command.port,
        limits: *console.limits(),
    };
    let server = Server::bind(&view)?;
    let url = server.url();
    print(&url)?;
    if !command.no_open
        && let Err(error) = open_browser(&url)
    {
        console.say(&format!("warning: {error}"));
    }
    console.say("Ctrl-C ends the viewer");
    match server.run()? {}
}

fn check_file(path: &Path) -> Result<(), Failure> {
    match std::fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            Err(Failure::Output(format!("{}: this is a folder; give a file in it", path.display())))
        }
        Ok(_) => Ok(()),
        Err(error) => Err(Failure::Output(format!("{}: cannot be read: {error}", path.display()))),
    }
}

impl From<ViewError> for Failure {
    fn from(error: ViewError) -> Self {
        Failure::Output(error.to_string())
    }
}
