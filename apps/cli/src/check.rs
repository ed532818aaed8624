//! `parbake check`.

use crate::arguments::CheckCommand;
use crate::bake::read;
use crate::document::write_document;
use crate::failure::{Ending, Failure};
use crate::outputs::{check_json, is_stdout};
use crate::printed::print;
use crate::progress::Console;
use parbake::{LayoutCheck, ModelCheck, UvCheck, check_model, with_threads};
use std::fmt::Write;

/// Runs the command.
pub fn run(command: &CheckCommand) -> Result<Ending, Failure> {
    let (size, gutter) = (command.texture_size, command.gutter);
    if let Some(size) = size.filter(|size| !(1..=65536).contains(size)) {
        return Err(Failure::Usage(format!("--texture-size cannot be {size}: it may be 1 to 65536")));
    }
    if !(gutter >= 0.0 && gutter.is_finite()) {
        return Err(Failure::Usage(format!("--gutter cannot be {gutter}: it may be 0 or more")));
    }
    check_json(command.json.as_ref(), &[&command.model])?;
    let to_stdout = command.json.as_ref().is_some_and(|path| is_stdout(path));
    let console = Console::new(command.talk).confined(command.reading);
    with_threads(command.threads, || {
        let model = read(&command.model, &console)?.model;
        let found = check_model(&model, size, gutter);
        console.finish();
        if let Some(path) = &command.json {
            write_document(path, ("check", &[("model", &command.model)], None), &found, &console)?;
        }
        // Quiet leaves what was asked for: the problems, or nothing.
        if !to_stdout {
            print_lines(&if command.talk.quiet { problems(&found) } else { table(&found) })?;
        }
        console.detail(&format!("checked in {:.2} s", console.seconds()));
        Ok(if found.sound { Ending::Finished } else { Ending::Problems })
    })?
}

fn print_lines(text: &str) -> Result<(), Failure> {
    if text.is_empty() { Ok(()) } else { print(text.trim_end()) }
}

/// All problems, one a line.
fn problems(found: &ModelCheck) -> String {
    let all = found.problems.iter().chain(found.layouts.iter().flat_map(|layout| &layout.problems));
    all.fold(String::new(), |text, problem| text + problem + "\n")
}

fn table(found: &ModelCheck) -> String {
    let mut out = String::new();
    let several = found.layouts.len() > 1;
    for layout in &found.layouts {
        if several || layout.picture.is_some() {
            let _ = writeln!(out, "{}", title(layout));
        }
        out += &figures(&layout.uv);
        let problems = layout.problems.iter().map(|problem| format!("  problem      {problem}\n"));
        out += &problems.collect::<String>();
        out.push('\n');
    }
    for problem in &found.problems {
        let _ = writeln!(out, "{problem}");
    }
    if found.triangles_without_picture > 0 {
        let _ = writeln!(
            out,
            "{} triangles have no base colour picture and were not checked.",
            found.triangles_without_picture
        );
    }
    out + if found.sound { "sound" } else { "not sound" }
}

fn title(layout: &LayoutCheck) -> String {
    let picture = match layout.picture.as_deref() {
        None => "no picture",
        Some("") => "a picture without a name",
        Some(name) => name,
    };
    let materials: Vec<&str> =
        layout.materials.iter().map(String::as_str).filter(|m| !m.is_empty()).collect();
    if materials.is_empty() { picture.into() } else { format!("{picture} ({})", materials.join(", ")) }
}

fn figures(uv: &UvCheck) -> String {
    let mut out = String::new();
    let mut row = |name: &str, value: String| {
        let _ = writeln!(out, "  {name:<12} {value}");
    };
    let o = &uv.orientations;
    let texels = |length: f64| format!("{length:.2} texels at {0} × {0}", uv.texture_size);
    let bound = if uv.overlaps.complete { "" } else { "at least " };
    row("triangles", uv.triangles.to_string());
    row("charts", uv.charts.to_string());
    row("flipped", (o.flipped.count + o.mirrored_triangles).to_string());
    row("degenerate", o.degenerate.count.to_string());
    row("outside", o.outside.count.to_string());
    row("overlaps", format!("{bound}{} pairs, {bound}{:.1} texels", uv.overlaps.pairs, uv.overlaps.texels));
    row(
        "gutter",
        uv.gutter.as_ref().map_or("- (one chart)".into(), |gutter| {
            let bound = if gutter.complete { "" } else { "at least " };
            format!("{bound}{}", texels(gutter.texels))
        }),
    );
    row("border", uv.border.map_or("-".into(), texels));
    row("utilisation", format!("{:.1} %", 100.0 * uv.utilisation));
    if let Some(distortion) = &uv.distortion {
        row("stretch", format!("{:.3} L², {:.3} at most", distortion.stretch_l2, distortion.stretch_max));
        row("", "       1 %      5 %     50 %     95 %     99 %".into());
        for (name, q) in [("area scale", distortion.area_scale), ("anisotropy", distortion.anisotropy)] {
            let all = [q.q1, q.q5, q.q50, q.q95, q.q99];
            row(name, all.map(|x| format!("{x:9.3}")).concat());
        }
    }
    out
}
