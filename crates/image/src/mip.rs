//! Mip pyramids: each level is the 2×2 box average of the one above.
//!
//! Forward: a side of odd length drops its last texel, a side of length 1 stays.
//! Adjoint: each coarse texel hands a quarter (or a half) of its gradient to each
//! texel that it averaged.
//!
//! Contract: levels halve down to 1×1.

use crate::FloatImage;
use crate::pyramid::Pyramid;
use parbake_model::Wrap;
use rayon::prelude::*;

/// How many fine texels one coarse texel averages along a side, and the coarse side.
fn halve(side: usize) -> (usize, usize) {
    if side == 1 { (1, 1) } else { (2, side / 2) }
}

impl<const C: usize> FloatImage<[f32; C]> {
    /// The next coarser level.
    pub fn halved(&self) -> Self {
        self.halved_along([true; 2])
    }

    /// Half of the texels along u, along v, or along both.
    pub fn halved_along(&self, along: [bool; 2]) -> Self {
        let side = |side: usize, is_halved: bool| if is_halved { halve(side) } else { (1, side) };
        let ((sx, width), (sy, height)) = (side(self.width, along[0]), side(self.height, along[1]));
        let scale = 1.0 / (sx * sy) as f32;
        let mut texels = vec![[0.0; C]; width * height];
        texels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, out) in row.iter_mut().enumerate() {
                for dy in 0..sy {
                    let start = (y * sy + dy) * self.width + x * sx;
                    for texel in &self.texels[start..start + sx] {
                        for k in 0..C {
                            out[k] += texel[k] * scale;
                        }
                    }
                }
            }
        });
        Self { width, height, texels }
    }

    /// Adjoint of [`FloatImage::halved`]: adds the coarse level's gradient to this one's.
    fn halved_adjoint(&mut self, coarse: &Self) {
        let ((sx, _), (sy, _)) = (halve(self.width), halve(self.height));
        let scale = 1.0 / (sx * sy) as f32;
        for (y, row) in coarse.texels.chunks(coarse.width).enumerate() {
            for (x, gradient) in row.iter().enumerate() {
                for dy in 0..sy {
                    let start = (y * sy + dy) * self.width + x * sx;
                    for texel in &mut self.texels[start..start + sx] {
                        for k in 0..C {
                            texel[k] += gradient[k] * scale;
                        }
                    }
                }
            }
        }
    }
}

impl<const C: usize> Pyramid<C> {
    /// All levels down to 1×1; wraps by repetition.
    pub fn from_base(base: FloatImage<[f32; C]>) -> Self {
        let mut levels = vec![base];
        while let Some(last) = levels.last().filter(|l| l.width > 1 || l.height > 1) {
            let next = last.halved();
            levels.push(next);
        }
        Self { levels, wrap: [Wrap::Repeat; 2] }
    }

    /// Only the base level: fetches are bilinear.
    pub fn single(base: FloatImage<[f32; C]>) -> Self {
        Self { levels: vec![base], wrap: [Wrap::Repeat; 2] }
    }

    /// Adjoint of [`Pyramid::from_base`]: gathers the gradients of all levels, as
    /// [`Pyramid::adjoint`] scattered them, into that of level 0.
    pub fn base_adjoint(mut self) -> FloatImage<[f32; C]> {
        while self.levels.len() > 1 {
            let coarse = self.levels.pop().unwrap_or_default();
            if let Some(fine) = self.levels.last_mut() {
                fine.halved_adjoint(&coarse);
            }
        }
        self.levels.pop().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the mip gradient: ⟨P a, b⟩ = ⟨a, Pᵀ b⟩, odd sides included.
    #[test]
    fn base_adjoint_is_the_transpose() {
        for (w, h) in [(8, 8), (5, 3), (1, 6)] {
            let value = |i: usize| ((i * 37 + 11) % 17) as f32 - 8.0;
            let base = FloatImage { width: w, height: h, texels: (0..w * h).map(|i| [value(i)]).collect() };
            let forward = Pyramid::from_base(base.clone());
            let mut b = forward.zeros_like();
            let mut i = 0;
            for level in &mut b.levels {
                for t in &mut level.texels {
                    i += 1;
                    t[0] = value(3 * i);
                }
            }
            let dot = |a: &FloatImage<[f32; 1]>, b: &FloatImage<[f32; 1]>| -> f32 {
                a.texels.iter().zip(&b.texels).map(|(a, b)| a[0] * b[0]).sum()
            };
            let left: f32 = forward.levels.iter().zip(&b.levels).map(|(a, b)| dot(a, b)).sum();
            let right = dot(&base, &b.base_adjoint());
            assert!((left - right).abs() < 1e-3 * left.abs().max(1.0));
        }
    }
}
