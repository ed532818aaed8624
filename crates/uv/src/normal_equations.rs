//! The normal equations `A x = b` of the best texture for given texture coordinates
//! (`least_squares_texture.rs` has the problem): `A = Σ_l Dˡᵀ Aˡ Dˡ` is kept as one nine-point matrix a mip
//! level and is never multiplied out.
//!
//! Contract: all channels share the matrix; sums are made run by run in order, so that they do not
//! depend on the number of threads.

use crate::footprint::{Footprint, OnLevel, shares};
use crate::normal_matrix::{NormalMatrix, Patch};
use crate::parameterized::ParameterizedSignal;
use crate::pyramid::{gather, halve, level_count};
use glam::{DVec2, Vec4};
use rayon::prelude::*;

/// The normal equations: one matrix a level, the first with the smoothness.
pub(crate) struct NormalEquations {
    /// Texels along a side.
    pub size: usize,
    /// Of the texture itself, and of each time it is halved.
    pub levels: Vec<NormalMatrix>,
    /// Right-hand side of the texture itself.
    pub right: Vec<Vec4>,
    /// Inverse of the whole matrix's diagonal.
    pub inverse: Vec<f32>,
}

impl NormalEquations {
    /// The sums over all samples of all scales.
    pub fn assemble(mapped: &ParameterizedSignal, size: usize, smoothness: f32) -> Self {
        let count = level_count(size);
        let runs: Vec<Vec<Patch>> =
            (0..mapped.runs.count()).into_par_iter().map(|run| patches(mapped, run, size, count)).collect();
        let used = (0..count)
            .rev()
            .find(|&level| runs.iter().any(|patches| !patches[level].is_empty()))
            .map_or(1, |level| level + 1);
        let mut levels: Vec<NormalMatrix> = (0..used)
            .map(|level| NormalMatrix::sum(size >> level, runs.iter().map(|patches| &patches[level])))
            .collect();
        // The weights of a sample's texels sum to 1, so that all couplings sum to what samples weigh.
        let weight: f64 = levels.iter().map(NormalMatrix::total).sum();
        let mean = weight as f32 / (size * size) as f32;
        levels[0].add_smoothness((smoothness * mean).max(1e-20));
        let mut rights: Vec<Vec<Vec4>> = levels.iter_mut().map(|m| std::mem::take(&mut m.right)).collect();
        gather(&mut rights, size);
        let inverse = (0..size * size)
            .into_par_iter()
            .map(|texel| {
                let (x, y) = (texel % size, texel / size);
                let diagonal: f32 = levels
                    .iter()
                    .enumerate()
                    .map(|(l, m)| m.rows[(y >> l) * m.size + (x >> l)].centre / (1u64 << (4 * l)) as f32)
                    .sum();
                1.0 / diagonal.max(1e-30)
            })
            .collect();
        Self { size, levels, right: rights.swap_remove(0), inverse }
    }

    /// Room for products.
    pub fn room(&self) -> Room {
        let level = |m: &NormalMatrix| vec![Vec4::ZERO; m.size * m.size];
        Room {
            halved: self.levels[1..].iter().map(level).collect(),
            products: self.levels.iter().map(level).collect(),
        }
    }

    /// `A x`, which lies in `room`.
    pub fn product<'a>(&self, x: &[Vec4], room: &'a mut Room) -> &'a mut [Vec4] {
        let Room { halved, products } = room;
        for level in 0..halved.len() {
            let (finer, coarser) = halved.split_at_mut(level);
            halve(finer.last().map_or(x, |l| l), self.levels[level + 1].size, &mut coarser[0]);
        }
        let pyramid = std::iter::once(x).chain(halved.iter().map(|l| &l[..]));
        for ((matrix, x), y) in self.levels.iter().zip(pyramid).zip(products.iter_mut()) {
            matrix.product(x, y);
        }
        gather(products, self.size);
        &mut products[0]
    }

    /// `b − A x`.
    pub fn residual(&self, x: &[Vec4], room: &mut Room) -> Vec<Vec4> {
        let product = self.product(x, room);
        product.par_iter().zip(&self.right).map(|(product, b)| *b - *product).collect()
    }
}

/// What products are made in, from one to the next.
pub(crate) struct Room {
    /// The texture halved once, twice, …
    halved: Vec<Vec<Vec4>>,
    /// A product a level.
    products: Vec<Vec<Vec4>>,
}

impl Room {
    /// Hands the last product out, in exchange for a vector of its length.
    pub fn exchange(&mut self, vector: &mut Vec<Vec4>) {
        std::mem::swap(&mut self.products[0], vector);
    }
}

/// What a run of triangles adds to the matrices of the `count` levels.
fn patches(mapped: &ParameterizedSignal, run: usize, size: usize, count: usize) -> Vec<Patch> {
    let corners = mapped.runs.own_points(run).points.iter().map(|&i| mapped.points[i as usize]);
    let [low, high] = corners.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[l, h], p| [l.min(p), h.max(p)]);
    let mut patches = vec![Patch::default(); count];
    for t in mapped.runs.triangles(run) {
        let footprint = Footprint::new(mapped.points, mapped.triangles[t]);
        for signal in mapped.signal_scales {
            let samples = signal.of(t);
            if samples.is_empty() {
                continue;
            }
            let shown = footprint.level(signal.pixels.of(t), size, count);
            for (level, share) in shares(&shown) {
                let (place, patch) = (footprint.on(size >> level), &mut patches[level]);
                if patch.is_empty() {
                    let [from, to] = OnLevel::of_box(low, high, size >> level).bounds();
                    *patch = Patch::new(from, to);
                }
                for sample in samples {
                    let (texel, fractions, _) = place.place(sample);
                    patch.add_sample(texel, fractions, sample.weight * share, sample.target);
                }
            }
        }
    }
    patches
}
