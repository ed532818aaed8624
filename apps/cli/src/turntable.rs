//! `parbake turntable`.

use crate::arguments::TurntableCommand;
use crate::bake::read;
use crate::failure::{Ending, Failure};
use crate::outputs::{check_not_input, check_place};
use crate::progress::{Console, interrupted};
use parbake::{BakeError, Loaded, Message, Stage, Watcher, with_threads};
use parbake_report::{FilmFormat, write_turntable};
use std::path::Path;

/// Runs the command.
pub fn run(command: &TurntableCommand) -> Result<Ending, Failure> {
    let (output, options) = (&command.output, &command.turntable);
    options.check()?;
    let format = FilmFormat::of(output).ok_or_else(|| {
        Failure::Usage(format!(
            "{}: the film must end in .png or .apng (all colours) or in .gif (256 of them)",
            output.display()
        ))
    })?;
    let inputs: Vec<&Path> =
        std::iter::once(&command.high).chain(&command.low).map(|path| path.as_path()).collect();
    check_place(output)?;
    check_not_input(output, &inputs)?;
    let console = Console::for_film(command.talk).confined(command.reading).with_stage_times();
    with_threads(options.threads, || {
        let models = read_all(&inputs, &console)?;
        let lows: Vec<_> = models[1..].iter().map(|low| &low.model).collect();
        let filmed = write_turntable(output, &models[0].model, &lows, options, format, &console);
        console.finish();
        if interrupted() && matches!(filmed, Err(BakeError::Stopped)) {
            return Ok(Ending::Interrupted);
        }
        filmed?;
        console.say(&format!(
            "{}: {} frames, {:.1} MB, {:.1} s",
            output.display(),
            options.frames,
            std::fs::metadata(output).map_or(0, |file| file.len()) as f64 / 1e6,
            console.seconds()
        ));
        Ok(Ending::Finished)
    })?
}

/// Reads models one after the other, as many as there are.
fn read_all(paths: &[&Path], console: &Console) -> Result<Vec<Loaded>, Failure> {
    let total = paths.len();
    let reading = paths.iter().enumerate().map(|(done, path)| {
        console.message(Message::Progress { stage: Stage::Read, done, total });
        read(path, console)
    });
    reading.collect()
}
