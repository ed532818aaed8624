//! Packing by boxes in rows, for very many charts: next-fit decreasing height (Coffman
//! et al. 1980). Wasteful for shapes, but a sort and a sum however many they are.

use super::pieces::Piece;
use super::polygon::bounds;
use glam::{DVec2, dvec2};

/// Lower corners of the pieces' boxes in the unit square at the largest scale that fits,
/// with that scale. `gap` lies between boxes, in parts of the square.
pub(super) fn shelves(pieces: &[Piece], gap: f64) -> Option<(f64, Vec<DVec2>)> {
    let size = |piece: &Piece| {
        let axis = piece.directions[0];
        let (low, high) = bounds(piece.points.iter().map(|p| dvec2(p.dot(axis), p.dot(axis.perp()))));
        high - low
    };
    let sizes: Vec<DVec2> = pieces.iter().map(size).collect();
    let boxes = |scale: f64| {
        pieces.iter().zip(&sizes).map(move |(p, &s)| s * scale.max(p.least_scale)).collect::<Vec<_>>()
    };
    // From no scale at all to one at which the areas alone fill the square.
    let (mut low, mut high) = (0.0, 2.0);
    let mut best = (0.0, rows(&boxes(0.0), gap)?);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        match rows(&boxes(middle), gap) {
            Some(corners) => {
                low = middle;
                best = (middle, corners);
            }
            None => high = middle,
        }
    }
    Some(best)
}

fn rows(boxes: &[DVec2], gap: f64) -> Option<Vec<DVec2>> {
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| boxes[b].y.total_cmp(&boxes[a].y));
    let mut corners = vec![DVec2::ZERO; boxes.len()];
    let (mut at, mut top) = (DVec2::ZERO, 0.0);
    for index in order {
        let size = boxes[index];
        if at.x + size.x > 1.0 {
            at = dvec2(0.0, top + gap);
        }
        if at.x == 0.0 {
            top = at.y + size.y;
        }
        if top > 1.0 || size.x > 1.0 {
            return None;
        }
        corners[index] = at;
        at.x += size.x + gap;
    }
    Some(corners)
}
