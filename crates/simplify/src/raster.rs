//! Pixels of one triangle: rows from top to bottom, and in each the interval in which all three edges hold.
//!
//! Nearness (1 / depth) is a plane over the screen, so it needs no division.
//!
//! The last bit of a nearness tells whether the front of the triangle is seen, so that a picture holds both in one
//! number. That bit is worth less than the rounding of the number.
//!
//! Contract: two-sided; a pixel counts if its centre lies inside or within a thousandth of a pixel of an edge, so
//! that no pixel falls between two triangles that share it.

/// A rectangle of pixels; ends are excluded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rectangle {
    /// First column.
    pub x0: usize,
    /// First row.
    pub y0: usize,
    /// Column after the last.
    pub x1: usize,
    /// Row after the last.
    pub y1: usize,
}

impl Rectangle {
    /// The pixels that a triangle may cover, within a picture of size².
    pub fn of(corners: &[[f32; 3]; 3], size: usize) -> Self {
        let limit = size as f32;
        let span = |k: usize| {
            let [a, b, c] = corners.map(|corner| corner[k]);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c).clamp(0.0, limit));
            // Casts round down; functions of the math library would take longer than all else here.
            let (low, up) = (low.clamp(0.0, limit) as usize, high as usize);
            (low, up + usize::from((up as f32) < high))
        };
        let ((x0, x1), (y0, y1)) = (span(0), span(1));
        Self { x0, y0, x1, y1 }
    }

    /// The least rectangle around both.
    pub fn around(self, other: Self) -> Self {
        match (self.is_empty(), other.is_empty()) {
            (true, _) => other,
            (_, true) => self,
            _ => Self {
                x0: self.x0.min(other.x0),
                y0: self.y0.min(other.y0),
                x1: self.x1.max(other.x1),
                y1: self.y1.max(other.y1),
            },
        }
    }

    /// Whether there is no pixel in it.
    pub fn is_empty(self) -> bool {
        self.x0 >= self.x1 || self.y0 >= self.y1
    }

    /// Pixels in a row.
    pub fn width(self) -> usize {
        self.x1.saturating_sub(self.x0)
    }

    /// Rows.
    pub fn height(self) -> usize {
        self.y1.saturating_sub(self.y0)
    }
}

/// A triangle set up for its pixels.
pub struct Edges {
    /// Coefficients of column, row and 1; positive inside.
    edges: [[f32; 3]; 3],
    /// Of the first coefficients; infinite where an edge is level.
    reciprocals: [f32; 3],
    nearness: [f32; 3],
    front: u32,
}

/// The pixels of a triangle in a row.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// Which row.
    pub row: usize,
    /// First column.
    pub first: usize,
    /// Column after the last.
    pub end: usize,
    /// The plane of nearness at column 0.
    base: f32,
}

/// A nearness with the side that is seen.
#[inline]
fn with_side(nearness: f32, front: u32) -> f32 {
    f32::from_bits(nearness.to_bits() & !1 | front)
}

/// Triangles of less than this area, in pixels, cover nothing.
const LEAST_AREA: f32 = 1e-6;
/// How far outside of an edge a centre still counts, in pixels.
const SLACK: f32 = 1e-3;

impl Edges {
    /// None where the triangle is seen from its edge.
    #[inline]
    pub fn new(corners: &[[f32; 3]; 3]) -> Option<Self> {
        let [a, b, c] = *corners;
        let doubled = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if doubled.abs() < LEAST_AREA {
            return None;
        }
        let sign = doubled.signum();
        // Relative to a corner, so that no digits are lost.
        let edge = |p: [f32; 3], q: [f32; 3]| {
            let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
            let (along_x, along_y) = (-dy * sign, dx * sign);
            let slack = SLACK * (dx.abs() + dy.abs());
            [along_x, along_y, slack - along_x * p[0] - along_y * p[1]]
        };
        let edges = [edge(b, c), edge(c, a), edge(a, b)];
        let (u, v) = (b[2] - a[2], c[2] - a[2]);
        let per_x = (u * (c[1] - a[1]) - v * (b[1] - a[1])) / doubled;
        let per_y = (v * (b[0] - a[0]) - u * (c[0] - a[0])) / doubled;
        let reciprocals = edges.map(|edge| edge[0].recip());
        let nearness = [per_x, per_y, a[2] - per_x * a[0] - per_y * a[1]];
        // Rows go down, so what is counter-clockwise in the scene turns the other way on the screen.
        Some(Self { edges, reciprocals, nearness, front: u32::from(doubled < 0.0) })
    }

    /// Calls `visit` with column, row and nearness of each pixel inside, within a rectangle.
    #[inline]
    pub fn each_pixel(&self, within: Rectangle, mut visit: impl FnMut(usize, usize, f32)) {
        self.each_span(within, |span| {
            for column in span.first..span.end {
                visit(column, span.row, self.nearness_in(&span, column));
            }
        });
    }

    /// Nearness at a column of a span of this triangle.
    #[inline]
    pub fn nearness_in(&self, span: &Span, column: usize) -> f32 {
        with_side(self.nearness[0] * column as f32 + span.base, self.front)
    }

    /// Calls `visit` with the pixels inside of each row, within a rectangle.
    #[inline]
    pub fn each_span(&self, within: Rectangle, mut visit: impl FnMut(Span)) {
        for row in within.y0..within.y1 {
            let y = row as f32 + 0.5;
            let (mut from, mut to) = (within.x0 as f32 + 0.5, within.x1 as f32 - 0.5);
            let mut is_outside = false;
            for (&[a, b, c], reciprocal) in self.edges.iter().zip(self.reciprocals) {
                let rest = b * y + c;
                if a > 0.0 {
                    from = from.max(-rest * reciprocal);
                } else if a < 0.0 {
                    to = to.min(-rest * reciprocal);
                } else {
                    is_outside |= rest < 0.0;
                }
            }
            if is_outside || from > to {
                continue;
            }
            // Both are at least 0.5, so that casts round down.
            let (from, to) = (from - 0.5, to - 0.5);
            let first = from as usize + usize::from((from as usize as f32) < from);
            let end = (to as usize + 1).min(within.x1);
            let base = self.nearness[1] * y + self.nearness[2] + 0.5 * self.nearness[0];
            if first < end {
                visit(Span { row, first, end, base });
            }
        }
    }
}

/// Nearness of a triangle at a pixel's centre, if it is inside; without dividing for those that are not.
#[inline]
pub fn nearness_at(corners: &[[f32; 3]; 3], column: usize, row: usize) -> Option<f32> {
    let (x, y) = (column as f32 + 0.5, row as f32 + 0.5);
    let [a, b, c] = *corners;
    let doubled = |p: [f32; 3], q: [f32; 3]| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
    let parts = [doubled(b, c), doubled(c, a), doubled(a, b)];
    let sum = parts[0] + parts[1] + parts[2];
    if sum.abs() < LEAST_AREA {
        return None;
    }
    let sign = sum.signum();
    let slack = |p: [f32; 3], q: [f32; 3]| -SLACK * ((q[0] - p[0]).abs() + (q[1] - p[1]).abs());
    let is_inside =
        parts[0] * sign >= slack(b, c) && parts[1] * sign >= slack(c, a) && parts[2] * sign >= slack(a, b);
    is_inside.then(|| {
        let nearness = (parts[0] * a[2] + parts[1] * b[2] + parts[2] * c[2]) / sum;
        with_side(nearness, u32::from(sum < 0.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects coverage: two triangles that share an edge cover a square once but for that edge, and nearness is
    /// the plane through the corners.
    #[test]
    fn triangles_cover_their_pixels() {
        let corners = [[1.0, 1.0, 0.1], [5.0, 1.0, 0.5], [5.0, 5.0, 0.5], [1.0, 5.0, 0.1]];
        let mut times = [0; 36];
        for t in [[0, 1, 2], [0, 2, 3]] {
            let triangle = t.map(|i: usize| corners[i]);
            let within = Rectangle::of(&triangle, 6);
            let edges = Edges::new(&triangle).unwrap_or_else(|| unreachable!("it has an area"));
            edges.each_pixel(within, |x, y, nearness| {
                times[y * 6 + x] += 1;
                let expected = 0.1 + 0.1 * (x as f32 + 0.5 - 1.0);
                assert!((nearness - expected).abs() < 1e-5);
                assert_eq!(nearness_at(&triangle, x, y).map(|n| (n - nearness).abs() < 1e-5), Some(true));
            });
        }
        for (pixel, times) in times.into_iter().enumerate() {
            let (x, y) = (pixel % 6, pixel / 6);
            let inside = (1..5).contains(&x) && (1..5).contains(&y);
            let expected = if inside { 1..=if x == y { 2 } else { 1 } } else { 0..=0 };
            assert!(expected.contains(&times), "{x} {y} {times}");
        }
        assert!(Edges::new(&[[0.0, 0.0, 1.0], [1.0, 1.0, 1.0], [2.0, 2.0, 1.0]]).is_none());
    }
}
