//! `parbake bake`.

use crate::arguments::{BakeCommand, Talk};
use crate::document::write_report_document;
use crate::failure::{Ending, Failure};
use crate::formats::{check_formats, write_model};
use crate::options_file::merged;
use crate::outputs::{check_beside, check_maps, check_not_input, check_output, is_obj};
use crate::progress::{Console, interrupted};
use crate::rules;
use crate::stage_times::stage_line;
use crate::watch;
use clap::ArgMatches;
use parbake::{
    BakeOptions, BakeReport, Baked, Comparison, Convention, Detail, FileError, Loaded, Message, Metrics,
    Model, NormalY, Shading, Stage, StageTime, Warning, WarningKind, Watcher, Work, WriteOptions, bake,
    bake_to_triangles, check_budget, compare_bake, psnr_from_mse, read_model, read_model_with_pictures,
    read_painted_model, with_normal_y, with_threads, write_file,
};
use parbake_report::html_report;
use std::path::Path;

/// Runs the command.
pub fn run(command: &BakeCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    let file = command.options.as_deref();
    let options = merged(&command.bake, given, file)?;
    rules::check(Work::Bake, &options, given, file)?;
    rules::check_watch(command.watch.watch, given)?;
    options.check()?;
    check_budget(&options)?;
    let inputs: Vec<&Path> =
        [Some(&command.high), command.low.as_ref()].into_iter().flatten().map(|p| p.as_path()).collect();
    let output = &command.output;
    check_maps(output, &options)?;
    check_output(output)?;
    check_formats(output, &options.write)?;
    check_parts(output, &options)?;
    check_not_input(output, &inputs)?;
    check_beside(Some(output), command.json.as_ref(), command.report.as_ref(), &inputs)?;
    let console = Console::for_bake(command.talk, options.time_budget).confined(command.reading);
    let page = watch::open(&command.watch, output, &command.high, &console)?;
    let console = console.with_page(page);
    let ending = bake_files(command, &options, &inputs, &console);
    watch::close(console.page(), &ending);
    ending
}

fn bake_files(
    command: &BakeCommand,
    options: &BakeOptions,
    inputs: &[&Path],
    console: &Console,
) -> Result<Ending, Failure> {
    let output = &command.output;
    with_threads(options.threads, || {
        let attribute = options.importance_attribute.as_deref();
        let pair = read_painted_pair(&command.high, attribute, command.low.as_deref(), console)?;
        if command.strict {
            check_textures(&pair.warnings)?;
        }
        let mut baked = match command.triangles {
            None => bake_and_write(&pair, options, output, console)?,
            Some(count) => {
                let baked = bake_to_triangles(&pair.high, count as usize, options, console)?;
                finish(baked, &pair, options, output, console)?
            }
        };
        let figures = figures_read(command.talk, command.json.is_some(), command.report.is_some());
        let is_shown = command.report.is_some();
        let is_compared = !command.no_comparison && has_time(&baked.report, is_shown);
        if let Some(detail) = figures.filter(|_| is_compared) {
            compare(&pair.high, &mut baked, detail, console)?;
        }
        if let Some(path) = &command.json {
            let names = ["high", "low"].into_iter();
            let files: Vec<(&str, &Path)> = names.zip(inputs.iter().copied()).collect();
            let about = ("bake", &files[..], Some(command.output.as_path()));
            write_report_document(path, about, &baked.report, console)?;
        }
        if let Some(path) = &command.report {
            write_report(path, &pair.high, &baked, console)?;
        }
        console.finish();
        tell(console, command.talk, &baked.report, output);
        Ok(ending(&baked.report))
    })?
}

/// Interrupted only if that cost anything: a report is finished all the same.
pub fn ending(report: &BakeReport) -> Ending {
    if interrupted() && report.stopped_early { Ending::Interrupted } else { Ending::Finished }
}

/// How the result is written: at once where the run was interrupted.
pub fn write_options(report: &BakeReport) -> WriteOptions {
    WriteOptions { is_urgent: ending(report) == Ending::Interrupted, ..report.options.write }
}

/// Refuses parts that stay apart in a file that has no nodes.
fn check_parts(output: &Path, options: &BakeOptions) -> Result<(), Failure> {
    match options.keep_parts.is_empty() || !is_obj(output) {
        true => Ok(()),
        false => Err(Failure::Usage(format!(
            "--keep-parts acts on GLB files only, since an OBJ has no nodes; {} is an OBJ",
            output.display()
        ))),
    }
}

/// Refuses the name that elsewhere means standard input.
pub fn check_input(path: &Path) -> Result<(), Failure> {
    match path.as_os_str() == "-" {
        true => Err(Failure::Usage("-: reading from standard input is not supported; give a file".into())),
        false => Ok(()),
    }
}

/// With `--strict` a missing texture or material is an error.
pub fn check_textures(warnings: &[Warning]) -> Result<(), Failure> {
    let is_missing = |kind| matches!(kind, WarningKind::MissingTexture | WarningKind::MissingMaterial);
    match warnings.iter().find(|warning| is_missing(warning.kind)) {
        Some(warning) => Err(Failure::Strict(warning.text.clone())),
        None => Ok(()),
    }
}

/// Reads one model and passes its warnings on.
pub fn read(path: &Path, console: &Console) -> Result<Loaded, Failure> {
    read_painted(path, None, console)
}

/// The same, with the importances that are painted in an attribute, if there is one.
pub fn read_painted(path: &Path, attribute: Option<&str>, console: &Console) -> Result<Loaded, Failure> {
    told(path, console, || match attribute {
        Some(attribute) => read_painted_model(path, attribute, console.limits()),
        None => read_model(path, console.limits()),
    })
}

/// A model with the files of its pictures, to be written with them.
pub fn read_with_pictures(path: &Path, console: &Console) -> Result<Loaded, Failure> {
    told(path, console, || read_model_with_pictures(path, console.limits()))
}

/// What was read, once its warnings are told.
fn told(
    path: &Path,
    console: &Console,
    read: impl FnOnce() -> Result<Loaded, FileError>,
) -> Result<Loaded, Failure> {
    check_input(path)?;
    let loaded = read()?;
    for warning in &loaded.warnings {
        console.message(Message::Warning(warning.text.clone()));
    }
    Ok(loaded)
}

/// Both models of a bake.
pub struct Pair {
    /// The detailed one.
    pub high: Model,
    /// The coarse one.
    pub low: Model,
    /// What their readers had to say.
    pub warnings: Vec<Warning>,
    /// Seconds that reading took; none for models that were not read.
    pub seconds: Option<f64>,
}

/// Reads two models at once.
pub fn read_both(first: &Path, second: &Path, console: &Console) -> Result<[Loaded; 2], Failure> {
    read_both_painted(first, None, second, console)
}

/// The same, with what is painted in an attribute of the first one.
fn read_both_painted(
    first: &Path,
    attribute: Option<&str>,
    second: &Path,
    console: &Console,
) -> Result<[Loaded; 2], Failure> {
    console.message(Message::Progress { stage: Stage::Read, done: 0, total: 2 });
    let (first, second) = parbake::join(|| read_painted(first, attribute, console), || read(second, console));
    Ok([first?, second?])
}

/// Reads both models of a bake at once.
pub fn read_pair(high: &Path, low: &Path, console: &Console) -> Result<Pair, Failure> {
    read_painted_pair(high, None, Some(low), console)
}

/// The same, with the importances that are painted on the high-poly; the low-poly may be yet to be made.
fn read_painted_pair(
    high: &Path,
    attribute: Option<&str>,
    low: Option<&Path>,
    console: &Console,
) -> Result<Pair, Failure> {
    let begin = console.seconds();
    let [high, low] = match low {
        Some(low) => read_both_painted(high, attribute, low, console)?,
        None => [read_painted(high, attribute, console)?, Loaded::default()],
    };
    let warnings = [high.warnings, low.warnings].concat();
    Ok(Pair { high: high.model, low: low.model, warnings, seconds: Some(console.seconds() - begin) })
}

/// Bakes and writes the model; completes the report with what happened around it.
pub fn bake_and_write(
    pair: &Pair,
    options: &BakeOptions,
    output: &Path,
    console: &Console,
) -> Result<Baked, Failure> {
    finish(bake(&pair.high, &pair.low, options, console)?, pair, options, output, console)
}

fn finish(
    mut baked: Baked,
    pair: &Pair,
    options: &BakeOptions,
    output: &Path,
    console: &Console,
) -> Result<Baked, Failure> {
    let begin = console.seconds();
    let model = with_normal_y(&baked.model, options.normal_y);
    (_, baked.report.written) = write_model(output, &model, &write_options(&baked.report), console)?;
    let report = &mut baked.report;
    report.warnings.splice(0..0, pair.warnings.iter().map(|warning| warning.text.clone()));
    let reading = pair.seconds.map(|seconds| StageTime { stage: Stage::Read, seconds });
    report.stages.splice(0..0, reading);
    report.stages.push(StageTime { stage: Stage::Write, seconds: console.seconds() - begin });
    if let Some(page) = console.page() {
        page.finish(output, console.limits());
    }
    for stage in &report.stages {
        console.detail(&stage_line(stage.stage, stage.seconds));
    }
    Ok(baked)
}

/// Which figures of a comparison somebody reads; none where nobody does. FLIP, which takes most of the time, is for the
/// HTML report alone; MS-SSIM and channels are for the report and for JSON.
pub fn figures_read(talk: Talk, json: bool, report: bool) -> Option<Detail> {
    let is_whole = report || json;
    let metrics = Metrics { ms_ssim: is_whole, flip: report };
    (!talk.quiet || is_whole).then_some(Detail { metrics, channels: is_whole })
}

/// Whether there is time for a comparison: who interrupts a bake wants its end, unless the report shows the figures.
pub fn has_time(report: &BakeReport, is_shown: bool) -> bool {
    is_shown || ending(report) == Ending::Finished
}

/// Compares the result with a ray-cast bake, for the last line, the report and JSON.
pub fn compare(high: &Model, baked: &mut Baked, detail: Detail, console: &Console) -> Result<(), Failure> {
    baked.report.comparison = Some(compare_bake(high, baked, detail, console)?);
    Ok(())
}

/// Renders and writes the HTML report.
pub fn write_report(path: &Path, high: &Model, baked: &Baked, console: &Console) -> Result<(), Failure> {
    let html = html_report(high, baked, console)?;
    write_file(path, html.as_bytes())?;
    Ok(())
}

/// The last lines: what came of it.
pub fn tell(console: &Console, talk: Talk, report: &BakeReport, output: &Path) {
    let compared = report.comparison.as_ref().map(|made| gains(made, "ray-cast", "baked") + "; ");
    let compared = compared.unwrap_or_default();
    console.say(&format!("{}: {compared}{:.1} s", output.display(), console.seconds()));
    if report.options.normal_y == NormalY::Down {
        console.say(
            "the normal map is written with -Y (--normal-y down); glTF viewers and eval show it wrongly",
        );
    }
    if talk.verbose {
        tell_of_shape(console, report);
        let share = 100.0 * report.unseen_texels as f64 / report.covered_texels.max(1) as f64;
        console.say(&format!(
            "{} texels on the surface, {} ({share:.1} %) seen by no view; {} samples",
            report.covered_texels, report.unseen_texels, report.samples
        ));
        console.say("agreement with the training views after each step:");
        for step in &report.losses {
            console.say(&format!(
                "  {:8.3} s  {:8}  {:.3} dB",
                step.seconds,
                step.moved,
                psnr_from_mse(step.mean_square)
            ));
        }
        if let Some(bytes) = report.peak_memory {
            console.say(&format!("peak memory {:.0} MB", bytes as f64 / 1e6));
        }
    }
}

/// Decibels before and after on black and on grey, and the command that gives the latter again.
pub fn gains(comparison: &Comparison, before: &str, after: &str) -> String {
    let [mut from, mut to] = [format!("{before} "), format!(" {after} ")];
    let mut text = String::new();
    for on in comparison.backgrounds.iter().take(2) {
        let [a, b] = [on.mean.ray_cast.psnr, on.mean.baked.psnr];
        text += &format!("{from}{a:.1} →{to}{b:.1} dB on {}, ", on.background);
        (from, to) = (String::new(), " ".into());
    }
    let views = comparison.options.views;
    let paper = if comparison.options.convention == Convention::Gltf { "" } else { " --convention paper" };
    let shading = match comparison.options.shading {
        Shading::Auto => "",
        Shading::Lambert => " --shading lambert",
        Shading::Pbr => " --shading pbr",
    };
    let text = text.trim_end_matches(", ");
    format!("{text} ({views} views; eval HIGH BAKED --views {views}{paper}{shading} gives the same)")
}

/// What became of vertices and silhouettes.
fn tell_of_shape(console: &Console, report: &BakeReport) {
    if let Some(shape) = &report.shape {
        let [mean, most] = shape.moved.map(|share| 100.0 * share);
        console.say(&format!(
            "vertices moved by {mean:.2} % of the model's length in the mean, {most:.2} % at most, in {} steps; \
             outlines were {:.3} % apart and are {:.3} %",
            shape.steps,
            100.0 * shape.gap[0],
            100.0 * shape.gap[1]
        ));
    }
    if let Some(depth) = &report.parallax_maps {
        if let Some([before, after]) = depth.misplaced.map(|shares| shares.map(|share| 100.0 * share)) {
            console.say(&format!(
                "cutout: {before:.1} % of the pixels near outlines were wrong, {after:.1} % are"
            ));
        }
        let [before, after] = depth.cross_chart.map(|share| 100.0 * share);
        let anew = match depth.begun_anew {
            0 => "",
            _ => ", started again for the finer texture, since it had only made up for the coarse one's blur",
        };
        console.say(&format!(
            "parallax: {} steps{anew}; {before:.3} % of the pixels fetched from another chart, {after:.3} % do",
            depth.steps
        ));
    }
    if let Some(fallback) = &report.fallback {
        let tried: Vec<String> =
            fallback.tried.iter().map(|(side, psnr)| format!("{psnr:.1} dB with {side}²")).collect();
        let taken = fallback.side.map_or("the maps' textures".into(), |side| format!("textures of {side}²"));
        console.say(&format!(
            "viewers without the maps show {taken}: {}, {:.1} dB with the maps' (training views, on black)",
            tried.join(", "),
            fallback.shared
        ));
    }
}
