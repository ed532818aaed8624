//! What one iteration asks of contact, for 50,000 triangles in 500 charts with 20,000
//! boundary edges, in a texture of 1024 texels:
//!
//!     cargo bench -p parbake-uv --bench contact

use divan::Bencher;
use glam::{DMat2, DVec2, dvec2};
use parbake_atlas::Layout;
use parbake_uv::contact::{Contact, ContactOptions};
use parbake_uv::inversion;
use std::hint::black_box;

/// Charts in a row and in a column.
const CHARTS: [usize; 2] = [10, 50];

/// Quads of a chart.
const QUADS: [usize; 2] = [17, 3];

fn main() {
    divan::main();
}

/// A number in [−1, 1] that looks random.
fn noise(seed: u64) -> f64 {
    let mut x = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Strips of jittered quads, three texels apart.
fn layout() -> Layout {
    let mut layout = Layout::default();
    for chart in 0..CHARTS[0] * CHARTS[1] {
        let first = layout.points.len() as u32;
        let room = dvec2(1.0 / CHARTS[0] as f64, 1.0 / CHARTS[1] as f64);
        let corner = room * dvec2((chart % CHARTS[0]) as f64, (chart / CHARTS[0]) as f64);
        let inner = room - 3.0 / 1024.0;
        for row in 0..=QUADS[1] {
            for column in 0..=QUADS[0] {
                let at = dvec2(column as f64 / QUADS[0] as f64, row as f64 / QUADS[1] as f64);
                let seed = 2 * layout.points.len() as u64;
                let jitter = 0.2 / 1024.0 * dvec2(noise(seed), noise(seed + 1));
                layout.points.push(corner + 1.5 / 1024.0 + inner * at + jitter);
            }
        }
        let width = QUADS[0] as u32 + 1;
        for row in 0..QUADS[1] as u32 {
            for column in 0..QUADS[0] as u32 {
                let a = first + row * width + column;
                layout.triangles.push([a, a + 1, a + width + 1]);
                layout.triangles.push([a, a + width + 1, a + width]);
                layout.charts.extend([chart as u32; 2]);
            }
        }
    }
    layout.rest = vec![DMat2::IDENTITY; layout.triangles.len()];
    layout.point_of_vertex = (0..layout.points.len() as u32).collect();
    layout.round();
    layout
}

/// A direction in which all points go about so many texels.
fn direction(layout: &Layout, texels: f64) -> Vec<DVec2> {
    let count = layout.points.len() as u64;
    (0..count).map(|i| texels / 1024.0 * dvec2(noise(3 * i + 7), noise(3 * i + 8))).collect()
}

fn contact(layout: &Layout) -> Contact {
    Contact::new(layout, &ContactOptions::default())
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn preparation(bencher: Bencher) {
    let layout = layout();
    bencher.bench_local(|| contact(black_box(&layout)));
}

#[divan::bench(sample_count = 50, sample_size = 1)]
fn energy_and_gradient(bencher: Bencher) {
    let layout = layout();
    let contact = contact(&layout);
    let mut gradient = vec![DVec2::ZERO; layout.points.len()];
    bencher.bench_local(|| contact.energy_and_gradient(black_box(&layout.points), &mut gradient));
}

#[divan::bench(args = [1.0, 30.0, 1e6], sample_count = 20, sample_size = 1)]
fn contact_step(bencher: Bencher, texels: f64) {
    let layout = layout();
    let (contact, direction) = (contact(&layout), direction(&layout, texels));
    bencher.bench_local(|| contact.max_step(black_box(&layout.points), &direction, 1.0));
}

/// All points go to the middle of the square, so that they get far before charts meet.
#[divan::bench(sample_count = 20, sample_size = 1)]
fn contact_step_of_a_shrinkage(bencher: Bencher) {
    let layout = layout();
    let contact = contact(&layout);
    let direction: Vec<DVec2> = layout.points.iter().map(|p| 0.5 - p).collect();
    bencher.bench_local(|| contact.max_step(black_box(&layout.points), &direction, 1.0));
}

#[divan::bench(sample_count = 50, sample_size = 1)]
fn inversion_step(bencher: Bencher) {
    let layout = layout();
    let (upright, direction) = (inversion::upright(&layout), direction(&layout, 1.0));
    bencher.bench_local(|| inversion::max_step(&upright, black_box(&layout.points), &direction, 1.0));
}

#[divan::bench(sample_count = 50, sample_size = 1)]
fn inversion_check(bencher: Bencher) {
    let layout = layout();
    let upright = inversion::upright(&layout);
    bencher.bench_local(|| inversion::all_upright(&upright, black_box(&layout.points)));
}

#[divan::bench(sample_count = 50, sample_size = 1)]
fn feasibility(bencher: Bencher) {
    let layout = layout();
    let contact = contact(&layout);
    bencher.bench_local(|| contact.feasible_after_rounding(black_box(&layout.points)));
}
