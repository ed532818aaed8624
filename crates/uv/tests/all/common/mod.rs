//! Small layouts with made-up signals. A surface is its layout at the start: rest shapes and
//! pictures are those of the texture coordinates there.

#![allow(dead_code)]

use glam::{DMat2, DVec2, Vec4, dvec2};
use parbake_atlas::{Layout, check::check};
use parbake_uv::signal::{Sample, Signal};

/// Numbers in [0, 1) that are the same on every machine.
pub struct Random(pub u64);

impl Random {
    /// The next one (Knuth's MMIX generator, its upper bits).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }

    /// In [−1, 1)².
    pub fn vector(&mut self) -> DVec2 {
        dvec2(2.0 * self.next() - 1.0, 2.0 * self.next() - 1.0)
    }
}

/// Adds a chart of `quads`² quads in a square; inner points are moved by up to `jitter` of
/// a quad along each axis.
pub fn add_chart(
    layout: &mut Layout,
    random: &mut Random,
    corner: DVec2,
    size: f64,
    quads: u32,
    jitter: f64,
) {
    let first = layout.points.len() as u32;
    let chart = layout.charts.last().map_or(0, |c| c + 1);
    for row in 0..=quads {
        for column in 0..=quads {
            let inner = row % quads != 0 && column % quads != 0;
            let moved = if inner { jitter * random.vector() } else { DVec2::ZERO };
            let place = dvec2(f64::from(column), f64::from(row)) + moved;
            layout.points.push(corner + place * (size / f64::from(quads)));
        }
    }
    for row in 0..quads {
        for column in 0..quads {
            let a = first + row * (quads + 1) + column;
            layout.triangles.push([a, a + 1, a + quads + 2]);
            layout.triangles.push([a, a + quads + 2, a + quads + 1]);
            layout.charts.extend([chart; 2]);
        }
    }
}

/// Rounds the points and takes rest shapes from them.
pub fn finished(mut layout: Layout) -> Layout {
    layout.round();
    layout.rest = (0..layout.triangles.len())
        .map(|t| {
            let [a, b, c] = layout.corners(t);
            DMat2::from_cols(b - a, c - a)
        })
        .collect();
    layout.point_of_vertex = (0..layout.points.len() as u32).collect();
    layout
}

/// One jittered chart that fills the square.
pub fn plane(quads: u32, seed: u64) -> Layout {
    let mut layout = Layout::default();
    add_chart(&mut layout, &mut Random(seed), DVec2::ZERO, 1.0, quads, 0.25);
    finished(layout)
}

/// Up to four charts, one in each quarter of the square, `gap` from each other and half of it
/// from the border.
pub fn quarters(charts: u32, quads: u32, gap: f64, seed: u64) -> Layout {
    let (mut layout, mut random) = (Layout::default(), Random(seed));
    for chart in 0..charts {
        let corner = dvec2(f64::from(chart % 2), f64::from(chart / 2)) * 0.5 + 0.5 * gap;
        add_chart(&mut layout, &mut random, corner, 0.5 - gap, quads, 0.25);
    }
    finished(layout)
}

/// `along`² / 2 samples on each triangle of what `picture` shows at its place.
pub fn signal(layout: &Layout, along: u32, picture: impl Fn(DVec2) -> Vec4) -> Signal {
    let mut samples = Vec::new();
    for t in 0..layout.triangles.len() {
        let [a, b, c] = layout.corners(t);
        for (i, j) in (0..along).flat_map(|i| (0..along - i).map(move |j| (i, j))) {
            let weights = dvec2(f64::from(i) + 0.31, f64::from(j) + 0.27) / (f64::from(along) + 0.2);
            let place = a + (b - a) * weights.x + (c - a) * weights.y;
            let barycentric = weights.as_vec2().to_array();
            samples.push((t as u32, Sample { target: picture(place), barycentric, weight: 1.0 }));
        }
    }
    Signal::new(layout.triangles.len(), &samples)
}

/// A fine checker in the corner at (0, 0), and little elsewhere.
pub fn checkered_corner(place: DVec2) -> Vec4 {
    let fields = (place * 36.0).floor();
    let is_dark = (fields.x + fields.y) as i64 % 2 == 0;
    if place.max_element() < 0.3 {
        Vec4::splat(if is_dark { 0.1 } else { 0.9 })
    } else {
        Vec4::splat(0.5 + 0.1 * place.x as f32)
    }
}

/// Fails unless a layout is sound and its charts, if there are several, are `gutter` texels
/// apart.
pub fn assert_sound(layout: &Layout, texture_size: usize, gutter: f64) {
    assert!(layout.points.iter().all(|p| p.is_finite()));
    let found = check(layout, texture_size);
    assert!(found.is_bijective(), "{:?}", found.problems());
    if let Some(measured) = found.gutter {
        assert!(measured.texels >= gutter - 1e-4, "{} of {gutter} texels", measured.texels);
    }
}
