//! `parbake compress`.

use crate::arguments::CompressCommand;
use crate::bake::{
    check_not_input, check_output, ending, print, read, write_json, write_model, write_report,
};
use crate::failure::{Ending, Failure};
use crate::image::bytes;
use crate::options_file::merged;
use crate::progress::Console;
use clap::ArgMatches;
use parbake::{BakeReport, LossStep, Model, Stage, StageTime, compress, with_threads};
use std::path::Path;

/// Runs the command.
pub fn run(command: &CompressCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    let options = merged(&command.bake, given, command.options.as_deref())?;
    options.check()?;
    check_output(&command.output)?;
    check_not_input(&command.output, &[&command.model])?;
    let console = Console::for_bake(command.talk, options.time_budget);
    with_threads(options.threads, || {
        let loaded = read(&command.model, &console)?;
        let mut baked = compress(&loaded.model, &options, &console)?;
        let begin = console.seconds();
        write_model(&command.output, &baked.model)?;
        baked.report.warnings.splice(0..0, loaded.warnings);
        baked.report.stages.push(StageTime { stage: Stage::Write, seconds: console.seconds() - begin });
        if let Some(path) = &command.json {
            write_json(path, &baked.report)?;
        }
        if let Some(path) = &command.report {
            write_report(path, &loaded.model, &baked, &console)?;
        }
        console.finish();
        if !command.talk.quiet && command.json.as_ref().is_none_or(|p| p.as_os_str() != "-") {
            let before = delivered_bytes(&command.model, &loaded.model);
            print(&summary(&baked.report, before, &command.output, console.seconds()))?;
        }
        Ok(ending(&baked.report))
    })?
}

/// Bytes of a model's file and of the pictures that lie beside it.
fn delivered_bytes(path: &Path, model: &Model) -> u64 {
    let folder = path.parent().unwrap_or(Path::new(""));
    let pictures: u64 = model.images.iter().map(|image| bytes(&folder.join(&image.name))).sum();
    bytes(path) + pictures
}

fn summary(report: &BakeReport, before: u64, output: &Path, seconds: f64) -> String {
    let decibels = |step: &LossStep| -10.0 * step.mean_square.max(1e-10).log10();
    let mut text = String::new();
    if let (Some(first), Some(last)) = (report.losses.first(), report.losses.last()) {
        let (ordinary, written) = (decibels(first), decibels(last));
        text += &format!(
            "{}: {ordinary:.2} dB with coordinates as they are, {written:.2} dB written, over the surface\n",
            output.display()
        );
    }
    text + &format!("{before} bytes → {} bytes, {seconds:.1} s", bytes(output))
}
