//! The image loss as a function of the texture, for layouts that stand still.
//!
//! Forward: `L = Σₛ ωₛ |Σ wᵢ Tᵢ − yₛ|² / (W C)` over samples s of weight ωₛ whose sum is W,
//! and C channels: the mean squared error of [`crate::residual::residual`].
//! Adjoint: `∂L/∂T = 2 (A T − b) / (W C)` with the normal matrix A and its right-hand side b,
//! the full batch at once. They are summed up when the layout has moved; a gradient then
//! costs nine products a texel, however many samples there are.

use crate::footprint::{Footprint, OnLevel};
use crate::least_squares_texture::ParameterizedSignal;
use crate::normal_matrix::{NormalMatrix, Patch};
use glam::Vec4;
use rayon::prelude::*;

/// The loss for one layout.
#[derive(Clone, Debug)]
pub struct TextureLoss {
    matrix: NormalMatrix,
    /// 2 / (W C).
    scale: f32,
}

impl TextureLoss {
    /// For a texture of size² texels, size ≥ 2, of which the finest level alone is looked at.
    /// `mean_over` is W C.
    pub fn new(mapped: &ParameterizedSignal, size: usize, mean_over: f64) -> Self {
        let patches: Vec<Patch> =
            (0..mapped.runs.count()).into_par_iter().map(|run| patch(mapped, run, size)).collect();
        Self { matrix: NormalMatrix::sum(size, patches.iter()), scale: (2.0 / mean_over) as f32 }
    }

    /// Overwrites `gradient` (size² values) with ∂L/∂T at `texels`.
    pub fn gradient(&self, texels: &[Vec4], gradient: &mut [Vec4]) {
        self.matrix.product(texels, gradient);
        let right = &self.matrix.right;
        gradient.par_iter_mut().zip(right).for_each(|(g, right)| *g = (*g - *right) * self.scale);
    }
}

/// What the triangles of a run add to the matrix.
fn patch(mapped: &ParameterizedSignal, run: usize, size: usize) -> Patch {
    let footprints: Vec<(usize, OnLevel)> = mapped
        .runs
        .triangles(run)
        .map(|t| (t, Footprint::new(mapped.points, mapped.triangles[t]).on(size)))
        .collect();
    let (mut low, mut high) = ([size; 2], [0; 2]);
    for (_, footprint) in &footprints {
        let [from, to] = footprint.bounds();
        for k in 0..2 {
            low[k] = low[k].min(from[k]);
            high[k] = high[k].max(to[k]);
        }
    }
    if footprints.is_empty() {
        return Patch::default();
    }
    let mut patch = Patch::new(low, high);
    for (t, footprint) in &footprints {
        for sample in mapped.signal_scales.iter().flat_map(|signal| signal.of(*t)) {
            let (texel, fractions, _) = footprint.place(sample);
            patch.add_sample(texel, fractions, sample.weight, sample.target);
        }
    }
    patch
}
