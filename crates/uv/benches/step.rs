//! Whole steps of the default method, energies, contact, line search and texture included, for the
//! layout in `charts` with as many samples as a bake takes. A run makes ten of them, so a tenth of
//! what is printed is a step:
//!
//!     cargo bench -p parbake-uv --bench step

mod charts;

use charts::{layout, noise};
use divan::Bencher;
use glam::{DMat2, Vec4};
use parbake_atlas::Layout;
use parbake_uv::contact::ContactOptions;
use parbake_uv::optimise::{Balance, Problem, UvOptions, refine, shape, tensors};
use parbake_uv::signal::{Pixels, Sample, Signal};
use std::hint::black_box;

/// Samples of the larger showing.
const SAMPLES: usize = 400_000;

/// Steps of a run.
const STEPS: usize = 10;

fn main() {
    divan::main();
}

/// Stripes that get finer from left to right, as samples of every triangle.
fn signal_scale(layout: &Layout, samples: usize) -> Signal {
    let each = samples / layout.triangles.len();
    let all: Vec<(u32, Sample)> = (0..layout.triangles.len())
        .flat_map(|t| (0..each).map(move |i| (t, i)))
        .map(|(t, i)| {
            let seed = (t * each + i) as u64;
            let (b, c) = (0.5 + 0.5 * noise(2 * seed), 0.5 + 0.5 * noise(2 * seed + 1));
            let (b, c) = if b + c <= 1.0 { (b, c) } else { (1.0 - b, 1.0 - c) };
            let [p, q, r] = layout.triangles[t].map(|v| layout.points[v as usize]);
            let at = p + (q - p) * b + (r - p) * c;
            let target = Vec4::splat((0.5 + 0.5 * (400.0 * at.x * at.x + 60.0 * at.y).sin()) as f32);
            let weight = 1.0 / (each * layout.triangles.len()) as f32;
            (t as u32, Sample { target, barycentric: [b as f32, c as f32], weight })
        })
        .collect();
    let mut signal = Signal::new(layout.triangles.len(), &all);
    signal.pixels = Pixels::Each(layout.rest.iter().map(|rest| rest.inverse() / 512.0).collect());
    signal
}

/// The layout with rest shapes of its own size, and its showings.
fn prepared() -> (Layout, Vec<Signal>, ContactOptions) {
    let mut layout = layout();
    layout.rest = (layout.triangles.iter())
        .map(|triangle| {
            let [a, b, c] = triangle.map(|v| layout.points[v as usize]);
            DMat2::from_cols(b - a, c - a)
        })
        .collect();
    let signal_scales = vec![signal_scale(&layout, SAMPLES), signal_scale(&layout, SAMPLES / 4)];
    let contact = ContactOptions { texture_size: 1024, ..ContactOptions::default() };
    (layout, signal_scales, contact)
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn ten_steps_of_the_start(bencher: Bencher) {
    let (layout, signal_scales, contact) = prepared();
    let problem =
        Problem { rest: &layout.rest, signal_scales: &signal_scales, texture_size: 1024, contact: &contact };
    let tensors = tensors(&problem, &layout);
    let options = UvOptions { shape_steps: STEPS, ..UvOptions::default() };
    bencher.bench_local(|| {
        let mut moved = black_box(layout.clone());
        let mut steps = 0;
        shape(&problem, &mut moved, &tensors, &options, |_, _| {
            steps += 1;
            true
        });
        assert!(steps > 0 && moved.points != layout.points);
        moved
    });
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn ten_steps_of_variable_projection(bencher: Bencher) {
    let (layout, signal_scales, contact) = prepared();
    let problem =
        Problem { rest: &layout.rest, signal_scales: &signal_scales, texture_size: 1024, contact: &contact };
    let (balance, texture) = Balance::new(&problem, &layout);
    let options = UvOptions { refine_steps: STEPS, tolerance: 0.0, ..UvOptions::default() };
    bencher.bench_local(|| {
        let mut moved = black_box(layout.clone());
        let mut steps = 0;
        refine(&problem, &balance, &mut moved, texture.clone(), &options, |_, _| {
            steps += 1;
            true
        });
        assert!(steps > 0 && moved.points != layout.points);
        moved
    });
}
