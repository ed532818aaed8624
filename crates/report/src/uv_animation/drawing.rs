//! One layout as a picture: filled triangles, thin lines inside charts, stronger ones
//! around them.
//!
//! A pixel is a hue and a level, how dark it is. Where several things meet, the darkest
//! one is seen, so the picture does not depend on the order of lines. A line's coverage
//! of a pixel is taken from the distance between the pixel's centre and the line.

use super::UvMoves;
use super::palette::{self, DONE, FAULT, GROUND, HUES, LEVELS, MARGIN};
use parbake_model::glam::{DVec2, Vec2, dvec2};

/// Pixels around the square.
const RIM: usize = 12;
/// The bar below the square: its distance from the square, and its height.
const BAR: (usize, usize) = (5, 3);
/// Levels of fills.
const FILL: u8 = 2;
const FLIPPED_FILL: u8 = 5;
/// Widths of lines in pixels.
const BORDER_WIDTH: f64 = 1.5;
const INSIDE_WIDTH: f64 = 0.9;
/// The level of lines inside charts, with edges of so many pixels in the mean; denser
/// ones are fainter, for they would be a blot.
const INSIDE: f64 = 6.0;
const LONG_EDGES: f64 = 12.0;
/// Points farther away than so many squares have no pixel precision left.
const FARTHEST: f64 = 1e4;

/// A square picture of palette indices.
pub struct Canvas {
    /// Pixels along a side.
    pub extent: usize,
    /// Row by row, the upper one first.
    pub pixels: Vec<u8>,
}

/// What all layouts of an animation have in common.
pub struct Drawing<'a> {
    triangles: &'a [[u32; 3]],
    /// F hues.
    hues: Vec<u8>,
    /// Points, hue, whether it is on a chart's border.
    edges: Vec<([u32; 2], u8, bool)>,
    /// The level of lines inside charts.
    inside: f64,
    side: usize,
}

impl<'a> Drawing<'a> {
    /// Prepares for a square of `side` pixels.
    pub fn new(moves: &'a UvMoves, side: usize) -> Self {
        let hue = |t: usize| moves.charts.get(t).map_or(0, |chart| (chart % u32::from(HUES)) as u8);
        let hues: Vec<u8> = (0..moves.triangles.len()).map(hue).collect();
        let mut all: Vec<([u32; 2], u8)> = Vec::with_capacity(3 * moves.triangles.len());
        for (&[a, b, c], &hue) in moves.triangles.iter().zip(&hues) {
            if a != b && b != c && c != a {
                all.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], hue)));
            }
        }
        all.sort_unstable();
        let edges: Vec<_> =
            all.chunk_by(|a, b| a.0 == b.0).map(|run| (run[0].0, run[0].1, run.len() == 1)).collect();
        let mut drawing = Self { triangles: &moves.triangles, hues, edges, inside: 0.0, side };
        let points = moves.frames.last().map_or(Vec::new(), |points| drawing.placed(points));
        let lengths = drawing.edges.iter().filter_map(|&([a, b], ..)| {
            Some(point(&points, a)?.distance(point(&points, b)?).min(side as f64))
        });
        let (sum, count) = lengths.fold((0.0, 0.0), |(sum, count), length| (sum + length, count + 1.0));
        let mean = if count > 0.0 { sum / count } else { LONG_EDGES };
        let faint = f64::from(FILL);
        // The same for all layouts, so that lines do not flicker.
        drawing.inside = faint + (INSIDE - faint) * (mean / LONG_EDGES).min(1.0);
        drawing
    }

    /// Pixels along a side of the whole picture.
    pub fn extent(&self) -> usize {
        self.side + 2 * RIM
    }

    /// Draws a layout that comes after this share of the run.
    pub fn frame(&self, points: &[Vec2], done: f64) -> Canvas {
        let extent = self.extent();
        let mut marks = Marks { extent, marks: vec![(0, 0); extent * extent] };
        let points = self.placed(points);
        let corners = |t: usize| {
            let [a, b, c] = self.triangles[t];
            Some([point(&points, a)?, point(&points, b)?, point(&points, c)?])
        };
        for (t, &hue) in self.hues.iter().enumerate() {
            if let Some([a, b, c]) = corners(t) {
                let is_flipped = (b - a).perp_dot(c - a) < 0.0;
                marks.fill([a, b, c], if is_flipped { (FLIPPED_FILL, FAULT) } else { (FILL, hue) });
            }
        }
        for &([a, b], hue, is_border) in &self.edges {
            if let (Some(a), Some(b)) = (point(&points, a), point(&points, b)) {
                let (width, level) =
                    if is_border { (BORDER_WIDTH, f64::from(LEVELS)) } else { (INSIDE_WIDTH, self.inside) };
                marks.line(a, b, width, level, hue);
            }
        }
        let mut canvas = self.ground(done);
        for (pixel, &(level, hue)) in canvas.pixels.iter_mut().zip(&marks.marks) {
            if level > 0 {
                *pixel = palette::index(hue, level);
            }
        }
        canvas
    }

    /// The empty square with the bar below.
    fn ground(&self, done: f64) -> Canvas {
        let extent = self.extent();
        let mut pixels = vec![MARGIN; extent * extent];
        let mut rectangle = |rows: std::ops::Range<usize>, width: usize, color: u8| {
            for y in rows {
                pixels[y * extent + RIM..][..width].fill(color);
            }
        };
        rectangle(RIM..RIM + self.side, self.side, GROUND);
        let bar = RIM + self.side + BAR.0;
        rectangle(bar..bar + BAR.1, self.side, GROUND);
        rectangle(bar..bar + BAR.1, (self.side as f64 * done.clamp(0.0, 1.0)).round() as usize, DONE);
        Canvas { extent, pixels }
    }

    /// Texture coordinates in pixels.
    fn placed(&self, points: &[Vec2]) -> Vec<DVec2> {
        points.iter().map(|p| p.as_dvec2() * self.side as f64 + RIM as f64).collect()
    }
}

/// A point that can be drawn.
fn point(points: &[DVec2], index: u32) -> Option<DVec2> {
    let p = *points.get(index as usize)?;
    (p.is_finite() && p.abs().max_element() < FARTHEST * 2048.0).then_some(p)
}

/// What has been drawn: level and hue of each pixel.
struct Marks {
    extent: usize,
    marks: Vec<(u8, u8)>,
}

impl Marks {
    fn darken(&mut self, x: usize, y: usize, mark: (u8, u8)) {
        let known = &mut self.marks[y * self.extent + x];
        *known = (*known).max(mark);
    }

    /// Whole numbers from one to the other that are on the canvas.
    fn steps(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let on = |x: f64| x.clamp(0.0, self.extent as f64) as usize;
        on(from.ceil())..on(to.floor() + 1.0)
    }

    /// Marks the pixels whose centres lie in a triangle.
    fn fill(&mut self, corners: [DVec2; 3], mark: (u8, u8)) {
        // Pixel centres lie at halves.
        let [a, b, c] = corners.map(|p| p - 0.5);
        let (low, high) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        for y in self.steps(low, high) {
            let row = y as f64;
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                if (p.y <= row) != (q.y <= row) {
                    let x = p.x + (row - p.y) / (q.y - p.y) * (q.x - p.x);
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            for x in self.steps(left, right) {
                self.darken(x, y, mark);
            }
        }
    }

    /// Draws a line of this width with round ends.
    fn line(&mut self, a: DVec2, b: DVec2, width: f64, level: f64, hue: u8) {
        let (a, b) = (a - 0.5, b - 0.5);
        let along = b - a;
        let length_squared = along.length_squared();
        let reach = 0.5 * width + 0.5;
        let is_steep = along.y.abs() > along.x.abs();
        let turned = |p: DVec2| if is_steep { dvec2(p.y, p.x) } else { p };
        let (from, to) = (turned(a), turned(b));
        let (from, to) = if from.x <= to.x { (from, to) } else { (to, from) };
        let slope = if to.x > from.x { (to.y - from.y) / (to.x - from.x) } else { 0.0 };
        // Across a slanted line the reach is longer along the axis, √2 times at most.
        let across = reach * (1.0 + slope * slope).sqrt();
        for step in self.steps(from.x - reach, to.x + reach) {
            let at = (step as f64).clamp(from.x, to.x);
            let middle = from.y + (at - from.x) * slope;
            for other in self.steps(middle - across, middle + across) {
                let (x, y) = if is_steep { (other, step) } else { (step, other) };
                let to_pixel = dvec2(x as f64, y as f64) - a;
                let share = if length_squared > 0.0 {
                    (to_pixel.dot(along) / length_squared).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let coverage = (reach - to_pixel.distance(along * share)).clamp(0.0, width.min(1.0));
                let level = (level * coverage).round() as u8;
                if level > 0 {
                    self.darken(x, y, (level, hue));
                }
            }
        }
    }
}
