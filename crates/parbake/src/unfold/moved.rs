//! The default method on a low-poly's texture coordinates (`parbake_uv::optimise`).
//!
//! ```text
//! as it is ───────────────┬ the better one ─ shape ─ refine
//! packed, charts scaled ──┘
//! ```
//!
//! Contract: a moved layout is as sound as the one before, and shows the surface better.

use super::surface_signal::Source;
use super::{Moved, UnfoldOptions, UnfoldReport, as_f32, contact, errors, packing, signal};
use crate::message::{Message, Stage, Watcher};
use parbake_atlas::{ChartScale, Layout, PackOptions, pack};
use parbake_model::Mesh;
use parbake_model::glam::{DMat2, DVec2, Vec2};
use parbake_uv::best_texture::Solve;
use parbake_uv::metric::chart_scales;
use parbake_uv::optimise::{Balance, Problem, RefineBy, UvOptions, refine, shape, tensors};

/// Charts are drawn at most so many times larger or smaller than their area says.
const MOST_SCALE: f64 = 3.0;
/// Packing leaves so many texels more than the gutter: charts that touch cannot turn.
const ROOM: f64 = 0.25;
/// Minified, a low-poly's must be better by this much: with a texture that is finer than what views
/// see, a better picture at full size is worth nothing, and coordinates that were drawn out for it cost
/// parallax maps 0.2 to 0.3 dB. A model's own smaller texture need only not be worse.
const MINIFIED: f64 = 0.95;
/// Minified errors that are above that by more than this after a turn stay so: further turns bring them
/// a hundredth nearer.
const HOPELESS: f64 = 0.05;
/// Turns of the refinement; in between showings are weighted anew.
const TURNS: usize = 3;
/// Steps of the start times triangles at most, a second or so: charts by the dozen need a hundred
/// steps to fill their square, and a step is Newton's, 4 µs a triangle…
const SHAPE_WORK: usize = 250_000;
/// …but so many steps at least, for meshes of any size, and never more than so many.
const LEAST_SHAPE_STEPS: usize = 20;
const MOST_SHAPE_STEPS: usize = 200;
/// What a triangle without signal weighs in the start: what surfaces of all kinds like, and what suits
/// plainly coloured parts with small textures (toy figure, 128²: +0.5 dB).
const FLAT: [f64; 2] = [0.1, 1e-3];
/// Samples that a texel needs before coordinates are refined for what a model's own texture leaves:
/// with fewer, a texture can please each of them wherever it falls.
const SAMPLES_PER_TEXEL: usize = 2;
/// A moved layout must be better than the one before by this much.
const WORTH_IT: f64 = 0.98;
/// Width of the barrier between charts: the paper's 5 texels would keep packed charts from
/// moving at all, and half a texel is enough to not run into them.
const ACTIVATION_TEXELS: f64 = 0.5;

/// None where no better one was found.
pub fn moved(
    mesh: &Mesh,
    source: &Source,
    asked: &UnfoldOptions,
    report: &mut UnfoldReport,
    watcher: &impl Watcher,
) -> Option<Moved> {
    let start = &Layout::new(mesh);
    let showings = signal(mesh, start, source, asked.texture_size)?;
    let contact = contact(asked, ACTIVATION_TEXELS);
    let problem = &Problem {
        rest: &start.rest,
        showings: &showings,
        texture_size: told_apart(asked.texture_size, showings[0].samples.len()),
        contact: &contact,
    };
    let most_steps = (SHAPE_WORK / mesh.triangles.len().max(1)).clamp(LEAST_SHAPE_STEPS, MOST_SHAPE_STEPS);
    let shape_steps = most_steps.min(10 * asked.steps);
    let own = source.surface.is_none();
    let refine_by = if own { RefineBy::Stiffness } else { RefineBy::Laplacian };
    let options = &UvOptions { refine_steps: asked.steps, shape_steps, refine_by, ..UvOptions::default() };
    // A low-poly's texture is fitted to views, which reads its first level alone.
    let judge = &Judge::new(problem, start, own);
    let tensors = &tensors(problem, start);
    let unmoved = judge.kept.len() as f64;
    let packed = packed(problem, start, &packing(asked), tensors)
        .map(|packed| (judge.total(&packed), packed))
        .filter(|(left, _)| *left < unmoved);
    let is_packed = packed.is_some();
    let (left, mut layout) = packed.unwrap_or_else(|| (unmoved, start.clone()));
    let mut frames = vec![as_f32(&start.points), as_f32(&layout.points)];
    let most = options.refine_steps + FLAT.len() * options.shape_steps;
    let steps = &mut Steps { done: 0, most, watcher };
    frames.extend(shaped(judge, &mut layout, left, tensors, options, steps));
    let (layout, relative) = refined(judge, start, layout, options, &mut frames, steps)?;
    report.packed |= is_packed;
    report.steps = frames.len() - 2;
    report.relative_error = relative;
    Some(Moved { layout, frames })
}

/// Texels along a side of the texture that layouts are judged by: halved until every other of its texels
/// has a sample, for finer ones could show so few samples in any layout.
fn told_apart(texture_size: usize, samples: usize) -> usize {
    let mut size = texture_size;
    while 2 * samples < size * size && size.is_multiple_of(2) {
        size /= 2;
    }
    size
}

/// How much worse or better layouts show the surface than the one that was given.
struct Judge<'a> {
    problem: &'a Problem<'a>,
    /// Whether textures are judged at all their mip levels.
    all_sizes: bool,
    /// The given layout's error by showing: at full size, half and so on.
    kept: Vec<f64>,
}

impl<'a> Judge<'a> {
    fn new(problem: &'a Problem<'a>, start: &Layout, all_sizes: bool) -> Self {
        Self { problem, all_sizes, kept: errors(problem, start, all_sizes) }
    }

    /// Errors as shares of those of the given layout.
    fn relative(&self, layout: &Layout) -> Vec<f64> {
        let errors = errors(self.problem, layout, self.all_sizes);
        errors.iter().zip(&self.kept).map(|(a, b)| a / b.max(1e-12)).collect()
    }

    /// The error that counts is that of all sizes.
    fn total(&self, layout: &Layout) -> f64 {
        self.relative(layout).iter().sum()
    }
}

/// How far along the way is.
struct Steps<'a, W> {
    done: usize,
    most: usize,
    watcher: &'a W,
}

impl<W: Watcher> Steps<'_, W> {
    /// Notes a step; false to stop.
    fn step(&mut self, way: &mut Vec<Vec<Vec2>>, points: &[DVec2]) -> bool {
        way.push(as_f32(points));
        self.done = self.most.min(self.done + 1);
        self.watcher.message(Message::Progress { stage: Stage::Unfold, done: self.done, total: self.most });
        !self.watcher.stopped()
    }
}

/// Moves the layout, which leaves this error in total, to the better one of the signal-specialised
/// starts, and returns the way there. The start is a guess: how plain the plain is depends on the
/// texture's size, and where both guesses are bad, none is better.
fn shaped<W: Watcher>(
    judge: &Judge,
    layout: &mut Layout,
    mut least: f64,
    tensors: &[DMat2],
    options: &UvOptions,
    steps: &mut Steps<W>,
) -> Vec<Vec<Vec2>> {
    let (before, mut shaped) = (layout.clone(), Vec::new());
    for flat in FLAT {
        let (mut guess, mut way) = (before.clone(), Vec::new());
        let own = UvOptions { flat, ..*options };
        shape(judge.problem, &mut guess, tensors, &own, |points, _| steps.step(&mut way, points));
        let left = judge.total(&guess);
        if left < least {
            (*layout, least, shaped) = (guess, left, way);
        }
        if steps.watcher.stopped() {
            break;
        }
    }
    shaped
}

/// Refines the layout by variable projection, in turns after each of which showings are weighted anew. The best
/// of the turns' layouts that are better than `start` at each size, and its errors as shares of
/// those of `start`.
fn refined<W: Watcher>(
    judge: &Judge,
    start: &Layout,
    mut layout: Layout,
    options: &UvOptions,
    frames: &mut Vec<Vec<Vec2>>,
    steps: &mut Steps<W>,
) -> Option<(Layout, Vec<f64>)> {
    // A bake's last thousandths lie in parallax and outlines, not in coordinates.
    let (tolerance, solve, minified, hopeless) = if judge.all_sizes {
        (options.tolerance, options.solve, 1.0, f64::INFINITY)
    } else {
        (1e-3, Solve::ROUGH, MINIFIED, MINIFIED + HOPELESS)
    };
    let is_sound =
        |relative: &[f64]| relative[0] < WORTH_IT && relative[1..].iter().all(|error| *error < minified);
    let problem = judge.problem;
    let texels = problem.texture_size * problem.texture_size;
    if judge.all_sizes && problem.showings[0].samples.len() < SAMPLES_PER_TEXEL * texels {
        let relative = judge.relative(&layout);
        return is_sound(&relative).then_some((layout, relative));
    }
    let turn = UvOptions { refine_steps: options.refine_steps.div_ceil(TURNS), tolerance, solve, ..*options };
    let (mut balance, mut texture) = Balance::new(problem, start);
    // Views see a surface under all angles: half of it is minified.
    balance.weights.fill(1.0);
    let mut best: Option<(f64, Layout, Vec<f64>)> = None;
    for _ in 0..TURNS {
        let found =
            refine(problem, &balance, &mut layout, texture, &turn, |points, _| steps.step(frames, points));
        texture = found.texture;
        let relative = judge.relative(&layout);
        // By what the texture that will be solved for leaves.
        balance.update(&relative);
        let lost = relative[1..].iter().any(|error| *error > hopeless);
        let sum: f64 = relative.iter().sum();
        if is_sound(&relative) && best.as_ref().is_none_or(|(least, ..)| sum < *least) {
            best = Some((sum, layout.clone(), relative));
        }
        if steps.watcher.stopped() || lost {
            break;
        }
    }
    best.map(|(_, layout, relative)| (layout, relative))
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
