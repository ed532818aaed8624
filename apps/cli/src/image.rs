//! `parbake image`.

use crate::arguments::ImageCommand;
use crate::bake::check_input;
use crate::document::write_document;
use crate::failure::{Ending, Failure};
use crate::formats::write_model;
use crate::outputs::{check_animation, check_beside, check_not_input, check_output, is_stdout};
use crate::printed::print;
use crate::progress::{Console, interrupted};
use crate::rules;
use clap::ArgMatches;
use parbake::{
    BakedImage, ImageReport, Limits, WriteOptions, bake_image, read_image, with_threads, write_file,
};
use parbake_report::{UvAnimationOptions, uv_animation};
use std::path::Path;

/// Runs the command.
pub fn run(command: &ImageCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    rules::check_image(&command.options, given)?;
    command.options.check()?;
    let (output, inputs) = (&command.output, [command.picture.as_path()]);
    check_input(&command.picture)?;
    check_output(output)?;
    check_not_input(output, &inputs)?;
    check_beside(Some(output), command.json.as_ref(), None, &inputs)?;
    if let Some(animation) = &command.animation {
        check_not_input(animation, &inputs)?;
        check_animation(animation)?;
    }
    let console = Console::for_bake(command.talk, None).with_stage_times();
    with_threads(command.options.threads, || {
        let picture = read_image(&command.picture, &Limits::default())?;
        let baked = bake_image(&picture, &command.options, &console)?;
        let before = std::fs::metadata(&command.picture).map_or(0, |file| file.len());
        let (after, _) = write_model(&command.output, &baked.model, &WriteOptions::default(), &console)?;
        let bytes = [before, after];
        if let Some(path) = &command.json {
            let about =
                ("image", &[("picture", command.picture.as_path())][..], Some(command.output.as_path()));
            write_document(path, about, &baked.report, &console)?;
        }
        if let Some(path) = &command.animation {
            write_animation(path, &baked, &console)?;
        }
        console.finish();
        if !command.talk.quiet && command.json.as_ref().is_none_or(|path| !is_stdout(path)) {
            print(&summary(&baked.report, bytes, &command.output, console.seconds()))?;
        }
        let stopped = interrupted() && baked.report.stopped_early;
        Ok(if stopped { Ending::Interrupted } else { Ending::Finished })
    })?
}

fn write_animation(path: &Path, baked: &BakedImage, console: &Console) -> Result<(), Failure> {
    match &baked.uv_moves {
        Some(moves) => write_file(path, &uv_animation(moves, &UvAnimationOptions::default())?)?,
        None => console.say("no animation: texture coordinates did not move"),
    }
    Ok(())
}

/// Cells whose plane takes a fifth of a megabyte.
const SMALL_GRID: usize = 100;

/// `bytes` are those of the picture and of the plane, with all files that belong to it.
fn summary(report: &ImageReport, [before, after]: [u64; 2], output: &Path, seconds: f64) -> String {
    let size = report.options.texture_size;
    let mut text = format!("shown at         ordinary {size}²   {}\n", output.display());
    for (name, (kept, written)) in
        ["full size", "half size", "a quarter"].iter().zip(report.kept.iter().zip(&report.written))
    {
        text += &format!("{name:13} {kept:9.2} dB   {written:9.2} dB   {:+.2} dB\n", written - kept);
    }
    if report.left_as_is {
        text += "moving texture coordinates gains nothing here: they were left as they are\n";
    }
    text += &match (report.uv.is_bijective(), report.uv.overlaps.pairs) {
        (true, _) => format!("{} triangles, none flipped, none overlapping\n", report.uv.triangles),
        (false, pairs) => format!("{} triangles, {pairs} pairs overlapping\n", report.uv.triangles),
    };
    text += &format!("{before} bytes → {after} bytes, {seconds:.1} s");
    let cells = report.options.settled_grid();
    if after > before && cells > SMALL_GRID && !report.left_as_is {
        text += &format!(
            "\nthe plane's {cells} × {cells} cells are most of that; --grid {SMALL_GRID} makes a smaller file that gains less"
        );
    }
    text
}
