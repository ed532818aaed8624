//! `parbake stats`.

use crate::arguments::StatsCommand;
use crate::bake::{read, read_both};
use crate::document::write_document;
use crate::failure::{Ending, Failure};
use crate::outputs::{check_json, is_stdout};
use crate::printed::print;
use crate::progress::Console;
use crate::rules;
use clap::ArgMatches;
use parbake::{LayoutStats, ModelStats, SurfaceDistance, model_distance, model_stats, with_threads};
use parbake_report::page::text::figures;
use serde::Serialize;
use std::path::Path;

/// The JSON output.
#[derive(Serialize)]
struct Stats {
    model: ModelStats,
    against: Option<ModelStats>,
    distance: Option<SurfaceDistance>,
}

/// Runs the command.
pub fn run(command: &StatsCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    rules::check_stats(command.against.is_some(), given)?;
    command.stats.check()?;
    let mut files = vec![("model", command.model.as_path())];
    files.extend(command.against.as_deref().map(|path| ("against", path)));
    let inputs: Vec<&Path> = files.iter().map(|(_, path)| *path).collect();
    check_json(command.json.as_ref(), &inputs)?;
    let to_stdout = command.json.as_ref().is_some_and(|path| is_stdout(path));
    let console = Console::new(command.talk).confined(command.reading);
    with_threads(command.stats.threads, || {
        let (model, against) = match &command.against {
            None => (read(&command.model, &console)?, None),
            Some(against) => {
                let [model, against] = read_both(&command.model, against, &console)?;
                (model, Some(against))
            }
        };
        let found = Stats {
            model: model_stats(&model),
            against: against.as_ref().map(model_stats),
            distance: against
                .as_ref()
                .and_then(|other| model_distance(&model.model, &other.model, &command.stats)),
        };
        console.finish();
        if let Some(path) = &command.json {
            write_document(path, ("stats", &files, None), &found, &console)?;
        }
        if !to_stdout && !command.talk.quiet {
            print(&text(&found, &inputs))?;
        }
        console.detail(&format!("measured in {:.2} s", console.seconds()));
        Ok(Ending::Finished)
    })?
}

/// "812 bytes", "12.3 kB", "4.0 MB".
fn bytes(bytes: u64) -> String {
    match bytes as f64 {
        b if b < 1e3 => format!("{bytes} bytes"),
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b => format!("{:.1} MB", b / 1e6),
    }
}

/// What heads a column: the file's name, with its folder's where both files have the same.
fn headings(inputs: &[&Path]) -> Vec<String> {
    let name = |path: &Path, parts: usize| {
        let all: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy()).collect();
        all[all.len().saturating_sub(parts)..].join("/")
    };
    let parts = (1..=8).find(|&parts| inputs.len() < 2 || name(inputs[0], parts) != name(inputs[1], parts));
    inputs.iter().map(|path| name(path, parts.unwrap_or(1))).collect()
}

/// Rows of a name and a cell for each model.
struct Rows(Vec<(String, Vec<String>)>);

impl Rows {
    fn head(&mut self, name: &str) {
        if !self.0.is_empty() {
            self.0.push((String::new(), Vec::new()));
        }
        self.0.push((name.into(), Vec::new()));
    }

    fn push(&mut self, name: &str, cells: Vec<String>) {
        self.0.push((format!("  {name}"), cells));
    }

    /// Names to the left, cells to the right of their columns.
    fn text(&self) -> String {
        let widest =
            |texts: &mut dyn Iterator<Item = &String>| texts.map(|t| t.chars().count()).max().unwrap_or(0);
        let name = widest(&mut self.0.iter().filter(|row| !row.1.is_empty()).map(|row| &row.0));
        let columns = self.0.iter().map(|row| row.1.len()).max().unwrap_or(0);
        let widths: Vec<usize> =
            (0..columns).map(|k| widest(&mut self.0.iter().filter_map(|row| row.1.get(k)))).collect();
        let line = |(text, cells): &(String, Vec<String>)| {
            let cells = cells.iter().zip(&widths).map(|(cell, width)| format!("  {cell:>width$}"));
            format!("{text:name$}{}", cells.collect::<String>()).trim_end().to_string()
        };
        self.0.iter().map(line).collect::<Vec<_>>().join("\n")
    }
}

fn text(found: &Stats, inputs: &[&Path]) -> String {
    let models: Vec<&ModelStats> = std::iter::once(&found.model).chain(&found.against).collect();
    let mut rows = Rows(Vec::new());
    rows.push("", headings(inputs));
    file_rows(&mut rows, &models);
    surface_rows(&mut rows, &models);
    let mut out = rows.text();
    for (model, path) in models.iter().zip(inputs) {
        let of = if models.len() > 1 { format!(" of {}", path.display()) } else { String::new() };
        out += &textures_text(model, &of);
        for layout in &model.layouts {
            out += &layout_text(layout, &of);
        }
    }
    if let Some(distance) = &found.distance {
        out += &distance_text(distance, inputs);
    } else if found.against.is_some() {
        out += "\n\nno distance: a model has no surface area";
    }
    out
}

/// Adds a row with a cell of each model.
fn row(rows: &mut Rows, models: &[&ModelStats], name: &str, cell: impl Fn(&ModelStats) -> String) {
    rows.push(name, models.iter().map(|model| cell(model)).collect());
}

fn file_rows(rows: &mut Rows, models: &[&ModelStats]) {
    rows.head("file");
    row(rows, models, "vertices, split by attributes", |m| m.file.vertices.to_string());
    row(rows, models, "triangles", |m| m.file.triangles.to_string());
    row(rows, models, "triangles left out, without area", |m| m.file.degenerate_triangles.to_string());
    row(rows, models, "materials", |m| m.file.materials.to_string());
    row(rows, models, "draw calls", |m| m.file.draw_calls.to_string());
    row(rows, models, "textures", |m| m.file.textures.len().to_string());
    row(rows, models, "textures on the GPU, RGBA and mips", |m| bytes(m.file.texture_gpu_bytes));
    row(rows, models, "all files", |m| bytes(m.file.bytes));
}

fn surface_rows(rows: &mut Rows, models: &[&ModelStats]) {
    let yes = |is: bool| if is { "yes" } else { "no" }.to_string();
    let unit = |number: f64| figures(number, 4);
    rows.head("surface, welded by position");
    row(rows, models, "size", |m| m.size.map(|x| unit(x.into())).join(" × "));
    row(rows, models, "area", |m| unit(m.topology.area));
    row(rows, models, "volume of closed components", |m| m.topology.volume.map_or("-".into(), unit));
    row(rows, models, "vertices", |m| m.topology.vertices.to_string());
    row(rows, models, "components", |m| m.topology.components.to_string());
    row(rows, models, "closed components", |m| m.topology.closed_components.to_string());
    row(rows, models, "holes (boundary loops)", |m| m.topology.boundary_loops.to_string());
    row(rows, models, "boundary edges", |m| m.topology.boundary_edges.to_string());
    row(rows, models, "manifold", |m| yes(m.topology.manifold));
    row(rows, models, "non-manifold edges", |m| m.topology.non_manifold_edges.to_string());
    row(rows, models, "non-manifold vertices", |m| m.topology.non_manifold_vertices.to_string());
    row(rows, models, "edges with inconsistent winding", |m| m.topology.inconsistent_edges.to_string());
    row(rows, models, "genus", |m| m.topology.genus.map_or("-".into(), |genus| genus.to_string()));
    row(rows, models, "components without genus", |m| m.topology.components_without_genus.to_string());
    row(rows, models, "Euler characteristic", |m| m.topology.euler_characteristic.to_string());
    row(rows, models, "duplicate triangles", |m| m.topology.duplicate_triangles.to_string());
    rows.head("surface, split by texture coordinates");
    row(rows, models, "vertices", |m| m.topology.split_vertices.to_string());
    row(rows, models, "components", |m| m.topology.split_components.to_string());
}

fn textures_text(model: &ModelStats, of: &str) -> String {
    let mut rows = Rows(Vec::new());
    for texture in &model.file.textures {
        let stored = &texture.stored;
        let size = format!("{} × {}", stored.width, stored.height);
        let cells = vec![stored.format.label().into(), size, bytes(stored.bytes), bytes(texture.gpu_bytes)];
        rows.push(if stored.name.is_empty() { "(no name)" } else { &stored.name }, cells);
    }
    match rows.0.is_empty() {
        true => String::new(),
        false => format!("\n\ntextures{of}: format, texels, bytes, bytes on the GPU\n{}", rows.text()),
    }
}

fn layout_text(stats: &LayoutStats, of: &str) -> String {
    let LayoutStats { layout, width, height, texel_density } = stats;
    let uv = &layout.uv;
    let picture = match layout.picture.as_deref() {
        None => "no picture".into(),
        Some("") => format!("a picture of {width} × {height}"),
        Some(name) => format!("{name}, {width} × {height}"),
    };
    let mut rows = Rows(Vec::new());
    let mut push = |name: &str, cell: String| rows.push(name, vec![cell]);
    let bound = if uv.overlaps.complete { "" } else { "at least " };
    let flipped = uv.orientations.flipped.count + uv.orientations.mirrored_triangles;
    push("triangles", uv.triangles.to_string());
    push("utilisation", format!("{:.1} %", 100.0 * uv.utilisation));
    push("charts", uv.charts.to_string());
    push("flipped or mirrored triangles", flipped.to_string());
    push("triangles without area in the texture", uv.orientations.degenerate.count.to_string());
    push("triangles outside the square", uv.orientations.outside.count.to_string());
    push("overlapping pairs", format!("{bound}{}", uv.overlaps.pairs));
    push("overlapping texels", format!("{bound}{}", figures(uv.overlaps.texels, 4)));
    if let Some(distortion) = &uv.distortion {
        push("stretch L² (1 is best)", figures(distortion.stretch_l2, 4));
        push("stretch L∞ (1 is best)", figures(distortion.stretch_max, 4));
        push("symmetric Dirichlet energy (4 is best)", figures(distortion.symmetric_dirichlet, 4));
    }
    if let Some(density) = texel_density {
        push("texels along a unit, mean", figures(density.mean, 4));
        let all = [density.q1, density.q50, density.q99].map(|d| figures(d, 4));
        push("at 1 %, 50 %, 99 % of the surface", all.join(", "));
    }
    format!("\n\nUV layout{of}: {picture}\n{}", rows.text())
}

fn distance_text(distance: &SurfaceDistance, inputs: &[&Path]) -> String {
    let mut rows = Rows(Vec::new());
    rows.push("", vec!["in units".into(), "of the diagonal".into()]);
    let all = [
        ("Chamfer (mean of both ways' means)", distance.chamfer, distance.chamfer_share),
        ("root mean square (greater way)", distance.rms, distance.rms_share),
        ("Hausdorff (greatest of both ways)", distance.hausdorff, distance.hausdorff_share),
    ];
    for (name, value, share) in all {
        rows.push(name, vec![figures(value, 4), format!("{:.4} %", 100.0 * share)]);
    }
    let names: Vec<String> = inputs.iter().map(|path| path.display().to_string()).collect();
    let (names, samples) = (names.join(" and "), distance.samples);
    format!("\n\ndistance between {names}, {samples} samples on each\n{}", rows.text())
}
