//! The seam for a GPU: the coarse operations in which a bake spends its time, on flat buffers of
//! plain elements.
//!
//! ```text
//! view samples ─────┬ assemble ─ solve     (texture solve, `step.rs`)
//! material samples ─┘
//! view gradient                            (parallax fit, `parallax.rs`)
//! ```
//!
//! Elements are `repr(C)`: [`Sample`](parbake_views::samples::Sample), [`MaterialSample`],
//! [`ViewSample`], [`Row`] and `Vec4`. A kernel for each operation can
//! stand in the place of the [`Cpu`]'s; nothing is kept between calls. Views are sampled by three functions: `sample_views`
//! keeps each view's samples; `view_samples` and `shifted_view_samples` gather those of all views by texel. Functions of
//! this crate take the implementation as an argument, so that their callers choose it.
//!
//! Contract: results depend on the arguments alone, not on the number of threads.

use crate::assemble::{SampleBlock, assemble_on_cpu};
use crate::problem::Problem;
use crate::robust_loss::Loss;
use crate::texels::Texels;
use crate::view_gradient::{Sums, add_view};
use parbake_image::display_table::DisplayTable;
use parbake_image::{MapKind, MapSet};
use parbake_model::glam::Vec4;
use parbake_progress::Watcher;
use parbake_render::parallax_variants::shift_map::ShiftMap;
use parbake_render::shade::Brdf;
use parbake_solve::conjugate_gradient::{self, Effort, Outcome};
use parbake_solve::free_lanes::FreeLanes;
use parbake_solve::stencil::{Block, Row, Stencil};
use parbake_views::high_poly::ViewSet;
use parbake_views::material_sample::MaterialSample;
use parbake_views::material_sampler::MaterialSampler;
use parbake_views::reference::Reference;
use parbake_views::samples::{SampleSet, collect_samples, shifted_samples};
use parbake_views::view_sample::{ViewSample, sample_views};
use parbake_views::view_sampler::ViewSampler;

/// What a bake asks of the machine.
pub trait Backend: Sync {
    /// The samples of each view, for what reads views again and again: shifts, cutouts and their gradients.
    fn sample_views(&self, sampler: &ViewSampler, references: &[Reference]) -> Vec<Vec<ViewSample>>;

    /// The samples of all views on a texture of `texture_size`² texels.
    fn view_samples(
        &self,
        sampler: &ViewSampler,
        references: &[Reference],
        texture_size: usize,
        watcher: &dyn Watcher,
    ) -> SampleSet;

    /// The same of views that were sampled before, their coordinates shifted by a map. Views that are
    /// handed over rather than lent are freed once they were read.
    fn shifted_view_samples<V: AsRef<[ViewSample]> + Send, M: ShiftMap>(
        &self,
        views: Vec<V>,
        texture_size: usize,
        map: &M,
        watcher: &dyn Watcher,
    ) -> SampleSet;

    /// The samples of the high-poly's materials in all views of a set, on a texture of `texture_size`² texels,
    /// and how many views there were time for. The sampler's shift, if it has one, is a function on the CPU: an
    /// implementation that cannot call it leaves such samplers to [`MaterialSampler::samples`].
    fn material_samples(
        &self,
        sampler: &MaterialSampler,
        set: &ViewSet,
        texture_size: usize,
        watcher: &dyn Watcher,
    ) -> (SampleSet<MaterialSample>, usize);

    /// The normal equations of one map over all samples, texture size² rows; returns the loss.
    fn assemble<P: Problem, S: SampleBlock>(
        &self,
        kind: MapKind,
        problem: &P,
        maps: &MapSet,
        rows: &mut Vec<Row<S>>,
    ) -> Loss;

    /// Solves `A x = b` from zero by conjugate gradients, b being the matrix's own right-hand side; lanes that are not
    /// `free` stay.
    fn solve<S: Block>(
        &self,
        matrix: &Stencil<S>,
        free: Option<&[FreeLanes]>,
        effort: &Effort,
    ) -> (Vec<Vec4>, Outcome);

    /// Adds the loss of one view's pixels, and its gradient by N maps and the parallax map.
    fn view_gradient<B: Brdf, M: ShiftMap, const N: usize>(
        &self,
        pixels: &[ViewSample],
        map: &M,
        texels: &Texels<N>,
        brdf: &B,
        display: &DisplayTable,
        sums: &mut Sums<M, N>,
    );
}

/// All cores of this machine, through rayon's current thread pool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cpu;

impl Backend for Cpu {
    fn sample_views(&self, sampler: &ViewSampler, references: &[Reference]) -> Vec<Vec<ViewSample>> {
        sample_views(sampler, references)
    }

    fn view_samples(
        &self,
        sampler: &ViewSampler,
        references: &[Reference],
        texture_size: usize,
        watcher: &dyn Watcher,
    ) -> SampleSet {
        collect_samples(sampler, references, texture_size, watcher)
    }

    fn shifted_view_samples<V: AsRef<[ViewSample]> + Send, M: ShiftMap>(
        &self,
        views: Vec<V>,
        texture_size: usize,
        map: &M,
        watcher: &dyn Watcher,
    ) -> SampleSet {
        shifted_samples(views, texture_size, map, watcher)
    }

    fn material_samples(
        &self,
        sampler: &MaterialSampler,
        set: &ViewSet,
        texture_size: usize,
        watcher: &dyn Watcher,
    ) -> (SampleSet<MaterialSample>, usize) {
        sampler.samples(set, texture_size, watcher)
    }

    fn assemble<P: Problem, S: SampleBlock>(
        &self,
        kind: MapKind,
        problem: &P,
        maps: &MapSet,
        rows: &mut Vec<Row<S>>,
    ) -> Loss {
        assemble_on_cpu(kind, problem, maps, rows)
    }

    fn solve<S: Block>(
        &self,
        matrix: &Stencil<S>,
        free: Option<&[FreeLanes]>,
        effort: &Effort,
    ) -> (Vec<Vec4>, Outcome) {
        conjugate_gradient::solve(matrix, free, effort)
    }

    fn view_gradient<B: Brdf, M: ShiftMap, const N: usize>(
        &self,
        pixels: &[ViewSample],
        map: &M,
        texels: &Texels<N>,
        brdf: &B,
        display: &DisplayTable,
        sums: &mut Sums<M, N>,
    ) {
        add_view(pixels, map, texels, brdf, display, sums);
    }
}
