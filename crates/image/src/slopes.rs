//! Texture fetch together with its derivatives, for adjoints that scatter the texels'
//! gradients later (`scatter.rs`).
//!
//! Forward: [`Pyramid::fetch`]'s value v and ∂v/∂u, ∂v/∂v, ∂v/∂λ from one reading of the
//! texels. Adjoint: the dot products with dL/dv; and of the level of detail
//! `λ = ½ log₂ q`, `q = max(|∂uv/∂x|², |∂uv/∂y|²)` in texels: `dL/d(∂uv/∂x) =
//! dL/dλ · size² ∘ ∂uv/∂x / (q ln 2)` for the longer of the two.
//!
//! Contract: as `pyramid.rs`.

use crate::FloatImage;
use crate::pyramid::{Pyramid, Taps, taps};
use parbake_model::glam::Vec2;

/// A fetched value and how it changes with the coordinate and the level of detail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FetchSlopes<const C: usize> {
    /// As [`Pyramid::fetch`] returns it.
    pub value: [f32; C],
    /// Derivative by u, for one texture width.
    pub per_u: [f32; C],
    /// Derivative by v, for one texture height.
    pub per_v: [f32; C],
    /// Derivative by the level of detail; 0 on level 0.
    pub per_lod: [f32; C],
}

impl<const C: usize> FetchSlopes<C> {
    /// Adjoint: gradients of the coordinate and of the level of detail.
    #[inline]
    pub fn adjoint(&self, gradient: &[f32; C]) -> (Vec2, f32) {
        let dot = |v: &[f32; C]| -> f32 { v.iter().zip(gradient).map(|(v, g)| v * g).sum() };
        (Vec2::new(dot(&self.per_u), dot(&self.per_v)), dot(&self.per_lod))
    }
}

/// Which texels a fetch blends: the same in every pyramid of the same shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reach {
    /// The finer level.
    pub level: usize,
    /// Share of the level below it, 0 … 1.
    pub blend: f32,
    /// On the finer level and, where `blend` is not 0, on the coarser.
    pub taps: [Taps; 2],
}

impl<const C: usize> FloatImage<[f32; C]> {
    /// A bilinear fetch with its derivatives.
    #[inline]
    fn slopes(&self, at: &Taps) -> FetchSlopes<C> {
        let [a, b, c, d] = self.four(at);
        let (width, height) = (self.width as f32, self.height as f32);
        let mut out = FetchSlopes { value: [0.0; C], per_u: [0.0; C], per_v: [0.0; C], per_lod: [0.0; C] };
        for k in 0..C {
            let (across_above, across_below) = (b[k] - a[k], d[k] - c[k]);
            let above = a[k] + across_above * at.fx;
            let down = c[k] + across_below * at.fx - above;
            out.value[k] = above + down * at.fy;
            out.per_u[k] = (across_above + (across_below - across_above) * at.fy) * width;
            out.per_v[k] = down * height;
        }
        out
    }
}

impl<const C: usize> Pyramid<C> {
    /// Whether texels of both lie at the same places, so that a [`Reach`] fits both.
    pub fn same_shape<const D: usize>(&self, other: &Pyramid<D>) -> bool {
        let (a, b) = (&self.levels, &other.levels);
        self.wrap == other.wrap
            && a.len() == b.len()
            && a.iter().zip(b).all(|(a, b)| (a.width, a.height) == (b.width, b.height))
    }

    /// Where a fetch at this coordinate and level of detail reads.
    #[inline]
    pub fn reach(&self, uv: Vec2, lod: f32) -> Reach {
        let (level, blend) = self.split(lod);
        let at = |level: usize| taps(uv, self.levels[level].width, self.levels[level].height, self.wrap);
        let coarse = if blend > 0.0 { at(level + 1) } else { Taps::default() };
        Reach { level, blend, taps: [at(level), coarse] }
    }

    /// [`Pyramid::fetch`] at a place already found.
    #[inline]
    pub fn fetch_at(&self, reach: &Reach) -> [f32; C] {
        let mut out = self.levels[reach.level].fetch(&reach.taps[0]);
        if reach.blend > 0.0 {
            let coarse = self.levels[reach.level + 1].fetch(&reach.taps[1]);
            for k in 0..C {
                out[k] += (coarse[k] - out[k]) * reach.blend;
            }
        }
        out
    }

    /// [`Pyramid::fetch_at`] with derivatives.
    #[inline]
    pub fn slopes_at(&self, reach: &Reach) -> FetchSlopes<C> {
        let mut out = self.levels[reach.level].slopes(&reach.taps[0]);
        if reach.blend > 0.0 {
            let coarse = self.levels[reach.level + 1].slopes(&reach.taps[1]);
            for k in 0..C {
                out.per_lod[k] = coarse.value[k] - out.value[k];
                out.value[k] += out.per_lod[k] * reach.blend;
                out.per_u[k] += (coarse.per_u[k] - out.per_u[k]) * reach.blend;
                out.per_v[k] += (coarse.per_v[k] - out.per_v[k]) * reach.blend;
            }
        }
        out
    }

    /// Adjoint of [`Pyramid::lod`]: gradients of the footprint's two derivatives.
    #[inline]
    pub fn lod_adjoint(&self, per_x: Vec2, per_y: Vec2, gradient: f32) -> (Vec2, Vec2) {
        let size = Vec2::new(self.levels[0].width as f32, self.levels[0].height as f32);
        let (x, y) = ((per_x * size).length_squared(), (per_y * size).length_squared());
        let longer = x.max(y);
        if self.levels.len() == 1 || longer <= 1.0 {
            return (Vec2::ZERO, Vec2::ZERO);
        }
        let scale = size * size * (gradient / (longer * std::f32::consts::LN_2));
        if x >= y { (per_x * scale, Vec2::ZERO) } else { (Vec2::ZERO, per_y * scale) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(i: usize) -> f32 {
        ((i * 7919 + 13) % 1009) as f32 / 1009.0
    }

    fn texture() -> Pyramid<2> {
        let texels = (0..8 * 4).map(|i| [number(2 * i), number(2 * i + 1)]).collect();
        Pyramid::from_base(FloatImage { width: 8, height: 4, texels })
    }

    /// Protects the two ways to the same gradient against drifting apart.
    #[test]
    fn slopes_agree_with_the_adjoint_of_the_fetch() {
        let p = texture();
        let g = [0.7, -1.2];
        let dot = |v: [f32; 2]| v[0] * g[0] + v[1] * g[1];
        for i in 0..200 {
            let uv = Vec2::new(number(3 * i) * 3.0 - 1.0, number(3 * i + 1) * 3.0 - 1.0);
            let lod = number(3 * i + 2) * 4.0 - 1.0;
            let (to_uv, to_lod) = p.adjoint(uv, lod, &g, &mut p.zeros_like());
            let slopes = p.slopes_at(&p.reach(uv, lod));
            let (own_uv, own_lod) = slopes.adjoint(&g);
            assert_eq!(p.fetch_at(&p.reach(uv, lod)), p.fetch(uv, lod));
            assert!((dot(slopes.value) - dot(p.fetch(uv, lod))).abs() < 1e-5);
            assert!((own_uv - to_uv).length() < 1e-4 && (own_lod - to_lod).abs() < 1e-5);
        }
    }

    /// Protects the gradient through the choice of mip levels.
    #[test]
    fn lod_adjoint_matches_central_differences() {
        let p = texture();
        for (x, y) in [([0.3, -0.2], [0.05, 0.1]), ([0.1, 0.2], [-0.4, 0.7]), ([0.01, 0.0], [0.0, 0.02])] {
            let footprint = [Vec2::from(x), Vec2::from(y)];
            let (to_x, to_y) = p.lod_adjoint(footprint[0], footprint[1], 1.3);
            for (side, analytic) in [to_x, to_y].into_iter().enumerate() {
                for axis in 0..2 {
                    let (mut lo, mut hi) = (footprint, footprint);
                    lo[side][axis] -= 1e-3;
                    hi[side][axis] += 1e-3;
                    let numeric = 1.3 * (p.lod(hi[0], hi[1]) - p.lod(lo[0], lo[1])) / 2e-3;
                    assert!((numeric - analytic[axis]).abs() < 1e-2 * numeric.abs().max(0.1));
                }
            }
        }
    }
}
