//! Packing of many and of few charts:
//!
//!     cargo bench -p parbake-atlas --bench pack

use divan::Bencher;
use glam::{DMat2, DVec2, dvec2};
use parbake_atlas::{ChartScale, Layout, PackOptions, pack};
use std::hint::black_box;

fn main() {
    divan::main();
}

/// Numbers from 0 to 1 that look random.
fn noise(seed: u64) -> f64 {
    let mixed = (seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ((mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as f64 / (1u64 << 24) as f64
}

/// So many stars of five to twelve corners, few of them large, each a fan of triangles: slim, bulky and with bays, as
/// unwrapping leaves them.
fn stars(count: usize) -> Layout {
    let mut layout = Layout::default();
    for star in 0..count {
        let random = |k: usize| noise((100 * star + k) as u64);
        let corners = 5 + (8.0 * random(0)) as usize;
        let (size, slim) = (0.02 + random(1).powi(4), 0.15 + 0.85 * random(2));
        let first = layout.points.len() as u32;
        layout.points.push(DVec2::ZERO);
        for corner in 0..corners {
            let angle = std::f64::consts::TAU * corner as f64 / corners as f64;
            let radius = size * (0.4 + 0.6 * random(3 + corner));
            layout.points.push(radius * dvec2(angle.cos(), slim * angle.sin()));
        }
        for corner in 0..corners as u32 {
            let (b, c) = (first + 1 + corner, first + 1 + (corner + 1) % corners as u32);
            layout.triangles.push([first, b, c]);
            let [b, c] = [b, c].map(|i| layout.points[i as usize]);
            layout.rest.push(DMat2::from_cols(b, c));
            layout.charts.push(star as u32);
        }
    }
    layout
}

#[divan::bench(args = [(20, 512), (300, 512), (1500, 256), (600, 1024)], sample_count = 5, sample_size = 1)]
fn charts_and_texels(bencher: Bencher, (count, texture_size): (usize, usize)) {
    let layout = stars(count);
    let options = PackOptions { texture_size, chart_scale: ChartScale::Keep, ..PackOptions::default() };
    bencher.bench_local(|| pack(black_box(&layout), &options));
}
