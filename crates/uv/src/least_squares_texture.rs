//! The best texture for given texture coordinates: a linear least-squares problem.
//!
//! With a sample's place known, its colour on level l is `Σ wᵢ Tˡᵢ` over four texels of
//! `Tˡ = Dˡ T`, the texture halved l times. Minimised is
//!
//! `Σ_scales Σₛ ωₛ ((1 − f) |Σ wᵢ Tˡᵢ − yₛ|² + f |Σ wᵢ Tˡ⁺¹ᵢ − yₛ|²) + ε Σ |Tᵢ − Tⱼ|²`,
//!
//! the blend f of two mip levels taken outside the square: an upper bound of the trilinear
//! fetch's error (Jensen) whose normal matrix `Σ_l Dˡᵀ Aˡ Dˡ` needs nine points a texel and
//! level. The last sum, over neighbouring texels, settles texels that no sample reaches.
//! Solved by the conjugate gradients of `parbake_solve` with the diagonal as preconditioner, each channel with
//! its own step lengths.
//!
//! The derivative for texture coordinates is in `residual.rs`. Results do not depend on the
//! number of threads.

use crate::normal_equations::{NormalEquations, Room};
pub use crate::parameterized::ParameterizedSignal;
use crate::rounding::rounded;
use glam::Vec4;
use parbake_image::FloatImage;
use parbake_solve::boxed::free_lanes;
use parbake_solve::conjugate_gradient::{Stop, descend, squared_norm};
use parbake_solve::free_lanes::FreeLanes;
use parbake_solve::operator::{Inner, Lanes, Operator};
use rayon::prelude::*;

/// The texture twice as fine, each texel four times.
fn doubled(coarse: &FloatImage<Vec4>) -> FloatImage<Vec4> {
    let size = 2 * coarse.width;
    let texel = |i: usize| coarse.texels[i / size / 2 * coarse.width + i % size / 2];
    FloatImage::square(size, (0..size * size).into_par_iter().map(texel).collect())
}

/// A texel whose samples weigh less than this share of the heaviest texel's starts at a half: rounding would dominate its
/// mean.
const LEAST_WEIGHT: f32 = 1e-4;

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
    /// How often texels that leave the box are held at its border and the rest is solved again, at most.
    pub box_passes: usize,
}

impl Solve {
    /// To see what a layout is about. Two passes tell layouts apart as six do.
    pub const ROUGH: Self =
        Self { tolerance: 1e-3, steps: 30, smoothness: 1e-5, least_gain: 0.0, box_passes: 2 };
    /// While texture coordinates move: until an objective's own `least_gain`.
    pub const MOVING: Self =
        Self { tolerance: 1e-6, steps: 300, smoothness: 1e-5, least_gain: 0.0, box_passes: 6 };
    /// For the texture that is written.
    pub const FINAL: Self =
        Self { tolerance: 1e-6, steps: 100, smoothness: 1e-6, least_gain: 0.0, box_passes: 6 };
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
/// (active set), as often as `solve` says.
pub fn least_squares_texture_in_box(
    mapped: &ParameterizedSignal,
    start: FloatImage<Vec4>,
    solve: &Solve,
) -> FloatImage<Vec4> {
    NormalEquations::assemble(mapped, start.width, solve.smoothness).solve_in_box(start, solve)
}

/// The same of `size`² texels; begins where each texel has the mean of its samples.
pub fn least_squares_texture_from_means(
    mapped: &ParameterizedSignal,
    size: usize,
    solve: &Solve,
) -> FloatImage<Vec4> {
    let equations = NormalEquations::assemble(mapped, size, solve.smoothness);
    equations.solve_in_box(equations.means(), solve)
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
    /// The mean of each texel's samples, by the sums of the matrix's rows; a half where there are none.
    fn means(&self) -> FloatImage<Vec4> {
        let mut room = self.room();
        let sums = self.product(&vec![Vec4::ONE; self.size * self.size], &mut room);
        let least = LEAST_WEIGHT * sums.iter().map(|sum| sum.x).fold(0.0, f32::max);
        let mean = |(sum, right): (&Vec4, &Vec4)| match sum.x > least {
            true => *right / sum.x,
            false => Vec4::splat(0.5),
        };
        FloatImage::square(self.size, sums.par_iter().zip(&self.right).map(mean).collect())
    }

    fn solve_in_box(&self, start: FloatImage<Vec4>, solve: &Solve) -> FloatImage<Vec4> {
        let mut texture = self.solve(start, solve, None);
        for _ in 0..solve.box_passes {
            let outside = |v: f32| !(0.0..=1.0).contains(&v);
            if !texture.texels.par_iter().any(|t| t.to_array().into_iter().any(outside)) {
                break;
            }
            texture.texels.par_iter_mut().for_each(|t| *t = t.clamp(Vec4::ZERO, Vec4::ONE));
            // A lane at the border stays there while the error wants it further out.
            let slope = self.residual(&texture.texels, &mut self.room());
            let free = free_lanes(&texture.texels, slope);
            texture = self.solve(texture, solve, Some(&free));
        }
        texture.texels.par_iter_mut().for_each(|t| *t = t.clamp(Vec4::ZERO, Vec4::ONE));
        texture
    }

    /// `free` says which lanes may move.
    fn solve(
        &self,
        mut texture: FloatImage<Vec4>,
        solve: &Solve,
        free: Option<&[FreeLanes]>,
    ) -> FloatImage<Vec4> {
        let x = &mut texture.texels;
        let mut operator = AllLevels { equations: self, room: self.room() };
        let mut r = self.residual(x, &mut operator.room);
        if let Some(free) = free {
            r.par_iter_mut().zip(free).for_each(|(r, free)| *r *= free.mask());
        }
        let rho = squared_norm(&operator, &r);
        // Measured against the right-hand side, not the start: a good start needs fewer steps.
        let all = squared_norm(&operator, &self.right).0;
        let enough = Lanes(all * (solve.tolerance * solve.tolerance) as f32);
        let stop = Stop { steps: solve.steps, enough, least_gain: solve.least_gain };
        descend(&mut operator, x, &mut r, rho, free, &stop);
        texture
    }
}

/// The normal equations of all mip levels as one matrix, preconditioned by its diagonal. All channels share it.
struct AllLevels<'a> {
    equations: &'a NormalEquations,
    room: Room,
}

impl Operator for AllLevels<'_> {
    type Inner = Lanes;

    fn width(&self) -> usize {
        self.equations.size
    }

    fn product(&mut self, p: &[Vec4], q: &mut Vec<Vec4>) -> Lanes {
        self.equations.product(p, &mut self.room);
        self.room.exchange(q);
        let size = self.equations.size;
        let rows: Vec<Lanes> = (p.par_chunks(size).zip(q.par_chunks(size)))
            .map(|(p, q)| {
                let mut sum = Lanes::ZERO;
                p.iter().zip(q).for_each(|(p, q)| sum.add(*p, *q));
                sum
            })
            .collect();
        Lanes::total(&rows)
    }

    #[inline(always)]
    fn precondition(&self, i: usize, r: Vec4) -> Vec4 {
        r * self.equations.inverse[i]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{Pixels, Sample, Signal};
    use crate::triangle_batches::TriangleBatches;
    use crate::trilinear_error::trilinear_errors;
    use glam::{DMat2, dvec2};

    /// Protects the start that layouts are scored from: texels have the mean of their samples, and a half where there are none.
    #[test]
    fn texels_begin_at_the_mean_of_their_samples() {
        let points = [dvec2(0.0, 0.0), dvec2(0.5, 0.0), dvec2(0.0, 0.5)];
        let triangles = [[0, 1, 2]];
        let of = |i: usize| {
            let along = (i as f32 * 0.618_034).fract();
            Sample { target: Vec4::splat(0.2), barycentric: [along, 0.5 - 0.5 * along], weight: 0.01 }
        };
        let samples: Vec<(u32, Sample)> = (0..100).map(|i| (0, of(i))).collect();
        let mut signal = Signal::new(1, &samples);
        signal.pixels = Pixels::ByTurns([DMat2::IDENTITY * (0.5 / 32.0); 2]);
        let signal_scales = [signal];
        let runs = TriangleBatches::new(&points, &triangles, &signal_scales[0]);
        let mapped = ParameterizedSignal {
            points: &points,
            triangles: &triangles,
            signal_scales: &signal_scales,
            runs: &runs,
        };
        let means = NormalEquations::assemble(&mapped, 32, 1e-5).means();
        let is_mean = |texel: &Vec4| (*texel - Vec4::splat(0.2)).abs().max_element() < 1e-4;
        let covered = means.texels.iter().filter(|texel| is_mean(texel)).count();
        assert!(means.texels.iter().all(|texel| is_mean(texel) || *texel == Vec4::splat(0.5)));
        assert!((10..512).contains(&covered), "{covered}");
    }

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
        let equations = NormalEquations::assemble(&mapped, 256, few.smoothness);
        let left =
            |start| trilinear_errors(&mapped, &equations.solve_in_box(start, &few)).iter().sum::<f64>();
        let (flat, fine) =
            (left(FloatImage::solid(256, Vec4::splat(0.5))), left(rough_texture(&mapped, 256)));
        assert!(fine < 0.9 * flat, "{fine} of {flat}");
    }
}
