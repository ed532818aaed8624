//! `parbake lod`.

use crate::arguments::LodCommand;
use crate::bake::read;
use crate::failure::{Ending, Failure};
use crate::outputs::check_not_input;
use crate::progress::{Console, interrupted};
use parbake::lod::document::{LodDocument, coverages};
use parbake::{
    Level, LevelReport, Model, make_levels, with_normal_y, with_threads, write_file, write_glb_with,
    write_lod_glb,
};
use std::fs::create_dir_all;
use std::path::Path;

/// The name of what tells of all levels.
const DOCUMENT: &str = "lods.json";

/// Runs the command.
pub fn run(command: &LodCommand) -> Result<Ending, Failure> {
    let options = &command.lod;
    options.check()?;
    let name =
        command.model.file_stem().map_or_else(|| "model".into(), |stem| stem.to_string_lossy().into_owned());
    make_folder(&command.output)?;
    let all_file = command.layout.all_levels_file(&name);
    let files = (0..options.screen_size.len()).map(|level| command.layout.level_file(&name, level));
    for file in files.chain([all_file.clone(), DOCUMENT.into()]) {
        check_not_input(&command.output.join(file), &[&command.model])?;
    }
    let console = Console::for_levels(command.talk).confined(command.reading);
    with_threads(options.threads, || {
        let mut model = read(&command.model, &console)?.model;
        if model.name.is_empty() {
            model.name.clone_from(&name);
        }
        let mut written: Vec<(String, u64, LevelReport)> = Vec::new();
        let mut levels: Vec<Model> = Vec::new();
        let on_level = |level: Level| -> Result<(), Failure> {
            let Level { baked, report } = level;
            let file = command.layout.level_file(&name, report.level);
            let mut model = with_normal_y(&baked.model, options.normal_y).into_owned();
            model.name = format!("{name}_LOD{}", report.level);
            let bytes = write_glb_with(&command.output.join(&file), &model, &options.write)?.bytes;
            console.say(&line(&report, bytes));
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
        let all: Vec<&Model> = levels.iter().collect();
        write_lod_glb(&command.output.join(&all_file), &all, &coverages(&reports), &options.write)?;
        let document = LodDocument::new(&model, options, all_file.clone(), written);
        let json =
            serde_json::to_string_pretty(&document).map_err(|e| Failure::Output(format!("no JSON: {e}")))?;
        write_file(&command.output.join(DOCUMENT), json.as_bytes())?;
        for (file, text) in command.layout.helpers(&name) {
            let path = command.output.join(file);
            path.parent().map_or(Ok(()), make_folder)?;
            write_file(&path, text.as_bytes())?;
        }
        console.finish();
        console.say(&format!(
            "{}: {} levels, {all_file}, {DOCUMENT}; {:.1} s",
            command.output.display(),
            all.len(),
            console.seconds()
        ));
        let is_cut_short = interrupted() && all.len() < options.screen_size.len();
        Ok(if is_cut_short { Ending::Interrupted } else { Ending::Finished })
    })?
}

fn make_folder(path: &Path) -> Result<(), Failure> {
    create_dir_all(path).map_err(|error| {
        Failure::Output(format!(
            "{}: the folder cannot be made ({error}); choose another one",
            path.display()
        ))
    })
}

/// What people want to know of a level.
fn line(report: &LevelReport, bytes: u64) -> String {
    let switch = match (report.switch_pixels, report.switch_coverage) {
        (Some(pixels), Some(coverage)) => {
            format!("takes over below {pixels:.0} pixels ({:.1} % of the screen)", 100.0 * coverage)
        }
        _ => "can be told from the one before at every size".into(),
    };
    format!(
        "level {}: {} triangles, {}² texels, {:.0} kB; {:.1} dB at {:.0} pixels; {switch}",
        report.level,
        report.triangles,
        report.texture_size,
        bytes as f64 / 1e3,
        report.at_screen_size.psnr,
        report.screen_size,
    )
}
