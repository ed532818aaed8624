//! The default method on a low-poly's texture coordinates (`crate::optimise`).
//!
//! ```text
//! as it is ───────────────┬ the better one (layout_score.rs) ─ shape ─ refine (refined.rs)
//! packed, charts scaled ──┘
//! ```
//!
//! Contract: a moved layout is as sound as the one before, and shows the surface better.

use super::layout_score::LayoutScore;
use super::refined::{Begun, Limits, refined};
use super::steps::Steps;
use super::surface_samples::Source;
use super::{Moved, UvStageOptions, UvStageReport, as_f32, contact, packing, signal};
use crate::metric::chart_scales;
use crate::optimise::{Problem, RefineBy, UvOptions, shape, tensors};
use parbake_atlas::{ChartScale, Layout, PackOptions, pack};
use parbake_model::Mesh;
use parbake_model::glam::{DMat2, Vec2};
use parbake_progress::Watcher;

/// Charts are drawn at most so many times larger or smaller than their area says.
const MOST_SCALE: f64 = 3.0;
/// Packing leaves so many texels more than the gutter: charts that touch cannot turn.
const ROOM: f64 = 0.25;
/// Steps of the start times triangles at most, a second or so: charts by the dozen need a hundred
/// steps to fill their square, and a step is Newton's, 4 µs a triangle…
const SHAPE_WORK: usize = 250_000;
/// …but so many steps at least, for meshes of any size, and never more than so many.
const LEAST_SHAPE_STEPS: usize = 20;
const MOST_SHAPE_STEPS: usize = 200;
/// What a triangle without signal weighs in the start: what surfaces of all kinds like, and what suits
/// plainly coloured parts with small textures (toy figure, 128²: +0.5 dB).
const FLAT: [f64; 2] = [0.1, 1e-3];
/// Width of the barrier between charts: the paper's 5 texels would keep packed charts from
/// moving at all, and half a texel is enough to not run into them.
const ACTIVATION_TEXELS: f64 = 0.5;

/// Texels of the texture for each triangle below which they are scarce: with 75, refinement takes up to 6 % off the error.
/// With 260 it takes 5 % off at most, and the PSNR of six bakes changes by 0.007 dB at most.
const SCARCE: usize = 80;

/// None where no better one was found.
pub fn moved(
    mesh: &Mesh,
    source: &Source,
    asked: &UvStageOptions,
    report: &mut UvStageReport,
    watcher: &dyn Watcher,
) -> Option<Moved> {
    if watcher.stopped() {
        return None;
    }
    let start = &Layout::new(mesh);
    let signal_scales = signal(mesh, start, source, asked.texture_size)?;
    let contact = contact(asked, ACTIVATION_TEXELS);
    let problem = &Problem {
        rest: &start.rest,
        signal_scales: &signal_scales,
        texture_size: told_apart(asked.texture_size, signal_scales[0].samples.len()),
        contact: &contact,
    };
    let most_steps = (SHAPE_WORK / mesh.triangles.len().max(1)).clamp(LEAST_SHAPE_STEPS, MOST_SHAPE_STEPS);
    let shape_steps = most_steps.min(10 * asked.steps);
    let own = source.surface.is_none();
    let refine_by = if own { RefineBy::Stiffness } else { RefineBy::Laplacian };
    let refine_steps = if own { asked.steps } else { worthwhile_steps(asked, mesh.triangles.len()) };
    let options = &UvOptions { refine_steps, shape_steps, refine_by, ..UvOptions::default() };
    let score = &LayoutScore::new(mesh, start, problem, own, asked.gutter_required.then_some(asked.gutter));
    let tensors = &tensors(problem, start);
    let limits = &Limits::new(own);
    let unmoved = vec![1.0; score.kept.len()];
    if watcher.stopped() {
        return None;
    }
    let packed = packed(problem, start, &packing(asked), tensors)
        .map(|packed| (score.relative(problem, &packed), packed))
        .filter(|(errors, _)| rank(errors, limits) < rank(&unmoved, limits));
    let is_packed = packed.is_some();
    let (mut errors, mut layout) = packed.unwrap_or_else(|| (unmoved, start.clone()));
    let mut frames = vec![as_f32(&start.points), as_f32(&layout.points)];
    let most = options.refine_steps + FLAT.len() * options.shape_steps;
    let steps = &Steps::new(most, mesh, start, watcher);
    frames.extend(shaped((score, limits), &mut layout, &mut errors, tensors, options, steps));
    let before_refining = frames.len();
    let more_triangles = if own { asked.more_triangles } else { 0 };
    let begun = Begun { layout, errors, way: frames };
    let (moved, relative) = refined(score, begun, options, more_triangles, steps)?;
    report.packed |= is_packed;
    report.steps = moved.frames.len().saturating_sub(before_refining);
    report.relative_error = relative;
    Some(moved)
}

/// Steps in which a low-poly of so many triangles is refined.
fn worthwhile_steps(asked: &UvStageOptions, triangles: usize) -> usize {
    let is_scarce = asked.texture_size * asked.texture_size < SCARCE * triangles;
    if is_scarce || !asked.refines_scarce_only { asked.steps } else { 0 }
}

/// Texels along a side of the texture that layouts are judged by: halved until every other of its texels
/// has a sample, for finer ones could show so few samples in any layout; never fewer than four.
fn told_apart(texture_size: usize, samples: usize) -> usize {
    let mut size = texture_size;
    while 2 * samples < size * size && size.is_multiple_of(2) && size >= 8 {
        size /= 2;
    }
    size
}

/// Orders layouts to begin with, the best one first: those that refinement can make good, then by the error of all sizes.
fn rank(errors: &[f64], limits: &Limits) -> (bool, f64) {
    (limits.is_lost_from_the_start(errors), errors.iter().sum())
}

/// Moves the layout, which leaves these errors, to the better one of the signal-specialised
/// starts, and returns the way there. The start is a guess: how plain the plain is depends on the
/// texture's size, and where both guesses are bad, none is better.
fn shaped(
    (score, limits): (&LayoutScore, &Limits),
    layout: &mut Layout,
    least: &mut Vec<f64>,
    tensors: &[DMat2],
    options: &UvOptions,
    steps: &Steps,
) -> Vec<Vec<Vec2>> {
    let before = layout.clone();
    let guess = |flat: f64, is_told: bool| {
        let (mut guess, mut way) = (before.clone(), Vec::new());
        let own = UvOptions { flat, ..*options };
        let mut descent = steps.descent(is_told);
        shape(score.problem, &mut guess, tensors, &own, |points, loss| descent.step(&mut way, points, loss));
        let errors = score.relative(score.problem, &guess);
        (guess, errors, way)
    };
    // Much of a descent is the factorisation of one matrix, on one core.
    let [one, other] = FLAT;
    let guesses: [_; 2] = rayon::join(|| guess(one, true), || guess(other, false)).into();
    let mut shaped = Vec::new();
    for (guess, errors, way) in guesses {
        if rank(&errors, limits) < rank(least, limits) && score.is_sound(&guess) {
            (*layout, *least, shaped) = (guess, errors, way);
        }
    }
    shaped
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mode::{Method, UvMode};
    use crate::paper::Guide;

    /// Protects time where texels abound, coordinates where they do not, and who asks for steps.
    #[test]
    fn coordinates_are_refined_where_texels_are_scarce() {
        let asked = UvStageOptions {
            mode: UvMode::Optimize,
            method: Method::Fit,
            guide: Guide::ContentAware,
            texture_size: 512,
            gutter: 1.0,
            gutter_required: false,
            parallax_size: None,
            smallest_mip: None,
            steps: 10,
            refines_scarce_only: true,
            more_triangles: 0,
        };
        assert_eq!([1000, 3276, 3277].map(|triangles| worthwhile_steps(&asked, triangles)), [0, 0, 10]);
        assert_eq!(worthwhile_steps(&UvStageOptions { refines_scarce_only: false, ..asked }, 1000), 10);
    }
}
