//! What maps of depth cost: steps of the parallax map's fit and of the cutout's.
//!
//! The scene is the built-in pair of models; all benches run on rayon's threads (set
//! `RAYON_NUM_THREADS=1` for one core).

mod scene;

use divan::Bencher;
use divan::counter::ItemsCount;
use parbake_fit::backend::Cpu;
use parbake_fit::cutout::{CutoutOptions, examples, fit_cutout};
use parbake_fit::parallax::{ParallaxOptions, State, fit_parallax};
use parbake_image::display_table::DisplayTable;
use parbake_image::{FloatImage, MapSet};
use parbake_model::glam::Vec4;
use parbake_model::{Basis, Mesh};
use parbake_render::parallax::ParallaxCoefficients;
use parbake_render::shade::Lambert;
use parbake_views::reference::Reference;
use parbake_views::view_sample::sample_views;
use parbake_views::view_sampler::{UncoveredPixels, ViewSampler};
use scene::{DISPLAY, VIEW_SIZE};
use std::sync::LazyLock;

/// Steps of a sample: enough that what comes before the first does not show.
const STEPS: usize = 20;

static SCENE: LazyLock<(Mesh, Vec<Reference>)> = LazyLock::new(scene::rendered);

fn main() {
    divan::main();
}

fn sampler(low: &Mesh) -> ViewSampler<'_> {
    ViewSampler::new(low, VIEW_SIZE, &DISPLAY, UncoveredPixels::Ignore)
}

/// What the first steps look at, in all.
fn looked_at<T>(views: &[Vec<T>], views_per_step: usize) -> ItemsCount {
    ItemsCount::new((0..STEPS * views_per_step).map(|i| views[i % views.len()].len()).sum::<usize>())
}

fn parallax(bencher: Bencher, order: usize, size: usize) {
    let (low, references) = &*SCENE;
    let views = sample_views(&sampler(low), references);
    let options =
        ParallaxOptions { basis: Basis::Harmonics(order), steps: STEPS, ..ParallaxOptions::default() };
    let state = || State {
        map: ParallaxCoefficients::zeros(Basis::Harmonics(order), options.size),
        maps: MapSet::of(
            FloatImage::solid(size, Vec4::new(0.5, 0.5, 0.5, 0.0)),
            FloatImage::solid(size, Vec4::Z),
        ),
    };
    let display = DisplayTable::new(&DISPLAY);
    bencher.counter(looked_at(&views, options.views_per_step)).with_inputs(state).bench_local_values(
        |mut state| fit_parallax(&Cpu, &views, &mut state, &Lambert, &display, &options, &()),
    );
}

/// By the texture's size; items are pixels.
#[divan::bench(args = [128, 256, 512], sample_size = 1, sample_count = 9)]
fn parallax_by_texture(bencher: Bencher, size: usize) {
    parallax(bencher, 2, size);
}

/// By the order of the map's functions; items are pixels.
#[divan::bench(args = [0, 1, 2, 3, 4, 5, 6, 7], sample_size = 1, sample_count = 5)]
fn parallax_by_order(bencher: Bencher, order: usize) {
    parallax(bencher, order, 128);
}

/// By the order of the map's functions; items are examples.
#[divan::bench(args = [2, 4], sample_size = 1, sample_count = 9)]
fn cutout(bencher: Bencher, order: usize) {
    let (low, references) = &*SCENE;
    let options = CutoutOptions { basis: Basis::Harmonics(order), steps: STEPS, ..CutoutOptions::default() };
    let views = examples(&sampler(low), references, options.size);
    bencher
        .counter(looked_at(&views, options.views_per_step))
        .bench_local(|| fit_cutout(&views, &options, &()));
}
