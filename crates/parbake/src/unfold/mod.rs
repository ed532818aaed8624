//! A low-poly's texture coordinates before the bake: kept, mended, made anew, or moved to
//! where they show most ([`UvMode`]).
//!
//! ```text
//! as delivered ─ repair ─┬ as it is ───────────────┬ the better one ─ shape ─ refine ─ Mesh
//!        signal ─────────┴ packed, charts scaled ──┘
//! ```
//!
//! Contract: whatever comes out of `repair`, `unwrap` or `optimize` is bijective, with the
//! gutter asked for between charts. Moved coordinates are only taken if they show the
//! surface better than the ones they began with.

mod surface_signal;

pub use surface_signal::Source;

use crate::error::BakeError;
use crate::low::texture_coordinates;
use crate::message::{Message, Stage, Watcher};
use crate::options::UvMode;
use crate::uv_animation::UvMoves;
use parbake_atlas::{
    ChartScale, Layout, PackOptions, RepairOptions, UnwrapOptions, check, pack, repair, unwrap,
};
use parbake_mesh::ensure_normals;
use parbake_model::glam::{DMat2, DVec2, Vec2, Vec4};
use parbake_model::{Material, Mesh, Model, Placement};
use parbake_uv::best_texture::{Mapped, Solve, Texture, best_texture_in_box};
use parbake_uv::contact::{Border, ContactOptions};
use parbake_uv::metric::chart_scales;
use parbake_uv::optimise::{Balance, Problem, UvOptions, refine, shape, tensors};
use parbake_uv::runs::Runs;
use parbake_uv::shown::shown_errors;
use serde::{Deserialize, Serialize};
use surface_signal::showings;

/// What is asked for.
#[derive(Clone, Copy, Debug)]
pub struct UnfoldOptions {
    /// What becomes of the coordinates.
    pub mode: UvMode,
    /// Texels along a side.
    pub texture_size: usize,
    /// Least distance between charts in texels.
    pub gutter: f64,
    /// Steps of the refinement.
    pub steps: usize,
}

/// What was done.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UnfoldReport {
    /// What was mended, a sentence each.
    pub mended: Vec<String>,
    /// Share of the square that was covered before and after.
    pub utilisation: [f64; 2],
    /// Steps that texture coordinates took.
    pub steps: usize,
    /// Estimated squared error of the surface's colours relative to that with the
    /// coordinates before, full size and half; 1 where nothing moved.
    pub relative_error: Vec<f64>,
    /// True where charts were packed anew before they moved.
    pub packed: bool,
}

/// A low-poly with new coordinates.
pub struct Unfolded {
    /// Its mesh alone: what its materials said of coordinates is applied.
    pub model: Model,
    /// How its coordinates moved.
    pub moves: Option<UvMoves>,
    /// What was done.
    pub report: UnfoldReport,
}

/// Samples of the surface at most.
const MOST_SAMPLES: usize = 400_000;
/// Width of a pixel in the common frame, in which a model is 2 long: a model that fills
/// some 700 pixels.
const PIXEL: f64 = 2.8 / 1024.0;
/// Charts are drawn at most so many times larger or smaller than their area says.
const MOST_SCALE: f64 = 3.0;
/// Packing leaves so many texels more than the gutter: charts that touch cannot turn.
const ROOM: f64 = 0.25;
/// A moved layout must be better than the one before by this much.
const WORTH_IT: f64 = 0.98;

/// Prepares the texture coordinates of a low-poly that `frame` places.
///
/// # Errors
/// Where charts do not fit into the texture with the gutter asked for.
pub fn unfold(
    low: &Model,
    frame: &Placement,
    source: &Source,
    options: &UnfoldOptions,
    watcher: &impl Watcher,
) -> Result<Unfolded, BakeError> {
    let (mut mesh, mended) = mended(low, options)?;
    let start = Layout::new(&mesh);
    let before = check(&start, options.texture_size).utilisation;
    let mut report =
        UnfoldReport { mended, utilisation: [before; 2], relative_error: vec![1.0; 2], ..Default::default() };
    let mut moves = None;
    if options.mode == UvMode::Optimize && options.steps > 0 {
        let mut placed = mesh.clone();
        frame.apply(&mut placed);
        if let Some(Moved { layout, frames }) = moved(&placed, source, options, &mut report, watcher) {
            report.utilisation[1] = check(&layout, options.texture_size).utilisation;
            mesh.uvs = layout.uvs();
            moves = Some(UvMoves { frames, triangles: layout.triangles, charts: layout.charts });
        }
    }
    mesh.triangle_materials.fill(0);
    let model = Model { name: low.name.clone(), mesh, materials: vec![Material::default()], images: Vec::new() };
    Ok(Unfolded { model, moves, report })
}

/// The mesh with sound coordinates, as the mode asks, and what was done for that.
fn mended(low: &Model, options: &UnfoldOptions) -> Result<(Mesh, Vec<String>), BakeError> {
    let mut mesh = low.mesh.clone();
    mesh.uvs = texture_coordinates(&low.mesh, &low.materials);
    mesh.tangents.clear();
    ensure_normals(&mut mesh);
    let pack = packing(options);
    Ok(match options.mode {
        UvMode::Keep => (mesh, Vec::new()),
        UvMode::Unwrap => (unwrap(&mesh, &UnwrapOptions { pack, ..Default::default() })?.mesh, Vec::new()),
        UvMode::Repair | UvMode::Optimize => repair(&mesh, &RepairOptions { pack, ..Default::default() })?,
    })
}

fn packing(options: &UnfoldOptions) -> PackOptions {
    PackOptions {
        texture_size: options.texture_size,
        gutter_texels: options.gutter,
        ..PackOptions::default()
    }
}

/// A layout that shows the surface better, and its way there.
struct Moved {
    layout: Layout,
    frames: Vec<Vec<Vec2>>,
}

/// None where no better one was found.
fn moved(
    mesh: &Mesh,
    source: &Source,
    asked: &UnfoldOptions,
    report: &mut UnfoldReport,
    watcher: &impl Watcher,
) -> Option<Moved> {
    let size = asked.texture_size;
    let start = &Layout::new(mesh);
    let most = MOST_SAMPLES.min((8 * size * size).max(1 << 16));
    let showings = showings(mesh, &start.rest, source, PIXEL, most);
    if showings[0].samples.is_empty() {
        return None;
    }
    let contact = ContactOptions {
        texture_size: size as u32,
        gutter_texels: asked.gutter,
        border: Border::Margin { margin_texels: (0.5 * asked.gutter).max(0.5) },
        ..ContactOptions::default()
    };
    let problem = &Problem { rest: &start.rest, showings: &showings, texture_size: size, contact: &contact };
    let options =
        &UvOptions { refine_steps: asked.steps, shape_steps: 2 * asked.steps, ..UvOptions::default() };
    let kept = errors(problem, start);
    let (mut balance, texture) = Balance::new(problem, start);
    let tensors = tensors(problem, start);
    let mut layout = start.clone();
    if let Some(packed) = packed(problem, start, &packing(asked), &tensors)
        && errors(problem, &packed)[0] < kept[0]
    {
        layout = packed;
        report.packed = true;
    }
    let mut frames = vec![as_f32(&start.points), as_f32(&layout.points)];
    let mut step = |points: &[DVec2]| {
        frames.push(as_f32(points));
        let total = options.refine_steps + options.shape_steps;
        watcher.message(Message::Progress { stage: Stage::Unfold, done: frames.len().min(total), total });
        !watcher.stopped()
    };
    let before = layout.clone();
    shape(problem, &mut layout, &tensors, options, |points, _| step(points));
    // The signal-specialised start is a guess; where it is a bad one, none is better.
    if errors(problem, &layout)[0] > errors(problem, &before)[0] {
        layout = before;
    }
    let refined = refine(problem, &balance, &mut layout, texture, options, |points, _| step(points));
    balance.update(&refined.relative);
    report.steps = frames.len() - 2;
    let found = errors(problem, &layout);
    report.relative_error = found.iter().zip(&kept).map(|(a, b)| a / b.max(1e-12)).collect();
    (report.relative_error[0] < WORTH_IT).then_some(Moved { layout, frames })
}

/// Charts packed anew, each as large as its signal asks for.
fn packed(problem: &Problem, start: &Layout, packing: &PackOptions, tensors: &[DMat2]) -> Option<Layout> {
    let scales = chart_scales(tensors, problem.rest, &start.charts, MOST_SCALE);
    let even = even_scales(start);
    let given = scales.iter().zip(even).map(|(a, b)| a * b).collect();
    let packing = PackOptions {
        gutter_texels: packing.gutter_texels + ROOM,
        chart_scale: ChartScale::Given(given),
        ..packing.clone()
    };
    // Without room for that, the layout as it is does.
    pack(start, &packing).ok()
}

/// Factors that give all charts the same texels per unit of surface.
fn even_scales(layout: &Layout) -> Vec<f64> {
    let count = layout.charts.iter().max().map_or(0, |c| *c as usize + 1);
    let (mut drawn, mut area) = (vec![0.0; count], vec![0.0; count]);
    for (t, chart) in layout.charts.iter().enumerate() {
        drawn[*chart as usize] += 0.5 * layout.doubled_area(t);
        area[*chart as usize] += layout.rest_area(t);
    }
    drawn.iter().zip(&area).map(|(d, a)| if *d > 0.0 && *a > 0.0 { (a / d).sqrt() } else { 1.0 }).collect()
}

/// What 8-bit texels leave of each showing.
fn errors(problem: &Problem, layout: &Layout) -> Vec<f64> {
    let runs = Runs::new(&layout.points, &layout.triangles, &problem.showings[0]);
    let whole = Mapped {
        points: &layout.points,
        triangles: &layout.triangles,
        showings: problem.showings,
        runs: &runs,
    };
    let first = Mapped { showings: &problem.showings[..1], ..whole };
    let start = Texture::solid(problem.texture_size, Vec4::splat(0.5));
    let mut texture = best_texture_in_box(&first, start, &Solve { steps: 40, ..Solve::MOVING });
    texture.texels.iter_mut().for_each(|t| *t = (*t * 255.0).round() / 255.0);
    shown_errors(&whole, &texture)
}

fn as_f32(points: &[DVec2]) -> Vec<Vec2> {
    points.iter().map(|p| p.as_vec2()).collect()
}
