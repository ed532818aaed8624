//! A chart as the cells that it touches.
//!
//! A placed chart marks all cells that are nearer than the gutter; a new chart may lie
//! where none of the cells that it touches is marked. Each of its points is then at
//! least the gutter away, in Euclidean distance: rasterisation costs a fraction of a
//! cell of room, never any of the gutter.

use super::polygon::{bounds, range_in_strip};
use glam::{DVec2, IVec2};

/// Cells that are touched by less than this are left out, so that a square of ten cells
/// is ten cells wide. The packer's margin makes up for it.
pub(super) const TOUCH: f64 = 1e-7;

/// A row's cells from `start` to `start + length`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    pub row: usize,
    pub start: usize,
    pub length: usize,
}

/// Cells on a grid, by rows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mask {
    /// The cell that stands in column 0 of row 0, relative to the shape's own origin.
    pub origin: IVec2,
    pub width: usize,
    pub height: usize,
    /// The longest first, because long runs are the first to meet an obstacle.
    pub runs: Vec<Run>,
}

/// A shape to be rasterised, in cells.
pub(super) struct Shape<'a> {
    pub points: &'a [DVec2],
    pub triangles: &'a [[u32; 3]],
    /// The edges that have a triangle on one side only.
    pub outline: &'a [[u32; 2]],
}

impl Mask {
    /// The cells that lie within `reach` cells of the shape; with 0 those it touches.
    pub fn new(shape: &Shape, reach: f64) -> Self {
        let (low, high) = bounds(shape.points.iter().copied());
        let low = ((low - reach) + TOUCH).floor().as_ivec2();
        let high = (((high + reach) - TOUCH).ceil().as_ivec2()).max(low + 1);
        let mut bits = Bits::new(low, high);
        let corner = |i: u32| shape.points[i as usize];
        for triangle in shape.triangles {
            bits.fill(&triangle.map(corner));
        }
        for edge in shape.outline {
            let [a, b] = edge.map(corner);
            if reach > 0.0 {
                bits.fill_near(a, b, reach);
            }
        }
        bits.into_mask()
    }
}

/// Rows of bits while a mask is drawn.
struct Bits {
    origin: IVec2,
    size: IVec2,
    words: usize,
    rows: Vec<u64>,
}

impl Bits {
    fn new(low: IVec2, high: IVec2) -> Self {
        let size = high - low;
        let words = size.x as usize / 64 + 1;
        Self { origin: low, size, words, rows: vec![0; words * size.y as usize] }
    }

    /// Marks the cells that a convex polygon touches.
    fn fill(&mut self, polygon: &[DVec2]) {
        let (low, high) = bounds(polygon.iter().copied());
        self.fill_rows(low.y, high.y, |y| range_in_strip(polygon, y, y + 1.0));
    }

    /// Marks the cells within `reach` of a segment: those that touch the two discs
    /// around its ends or the rectangle between.
    fn fill_near(&mut self, a: DVec2, b: DVec2, reach: f64) {
        let side = (b - a).perp().normalize_or_zero() * reach;
        let rectangle = [a + side, a - side, b - side, b + side];
        let disc = |centre: DVec2, y: f64| {
            let away = (y - centre.y).max(centre.y - (y + 1.0)).max(0.0);
            let half = (reach * reach - away * away).max(0.0).sqrt();
            (away <= reach).then_some((centre.x - half, centre.x + half))
        };
        self.fill_rows(a.y.min(b.y) - reach, a.y.max(b.y) + reach, |y| {
            let parts = [disc(a, y), disc(b, y), range_in_strip(&rectangle, y, y + 1.0)];
            parts.into_iter().flatten().reduce(|p, q| (p.0.min(q.0), p.1.max(q.1)))
        });
    }

    /// Marks in each row between two heights the range of x that `range` names for the
    /// strip that begins at y.
    fn fill_rows(&mut self, low: f64, high: f64, range: impl Fn(f64) -> Option<(f64, f64)>) {
        let first = (low + TOUCH).floor() as i32;
        let last = ((high - TOUCH).ceil() as i32 - 1).max(first);
        for y in first.max(self.origin.y)..=last.min(self.origin.y + self.size.y - 1) {
            let Some((left, right)) = range(f64::from(y)) else { continue };
            let start = (left + TOUCH).floor() as i32;
            let end = ((right - TOUCH).ceil() as i32).max(start + 1);
            let start = (start - self.origin.x).clamp(0, self.size.x) as usize;
            let end = (end - self.origin.x).clamp(0, self.size.x) as usize;
            let row = (y - self.origin.y) as usize * self.words;
            set_range(&mut self.rows[row..row + self.words], start, end);
        }
    }

    fn into_mask(self) -> Mask {
        let mut runs = Vec::new();
        let (width, height) = (self.size.x as usize, self.size.y as usize);
        for (row, words) in self.rows.chunks_exact(self.words).enumerate() {
            let mut column = 0;
            while let Some(start) = next_bit(words, column, true) {
                let end = next_bit(words, start, false).unwrap_or(width).min(width);
                runs.push(Run { row, start, length: end - start });
                column = end;
            }
        }
        runs.sort_unstable_by_key(|run| (std::cmp::Reverse(run.length), run.row, run.start));
        Mask { origin: self.origin, width, height, runs }
    }
}

/// Sets the bits from `start` to `end`.
pub(super) fn set_range(words: &mut [u64], start: usize, end: usize) {
    for (index, word) in words.iter_mut().enumerate().take(end.div_ceil(64)).skip(start / 64) {
        let low = start.saturating_sub(index * 64);
        let high = (end - index * 64).min(64);
        if low < high {
            *word |= (u64::MAX >> (64 - (high - low))) << low;
        }
    }
}

/// The first bit at or after `from` that has the given value.
pub(super) fn next_bit(words: &[u64], from: usize, value: bool) -> Option<usize> {
    let mut index = from / 64;
    let mut mask = u64::MAX << (from % 64);
    while let Some(&word) = words.get(index) {
        let word = if value { word } else { !word } & mask;
        if word != 0 {
            return Some(index * 64 + word.trailing_zeros() as usize);
        }
        mask = u64::MAX;
        index += 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    fn cells(mask: &Mask) -> Vec<(i32, i32)> {
        let mut cells: Vec<_> = mask
            .runs
            .iter()
            .flat_map(|r| {
                (0..r.length).map(|k| (mask.origin.x + (r.start + k) as i32, mask.origin.y + r.row as i32))
            })
            .collect();
        cells.sort_unstable();
        cells
    }

    /// Protects the gutter itself: exactly the cells within reach are marked.
    #[test]
    fn cells_within_reach_are_marked() {
        let points = [dvec2(0.3, 0.2), dvec2(70.4, 5.1), dvec2(9.6, 31.7)];
        let shape = Shape { points: &points, triangles: &[[0, 1, 2]], outline: &[[0, 1], [1, 2], [2, 0]] };
        for reach in [0.0, 0.9, 5.29] {
            let marked = cells(&Mask::new(&shape, reach));
            let mut wanted = Vec::new();
            for x in -8..80 {
                for y in -8..40 {
                    if distance(&points, dvec2(f64::from(x), f64::from(y))) <= reach {
                        wanted.push((x, y));
                    }
                }
            }
            let extra: Vec<_> = marked.iter().filter(|c| !wanted.contains(c)).collect();
            let lost: Vec<_> = wanted.iter().filter(|c| !marked.contains(c)).collect();
            assert!(extra.is_empty() && lost.is_empty(), "reach {reach}: {extra:?} {lost:?}");
        }
    }

    /// Distance of the triangle from the cell at `low`, by closest pairs of the sides.
    fn distance(triangle: &[DVec2; 3], low: DVec2) -> f64 {
        let cell = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)].map(|d| low + d);
        let inside = |polygon: &[DVec2], p: DVec2| {
            (0..polygon.len())
                .all(|i| (polygon[(i + 1) % polygon.len()] - polygon[i]).perp_dot(p - polygon[i]) >= 0.0)
        };
        let to_side = |p: DVec2, a: DVec2, b: DVec2| {
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            p.distance(a + (b - a) * t)
        };
        let mut least = f64::INFINITY;
        for i in 0..3 {
            let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
            for k in 0..4 {
                let (c, d) = (cell[k], cell[(k + 1) % 4]);
                let crossing = (b - a).perp_dot(c - a) * (b - a).perp_dot(d - a) <= 0.0
                    && (d - c).perp_dot(a - c) * (d - c).perp_dot(b - c) <= 0.0;
                let apart = to_side(a, c, d).min(to_side(c, a, b));
                least =
                    least.min(if crossing || inside(&cell, a) || inside(triangle, c) { 0.0 } else { apart });
            }
        }
        least
    }

    /// Protects bits across words.
    #[test]
    fn ranges_cross_words() {
        let mut words = [0; 4];
        set_range(&mut words, 60, 193);
        set_range(&mut words, 200, 200);
        assert_eq!((next_bit(&words, 0, true), next_bit(&words, 61, false)), (Some(60), Some(193)));
        assert_eq!(words.iter().map(|w| w.count_ones()).sum::<u32>(), 133);
        assert_eq!(next_bit(&words, 193, true), None);
    }
}
