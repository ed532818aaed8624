//! A texture in bytes, its texels rounded together.
//!
//! What a texture shows is a blend of neighbours: what rounding one texel up adds, rounding those
//! beside it down takes away again. With the normal equations `A x = b` a texture `q` leaves the error
//! `qᵀ A q − 2 bᵀ q` and a constant; with all other texels held that is least where texel i is
//! `qᵢ + (b − A q)ᵢ / Aᵢᵢ`, and among bytes at the one nearest to that (coordinate descent on an integer
//! least-squares problem). Texels are put there one after the other. In the first pass those that
//! are still to come have their real values and make up for what was rounded already, as in error
//! diffusion (Floyd and Steinberg 1976), but with the weights of this very problem; later passes
//! only ever lower the error.
//!
//! Where values are dark and shown on a steep curve, rounding is most of what is left: a lemon's blue
//! lies between 0 and 3 of 255, and its pictures gain 0.15 dB at 256² and 0.7 dB at 512².
//!
//! Texels depend on those before them, so this runs on one thread; a pass costs a few steps of the
//! conjugate gradients before it.

use crate::normal_equations::NormalEquations;
use crate::normal_matrix::NormalMatrix;
use crate::pyramid::levels;
use glam::Vec4;
use parbake_image::FloatImage;

/// After the third pass pictures gain another 0.02 dB at most.
const PASSES: usize = 3;

/// A byte's largest value.
const WHITE: f32 = 255.0;

/// The texture with values that are 255ths in [0, 1].
pub(crate) fn rounded(equations: &NormalEquations, texture: FloatImage<Vec4>) -> FloatImage<Vec4> {
    let mut rounding = Rounding::new(equations, texture);
    for _ in 0..PASSES {
        if !rounding.pass() {
            break;
        }
    }
    rounding.texture
}

struct Rounding<'a> {
    equations: &'a NormalEquations,
    texture: FloatImage<Vec4>,
    /// `Aˡ Dˡ q` on each level.
    products: Vec<Vec<Vec4>>,
}

impl<'a> Rounding<'a> {
    fn new(equations: &'a NormalEquations, texture: FloatImage<Vec4>) -> Self {
        let pyramid = levels(&texture.texels, texture.width, equations.levels.len());
        let product = |(matrix, x): (&NormalMatrix, &Vec<Vec4>)| {
            let mut product = vec![Vec4::ZERO; x.len()];
            matrix.product(x, &mut product);
            product
        };
        let products = equations.levels.iter().zip(&pyramid).map(product).collect();
        Self { equations, texture, products }
    }

    /// Visits each texel once; false if none changed.
    fn pass(&mut self) -> bool {
        let size = self.texture.width;
        let mut changed = false;
        for texel in 0..size * size {
            let place = [texel % size, texel / size];
            let value = self.texture.texels[texel];
            let best = value + self.residual(texel, place) * self.equations.inverse[texel];
            let byte = (best.clamp(Vec4::ZERO, Vec4::ONE) * WHITE).round() / WHITE;
            if byte != value {
                self.texture.texels[texel] = byte;
                self.note(place, byte - value);
                changed = true;
            }
        }
        changed
    }

    /// `(b − A q)` at a texel: each of a level's texels is the mean of four of the level before.
    fn residual(&self, texel: usize, [x, y]: [usize; 2]) -> Vec4 {
        let (mut residual, mut share) = (self.equations.right[texel], 1.0);
        for (level, product) in self.products.iter().enumerate() {
            residual -= product[(y >> level) * (self.texture.width >> level) + (x >> level)] * share;
            share *= 0.25;
        }
        residual
    }

    /// Brings the products up to date with a texel's change.
    fn note(&mut self, [x, y]: [usize; 2], mut change: Vec4) {
        let levels = self.equations.levels.iter().zip(&mut self.products);
        for (level, (matrix, product)) in levels.enumerate() {
            matrix.add_column([x >> level, y >> level], change, product);
            change *= 0.25;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_squares_texture::{
        ParameterizedSignal, Solve, least_squares_texture_from_means, least_squares_texture_in_bytes,
    };
    use crate::signal::{Pixels, Sample, Signal};
    use crate::triangle_batches::TriangleBatches;
    use crate::trilinear_error::trilinear_errors;
    use glam::{DMat2, dvec2};

    /// The square as two triangles, of a dark pattern, seen with pixels a few texels wide too.
    fn dark_square() -> (Vec<glam::DVec2>, Vec<[u32; 3]>, Vec<Signal>) {
        let points = vec![dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(0.0, 1.0), dvec2(1.0, 1.0)];
        let triangles = vec![[0, 1, 2], [3, 2, 1]];
        let golden = |i: usize, step: f32| (i as f32 * step).fract();
        let samples: Vec<(u32, Sample)> = (0..6000)
            .map(|i| {
                let (b, c) = (golden(i, 0.754_877_7), golden(i, 0.569_840_3));
                let barycentric = if b + c <= 1.0 { [b, c] } else { [1.0 - b, 1.0 - c] };
                let [b, c] = barycentric;
                let target = Vec4::splat((1.5 + (9.0 * b).sin() + (7.0 * c).cos()) / 255.0);
                ((i % 2) as u32, Sample { target, barycentric, weight: 1.0 })
            })
            .collect();
        let of = |texels: f64| {
            let mut signal = Signal::new(2, &samples);
            signal.pixels = Pixels::ByTurns([DMat2::IDENTITY * (texels / 32.0); 2]);
            signal
        };
        (points, triangles, vec![of(0.5), of(3.0)])
    }

    /// Protects the gain: what is rounded together leaves less than what is rounded texel by texel,
    /// at all mip levels, and is made of bytes.
    #[test]
    fn texels_rounded_together_leave_less() {
        let (points, triangles, signal_scales) = dark_square();
        let runs = TriangleBatches::new(&points, &triangles, &signal_scales[0]);
        let mapped = ParameterizedSignal {
            points: &points,
            triangles: &triangles,
            signal_scales: &signal_scales,
            runs: &runs,
        };
        let start = FloatImage::solid(32, Vec4::splat(0.5));
        let mut apart = least_squares_texture_from_means(&mapped, 32, &Solve::FINAL);
        apart.texels.iter_mut().for_each(|t| *t = (*t * WHITE).round() / WHITE);
        let together = least_squares_texture_in_bytes(&mapped, start, &Solve::FINAL);
        assert!(together.texels.iter().all(|t| {
            t.cmpge(Vec4::ZERO).all() && t.cmple(Vec4::ONE).all() && (*t * WHITE).round() / WHITE == *t
        }));
        for (together, apart) in
            trilinear_errors(&mapped, &together).iter().zip(trilinear_errors(&mapped, &apart))
        {
            assert!(*together < 0.9 * apart, "{together} of {apart}");
        }
    }

    /// Protects what is kept up to date while texels change: it is the product with the texture.
    #[test]
    fn products_follow_the_texels() {
        let (points, triangles, signal_scales) = dark_square();
        let runs = TriangleBatches::new(&points, &triangles, &signal_scales[0]);
        let mapped = ParameterizedSignal {
            points: &points,
            triangles: &triangles,
            signal_scales: &signal_scales,
            runs: &runs,
        };
        let equations = NormalEquations::assemble(&mapped, 32, 1e-6);
        assert!(equations.levels.len() > 1);
        let mut rounding = Rounding::new(&equations, FloatImage::solid(32, Vec4::splat(0.0123)));
        assert!(rounding.pass());
        let anew = Rounding::new(&equations, rounding.texture.clone());
        for (kept, anew) in rounding.products.iter().zip(&anew.products) {
            let largest = anew.iter().map(|v| v.abs().max_element()).fold(0.0, f32::max);
            let off = kept.iter().zip(anew).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
            assert!(off < 1e-4 * largest, "{off} of {largest}");
        }
    }
}
