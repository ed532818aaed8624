//! The paper's method on a low-poly's texture coordinates (`crate::paper`): from the
//! repaired layout as it is, with the paper's weights for models. Only the coordinates are
//! taken from it; textures are then fitted to views as after the default method.
//!
//! The energy's scale is s = pixel · texture size, a pixel being as wide as in a picture that
//! the model fills: a triangle is at rest where it has as many texels as pixels, so triangles
//! with errors grow until then. A layout with more texels than that would shrink; there s is
//! such that the layout as a whole is at rest.
//!
//! The method itself looks at pictures of one size. Left alone it grows what has errors until the
//! rest is minified to a blur, which a shift of coordinates that is fitted afterwards takes for
//! depth (1.5 to 3 dB on a plain skin). So the round is chosen at two sizes.
//!
//! Contract: of the rounds that were looked at the one that shows the surface best at full size, of
//! those that do not show it worse at half; as sound as the layout before, which stays where no round
//! is better.

use super::surface_samples::Source;
use super::{Moved, UvStageOptions, UvStageReport, as_f32, contact, errors, signal};
use crate::distortion::total_area;
use crate::least_squares_texture::ParameterizedSignal;
use crate::optimise::Problem;
use crate::paper::{PaperOptions, paper_method};
use crate::region::Feasible;
use crate::triangle_batches::TriangleBatches;
use parbake_atlas::Layout;
use parbake_model::Mesh;
use parbake_model::glam::DVec2;
use parbake_progress::{Message, Snapshot, Stage, Watcher};

/// Rounds between two frames of an animation.
const FRAME_ROUNDS: usize = 10;

/// Rounds between two that are looked at.
const JUDGED_ROUNDS: usize = 40;

/// Minified, a round may be worse than the start by this much: what eight bits do not show.
const MINIFIED: f64 = 1.01;

/// None where nothing of the surface is seen.
pub fn moved(
    mesh: &Mesh,
    source: &Source,
    asked: &UvStageOptions,
    report: &mut UvStageReport,
    watcher: &dyn Watcher,
) -> Option<Moved> {
    let start = Layout::new(mesh);
    let signal_scales = signal(mesh, &start, source, asked.texture_size)?;
    let own = PaperOptions {
        rounds: asked.steps,
        guide: asked.guide,
        scale: scale(&start, asked.texture_size),
        ..PaperOptions::default()
    };
    let contact = contact(asked, own.contact_texels);
    let problem = Problem {
        rest: &start.rest,
        signal_scales: &signal_scales,
        texture_size: asked.texture_size,
        contact: &contact,
    };
    let region = Feasible::new(&start, &contact);
    let runs = TriangleBatches::new(&start.points, &start.triangles, &signal_scales[0]);
    let mapped = ParameterizedSignal {
        points: &start.points,
        triangles: &start.triangles,
        signal_scales: &signal_scales[..1],
        runs: &runs,
    };
    let mut frames = vec![as_f32(&start.points)];
    let kept = errors(&problem, &start, false);
    let relative = |points: &[DVec2]| -> Vec<f64> {
        let layout = Layout { points: points.to_vec(), ..start.clone() };
        errors(&problem, &layout, false).iter().zip(&kept).map(|(a, b)| a / b.max(1e-12)).collect()
    };
    let mut best = (vec![1.0; kept.len()], start.points.clone());
    let mut score = |points: &[DVec2]| {
        let found = relative(points);
        if found[0] < best.0[0] && found[1..].iter().all(|r| *r < MINIFIED) {
            best = (found, points.to_vec());
        }
    };
    let (barrier, total) = (Some(region.contact()), own.rounds);
    let found = paper_method(&mapped, &start.rest, asked.texture_size, &region, barrier, &own, |progress| {
        if progress.round.is_multiple_of(FRAME_ROUNDS) {
            frames.push(as_f32(progress.points));
        }
        if progress.round.is_multiple_of(JUDGED_ROUNDS) {
            score(progress.points);
        }
        watcher.message(Message::Progress { stage: Stage::Uv, done: progress.round, total });
        if watcher.wants_snapshot() {
            let layout = Layout { points: progress.points.to_vec(), ..start.clone() };
            let mesh = Mesh { uvs: layout.uvs(), ..mesh.clone() };
            watcher.snapshot(Snapshot::Surface { mesh, color: None });
        }
        !watcher.stopped()
    });
    score(&found.points);
    let (relative, points) = best;
    frames.push(as_f32(&points));
    let layout = Layout { points, ..start.clone() };
    report.steps = found.rounds;
    report.convergence = Some(found.history.into());
    report.relative_error = relative;
    Some(Moved { layout, frames, bisected: None })
}

/// s for rest shapes in units of the common frame, as said above.
fn scale(start: &Layout, texture_size: usize) -> f64 {
    let drawn: f64 = (0..start.triangles.len()).map(|t| 0.5 * start.doubled_area(t).max(0.0)).sum();
    let at_rest = (total_area(&start.rest) / drawn.max(f64::MIN_POSITIVE)).sqrt();
    (Source::PIXEL * texture_size as f64).min(at_rest)
}
