//! From packed places to the 32-bit numbers of a file, without flipping a triangle.
//!
//! Rounding moves a point by up to 3e-8 of the square. A triangle thinner than that may
//! be flipped; its corners are then tried on the neighbouring numbers of their grid.

use crate::{AtlasError, Layout};
use glam::{DVec2, dvec2};
use robust::{Coord, orient2d};

/// Rounds a layout. Triangles that were not mirrored before are not mirrored after, or
/// the error names them.
pub(super) fn round(layout: &mut Layout) -> Result<(), AtlasError> {
    let was_positive: Vec<bool> = (0..layout.triangles.len()).map(|t| sign(layout, t) > 0.0).collect();
    layout.round();
    let flipped_triangles = |layout: &Layout| -> Vec<u32> {
        (0..was_positive.len()).filter(|&t| is_flipped(layout, t, &was_positive)).map(|t| t as u32).collect()
    };
    let mut flipped = flipped_triangles(layout);
    if flipped.is_empty() {
        return Ok(());
    }
    let around = triangles_of_points(layout);
    for _ in 0..4 {
        for &t in &flipped {
            repair(layout, t as usize, &around, &was_positive);
        }
        flipped = flipped_triangles(layout);
        if flipped.is_empty() {
            return Ok(());
        }
    }
    Err(AtlasError::TooThin { triangles: flipped })
}

/// Whether a triangle of positive area has lost it: it is flipped or degenerate.
fn is_flipped(layout: &Layout, t: usize, was_positive: &[bool]) -> bool {
    was_positive[t] && sign(layout, t) <= 0.0
}

/// Exact sign of a triangle's area.
fn sign(layout: &Layout, t: usize) -> f64 {
    let [a, b, c] = layout.corners(t).map(|p| Coord { x: p.x, y: p.y });
    orient2d(a, b, c)
}

fn triangles_of_points(layout: &Layout) -> Vec<Vec<u32>> {
    let mut around = vec![Vec::new(); layout.points.len()];
    for (t, triangle) in layout.triangles.iter().enumerate() {
        for &p in triangle {
            around[p as usize].push(t as u32);
        }
    }
    around
}

/// Tries the numbers next to a corner's for those with which the fewest triangles around it are flipped.
fn repair(layout: &mut Layout, t: usize, around: &[Vec<u32>], was_positive: &[bool]) {
    for p in layout.triangles[t].map(|p| p as usize) {
        let before = layout.points[p];
        let flipped = |layout: &Layout| {
            around[p].iter().filter(|&&t| is_flipped(layout, t as usize, was_positive)).count()
        };
        let mut best = (flipped(layout), before);
        for reach in 1..=3i32 {
            for (i, k) in (-reach..=reach).flat_map(|i| (-reach..=reach).map(move |k| (i, k))) {
                if best.0 > 0 && i.abs().max(k.abs()) == reach {
                    layout.points[p] = stepped(before, i, k);
                    let count = flipped(layout);
                    if count < best.0 {
                        best = (count, layout.points[p]);
                    }
                }
            }
        }
        layout.points[p] = best.1;
    }
}

/// A point some 32-bit numbers further on.
fn stepped(p: DVec2, i: i32, k: i32) -> DVec2 {
    let step = |value: f64, by: i32| {
        let mut value = value as f32;
        for _ in 0..by.abs() {
            value = if by > 0 { value.next_up() } else { value.next_down() };
        }
        f64::from(value).clamp(0.0, 1.0)
    };
    dvec2(step(p.x, i), step(p.y, k))
}
