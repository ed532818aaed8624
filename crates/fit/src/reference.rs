//! The pictures to be matched: the high-poly from every training view, rendered
//! once and kept compactly, so that no later step depends on its size.
//!
//! Each pixel is the mean of a few samples spread over a box narrower than the
//! pixel: with the views' shifted grids the pool then shows the sharpness of much
//! larger pictures. Kept as four half floats a pixel: linear, premultiplied.

use crate::views::View;
use crate::watch::{Stage, Watch};
use half::f16;
use parbake_render::raster::{NOTHING, Visibility, rasterise};
use parbake_render::scene::Scene;
use parbake_render::shade::Shading;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How reference pictures are sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Pixels along a side of a view.
    pub size: usize,
    /// Width of a pixel's box filter in pixels, 0 … 1.
    pub filter: f32,
    /// Samples along a side of that box, ≥ 1.
    pub samples: usize,
}

/// One rendered training view.
#[derive(Clone, Debug)]
pub struct Reference {
    /// From where.
    pub view: View,
    /// size² pixels of premultiplied linear light and coverage.
    pub pixels: Vec<[f16; 4]>,
}

/// Renders the pool. Stops early, with fewer views, when asked to, but never
/// before `at_least` views are done.
pub fn render_references(
    high: &Scene,
    shading: &impl Shading,
    pool: &[View],
    sampling: &Sampling,
    at_least: usize,
    watch: &impl Watch,
) -> Vec<Reference> {
    let done = AtomicUsize::new(0);
    // Small groups in order, so that an early stop keeps a well-spread prefix.
    let group = rayon::current_num_threads().max(1) * 2;
    let mut out = Vec::with_capacity(pool.len());
    for (index, views) in pool.chunks(group).enumerate() {
        if index * group >= at_least && watch.should_stop() {
            break;
        }
        out.par_extend(views.par_iter().map(|view| {
            let picture = render(high, shading, view, sampling);
            watch.progress(Stage::Reference, done.fetch_add(1, Ordering::Relaxed) + 1, pool.len());
            picture
        }));
    }
    out
}

fn render(high: &Scene, shading: &impl Shading, view: &View, sampling: &Sampling) -> Reference {
    let Sampling { size, filter, samples } = *sampling;
    let screen = high.on_screen(&view.camera, size);
    let mut seen = Visibility::default();
    let mut sum = vec![[0.0f32; 4]; size * size];
    let share = 1.0 / (samples * samples) as f32;
    let footprint = (filter / samples as f32).max(1.0 / 16.0);
    for sample in 0..samples * samples {
        let shift =
            [sample % samples, sample / samples].map(|i| filter * ((i as f32 + 0.5) / samples as f32 - 0.5));
        let offset = (view.jitter[0] + shift[0], view.jitter[1] + shift[1]);
        rasterise(&screen, size, offset, &mut seen);
        for (index, (&triangle, pixel)) in seen.triangle.iter().zip(&mut sum).enumerate() {
            if triangle == NOTHING {
                continue;
            }
            let at = (
                (index % size) as f64 + 0.5 + f64::from(offset.0),
                (index / size) as f64 + 0.5 + f64::from(offset.1),
            );
            let light = high.shade(shading, &view.camera, &screen, triangle as usize, at, footprint);
            for k in 0..3 {
                pixel[k] += light[k] * share;
            }
            pixel[3] += share;
        }
    }
    let pixels = sum.into_iter().map(|p| p.map(f16::from_f32)).collect();
    Reference { view: *view, pixels }
}
