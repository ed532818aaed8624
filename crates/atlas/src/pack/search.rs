//! The search for the largest scale at which all pieces find a place.
//!
//! One attempt puts the pieces down one after the other, in the order of a plan and each at the best place by its preference.
//!
//! ```text
//! coarse grid    the first plan alone, at several scales at once: the largest that fits
//! finer grids    the same, from there on upwards: on finer cells pieces lie closer
//! finest grid    all plans, a little larger each time: a piece that found no place moves forward in the order
//! ```
//!
//! The last is a "squeaky wheel" (Joslin and Clements 1999). Where a scale is well below the largest nearly every plan
//! fits, so one is enough to find it. Attempts are counted, not timed, and results of cancelled ones are dropped, so that
//! the result does not depend on timing.

use super::board::{Board, Place, Preference};
use super::mask::{Mask, Shape, TOUCH};
use super::pieces::Piece;
use super::polygon::bounds;
use glam::{DVec2, dvec2};
use rayon::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How the pieces are put down.
#[derive(Clone)]
struct Plan {
    order: Vec<usize>,
    preference: Preference,
}

/// Where pieces lie: for each the x axis it was turned to and the lower corner of its
/// box, in parts of the square.
pub(super) struct Arrangement {
    pub scale: f64,
    pub axes: Vec<DVec2>,
    pub corners: Vec<DVec2>,
}

/// The square that is packed.
#[derive(Clone, Copy)]
pub(super) struct Square {
    /// Cells along a side.
    pub cells: usize,
    /// Gutter in parts of the side.
    pub gutter: f64,
    /// Whether quarter turns are allowed.
    pub rotate: bool,
}

/// Scales below this are given up.
const LEAST_SCALE: f64 = 1e-6;
/// Scales at which one plan is tried side by side.
const AT_ONCE: i32 = 4;
/// From one scale to the next, as a share of it: where nothing is known yet, and from one grid to the next.
const COARSE_STEP: f64 = 0.1;
const FINE_STEP: f64 = 0.02;
/// The same in the search with all plans: the first one, by what it shrinks where none fits, and the least.
const FIRST_STEP: f64 = 0.015;
const SHRINK: f64 = 0.8;
const LAST_STEP: f64 = 0.001;

/// The best arrangement found, or `None` where none fits at any scale. `squares` go from coarse to fine.
pub(super) fn search(pieces: &[Piece], squares: &[Square], effort: usize) -> Option<Arrangement> {
    let (coarsest, finer) = squares.split_first()?;
    let finest = finer.last().unwrap_or(coarsest);
    let mut plans = plans(pieces);
    let mut best = first_fit(pieces, *coarsest, &mut plans)?;
    for square in finer {
        loop {
            let scale = best.scale;
            let larger = |k: i32| scale * (1.0 + FINE_STEP * f64::from(k));
            best = largest(pieces, *square, &plans[0], larger).unwrap_or(best);
            if best.scale < larger(AT_ONCE) {
                break;
            }
        }
    }
    let mut step = FIRST_STEP;
    for _ in 0..rounds(pieces.len(), effort) {
        if step < LAST_STEP {
            break;
        }
        match try_all(pieces, best.scale * (1.0 + step), *finest, &mut plans) {
            Some(found) => best = found,
            None => step *= SHRINK,
        }
    }
    Some(best)
}

/// Rounds of attempts that a number of pieces is worth.
fn rounds(count: usize, effort: usize) -> usize {
    effort * (1600 / count.max(1)).clamp(5, 32)
}

/// An arrangement on the coarse grid whose scale is not much below the largest.
fn first_fit(pieces: &[Piece], square: Square, plans: &mut [Plan]) -> Option<Arrangement> {
    let mut high = 1.0 / (1.0 - COARSE_STEP);
    while high > LEAST_SCALE {
        let scale = |k: i32| high * (1.0 - COARSE_STEP).powi(AT_ONCE + 1 - k);
        if let Some(found) = largest(pieces, square, &plans[0], scale) {
            let between = |k: i32| found.scale * (1.0 + FINE_STEP * f64::from(k));
            return largest(pieces, square, &plans[0], between).or(Some(found));
        }
        high = scale(1);
    }
    // Where gutters alone nearly fill the square, other orders may fit.
    let mut scale = 1.0;
    while scale > LEAST_SCALE {
        if let Some(found) = try_all(pieces, scale, square, plans) {
            return Some(found);
        }
        scale *= 1.0 - COARSE_STEP;
    }
    None
}

/// One plan at the scales that `scale` gives for 1 to [`AT_ONCE`], ascending, side by side: the largest that fits.
fn largest(
    pieces: &[Piece],
    square: Square,
    plan: &Plan,
    scale: impl Fn(i32) -> f64 + Sync,
) -> Option<Arrangement> {
    let descending: Vec<i32> = (1..=AT_ONCE).rev().collect();
    let found = first_fitting(&descending, |_, &k, is_cancelled| {
        Sheet::new(pieces, scale(k), square)?.attempt(plan, is_cancelled).ok()
    });
    found.map(|(_, found)| found)
}

/// Tries all plans at a scale. The first one that fits counts, and comes first from then on; those before it learn from
/// their failure.
fn try_all(pieces: &[Piece], scale: f64, square: Square, plans: &mut [Plan]) -> Option<Arrangement> {
    let sheet = Sheet::new(pieces, scale, square)?;
    let failed: Vec<OnceLock<usize>> = plans.iter().map(|_| OnceLock::new()).collect();
    let fitted = first_fitting(plans, |index, plan, is_cancelled| {
        let result = sheet.attempt(plan, is_cancelled);
        result.map_err(|position| failed[index].get_or_init(|| position)).ok()
    });
    let learning = fitted.as_ref().map_or(plans.len(), |(index, _)| *index);
    for (plan, failed) in plans.iter_mut().zip(&failed).take(learning) {
        if let Some(&position) = failed.get() {
            promote(&mut plan.order, position);
        }
    }
    fitted.map(|(index, found)| {
        plans[..=index].rotate_right(1);
        found
    })
}

/// The first item by whose attempt all pieces fit, and its index. All are attempted side by side; attempts after one that
/// fitted are cancelled.
fn first_fitting<T: Sync>(
    items: &[T],
    attempt: impl Fn(usize, &T, &dyn Fn() -> bool) -> Option<Arrangement> + Sync,
) -> Option<(usize, Arrangement)> {
    let first = AtomicUsize::new(usize::MAX);
    items.par_iter().enumerate().find_map_first(|(index, item)| {
        let found = attempt(index, item, &|| first.load(Ordering::Relaxed) < index)?;
        first.fetch_min(index, Ordering::Relaxed);
        Some((index, found))
    })
}

/// Orders to begin with: by area, by the longer side, by the outline's length.
fn plans(pieces: &[Piece]) -> Vec<Plan> {
    let by = |key: &dyn Fn(&Piece) -> f64| {
        let keys: Vec<f64> = pieces.iter().map(key).collect();
        let mut order: Vec<usize> = (0..pieces.len()).collect();
        order.sort_by(|&a, &b| keys[b].total_cmp(&keys[a]));
        order
    };
    let longest = |piece: &Piece| {
        let (low, high) = bounds(piece.placed(1.0, piece.directions[0]).into_iter());
        (high - low).max_element()
    };
    let length = |piece: &Piece| {
        piece.outline.iter().map(|e| piece.points[e[0] as usize].distance(piece.points[e[1] as usize])).sum()
    };
    let mut orders = vec![by(&|p| p.area), by(&longest), by(&length)];
    orders.dedup();
    let preferences = [Preference::Bottom, Preference::Corner, Preference::Centre];
    let mut plans = Vec::new();
    for (i, order) in orders.iter().enumerate() {
        for (k, &preference) in preferences.iter().enumerate() {
            if i == 0 || k == 0 || pieces.len() <= 64 {
                plans.push(Plan { order: order.clone(), preference });
            }
        }
    }
    plans
}

/// Moves a piece that found no place forward, by half its way to the front.
fn promote(order: &mut [usize], failed: usize) {
    let target = failed / 2;
    order[target..=failed].rotate_right(1);
}

/// All pieces as masks at one scale, shared by the attempts at that scale.
struct Sheet<'a> {
    pieces: &'a [Piece],
    scale: f64,
    square: Square,
    /// For each piece its turns.
    turns: Vec<Vec<Turn>>,
}

/// A piece turned: the cells that it touches and, once it is needed, those in its gutter.
struct Turn {
    axis: DVec2,
    solid: Mask,
    grown: OnceLock<Mask>,
}

impl<'a> Sheet<'a> {
    /// `None` where the areas alone, or one piece in all its turns, are too much.
    fn new(pieces: &'a [Piece], scale: f64, square: Square) -> Option<Self> {
        let area: f64 = pieces.iter().map(|p| p.area * scale.max(p.least_scale).powi(2)).sum();
        if area > 1.0 {
            return None;
        }
        let cells = square.cells as f64;
        let turns: Vec<Vec<Turn>> = pieces
            .par_iter()
            .map(|piece| {
                let turned = axes(piece, square.rotate).filter_map(|axis| {
                    let points = placed(piece, scale, axis, cells);
                    // A mask is no larger than its box: look before drawing it.
                    let (_, size) = bounds(points.iter().copied());
                    (size.max_element() <= cells + TOUCH).then(|| Turn {
                        axis,
                        solid: Mask::new(&shape(piece, &points), 0.0),
                        grown: OnceLock::new(),
                    })
                });
                turned.collect()
            })
            .collect();
        turns.iter().all(|t| !t.is_empty()).then_some(Self { pieces, scale, square, turns })
    }

    /// Puts all pieces down, or says which place in the order failed, or was next when the attempt `is_cancelled`.
    fn attempt(&self, plan: &Plan, is_cancelled: &dyn Fn() -> bool) -> Result<Arrangement, usize> {
        let cells = self.square.cells as f64;
        let mut board = Board::new(self.square.cells);
        let mut axes = vec![DVec2::X; self.pieces.len()];
        let mut corners = vec![DVec2::ZERO; self.pieces.len()];
        for (position, &index) in plan.order.iter().enumerate() {
            if is_cancelled() {
                return Err(position);
            }
            let mut best: Option<(Place, &Turn)> = None;
            for turn in &self.turns[index] {
                let limit = best.as_ref().map_or((usize::MAX, usize::MAX), |b| b.0.cost);
                if let Some(place) = board.find(&turn.solid, plan.preference, limit) {
                    best = Some((place, turn));
                }
            }
            let Some((place, turn)) = best else { return Err(position) };
            let piece = &self.pieces[index];
            let grown = turn.grown.get_or_init(|| {
                let points = placed(piece, self.scale, turn.axis, cells);
                Mask::new(&shape(piece, &points), self.square.gutter * cells)
            });
            board.take(grown, place.x as i32 + grown.origin.x, place.y as i32 + grown.origin.y);
            axes[index] = turn.axis;
            corners[index] = dvec2(place.x as f64, place.y as f64) / cells;
        }
        Ok(Arrangement { scale: self.scale, axes, corners })
    }
}

/// A piece's points in cells.
fn placed(piece: &Piece, scale: f64, axis: DVec2, cells: f64) -> Vec<DVec2> {
    piece.placed(scale, axis).into_iter().map(|p| p * cells).collect()
}

/// The directions of a piece with their quarter turns.
fn axes(piece: &Piece, rotate: bool) -> impl Iterator<Item = DVec2> + '_ {
    piece.directions.iter().flat_map(move |&axis| {
        let quarter = [axis, axis.perp(), -axis, -axis.perp()];
        quarter.into_iter().take(if rotate { 4 } else { 1 })
    })
}

fn shape<'a>(piece: &'a Piece, points: &'a [DVec2]) -> Shape<'a> {
    Shape { points, triangles: &piece.triangles, outline: &piece.outline }
}
