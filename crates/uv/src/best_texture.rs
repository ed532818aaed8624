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

use crate::footprint::{Footprint, OnLevel, shares};
use crate::normal_matrix::{NormalMatrix, Patch};
use crate::pyramid::{gather, level_count, levels};
use crate::runs::Runs;
use crate::signal::{Sample, Signal};
use glam::{DVec2, Vec4};
use rayon::prelude::*;

/// A square texture of four channels, row 0 at v = 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Texture {
    /// Texels along a side, ≥ 2.
    pub size: usize,
    /// size² texels.
    pub texels: Vec<Vec4>,
}

impl Texture {
    /// One value everywhere.
    pub fn solid(size: usize, value: Vec4) -> Self {
        Self { size, texels: vec![value; size * size] }
    }
}

/// Texture coordinates and the signals that they carry.
#[derive(Clone, Copy)]
pub struct Mapped<'a> {
    /// P points.
    pub points: &'a [DVec2],
    /// F triangles.
    pub triangles: &'a [[u32; 3]],
    /// What the texture shall show: the same surface at one or more sizes.
    pub showings: &'a [Signal],
    /// The triangles, shared out.
    pub runs: &'a Runs,
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
pub fn best_texture(mapped: &Mapped, start: Texture, solve: &Solve) -> Texture {
    System::assemble(mapped, start.size, solve.smoothness).solve(start, solve, None)
}

/// The best texture whose values lie in [0, 1]; begins at `start`.
///
/// Texels that leave the box are held at its border and the rest is solved again
/// (active set), at most a few times.
pub fn best_texture_in_box(mapped: &Mapped, start: Texture, solve: &Solve) -> Texture {
    const PASSES: usize = 6;
    let system = System::assemble(mapped, start.size, solve.smoothness);
    let mut texture = system.solve(start, solve, None);
    for _ in 0..PASSES {
        let outside = |v: f32| !(0.0..=1.0).contains(&v);
        if !texture.texels.par_iter().any(|t| t.to_array().into_iter().any(outside)) {
            break;
        }
        texture.texels.par_iter_mut().for_each(|t| *t = t.clamp(Vec4::ZERO, Vec4::ONE));
        // A lane at the border stays there while the error wants it further out.
        let slope = system.residual(&texture.texels);
        let held = |value: f32, slope: f32| (value <= 0.0 && slope <= 0.0) || (value >= 1.0 && slope >= 0.0);
        let free: Vec<Vec4> = (texture.texels.par_iter().zip(&slope))
            .map(|(t, r)| {
                let (t, r) = (t.to_array(), r.to_array());
                Vec4::from_array(std::array::from_fn(|k| if held(t[k], r[k]) { 0.0 } else { 1.0 }))
            })
            .collect();
        texture = system.solve(texture, solve, Some(&free));
    }
    texture.texels.par_iter_mut().for_each(|t| *t = t.clamp(Vec4::ZERO, Vec4::ONE));
    texture
}

/// The normal equations: one matrix a level, the first with the smoothness.
struct System {
    size: usize,
    levels: Vec<NormalMatrix>,
    /// Right-hand side of the texture itself.
    right: Vec<Vec4>,
    /// Inverse of the whole matrix's diagonal.
    inverse: Vec<f32>,
}

impl System {
    fn assemble(mapped: &Mapped, size: usize, smoothness: f32) -> Self {
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
        let weight: f64 = mapped.showings.iter().map(Signal::weight).sum();
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
                    .map(|(l, m)| m.rows[(y >> l) * m.size + (x >> l)].centre / (1 << (4 * l)) as f32)
                    .sum();
                1.0 / diagonal.max(1e-30)
            })
            .collect();
        Self { size, levels, right: rights.swap_remove(0), inverse }
    }

    /// `A x`.
    fn product(&self, x: &[Vec4]) -> Vec<Vec4> {
        if let [only] = &self.levels[..] {
            let mut y = vec![Vec4::ZERO; x.len()];
            only.add_product(x, &mut y);
            return y;
        }
        let pyramid = levels(x, self.size, self.levels.len());
        let mut products: Vec<Vec<Vec4>> = pyramid.iter().map(|l| vec![Vec4::ZERO; l.len()]).collect();
        for ((matrix, x), y) in self.levels.iter().zip(&pyramid).zip(&mut products) {
            matrix.add_product(x, y);
        }
        gather(&mut products, self.size);
        products.swap_remove(0)
    }

    /// `b − A x`.
    fn residual(&self, x: &[Vec4]) -> Vec<Vec4> {
        let mut r = self.product(x);
        r.par_iter_mut().zip(&self.right).for_each(|(r, b)| *r = *b - *r);
        r
    }

    /// `free` holds 0 in lanes that must stay.
    fn solve(&self, mut texture: Texture, solve: &Solve, free: Option<&[Vec4]>) -> Texture {
        let size = self.size;
        let x = &mut texture.texels;
        let mask = |i: usize| free.map_or(Vec4::ONE, |f| f[i]);
        let weighted = |r: &[Vec4]| -> Vec4 {
            let rows: Vec<Vec4> = (r.par_chunks(size).zip(self.inverse.par_chunks(size)))
                .map(|(r, m)| r.iter().zip(m).map(|(r, m)| *r * *r * *m).sum())
                .collect();
            sum(&rows)
        };
        let mut r = self.residual(x);
        r.par_iter_mut().enumerate().for_each(|(i, r)| *r *= mask(i));
        let mut p: Vec<Vec4> = r.par_iter().zip(&self.inverse).map(|(r, m)| *r * *m).collect();
        let mut rho = weighted(&r);
        // Measured against the right-hand side, not the start: a good start needs fewer steps.
        let enough = weighted(&self.right) * (solve.tolerance * solve.tolerance) as f32;
        for _ in 0..solve.steps {
            if rho.cmple(enough).all() {
                break;
            }
            let q = self.product(&p);
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

/// What a run of triangles adds to the matrices of the `count` levels.
fn patches(mapped: &Mapped, run: usize, size: usize, count: usize) -> Vec<Patch> {
    let mut parts: Vec<Vec<Part>> = vec![Vec::new(); count];
    for t in mapped.runs.triangles(run) {
        let footprint = Footprint::new(mapped.points, mapped.triangles[t]);
        for signal in mapped.showings {
            let samples = signal.of(t);
            if !samples.is_empty() {
                let shown = footprint.level(signal.pixels.of(t), size, count);
                for (level, share) in shares(&shown) {
                    parts[level].push(Part { place: footprint.on(size >> level), samples, share });
                }
            }
        }
    }
    parts.into_iter().enumerate().map(|(level, parts)| patch(&parts, size >> level)).collect()
}

/// A triangle's samples on one level, of whose error this share counts.
#[derive(Clone, Copy)]
struct Part<'a> {
    place: OnLevel,
    samples: &'a [Sample],
    share: f32,
}

/// What these parts add to the matrix of a level of `size`² texels.
fn patch(parts: &[Part], size: usize) -> Patch {
    if parts.is_empty() {
        return Patch::default();
    }
    let (mut low, mut high) = ([size; 2], [0; 2]);
    for part in parts {
        let [from, to] = part.place.bounds();
        for k in 0..2 {
            low[k] = low[k].min(from[k]);
            high[k] = high[k].max(to[k]);
        }
    }
    let mut patch = Patch::new(low, high);
    for part in parts {
        for sample in part.samples {
            let (texel, fractions, _) = part.place.place(sample);
            patch.add_sample(texel, fractions, sample.weight * part.share, sample.target);
        }
    }
    patch
}
