//! `parbake compress`.

use crate::arguments::CompressCommand;
use crate::bake::{
    check_textures, compare, ending, figures_read, gains, has_time, read, write_options, write_report,
};
use crate::document::write_report_document;
use crate::failure::{Ending, Failure};
use crate::formats::{check_formats, write_model};
use crate::options_file::merged;
use crate::outputs::{check_beside, check_not_input, check_output, is_stdout};
use crate::printed::print;
use crate::progress::Console;
use crate::rules;
use clap::ArgMatches;
use parbake::{
    BakeReport, MeshCompression, Message, Stage, StageTime, TextureFormat, UvMode, Watcher, Work,
    WriteOptions, check_budget, compress, has_colour_alone, with_normal_y, with_threads,
};
use std::path::Path;

/// Runs the command.
pub fn run(command: &CompressCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    let file = command.options.as_deref();
    let options = merged(&command.bake, given, file)?;
    rules::check(Work::Compress, &options, given, file)?;
    options.check()?;
    check_budget(&options)?;
    let (output, inputs) = (&command.output, [command.model.as_path()]);
    check_output(output)?;
    check_formats(output, &options.write)?;
    check_not_input(output, &inputs)?;
    check_beside(Some(output), command.json.as_ref(), command.report.as_ref(), &inputs)?;
    let console =
        Console::for_bake(command.talk, options.time_budget).confined(command.reading).with_stage_times();
    with_threads(options.threads, || {
        let loaded = read(&command.model, &console)?;
        if command.strict {
            check_textures(&loaded.warnings)?;
        }
        if options.uv != UvMode::Keep && has_colour_alone(&loaded.model, &options) {
            for name in rules::typed_of_views(given) {
                let text = format!(
                    "{name} acts only on models with a normal map, or more to their materials than colour"
                );
                console.message(Message::Warning(text));
            }
        }
        let mut baked = compress(&loaded.model, &options, &console)?;
        let begin = console.seconds();
        let model = with_normal_y(&baked.model, options.normal_y);
        let write = write_options(&baked.report);
        let (after, written) = write_model(output, &model, &write, &console)?;
        let bytes = [loaded.bytes, after];
        let told = grown(bytes, output, &write);
        told.iter().for_each(|text| console.message(Message::Warning(text.clone())));
        baked.report.warnings.extend(told);
        baked.report.written = written;
        baked.report.warnings.splice(0..0, loaded.warnings.iter().map(|warning| warning.text.clone()));
        baked.report.stages.push(StageTime { stage: Stage::Write, seconds: console.seconds() - begin });
        let figures = figures_read(command.talk, command.json.is_some(), command.report.is_some());
        let is_shown = command.report.is_some();
        let is_compared = !command.no_comparison && has_time(&baked.report, is_shown);
        if let Some(detail) = figures.filter(|_| is_compared) {
            compare(&loaded.model, &mut baked, detail, &console)?;
        }
        if let Some(path) = &command.json {
            let about =
                ("compress", &[("model", command.model.as_path())][..], Some(command.output.as_path()));
            write_report_document(path, about, &baked.report, &console)?;
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

/// A word about a file that became larger than the model was, with what makes it smaller.
fn grown([before, after]: [u64; 2], output: &Path, write: &WriteOptions) -> Option<String> {
    let is_glb = output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("glb"));
    let format = is_glb && matches!(write.texture_format, TextureFormat::Png);
    let mesh = is_glb && write.mesh_compression == MeshCompression::None;
    let more = [(format, "--texture-format webp"), (mesh, "--mesh-compression meshopt")];
    let more: String =
        more.iter().filter(|(helps, _)| *helps).map(|(_, text)| format!(", or {text}")).collect();
    // What is written at once is larger than it would be.
    (after > before && !write.is_urgent).then(|| {
        let name = output.display();
        format!(
            "{name} is larger than the model was ({after} bytes, {before} before); for a smaller file take a smaller \
             --texture-size{more}"
        )
    })
}

/// `bytes` are those of the model as delivered and as written, with all files that belong to it.
fn summary(report: &BakeReport, [before, after]: [u64; 2], output: &Path, seconds: f64) -> String {
    let mut text = format!("{}: ", output.display());
    if let Some(comparison) = &report.comparison {
        let before = match report.losses.first().map(|first| first.moved.as_str()) {
            Some("delivered") => "coordinates as they are",
            Some("repaired") => "UVs repaired",
            _ => "ray-cast",
        };
        let gains = gains(comparison, before, "compressed").replace("HIGH BAKED", "MODEL COMPRESSED");
        text += &format!("{gains}\n");
    }
    text += &format!("{before} bytes → {after} bytes, ");
    let [given, now] = [report.high_triangles, report.low_triangles];
    if now > given {
        text += &format!("{given} → {now} triangles (--more-triangles 0 keeps them), ");
    }
    text + &format!("{seconds:.1} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects who wants a smaller file and gets a larger one: they are told what helps, and nothing that they have.
    #[test]
    fn a_file_that_grew_is_told() {
        let plain = WriteOptions::default();
        let of = |bytes, file: &str, write| grown(bytes, file.as_ref(), write).unwrap_or_default();
        assert_eq!(of([2000, 2000], "a.glb", &plain), "");
        let told = of([1000, 2000], "a.glb", &plain);
        assert!(
            told.contains("2000 bytes, 1000 before") && told.ends_with("--mesh-compression meshopt"),
            "{told}"
        );
        let packed = WriteOptions { texture_format: TextureFormat::Webp, ..plain };
        assert!(!of([1000, 2000], "a.glb", &packed).contains("webp"));
        let urgent = WriteOptions { is_urgent: true, ..plain };
        assert_eq!(of([1000, 2000], "a.glb", &urgent), "");
        assert!(of([1000, 2000], "a.obj", &plain).ends_with("a smaller --texture-size"));
    }
}
