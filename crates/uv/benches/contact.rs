//! What one iteration asks of contact, for the layout in `charts`:
//!
//!     cargo bench -p parbake-uv --bench contact

mod charts;

use charts::{layout, noise};
use divan::Bencher;
use glam::{DVec2, dvec2};
use parbake_atlas::Layout;
use parbake_uv::contact::{Contact, ContactOptions};
use parbake_uv::inversion;
use std::hint::black_box;

fn main() {
    divan::main();
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
