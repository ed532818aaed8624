//! What the fit costs: making samples of views, one step of each texture, and the
//! linear solver that both steps share.
//!
//! The scene is the built-in pair of models with 128 views of 192² and textures of
//! 512², a fifth of a default bake. Items are samples, or texels and solver steps; all
//! benches run on rayon's threads (set `RAYON_NUM_THREADS=1` for one core).

mod scene;

use divan::Bencher;
use divan::counter::ItemsCount;
use parbake_fit::backend::Cpu;
use parbake_fit::membrane::Membrane;
use parbake_fit::problem::{Problem, ShadedProblem, footprint};
use parbake_fit::robust_loss::Cauchy;
use parbake_fit::step::{StepOptions, Workspace, fit_step};
use parbake_image::display_table::DisplayTable;
use parbake_image::{FloatImage, MapKind, MapSet};
use parbake_mesh::{charts, texel_map};
use parbake_model::Mesh;
use parbake_model::glam::{Vec3, Vec4};
use parbake_render::shade::Lambert;
use parbake_solve::conjugate_gradient::{Effort, solve};
use parbake_solve::grid::block;
use parbake_solve::stencil::{Block, Diagonal, Row, Stencil, Symmetric, add_diagonal, add_symmetric};
use parbake_views::chart_labels::Atlas;
use parbake_views::reference::Reference;
use parbake_views::samples::{SampleSet, collect_samples};
use parbake_views::view_sampler::{UncoveredPixels, ViewSampler};
use scene::{DISPLAY, VIEW_SIZE};
use std::sync::LazyLock;

const TEXTURE_SIZE: usize = 512;

/// Solver steps of a bench: those of a step of the fit.
const EFFORT: Effort = Effort { steps: 6, tolerance: 0.0 };

fn main() {
    divan::main();
}

struct Bench {
    low: Mesh,
    references: Vec<Reference>,
    atlas: Atlas,
    samples: SampleSet,
    display: DisplayTable,
    maps: MapSet,
}

/// Rendering the references takes longer than all benches.
static BENCH: LazyLock<Bench> = LazyLock::new(|| {
    let (low, references) = scene::rendered();
    let atlas = Atlas::new(&texel_map(&low, TEXTURE_SIZE), &charts(&low), 2);
    Bench {
        samples: collect(&low, &references),
        display: DisplayTable::new(&DISPLAY),
        maps: MapSet::of(
            FloatImage::solid(TEXTURE_SIZE, Vec4::new(0.5, 0.5, 0.5, 0.0)),
            FloatImage::solid(TEXTURE_SIZE, Vec4::Z),
        ),
        low,
        references,
        atlas,
    }
});

fn collect(low: &Mesh, references: &[Reference]) -> SampleSet {
    let beyond = UncoveredPixels::Background([0.0; 3], 0.5);
    collect_samples(&ViewSampler::new(low, VIEW_SIZE, &DISPLAY, beyond), references, TEXTURE_SIZE, &())
}

impl Bench {
    fn problem(&self) -> ShadedProblem<'_, Lambert> {
        let Self { samples, atlas, display, .. } = self;
        ShadedProblem { samples, atlas, display, brdf: &Lambert, robust: Cauchy::new(1.0) }
    }

    fn count(&self) -> ItemsCount {
        ItemsCount::new(self.samples.len())
    }

    /// A matrix of all samples, of one block each, with something on the diagonal: no
    /// texel is skipped, as those that nothing pulls at are in a bake.
    fn matrix<B: Block>(&self, add: impl Fn(&mut [Row<B>], [usize; 4], [f32; 4])) -> Stencil<B> {
        let mut rows = vec![Row::default(); TEXTURE_SIZE * TEXTURE_SIZE];
        for sample in self.samples.iter() {
            let (_, weights) = footprint(sample, TEXTURE_SIZE);
            add(&mut rows, block(sample.texel as usize, TEXTURE_SIZE), weights);
        }
        for row in &mut rows {
            row.centre.add(&B::identity(0.1));
        }
        Stencil { size: TEXTURE_SIZE, rows }
    }

    fn diagonal(&self) -> Stencil<Diagonal> {
        self.matrix(|rows, places, w| add_diagonal(rows, places, w, Vec4::ONE, Vec4::ONE))
    }

    fn symmetric(&self) -> Stencil<Symmetric> {
        let pull = Symmetric::outer(Vec3::new(0.3, 0.2, 0.9), 1.0);
        self.matrix(|rows, places, w| add_symmetric(rows, places, w, &pull, Vec4::ONE))
    }
}

const COLOR_MEMBRANE: Membrane = Membrane { stiffness: 3e-3, least: 0.0, tether: 1e-5 };
const NORMAL_MEMBRANE: Membrane = Membrane { stiffness: 0.2, least: 0.0, tether: 1e-3 };

/// From rendered views to samples sorted by their place on the texture.
#[divan::bench(sample_size = 1, sample_count = 15)]
fn sampling(bencher: Bencher) {
    let b = &*BENCH;
    bencher.counter(b.count()).bench_local(|| collect(&b.low, &b.references));
}

/// The loss alone: the forward half of a step.
#[divan::bench(sample_size = 1, sample_count = 15)]
fn loss_forward(bencher: Bencher) {
    let b = &*BENCH;
    let problem = b.problem();
    bencher.counter(b.count()).bench_local(|| problem.loss(&b.maps));
}

/// A step of one map with so many steps of the solver.
fn step(bencher: Bencher, kind: MapKind, membrane: Membrane, effort: Effort) {
    let b = &*BENCH;
    let (problem, mut workspace) = (b.problem(), Workspace::default());
    let options = StepOptions { membrane, effort, damping: 6.0 };
    let start = b.maps.get(kind).cloned().unwrap_or_default();
    bencher.counter(b.count()).with_inputs(|| b.maps.clone()).bench_local_values(|mut maps| {
        fit_step(&Cpu, kind, &problem, &options, &mut maps, &start, &mut workspace)
    });
}

/// A whole step of the colours, solver included.
#[divan::bench(sample_size = 1, sample_count = 15)]
fn step_of_colors(bencher: Bencher) {
    step(bencher, MapKind::BaseColor, COLOR_MEMBRANE, EFFORT);
}

/// The same without solver steps: what is left is accumulation.
#[divan::bench(sample_size = 1, sample_count = 15)]
fn step_of_colors_unsolved(bencher: Bencher) {
    step(bencher, MapKind::BaseColor, COLOR_MEMBRANE, Effort { steps: 0, ..EFFORT });
}

/// A whole step of the normals, solver included.
#[divan::bench(sample_size = 1, sample_count = 15)]
fn step_of_normals(bencher: Bencher) {
    step(bencher, MapKind::Normal, NORMAL_MEMBRANE, EFFORT);
}

/// The same without solver steps.
#[divan::bench(sample_size = 1, sample_count = 15)]
fn step_of_normals_unsolved(bencher: Bencher) {
    step(bencher, MapKind::Normal, NORMAL_MEMBRANE, Effort { steps: 0, ..EFFORT });
}

fn product<B: Block>(bencher: Bencher, matrix: &Stencil<B>) {
    let x: Vec<Vec4> = matrix.rows.iter().map(|row| row.right).collect();
    let mut y = x.clone();
    bencher.counter(ItemsCount::new(x.len())).bench_local(|| matrix.product(&x, &mut y));
}

fn conjugate_gradients<B: Block>(bencher: Bencher, matrix: &Stencil<B>) {
    let items = ItemsCount::new(matrix.rows.len() * EFFORT.steps);
    bencher.counter(items).bench_local(|| solve(matrix, None, &EFFORT));
}

/// Items are texels.
#[divan::bench(sample_size = 1, sample_count = 30)]
fn product_of_colors(bencher: Bencher) {
    product(bencher, &BENCH.diagonal());
}

/// Items are texels.
#[divan::bench(sample_size = 1, sample_count = 30)]
fn product_of_normals(bencher: Bencher) {
    product(bencher, &BENCH.symmetric());
}

/// Items are texels times solver steps.
#[divan::bench(sample_size = 1, sample_count = 15)]
fn solver_of_colors(bencher: Bencher) {
    conjugate_gradients(bencher, &BENCH.diagonal());
}

/// Items are texels times solver steps.
#[divan::bench(sample_size = 1, sample_count = 15)]
fn solver_of_normals(bencher: Bencher) {
    conjugate_gradients(bencher, &BENCH.symmetric());
}
