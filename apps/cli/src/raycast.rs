//! `parbake raycast`.

use crate::arguments::RaycastCommand;
use crate::bake::{Pair, check_textures, read_pair};
use crate::document::write_document;
use crate::failure::{Ending, Failure};
use crate::formats::{check_formats, write_model};
use crate::outputs::{check_beside, check_not_input, check_output, check_place, is_stdout};
use crate::printed::print;
use crate::progress::Console;
use crate::rules;
use crate::stage_times::stage_line;
use clap::ArgMatches;
use parbake::{
    GeometryMap, NormalY, RaycastReport, ShapeMapReport, Stage, StageTime, raycast, with_normal_y,
    with_threads, write_file,
};
use std::path::{Path, PathBuf};

/// Runs the command.
pub fn run(command: &RaycastCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    let options = &command.raycast;
    rules::check_raycast(options, given)?;
    options.check()?;
    let (output, inputs) = (&command.output, [command.high.as_path(), command.low.as_path()]);
    check_output(output)?;
    check_formats(output, &options.write)?;
    check_not_input(output, &inputs)?;
    check_beside(Some(output), command.json.as_ref(), None, &inputs)?;
    for map in &options.maps {
        let path = beside(output, *map);
        check_not_input(&path, &inputs)?;
        check_place(&path)?;
    }
    let console = Console::for_whole(command.talk).confined(command.reading);
    with_threads(options.threads, || {
        let Pair { high, low, warnings, seconds } = read_pair(&command.high, &command.low, &console)?;
        if command.strict {
            check_textures(&warnings)?;
        }
        let mut baked = raycast(&high, &low, options, &console)?;
        let begin = console.seconds();
        let model = with_normal_y(&baked.model, options.normal_y);
        let report = &mut baked.report;
        (_, report.written) = write_model(output, &model, &options.write, &console)?;
        for picture in &baked.pictures {
            let path = beside(output, picture.map);
            write_file(&path, &picture.png()?)?;
            report.note_file(picture.map, &path);
        }
        report.warnings.splice(0..0, warnings.iter().map(|warning| warning.text.clone()));
        let reading = seconds.map(|seconds| StageTime { stage: Stage::Read, seconds });
        report.stages.splice(0..0, reading);
        report.stages.push(StageTime { stage: Stage::Write, seconds: console.seconds() - begin });
        for stage in &report.stages {
            console.detail(&stage_line(stage.stage, stage.seconds));
        }
        if let Some(path) = &command.json {
            let files = [("high", command.high.as_path()), ("low", command.low.as_path())];
            write_document(path, ("raycast", &files[..], Some(output.as_path())), report, &console)?;
        }
        console.finish();
        if !command.talk.quiet && command.json.as_ref().is_none_or(|path| !is_stdout(path)) {
            print(&summary(report, output, console.seconds()))?;
        }
        if options.normal_y == NormalY::Down {
            console.say(
                "normal maps are written with -Y (--normal-y down); glTF viewers and eval show them wrongly",
            );
        }
        Ok(Ending::Finished)
    })?
}

/// The file of a map of shape: `baked_occlusion.png` beside `baked.glb`.
fn beside(output: &Path, map: GeometryMap) -> PathBuf {
    let mut name = output.file_stem().unwrap_or_default().to_os_string();
    name.push(format!("_{}.png", map.name()));
    output.with_file_name(name)
}

fn summary(report: &RaycastReport, output: &Path, seconds: f64) -> String {
    let covered = report.covered_texels.max(1);
    let missed = 100.0 * report.missed_texels as f64 / covered as f64;
    let mut text = format!(
        "{}: {} texels on the surface, {missed:.1} % found nothing within --max-distance and took the closest point; {seconds:.1} s",
        output.display(),
        report.covered_texels
    );
    for ShapeMapReport { map, file, black, white } in &report.maps {
        let file = file.clone().unwrap_or_default();
        text += &format!("\n{file}: ");
        text += &match map {
            GeometryMap::Thickness | GeometryMap::Height | GeometryMap::Position => {
                format!("black is {}, white is {} in the model's unit", numbers(black), numbers(white))
            }
            _ => format!("black is {}, white is {}", numbers(black), numbers(white)),
        };
    }
    text
}

/// "0.5", or "(1, 2, 3)"; one number where all are the same.
fn numbers(values: &[f32]) -> String {
    let shown: Vec<String> = values.iter().map(|value| format!("{value:.6}")).collect();
    let plain: Vec<&str> = shown.iter().map(|s| s.trim_end_matches('0').trim_end_matches('.')).collect();
    match plain.split_first() {
        Some((first, rest)) if rest.iter().all(|other| other == first) => (*first).to_string(),
        _ => format!("({})", plain.join(", ")),
    }
}
