//! How the jar is cut into charts, how these are packed into the texture, and how
//! they become triangles.
//!
//! Each band of the profile is cut into strips round the jar; a strip becomes a
//! rectangle as wide as it is long on average, so that there is little stretch,
//! and the two ends of the profile become discs. Packing is by shelves: the
//! tallest first, left to right, at the largest scale at which all fit.

use super::shape::{Part, profile, surface};
use crate::normals::smooth_normals;
use parbake_model::Mesh;
use parbake_model::glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// A piece of the jar and where it is in the texture.
pub(super) struct Chart {
    pub(super) part: Part,
    /// First and last column's `u` as counts of the columns round the part.
    columns: (usize, usize),
    /// First and last `v`.
    ends: (f32, f32),
    rows: usize,
    disc: bool,
    /// Width and height on the surface.
    size: Vec2,
    /// Top left corner in the texture.
    corner: Vec2,
}

/// All charts of one model.
pub(super) struct Layout {
    pub(super) charts: Vec<Chart>,
    /// Texture widths per unit of length.
    scale: f32,
    /// Columns round the body and a handle.
    round: (usize, usize),
    detailed: bool,
}

/// Knots at which the profile is cut, and the rows of triangles between, for the
/// detailed and the coarse model.
const BANDS: [(f32, f32, usize, usize); 11] = [
    (0.0, 1.0, 3, 1),
    (1.0, 4.0, 18, 3),
    (4.0, 5.0, 7, 1),
    (5.0, 6.0, 12, 1),
    (6.0, 8.0, 32, 2),
    (8.0, 9.0, 15, 1),
    (9.0, 10.0, 13, 1),
    (10.0, 13.0, 16, 3),
    (13.0, 16.0, 10, 3),
    (16.0, 18.0, 3, 2),
    (18.0, 19.0, 2, 1),
];

impl Layout {
    pub(super) fn detailed() -> Self {
        Self::new(true, (208, 16), 64, 4, 4.0 / 1024.0)
    }

    pub(super) fn coarse() -> Self {
        Self::new(false, (20, 5), 8, 2, 6.0 / 512.0)
    }

    fn new(detailed: bool, round: (usize, usize), handle_rows: usize, strips: usize, gutter: f32) -> Self {
        let mut charts = Vec::new();
        for (index, (from, to, fine, coarse)) in BANDS.into_iter().enumerate() {
            let rows = if detailed { fine } else { coarse };
            let disc = index == 0 || index == BANDS.len() - 1;
            let strips = if disc { 1 } else { strips };
            for strip in 0..strips {
                // Two cuts are under the handles, four between them.
                let column = |s: usize| round.0 / 2 / strips + s * round.0 / strips;
                charts.push(Chart {
                    part: Part::Body,
                    columns: (column(strip), column(strip + 1)),
                    ends: (from, to),
                    rows,
                    disc,
                    size: band_size(from, to, disc) / Vec2::new(strips as f32, 1.0),
                    corner: Vec2::ZERO,
                });
            }
        }
        for side in [1.0, -1.0] {
            let part = Part::Handle { side };
            for (from, to) in [(0.0, 0.5), (0.5, 1.0)] {
                let at = |step: usize| surface(part, 0.25, from + step as f32 / 64.0, false);
                let length = (0..32).map(|step| at(step).distance(at(step + 1))).sum();
                charts.push(Chart {
                    part,
                    columns: (0, round.1),
                    ends: (from, to),
                    rows: handle_rows / 2,
                    disc: false,
                    size: Vec2::new(TAU * 0.07, length),
                    corner: Vec2::ZERO,
                });
            }
        }
        let (mut fits, mut fails) = (0.01, 2.0);
        for _ in 0..30 {
            let scale = 0.5 * (fits + fails);
            if pack(&mut charts, scale, gutter) {
                fits = scale;
            } else {
                fails = scale;
            }
        }
        pack(&mut charts, fits, gutter);
        Self { charts, scale: fits, round, detailed }
    }

    /// The mesh, with smooth normals.
    pub(super) fn tessellate(&self) -> Mesh {
        let mut mesh = Mesh::default();
        for chart in &self.charts {
            let round = self.round_of(chart.part);
            let (first, last) = chart.columns;
            let row_length = (last - first + 1) as u32;
            let start = mesh.positions.len() as u32;
            for row in 0..=chart.rows {
                let v = chart.ends.0 + (chart.ends.1 - chart.ends.0) * row as f32 / chart.rows as f32;
                for column in first..=last {
                    // Modulo, so that the last column meets the first exactly.
                    let u = (column % round) as f32 / round as f32;
                    mesh.positions.push(surface(chart.part, u, v, self.detailed));
                    mesh.uvs.push(self.place(chart, column as f32 / round as f32, v));
                }
            }
            for row in 0..chart.rows as u32 {
                for column in 0..row_length - 1 {
                    let a = start + row * row_length + column;
                    let (b, c, d) = (a + 1, a + row_length + 1, a + row_length);
                    mesh.triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
        // At the profile's ends the rows shrink to a point.
        let positions = &mesh.positions;
        mesh.triangles.retain(|t| {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            let same = |p: Vec3, q: Vec3| p.distance_squared(q) < 1e-12;
            !(same(a, b) || same(b, c) || same(c, a))
        });
        mesh.triangle_materials = vec![0; mesh.triangles.len()];
        crate::vertices::drop_unused(&mut mesh);
        mesh.normals = smooth_normals(&mesh);
        mesh
    }

    fn round_of(&self, part: Part) -> usize {
        if part == Part::Body { self.round.0 } else { self.round.1 }
    }

    /// Where a point of a chart is in the texture.
    fn place(&self, chart: &Chart, u: f32, v: f32) -> Vec2 {
        let size = chart.size * self.scale;
        if chart.disc {
            let (radius, turn) = (profile(v).x * self.scale, chart.turn());
            let (sin, cos) = (turn * u * TAU).sin_cos();
            return chart.corner + size * 0.5 + Vec2::new(cos, -sin) * radius;
        }
        let round = self.round_of(chart.part) as f32;
        let (first, last) = (chart.columns.0 as f32 / round, chart.columns.1 as f32 / round);
        let across = (u - first) / (last - first);
        let up = (v - chart.ends.0) / (chart.ends.1 - chart.ends.0);
        chart.corner + size * Vec2::new(across, 1.0 - up)
    }

    /// The inverse of [`Layout::place`], going on straight outside the chart.
    pub(super) fn find(&self, chart: &Chart, place: Vec2) -> (f32, f32) {
        let size = chart.size * self.scale;
        let (start, end) = chart.ends;
        if chart.disc {
            let offset = place - chart.corner - size * 0.5;
            let radius = offset.length() / (0.5 * size.x);
            let angle = (-offset.y).atan2(offset.x) * chart.turn();
            let v = if chart.turn() < 0.0 { start + radius } else { end - radius };
            return ((angle / TAU).rem_euclid(1.0), v.clamp(start, end));
        }
        let round = self.round_of(chart.part) as f32;
        let (first, last) = (chart.columns.0 as f32 / round, chart.columns.1 as f32 / round);
        let inside = (place - chart.corner) / size;
        (first + (last - first) * inside.x, end - (end - start) * inside.y)
    }

    /// A chart's bounds in the texture, `margin` added.
    pub(super) fn bounds(&self, chart: &Chart, margin: f32) -> (Vec2, Vec2) {
        (chart.corner - margin, chart.corner + chart.size * self.scale + margin)
    }
}

impl Chart {
    /// The sense in which `u` goes round a disc, so that it is not mirrored:
    /// −1 where the profile leads outwards.
    fn turn(&self) -> f32 {
        if profile(self.ends.1).x > profile(self.ends.0).x { -1.0 } else { 1.0 }
    }
}

/// Mean circumference and length of a band of the profile; a disc's diameter.
fn band_size(from: f32, to: f32, disc: bool) -> Vec2 {
    const STEPS: usize = 64;
    let at = |step: usize| profile(from + (to - from) * step as f32 / STEPS as f32);
    let (mut length, mut area) = (0.0, 0.0);
    for step in 0..STEPS {
        let (a, b) = (at(step), at(step + 1));
        length += a.distance(b);
        area += a.distance(b) * TAU * 0.5 * (a.x + b.x);
    }
    if disc {
        Vec2::splat(2.0 * profile(from).x.max(profile(to).x))
    } else {
        Vec2::new(area / length, length)
    }
}

/// Places the charts at this scale; whether they fit.
fn pack(charts: &mut [Chart], scale: f32, gutter: f32) -> bool {
    let mut order: Vec<usize> = (0..charts.len()).collect();
    order.sort_by(|&a, &b| charts[b].size.y.total_cmp(&charts[a].size.y).then(a.cmp(&b)));
    let (mut x, mut y, mut shelf) = (gutter, gutter, 0.0f32);
    for index in order {
        let chart = &mut charts[index];
        let size = chart.size * scale;
        if x + size.x + gutter > 1.0 {
            (x, y, shelf) = (gutter, y + shelf + gutter, 0.0);
        }
        chart.corner = Vec2::new(x, y);
        shelf = shelf.max(size.y);
        if x + size.x + gutter > 1.0 || y + size.y + gutter > 1.0 {
            return false;
        }
        x += size.x + gutter;
    }
    true
}
