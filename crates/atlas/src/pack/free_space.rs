//! Charts put where a layout has room for them, while all others lie still.
//!
//! The square is a grid of cells as in `board.rs`; what lies still takes its cells and those nearer than
//! the gutter. Each chart that looks for a place, the largest first, tries
//!
//! ```text
//! its own place ─ places a few cells from it ─ any place, in four directions ─ the same a little smaller
//! ```
//!
//! Contract: a chart that found a place is at least the gutter away from all others and half of it from
//! the border; what lies still is not touched.

use super::PackOptions;
use super::board::{Board, Preference};
use super::mask::{Mask, Shape};
use super::polygon::bounds;
use crate::Layout;
use glam::{DVec2, IVec2, dvec2};

/// Cells along a side of the square, by the texture's texels within these limits.
const CELLS: std::ops::RangeInclusive<usize> = 512..=2048;
/// Charts that look for a place at most: more are packed anew.
const MOST_CHARTS: usize = 2000;
/// Cells from its own place that a chart tries, and the directions.
const NEAR: [i32; 9] = [1, 2, 3, 4, 6, 8, 12, 16, 24];
const DIRECTIONS: [IVec2; 8] = [
    IVec2::new(1, 0),
    IVec2::new(0, 1),
    IVec2::new(-1, 0),
    IVec2::new(0, -1),
    IVec2::new(1, 1),
    IVec2::new(-1, 1),
    IVec2::new(-1, -1),
    IVec2::new(1, -1),
];
/// How much smaller a chart may be drawn to find a place; those of less than [`SMALL`] of the square
/// may shrink further.
const SCALES: [f64; 4] = [1.0, 0.97, 0.93, 0.87];
const SMALL_SCALES: [f64; 4] = [0.8, 0.7, 0.6, 0.5];
const SMALL: f64 = 0.002;

/// Charts in their places.
pub(crate) struct Placed {
    pub layout: Layout,
    /// Charts that are drawn smaller than they were.
    pub smaller: usize,
}

/// One chart in cells, relative to its own centre.
struct Chart {
    points: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    outline: Vec<[u32; 2]>,
}

/// Finds places for the charts that are `free`, one flag a chart. No two charts may share a point. None
/// where one finds no place.
pub(crate) fn place(layout: &Layout, free: &[bool], options: &PackOptions) -> Option<Placed> {
    let count = free.iter().filter(|free| **free).count();
    if count > MOST_CHARTS {
        return None;
    }
    let cells = options.texture_size.clamp(*CELLS.start(), *CELLS.end());
    let scale = cells as f64;
    let texel = scale / options.texture_size as f64;
    let border = (0.5 * options.gutter_texels).max(0.5) * texel;
    // Rounding takes up to 3e-8 of each coordinate.
    let reach = options.gutter_texels * texel + 1e-6 * scale;
    let inner = (scale - 2.0 * border).floor();
    if inner < 1.0 {
        return None;
    }
    let mut board = Board::new(inner as usize);
    let mut points: Vec<DVec2> = layout.points.iter().map(|p| *p * scale - border).collect();
    let (still, mut charts) = split(layout, free);
    let whole = Shape { points: &points, triangles: &still.triangles, outline: &still.outline };
    if !still.triangles.is_empty() {
        let mask = Mask::new(&whole, reach);
        board.take(&mask, mask.origin.x, mask.origin.y);
    }
    let area = |chart: &Chart| -> f64 {
        let doubled = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| layout.points[i as usize]);
            (b - a).perp_dot(c - a).abs()
        };
        0.5 * chart.triangles.iter().map(doubled).sum::<f64>()
    };
    charts.sort_by(|a, b| area(b).total_cmp(&area(a)));
    let mut smaller = 0;
    for chart in &charts {
        let more: &[f64] = if area(chart) < SMALL { &SMALL_SCALES } else { &[] };
        let found = SCALES.iter().chain(more).find_map(|&scale| {
            let found = at_scale(&board, &points, chart, scale)?;
            smaller += usize::from(scale < 1.0);
            Some(found)
        })?;
        chart.points.iter().zip(&found).for_each(|(&i, p)| points[i as usize] = *p);
        let own = chart.shape(&points);
        let mask = Mask::new(&Shape { points: &own.0, triangles: &own.1, outline: &own.2 }, reach);
        board.take(&mask, mask.origin.x, mask.origin.y);
    }
    let mut placed = layout.clone();
    for chart in &charts {
        for &i in &chart.points {
            placed.points[i as usize] = ((points[i as usize] + border) / scale).as_vec2().as_dvec2();
        }
    }
    Some(Placed { layout: placed, smaller })
}

/// What lies still as one, and each chart that does not.
fn split(layout: &Layout, free: &[bool]) -> (Chart, Vec<Chart>) {
    let none = || Chart { points: Vec::new(), triangles: Vec::new(), outline: Vec::new() };
    let mut still = none();
    let mut charts: Vec<Chart> = free.iter().map(|_| none()).collect();
    for (t, triangle) in layout.triangles.iter().enumerate() {
        let chart = layout.charts[t] as usize;
        if free[chart] {
            charts[chart].triangles.push(*triangle);
            charts[chart].points.extend(triangle);
        } else {
            still.triangles.push(*triangle);
        }
    }
    for edge in layout.boundary() {
        let chart = layout.charts[edge.triangle as usize] as usize;
        let owner = if free[chart] { &mut charts[chart] } else { &mut still };
        owner.outline.push(edge.points);
    }
    charts.retain(|chart| !chart.triangles.is_empty());
    for chart in &mut charts {
        chart.points.sort_unstable();
        chart.points.dedup();
    }
    (still, charts)
}

impl Chart {
    /// Its points alone, with its triangles and outline over them.
    fn shape(&self, points: &[DVec2]) -> (Vec<DVec2>, Vec<[u32; 3]>, Vec<[u32; 2]>) {
        let local = |i: u32| self.points.partition_point(|&p| p < i) as u32;
        (
            self.points.iter().map(|&i| points[i as usize]).collect(),
            self.triangles.iter().map(|t| t.map(local)).collect(),
            self.outline.iter().map(|e| e.map(local)).collect(),
        )
    }
}

/// A chart's points in a free place, drawn at this scale.
fn at_scale(board: &Board, points: &[DVec2], chart: &Chart, scale: f64) -> Option<Vec<DVec2>> {
    let (own, triangles, outline) = chart.shape(points);
    let (low, high) = bounds(own.iter().copied());
    let centre = 0.5 * (low + high);
    let turned = |axis: DVec2| -> Vec<DVec2> {
        own.iter().map(|&p| centre + axis.rotate(p - centre) * scale).collect()
    };
    let drawn =
        |points: &[DVec2]| Mask::new(&Shape { points, triangles: &triangles, outline: &outline }, 0.0);
    let moved = |points: Vec<DVec2>, by: IVec2| points.into_iter().map(|p| p + by.as_dvec2()).collect();
    let upright = turned(DVec2::X);
    let mask = drawn(&upright);
    let tries = std::iter::once(IVec2::ZERO).chain(NEAR.iter().flat_map(|n| DIRECTIONS.map(|d| d * *n)));
    for by in tries {
        if board.is_free(&mask, mask.origin.x + by.x, mask.origin.y + by.y) {
            return Some(moved(upright, by));
        }
    }
    let mut best = None;
    let mut limit = (usize::MAX, 0);
    for axis in [DVec2::X, DVec2::Y, -DVec2::X, dvec2(0.0, -1.0)] {
        let points = turned(axis);
        let mask = drawn(&points);
        if let Some(found) = board.find(&mask, Preference::Corner, limit) {
            limit = found.cost;
            let to = IVec2::new(found.x as i32, found.y as i32);
            best = Some(moved(points, to - mask.origin));
        }
    }
    best
}
