//! The search for the largest scale at which all pieces find a place.
//!
//! One attempt puts the pieces down one after the other, each where it lies lowest. The
//! search bisects on a coarse grid, then asks again and again for a little more on the
//! fine one: a piece that found no place moves forward in the order ("squeaky wheel",
//! Joslin and Clements 1999). The number of attempts is counted, not timed, so that
//! the result is the same everywhere.

use super::board::{Board, Place, Preference};
use super::mask::{Mask, Shape, TOUCH};
use super::pieces::Piece;
use super::polygon::bounds;
use glam::{DVec2, dvec2};
use rayon::prelude::*;
use std::sync::OnceLock;

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

/// The best arrangement found, or `None` where none fits at any scale.
pub(super) fn search(pieces: &[Piece], coarse: Square, fine: Square, effort: usize) -> Option<Arrangement> {
    let mut plans = plans(pieces);
    let mut best = first_fit(pieces, coarse, &mut plans)?;
    let mut scale = best.scale;
    let mut step = 0.02;
    let mut rounds = rounds(pieces.len(), effort);
    while rounds > 0 && step > 0.0005 {
        rounds -= 1;
        let wanted = scale * (1.0 + step);
        match try_all(pieces, wanted, fine, &mut plans) {
            Some(found) => {
                scale = wanted;
                best = found;
            }
            None => step *= 0.8,
        }
    }
    Some(best)
}

/// Tries all plans at a scale. Those that fail learn from it; one that fits comes first
/// and replaces the last.
fn try_all(pieces: &[Piece], scale: f64, square: Square, plans: &mut [Plan]) -> Option<Arrangement> {
    let sheet = Sheet::new(pieces, scale, square)?;
    let results: Vec<Result<Arrangement, usize>> = plans.par_iter().map(|plan| sheet.attempt(plan)).collect();
    let mut fitted = None;
    for (plan, result) in plans.iter_mut().zip(results) {
        match result {
            Ok(found) => fitted = fitted.or(Some(found)),
            Err(failed) => promote(&mut plan.order, failed),
        }
    }
    fitted
}

/// Rounds of attempts that a number of pieces is worth.
fn rounds(count: usize, effort: usize) -> usize {
    effort * (400 / count.max(1)).clamp(6, 16)
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

/// Bisection on the coarse grid.
fn first_fit(pieces: &[Piece], square: Square, plans: &mut [Plan]) -> Option<Arrangement> {
    let mut fits = |scale: f64| try_all(pieces, scale, square, plans);
    let mut high = 1.0;
    let mut low = 1.0;
    let mut best = loop {
        if let Some(found) = fits(low) {
            break found;
        }
        if low < LEAST_SCALE {
            return None;
        }
        high = low;
        low *= 0.9;
    };
    while high > low * 1.02 {
        let middle = 0.5 * (low + high);
        match fits(middle) {
            Some(found) => {
                low = middle;
                best = found;
            }
            None => high = middle,
        }
    }
    Some(best)
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

    /// Puts all pieces down, or says which place in the order failed.
    fn attempt(&self, plan: &Plan) -> Result<Arrangement, usize> {
        let cells = self.square.cells as f64;
        let mut board = Board::new(self.square.cells);
        let mut axes = vec![DVec2::X; self.pieces.len()];
        let mut corners = vec![DVec2::ZERO; self.pieces.len()];
        for (position, &index) in plan.order.iter().enumerate() {
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
