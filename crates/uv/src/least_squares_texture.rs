//! The best texture for given texture coordinates: a linear least-squares problem.
//!
//! With a sample's place known, its colour on level l is `Σ wᵢ Tˡᵢ` over four texels of
//! `Tˡ = Dˡ T`, the texture halved l times. Minimised is
//!
//! `Σ_showings Σₛ ωₛ ((1 − f) |Σ wᵢ Tˡᵢ − yₛ|² + f |Σ wᵢ Tˡ⁺¹ᵢ − yₛ|²) + ε Σ |Tᵢ − Tⱼ|²`,
//!
//! the blend f of two mip levels taken outside the square: an upper bound of the trilinear
//! fetch's error (Jensen) whose normal matrix `Σ_l Dˡᵀ Aˡ Dˡ` needs nine points a texel and
//! level. The last sum, over neighbouring texels, settles texels that no sample reaches.
//! Solved by conjugate gradients with the diagonal as preconditioner, each channel with its
//! own step lengths (Hestenes and Stiefel 1952).
//!
//! The derivative for texture coordinates is in `residual.rs`. Results do not depend on the
//! number of threads.

use crate::normal_equations::NormalEquations;
pub use crate::parameterized::ParameterizedSignal;
use crate::rounding::rounded;
use glam::Vec4;
use parbake_image::FloatImage;
use rayon::prelude::*;

/// The texture twice as fine, each texel four times.
fn doubled(coarse: &FloatImage<Vec4>) -> FloatImage<Vec4> {
    let size = 2 * coarse.width;
    let texel = |i: usize| coarse.texels[i / size / 2 * coarse.width + i % size / 2];
    FloatImage::square(size, (0..size * size).into_par_iter().map(texel).collect())
}

/// How exactly a texture is solved for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solve {
    /// Stops once the residual's norm is this share of the right-hand side's…
    pub tolerance: f64,
    /// …or after so many steps of conjugate gradients.
    pub steps: usize,
    /// Weight ε of the differences of neighbours, relative to the mean weight that a
    /// texel has of samples.
    pub smoothness: f32,
    /// Also stops once a step takes less than this from the error, as samples weigh it.
    pub least_gain: f64,
}

impl Solve {
    /// To see what a layout is about.
    pub const ROUGH: Self = Self { tolerance: 1e-3, steps: 30, smoothness: 1e-5, least_gain: 0.0 };
    /// While texture coordinates move: until an objective's own `least_gain`.
    pub const MOVING: Self = Self { tolerance: 1e-6, steps: 300, smoothness: 1e-5, least_gain: 0.0 };
    /// For the texture that is written.
    pub const FINAL: Self = Self { tolerance: 1e-6, steps: 100, smoothness: 1e-6, least_gain: 0.0 };
}

/// The best texture; begins at `start`.
pub fn least_squares_texture(
    mapped: &ParameterizedSignal,
    start: FloatImage<Vec4>,
    solve: &Solve,
) -> FloatImage<Vec4> {
    NormalEquations::assemble(mapped, start.width, solve.smoothness).solve(start, solve, None)
}

/// The best texture whose values lie in [0, 1]; begins at `start`.
///
/// Texels that leave the box are held at its border and the rest is solved again
/// (active set), at most a few times.
pub fn least_squares_texture_in_box(
    mapped: &ParameterizedSignal,
    start: FloatImage<Vec4>,
    solve: &Solve,
) -> FloatImage<Vec4> {
    NormalEquations::assemble(mapped, start.width, solve.smoothness).solve_in_box(start, solve)
}

/// A first guess for a texture of this size: rough textures from coarse to fine, so that
/// conjugate gradients need not carry what is far apart from texel to texel.
pub fn rough_texture(mapped: &ParameterizedSignal, size: usize) -> FloatImage<Vec4> {
    const COARSEST: usize = 64;
    if size <= COARSEST || !size.is_multiple_of(2) {
        return FloatImage::solid(size, Vec4::splat(0.5));
    }
    let rough = Solve { steps: 10, ..Solve::ROUGH };
    doubled(&least_squares_texture(mapped, rough_texture(mapped, size / 2), &rough))
}

/// The best texture whose values are 255ths, as files of eight bits hold them; begins at `start`.
pub fn least_squares_texture_in_bytes(
    mapped: &ParameterizedSignal,
    start: FloatImage<Vec4>,
    solve: &Solve,
) -> FloatImage<Vec4> {
    let equations = NormalEquations::assemble(mapped, start.width, solve.smoothness);
    rounded(&equations, equations.solve_in_box(start, solve))
}

impl NormalEquations {
    fn solve_in_box(&self, start: FloatImage<Vec4>, solve: &Solve) -> FloatImage<Vec4> {
        const PASSES: usize = 6;
        let mut texture = self.solve(start, solve, None);
        for _ in 0..PASSES {
            let outside = |v: f32| !(0.0..=1.0).contains(&v);
            if !texture.texels.par_iter().any(|t| t.to_array().into_iter().any(outside)) {
                break;
            }
            texture.texels.par_iter_mut().for_each(|t| *t = t.clamp(Vec4::ZERO, Vec4::ONE));
            // A lane at the border stays there while the error wants it further out.
            let slope = self.residual(&texture.texels, &mut self.room());
            let held =
                |value: f32, slope: f32| (value <= 0.0 && slope <= 0.0) || (value >= 1.0 && slope >= 0.0);
            let free: Vec<Vec4> = (texture.texels.par_iter().zip(&slope))
                .map(|(t, r)| {
                    let (t, r) = (t.to_array(), r.to_array());
                    Vec4::from_array(std::array::from_fn(|k| if held(t[k], r[k]) { 0.0 } else { 1.0 }))
                })
                .collect();
            texture = self.solve(texture, solve, Some(&free));
        }
        texture.texels.par_iter_mut().for_each(|t| *t = t.clamp(Vec4::ZERO, Vec4::ONE));
        texture
    }

    /// `free` holds 0 in lanes that must stay.
    fn solve(&self, mut texture: FloatImage<Vec4>, solve: &Solve, free: Option<&[Vec4]>) -> FloatImage<Vec4> {
        let size = self.size;
        let x = &mut texture.texels;
        let mask = |i: usize| free.map_or(Vec4::ONE, |f| f[i]);
        let weighted = |r: &[Vec4]| -> Vec4 {
            let rows: Vec<Vec4> = (r.par_chunks(size).zip(self.inverse.par_chunks(size)))
                .map(|(r, m)| r.iter().zip(m).map(|(r, m)| *r * *r * *m).sum())
                .collect();
            sum(&rows)
        };
        let room = &mut self.room();
        let mut r = self.residual(x, room);
        r.par_iter_mut().enumerate().for_each(|(i, r)| *r *= mask(i));
        let mut p: Vec<Vec4> = r.par_iter().zip(&self.inverse).map(|(r, m)| *r * *m).collect();
        let mut rho = weighted(&r);
        // Measured against the right-hand side, not the start: a good start needs fewer steps.
        let enough = weighted(&self.right) * (solve.tolerance * solve.tolerance) as f32;
        for _ in 0..solve.steps {
            if rho.cmple(enough).all() {
                break;
            }
            let q = self.product(&p, room);
            let dots: Vec<Vec4> = (p.par_chunks(size).zip(q.par_chunks(size)))
                .map(|(p, q)| p.iter().zip(q).map(|(a, b)| *a * *b).sum())
                .collect();
            let alpha = ratio(rho, sum(&dots));
            let gain = f64::from((alpha * rho).element_sum());
            let dots: Vec<Vec4> = (x.par_chunks_mut(size).zip(r.par_chunks_mut(size)))
                .enumerate()
                .map(|(row, (x, r))| {
                    let mut sum = Vec4::ZERO;
                    for (k, i) in (row * size..(row + 1) * size).enumerate() {
                        x[k] += p[i] * alpha;
                        r[k] -= q[i] * mask(i) * alpha;
                        sum += r[k] * r[k] * self.inverse[i];
                    }
                    sum
                })
                .collect();
            if gain < solve.least_gain {
                break;
            }
            let next = sum(&dots);
            let beta = ratio(next, rho);
            p.par_iter_mut().zip(&r).zip(&self.inverse).for_each(|((p, r), m)| *p = *r * *m + *p * beta);
            rho = next;
        }
        texture
    }
}

fn ratio(a: Vec4, b: Vec4) -> Vec4 {
    let least = Vec4::splat(1e-30);
    Vec4::select(b.cmpgt(least), a / b.max(least), Vec4::ZERO)
}

fn sum(rows: &[Vec4]) -> Vec4 {
    rows.iter().map(|v| v.as_dvec4()).sum::<glam::DVec4>().as_vec4()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{Pixels, Sample, Signal};
    use crate::triangle_batches::TriangleBatches;
    use crate::trilinear_error::trilinear_errors;
    use glam::{DMat2, dvec2};

    /// Protects the time that fine textures of few samples take: begun from coarse to fine, few steps
    /// leave less than they do from a plain start.
    #[test]
    fn coarse_to_fine_takes_fewer_steps() {
        let points = [dvec2(0.0, 0.0), dvec2(0.5, 0.0), dvec2(0.0, 0.5)];
        let triangles = [[0, 1, 2]];
        let samples: Vec<(u32, Sample)> = (0..4000)
            .map(|i| {
                let (b, c) = ((i as f32 * 0.754_877_7).fract(), (i as f32 * 0.569_840_3).fract());
                let barycentric = if b + c <= 1.0 { [b, c] } else { [1.0 - b, 1.0 - c] };
                let target = Vec4::splat(0.8 + 0.1 * (50.0 * barycentric[0]).sin());
                (0, Sample { target, barycentric, weight: 1.0 / 4000.0 })
            })
            .collect();
        let signal_scales = [0.5, 3.0].map(|texels| {
            let mut signal = Signal::new(1, &samples);
            signal.pixels = Pixels::ByTurns([DMat2::IDENTITY * (texels / 256.0); 2]);
            signal
        });
        let runs = TriangleBatches::new(&points, &triangles, &signal_scales[0]);
        let mapped = ParameterizedSignal {
            points: &points,
            triangles: &triangles,
            signal_scales: &signal_scales,
            runs: &runs,
        };
        let few = Solve { steps: 5, ..Solve::FINAL };
        let left = |start| {
            trilinear_errors(&mapped, &least_squares_texture_in_box(&mapped, start, &few)).iter().sum::<f64>()
        };
        let (flat, fine) =
            (left(FloatImage::solid(256, Vec4::splat(0.5))), left(rough_texture(&mapped, 256)));
        assert!(fine < 0.9 * flat, "{fine} of {flat}");
    }
}
