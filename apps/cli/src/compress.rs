//! `parbake compress`.

use crate::arguments::CompressCommand;
use crate::bake::{check_textures, ending, print, read, write_json, write_model, write_report};
use crate::failure::{Ending, Failure};
use crate::options_file::merged;
use crate::outputs::{check_beside, check_not_input, check_output, is_stdout};
use crate::progress::Console;
use crate::rules;
use clap::ArgMatches;
use parbake::{BakeReport, LossStep, Stage, StageTime, Work, compress, with_normal_y, with_threads};
use std::path::Path;

/// Runs the command.
pub fn run(command: &CompressCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    let file = command.options.as_deref();
    let options = merged(&command.bake, given, file)?;
    rules::check(Work::Compress, &options, given, file)?;
    options.check()?;
    let (output, inputs) = (&command.output, [command.model.as_path()]);
    check_output(output)?;
    check_not_input(output, &inputs)?;
    check_beside(Some(output), command.json.as_ref(), command.report.as_ref(), &inputs)?;
    let console = Console::for_bake(command.talk, options.time_budget);
    with_threads(options.threads, || {
        let loaded = read(&command.model, &console)?;
        if command.strict {
            check_textures(&loaded.warnings)?;
        }
        let mut baked = compress(&loaded.model, &options, &console)?;
        let begin = console.seconds();
        let bytes = [loaded.bytes, write_model(output, &with_normal_y(&baked.model, options.normal_y))?];
        baked.report.warnings.splice(0..0, loaded.warnings);
        baked.report.stages.push(StageTime { stage: Stage::Write, seconds: console.seconds() - begin });
        if let Some(path) = &command.json {
            write_json(path, &baked.report)?;
        }
        if let Some(path) = &command.report {
            write_report(path, &loaded.model, &baked, &console)?;
        }
        console.finish();
        if !command.talk.quiet && command.json.as_ref().is_none_or(|path| !is_stdout(path)) {
            print(&summary(&baked.report, bytes, output, console.seconds()))?;
        }
        Ok(ending(&baked.report))
    })?
}

/// `bytes` are those of the model as delivered and as written, with all files that belong to it.
fn summary(report: &BakeReport, [before, after]: [u64; 2], output: &Path, seconds: f64) -> String {
    let decibels = |step: &LossStep| -10.0 * step.mean_square.max(1e-10).log10();
    let mut text = String::new();
    if let (Some(first), Some(last)) = (report.losses.first(), report.losses.last()) {
        let (ordinary, written) = (decibels(first), decibels(last));
        let (begun, over) = match first.moved.as_str() {
            "delivered" => ("with coordinates as they are", "the surface"),
            "mended" => ("with coordinates mended", "the surface"),
            _ => ("projected", "training views"),
        };
        text += &format!(
            "{}: {ordinary:.2} dB {begun}, {written:.2} dB written, over {over}\n",
            output.display()
        );
    }
    text += &format!("{before} bytes → {after} bytes, ");
    let [given, now] = [report.high_triangles, report.low_triangles];
    if now > given {
        text += &format!("{given} → {now} triangles (--more-triangles 0 keeps them), ");
    }
    text + &format!("{seconds:.1} s")
}
