//! The same number of triangles, better placed: points move, edges flip, and triangles go from where they show
//! nothing to where the error is.
//!
//! Every trial is a change (`change.rs`) that is judged by the pictures. A sweep evaluates all trials against one
//! state, on all cores, then makes them in the order of their gains, each only if it still gains.
//!
//! Sweeps look from several sets of views in turn: moved by one set alone, points come to lie where its pixels do not
//! see what is wrong.
//!
//! Contract: the number of triangles never grows, nor, with one set of views, the error. Deterministic, unless the watcher
//! has no seconds left.

use crate::change::Change;
use crate::collapse::{collapse_to, least_squares};
use crate::pictures::Pictures;
use crate::surface::Surface;
use crate::target::Target;
use glam::Vec3;
use parbake_progress::{Muted, Snapshot, Stage, Watcher};
use parbake_render::interpolate::interpolate;
use parbake_views::high_poly::HighPoly;
use rayon::prelude::*;

/// How much is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolishOptions {
    /// Times that triangles are exchanged.
    pub rounds: usize,
    /// Sweeps over all points in each round; three times as many at the beginning and at the end.
    pub sweeps: usize,
    /// Share of the triangles that the first round exchanges at most; later rounds fewer.
    pub exchanged: f64,
}

impl Default for PolishOptions {
    fn default() -> Self {
        Self { rounds: 8, sweeps: 2, exchanged: 0.12 }
    }
}

/// Rounds in a row without a gain after which no more follow.
const PATIENCE: usize = 3;

/// Polishes a surface. `high` is what new points are put on. Each sweep looks from the next of the `sets` of views; the surface
/// was looked at from set `first` so far.
pub fn polish<'a>(
    pictures: &mut Pictures<'a>,
    sets: &'a [Vec<Target>],
    first: usize,
    high: &HighPoly,
    options: &PolishOptions,
    watcher: &dyn Watcher,
) {
    let target = pictures.surface.count();
    let mut steps = Steps::default();
    let mut sets = Sets { sets, next: first };
    show(pictures, watcher);
    settle(pictures, &mut sets, &mut steps, 3 * options.sweeps, watcher);
    let mut without = 0;
    for round in 0..options.rounds {
        watcher.progress(Stage::Simplify, round + 1, options.rounds + 2);
        show(pictures, watcher);
        if is_over(watcher) || without == PATIENCE {
            break;
        }
        let left = 1.0 - round as f64 / options.rounds as f64;
        let count = ((options.exchanged * left * target as f64) as usize).max(1);
        let (mut trial, mut own) = (pictures.clone(), steps.clone());
        split_worst(&mut trial, high, count);
        settle(&mut trial, &mut sets, &mut own, 1, watcher);
        collapse_to(&mut trial, target, &Muted(watcher));
        settle(&mut trial, &mut sets, &mut own, options.sweeps, watcher);
        // Judged from where neither was fitted to last.
        let views = sets.next();
        pictures.look_from(views);
        trial.look_from(views);
        if trial.error() < pictures.error() && trial.surface.count() <= target {
            (*pictures, steps) = (trial, own);
            without = 0;
        } else {
            without += 1;
        }
    }
    settle(pictures, &mut sets, &mut steps, 3 * options.sweeps, watcher);
}

fn show(pictures: &Pictures, watcher: &dyn Watcher) {
    if watcher.wants_snapshot() {
        watcher.snapshot(Snapshot::Surface { mesh: pictures.surface.to_mesh(), color: None });
    }
}

/// Sets of views that take turns, so that points do not settle on the pixels of one.
struct Sets<'a> {
    sets: &'a [Vec<Target>],
    next: usize,
}

impl<'a> Sets<'a> {
    fn next(&mut self) -> &'a [Target] {
        self.next += 1;
        &self.sets[self.next % self.sets.len()]
    }
}

/// Whether to go no further: what there is may be kept at any time, so an end of time that is known ends it too.
pub(crate) fn is_over(watcher: &dyn Watcher) -> bool {
    watcher.stopped() || watcher.seconds_left().is_some_and(|left| left <= 0.0)
}

/// How far each point goes at a time (a pattern search with a step of its own for each point): farther after a
/// gain, less far after none.
#[derive(Clone, Debug, Default)]
struct Steps {
    of_point: Vec<f32>,
    sweeps: u64,
}

/// First step of a point, as a share of the mean length of its edges.
const FIRST_STEP: f32 = 0.25;
/// Steps that are shorter than this show nothing.
const LEAST_STEP: f32 = 0.01;

impl Steps {
    fn of(&self, point: u32) -> f32 {
        self.of_point.get(point as usize).copied().unwrap_or(FIRST_STEP)
    }

    fn note(&mut self, points: &[u32], before: &[Vec3], surface: &Surface) {
        self.of_point.resize(surface.points.len(), FIRST_STEP);
        for (&point, &before) in points.iter().zip(before) {
            let has_moved = surface.points[point as usize] != before;
            let step = &mut self.of_point[point as usize];
            *step =
                if has_moved { (1.3 * *step).min(2.0 * FIRST_STEP) } else { (0.55 * *step).max(LEAST_STEP) };
        }
        self.sweeps += 1;
    }
}

/// Moves points and flips edges.
fn settle<'a>(
    pictures: &mut Pictures<'a>,
    sets: &mut Sets<'a>,
    steps: &mut Steps,
    sweeps: usize,
    watcher: &dyn Watcher,
) {
    for _ in 0..sweeps {
        if is_over(watcher) {
            return;
        }
        pictures.look_from(sets.next());
        let points = points(&pictures.surface);
        let before: Vec<Vec3> = points.iter().map(|&point| pictures.surface.points[point as usize]).collect();
        sweep(pictures, points.clone(), |surface, &point| {
            moves(surface, point, steps.of(point), steps.sweeps)
        });
        steps.note(&points, &before, &pictures.surface);
        if steps.sweeps.is_multiple_of(2) {
            let flips =
                |surface: &Surface, &[a, b]: &[u32; 2]| Change::flip(surface, a, b).into_iter().collect();
            sweep(pictures, pictures.surface.edges(), flips);
        }
    }
}

fn points(surface: &Surface) -> Vec<u32> {
    (0..surface.points.len() as u32).filter(|&point| !surface.around(point).is_empty()).collect()
}

/// Trials of all places, then the best of each, in the order of gains.
fn sweep<T: Sync + Send>(
    pictures: &mut Pictures,
    places: Vec<T>,
    trials: impl Fn(&Surface, &T) -> Vec<Change> + Sync,
) {
    let of_all = places.par_iter().map(|place| trials(&pictures.surface, place)).collect();
    let best = pictures.best_of_each(of_all).into_iter().enumerate();
    let with_index = |(index, best): (usize, Option<(f64, Change)>)| {
        best.filter(|(gain, _)| *gain > 0.0).map(|(gain, change)| (gain, index, change))
    };
    let mut order: Vec<(f64, usize, Change)> = best.filter_map(with_index).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut is_changed = vec![false; pictures.surface.points.len()];
    for (_, index, change) in order {
        let points = |change: &Change, surface: &Surface| -> Vec<u32> {
            change.removed.iter().filter_map(|&t| surface.get(t)).flat_map(|t| t.corners).collect()
        };
        let around = points(&change, &pictures.surface);
        let is_stale =
            around.len() < 3 * change.removed.len() || around.iter().any(|&p| is_changed[p as usize]);
        let change = if is_stale {
            let trials = trials(&pictures.surface, &places[index]);
            pictures.best_of(trials).filter(|(gain, _)| *gain > 0.0).map(|best| best.1)
        } else {
            Some(change)
        };
        if let Some(change) = change {
            points(&change, &pictures.surface)
                .into_iter()
                .for_each(|point| is_changed[point as usize] = true);
            pictures.apply(&change);
        }
    }
}

/// Where a point may go: along its normal and across, in other directions in each sweep, and to where the planes
/// around it meet.
fn moves(surface: &Surface, point: u32, step: f32, sweep: u64) -> Vec<Change> {
    let at = surface.points[point as usize];
    let neighbours = surface.neighbours(point);
    let mean = neighbours.iter().map(|&other| surface.points[other as usize].distance(at)).sum::<f32>()
        / neighbours.len().max(1) as f32;
    let around =
        || surface.around(point).iter().filter_map(|&t| surface.get(t)).map(|t| surface.corners(t.corners));
    let normal: Vec3 = around().map(|[a, b, c]| (b - a).cross(c - a)).sum();
    let normal = normal.normalize_or(Vec3::Z);
    let (x, y) = normal.any_orthonormal_pair();
    // Golden angles never repeat.
    let (sin, cos) = (2.4 * sweep as f32 + point as f32).sin_cos();
    let (across, along) = (cos * x + sin * y, cos * y - sin * x);
    let ways = [normal, -normal, across, -across, along, -along];
    let places = ways.into_iter().map(|way| at + way * (step * mean));
    let meet = least_squares(around(), at).filter(|place| place.distance(at) < mean);
    places.chain(meet).filter_map(|place| Change::shift(surface, point, place)).collect()
}

/// Splits the edges from which most is to be hoped, until at least `count` triangles came.
fn split_worst(pictures: &mut Pictures, high: &HighPoly, count: usize) {
    let edges = pictures.surface.edges();
    let trials = |surface: &Surface, &[a, b]: &[u32; 2]| -> Vec<Change> {
        let [p, q] = [a, b].map(|point| surface.points[point as usize]);
        let middle = 0.5 * (p + q);
        let reach = 0.5 * p.distance(q);
        let on_high = closest(high, middle, reach);
        [Some(middle), on_high]
            .into_iter()
            .flatten()
            .filter_map(|at| Change::split(surface, a, b, at))
            .collect()
    };
    let errors = pictures.errors_by_triangle();
    let of_all = edges.par_iter().map(|edge| trials(&pictures.surface, edge)).collect();
    let best = pictures.best_of_each(of_all).into_iter().enumerate();
    let with_hope = |(index, best): (usize, Option<(f64, Change)>)| {
        let (gain, change) = best?;
        // What is wrong there may be mended once the new point has moved.
        let hope: f64 = change.removed.iter().map(|&t| errors[t as usize]).sum();
        Some((gain + 0.1 * hope / pictures.pixels(), index))
    };
    let mut order: Vec<(f64, usize)> = best.filter_map(with_hope).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut added = 0;
    for (_, index) in order {
        if added >= count {
            break;
        }
        let [a, b] = edges[index];
        if pictures.surface.at_edge(a, b).is_empty() {
            continue;
        }
        if let Some((_, change)) = pictures.best_of(trials(&pictures.surface, &edges[index])) {
            added += change.added.len() - change.removed.len();
            pictures.apply(&change);
        }
    }
}

/// The nearest point of the high-poly within a distance.
fn closest(high: &HighPoly, point: Vec3, reach: f32) -> Option<Vec3> {
    let hit = high.surface.closest(point, reach)?;
    let [second, third] = hit.barycentric;
    Some(interpolate(high.scene.mesh().corners(hit.triangle as usize), [1.0 - second - third, second, third]))
}
