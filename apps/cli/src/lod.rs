//! `parbake lod`.

use crate::arguments::LodCommand;
use crate::bake::read_painted;
use crate::failure::{Ending, Failure};
use crate::lod_text::{line, target_lines};
use crate::outputs::{check_beside, check_folder, check_not_input, make_folder};
use crate::progress::{Console, interrupted};
use crate::rules;
use clap::ArgMatches;
use parbake::lod::document::{LodDocument, coverages};
use parbake::{
    Level, LevelReport, Model, Verdict, WriteOptions, make_levels, with_normal_y, with_threads, write_file,
    write_glb_with, write_lod_glb,
};
use parbake_report::lod_report;

/// The name of what tells of all levels.
const DOCUMENT: &str = "lods.json";

/// Runs the command.
pub fn run(command: &LodCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    let options = &command.lod;
    rules::check_quality(&options.write, given)?;
    options.check()?;
    check_folder(&command.output)?;
    let name =
        command.model.file_stem().map_or_else(|| "model".into(), |stem| stem.to_string_lossy().into_owned());
    let is_new = !command.output.exists();
    make_folder(&command.output)?;
    let all_file = command.layout.all_levels_file(&name);
    let files = (0..options.screen_size.len()).map(|level| command.layout.level_file(&name, level));
    for file in files.chain([all_file.clone(), DOCUMENT.into()]) {
        check_not_input(&command.output.join(file), &[&command.model])?;
    }
    check_beside(None, None, command.report.as_ref(), &[&command.model])?;
    let console =
        Console::for_levels(command.talk, options.time_budget).confined(command.reading).with_stage_times();
    with_threads(options.threads, || {
        let read = read_painted(&command.model, options.importance_attribute.as_deref(), &console);
        if read.is_err() && is_new {
            // The error of the model is the one to tell; a folder that has something in it stays.
            std::fs::remove_dir(&command.output).ok();
        }
        let mut model = read?.model;
        if model.name.is_empty() {
            model.name.clone_from(&name);
        }
        let mut written: Vec<(String, u64, LevelReport)> = Vec::new();
        let mut levels: Vec<Model> = Vec::new();
        // All in one file have the textures' quality of the best.
        let mut write = WriteOptions { texture_quality: 1, ..options.write };
        let on_level = |level: Level| -> Result<(), Failure> {
            let Level { baked, write: own, mut report } = level;
            let file = command.layout.level_file(&name, report.level);
            let mut model = baked.model;
            model.name = format!("{name}_LOD{}", report.level);
            let bytes =
                write_glb_with(&command.output.join(&file), &with_normal_y(&model, options.normal_y), &own)?
                    .bytes;
            // The level's name is longer than the trial's.
            for trial in report.target.iter_mut().flat_map(|target| &mut target.trials).filter(|t| t.chosen) {
                trial.bytes = bytes;
            }
            console.say(&line(&report, bytes));
            target_lines(&report).iter().for_each(|line| console.say(line));
            write.texture_quality = write.texture_quality.max(own.texture_quality);
            levels.push(model);
            written.push((file, bytes, report));
            Ok(())
        };
        make_levels(&model, options, &console, on_level)?;
        if levels.is_empty() {
            console.finish();
            console.say("stopped before the first level was finished: nothing was written");
            return Ok(Ending::Interrupted);
        }
        let reports: Vec<LevelReport> = written.iter().map(|(_, _, report)| report.clone()).collect();
        let turned: Vec<_> = levels.iter().map(|level| with_normal_y(level, options.normal_y)).collect();
        let all: Vec<&Model> = turned.iter().map(AsRef::as_ref).collect();
        write_lod_glb(&command.output.join(&all_file), &all, &coverages(&reports), &write)?;
        let document = LodDocument::new(&model, options, all_file.clone(), console.seconds(), written);
        let json =
            serde_json::to_string_pretty(&document).map_err(|e| Failure::Output(format!("no JSON: {e}")))?;
        write_file(&command.output.join(DOCUMENT), json.as_bytes())?;
        for (file, text) in command.layout.helpers(&name) {
            let path = command.output.join(file);
            path.parent().map_or(Ok(()), make_folder)?;
            write_file(&path, text.as_bytes())?;
        }
        if let Some(path) = &command.report {
            write_file(path, lod_report(&model, &document, &levels, options, &console)?.as_bytes())?;
        }
        console.finish();
        console.say(&format!(
            "{}: {} level{}, {all_file}, {DOCUMENT}; {:.1} s",
            command.output.display(),
            levels.len(),
            if levels.len() == 1 { "" } else { "s" },
            console.seconds()
        ));
        Ok(ending(&reports, options.screen_size.len()))
    })?
}

/// Interrupted where a level is missing for that; a level that is no file of the target is told, too.
fn ending(reports: &[LevelReport], wanted: usize) -> Ending {
    let is_missed =
        |report: &LevelReport| report.target.as_ref().is_some_and(|t| t.verdict == Verdict::Missed);
    match () {
        () if interrupted() && reports.len() < wanted => Ending::Interrupted,
        () if reports.iter().any(is_missed) => Ending::Missed,
        () => Ending::Finished,
    }
}
