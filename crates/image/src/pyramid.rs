//! Texture fetch: bilinear, and trilinear over a mip pyramid.
//!
//! Forward (OpenGL 4.6, 8.14): texel centres at half-integers; level of detail
//! `λ = log₂ max(|∂uv/∂x|, |∂uv/∂y|)` in texels, levels ⌊λ⌋ and ⌊λ⌋ + 1 blended.
//! Adjoint: each fetched texel receives its weight times the gradient; the
//! coordinate receives the gradient of the bilinear surface; λ receives the
//! difference of the two levels (its own dependence on the footprint is the
//! caller's to follow). `mip.rs` carries the levels' gradients to level 0.
//!
//! Contract: coordinates are v-down and finite; wrap modes as the material says.

use crate::FloatImage;
use parbake_model::Wrap;
use parbake_model::glam::{Vec2, Vec4};

/// The four texels that a bilinear fetch blends, in the order (x0,y0), (x1,y0),
/// (x0,y1), (x1,y1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taps {
    /// Texel indices.
    pub index: [u32; 4],
    /// Horizontal fraction, 0 … 1.
    pub fx: f32,
    /// Vertical fraction, 0 … 1.
    pub fy: f32,
}

impl Taps {
    /// Bilinear weights, which sum to 1.
    #[inline]
    pub fn weights(&self) -> [f32; 4] {
        let (gx, gy) = (1.0 - self.fx, 1.0 - self.fy);
        [gx * gy, self.fx * gy, gx * self.fy, self.fx * self.fy]
    }
}

#[inline]
pub(crate) fn wrapped(i: i64, size: i64, wrap: Wrap) -> u32 {
    (match wrap {
        // The texture's inside needs no division.
        _ if (0..size).contains(&i) => i,
        Wrap::Repeat => i.rem_euclid(size),
        Wrap::Mirror => {
            let j = i.rem_euclid(2 * size);
            if j < size { j } else { 2 * size - 1 - j }
        }
        Wrap::Clamp => i.clamp(0, size - 1),
    }) as u32
}

/// `x.floor() as i64` without the call that CPUs before SSE 4.1 need for it.
#[inline]
fn floor(x: f32) -> i64 {
    let towards_zero = x as i64;
    towards_zero.saturating_sub(i64::from(towards_zero as f32 > x))
}

/// The taps of a coordinate on a level of this size.
#[inline]
pub fn taps(uv: Vec2, width: usize, height: usize, wrap: [Wrap; 2]) -> Taps {
    let (x, y) = (uv.x * width as f32 - 0.5, uv.y * height as f32 - 0.5);
    let (i, j) = (floor(x), floor(y));
    let (x0, y0) = (i as f32, j as f32);
    let (w, h) = (width as i64, height as i64);
    let columns = [wrapped(i, w, wrap[0]), wrapped(i.saturating_add(1), w, wrap[0])];
    let rows = [wrapped(j, h, wrap[1]), wrapped(j.saturating_add(1), h, wrap[1])].map(|r| r * width as u32);
    Taps {
        index: [rows[0] + columns[0], rows[0] + columns[1], rows[1] + columns[0], rows[1] + columns[1]],
        // Only coordinates beyond any i64 are not in this range already.
        fx: (x - x0).clamp(0.0, 1.0),
        fy: (y - y0).clamp(0.0, 1.0),
    }
}

impl<const C: usize> FloatImage<[f32; C]> {
    /// The texels of a fetch. Written out, since `map` on an array is a call here.
    #[inline(always)]
    pub fn four(&self, taps: &Taps) -> [&[f32; C]; 4] {
        let [a, b, c, d] = taps.index;
        let texel = |i: u32| &self.texels[i as usize];
        [texel(a), texel(b), texel(c), texel(d)]
    }

    /// The texels of a fetch as four lanes each, of which the last holds what follows in memory; none where nothing follows,
    /// and where texels are not of three channels.
    #[inline(always)]
    fn four_wide(&self, taps: &Taps) -> Option<[Vec4; 4]> {
        if C != 3 {
            return None;
        }
        let channels = self.texels.as_flattened();
        let texel = |i: u32| Some(Vec4::from_array(*channels.get(3 * i as usize..)?.first_chunk()?));
        let [a, b, c, d] = taps.index;
        Some([texel(a)?, texel(b)?, texel(c)?, texel(d)?])
    }

    /// The blend of four texels.
    #[inline]
    pub fn fetch(&self, taps: &Taps) -> [f32; C] {
        let w = taps.weights();
        // One register a texel instead of three, in the same order of sums.
        if let Some([a, b, c, d]) = self.four_wide(taps) {
            let blend = a * w[0] + b * w[1] + c * w[2] + d * w[3];
            return std::array::from_fn(|k| blend[k]);
        }
        let [a, b, c, d] = self.four(taps);
        std::array::from_fn(|k| a[k] * w[0] + b[k] * w[1] + c[k] * w[2] + d[k] * w[3])
    }

    /// Adds the gradient of a fetch to the texels that it blended.
    #[inline]
    pub fn scatter(&mut self, taps: &Taps, gradient: &[f32; C]) {
        for (index, weight) in taps.index.into_iter().zip(taps.weights()) {
            let texel = &mut self.texels[index as usize];
            for k in 0..C {
                texel[k] += weight * gradient[k];
            }
        }
    }

    /// Gradient of a fetch with respect to the coordinate.
    #[inline]
    pub fn uv_adjoint(&self, taps: &Taps, gradient: &[f32; C]) -> Vec2 {
        let [a, b, c, d] = self.four(taps);
        let (fx, fy) = (taps.fx, taps.fy);
        let mut out = Vec2::ZERO;
        for k in 0..C {
            out.x += gradient[k] * ((b[k] - a[k]) * (1.0 - fy) + (d[k] - c[k]) * fy);
            out.y += gradient[k] * ((c[k] - a[k]) * (1.0 - fx) + (d[k] - b[k]) * fx);
        }
        out * Vec2::new(self.width as f32, self.height as f32)
    }
}

/// A texture with its mip levels, finest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pyramid<const C: usize> {
    /// At least one level.
    pub levels: Vec<FloatImage<[f32; C]>>,
    /// Wrap modes along u and v.
    pub wrap: [Wrap; 2],
}

/// Level of detail of a footprint: its derivatives per pixel, in texture widths.
/// 0 where the texture is magnified; not bounded above.
#[inline]
pub fn level_of_detail(per_x: Vec2, per_y: Vec2, width: usize, height: usize) -> f32 {
    let size = Vec2::new(width as f32, height as f32);
    let square = (per_x * size).length_squared().max((per_y * size).length_squared());
    0.5 * square.max(1.0).log2()
}

impl<const C: usize> Pyramid<C> {
    /// Texels along u and v of the finest level.
    #[inline]
    pub fn size(&self) -> [usize; 2] {
        [self.levels[0].width, self.levels[0].height]
    }

    /// The finer of the two levels that a level of detail blends, and the share of the coarser one.
    #[inline]
    pub fn split(&self, lod: f32) -> (usize, f32) {
        let lod = lod.clamp(0.0, (self.levels.len() - 1) as f32);
        let level = lod as usize;
        (level, lod - level as f32)
    }

    /// The level of detail of a footprint on this texture.
    #[inline]
    pub fn lod(&self, per_x: Vec2, per_y: Vec2) -> f32 {
        if self.levels.len() == 1 {
            return 0.0;
        }
        level_of_detail(per_x, per_y, self.levels[0].width, self.levels[0].height)
    }

    /// Bilinear on level 0 for lod ≤ 0, trilinear above.
    #[inline]
    pub fn fetch(&self, uv: Vec2, lod: f32) -> [f32; C] {
        let (level, blend) = self.split(lod);
        let fine = &self.levels[level];
        let mut out = fine.fetch(&taps(uv, fine.width, fine.height, self.wrap));
        if blend > 0.0 {
            let coarse = &self.levels[level + 1];
            let other = coarse.fetch(&taps(uv, coarse.width, coarse.height, self.wrap));
            for k in 0..C {
                out[k] += (other[k] - out[k]) * blend;
            }
        }
        out
    }

    /// Adjoint of [`Pyramid::fetch`]: scatters into the levels of `texels` (of
    /// this pyramid's shape) and returns the gradients of uv and of lod.
    #[inline]
    pub fn adjoint(&self, uv: Vec2, lod: f32, gradient: &[f32; C], texels: &mut Pyramid<C>) -> (Vec2, f32) {
        let (level, blend) = self.split(lod);
        let fine = &self.levels[level];
        let fine_taps = taps(uv, fine.width, fine.height, self.wrap);
        if blend <= 0.0 {
            texels.levels[level].scatter(&fine_taps, gradient);
            return (fine.uv_adjoint(&fine_taps, gradient), 0.0);
        }
        let coarse = &self.levels[level + 1];
        let coarse_taps = taps(uv, coarse.width, coarse.height, self.wrap);
        let to_fine = gradient.map(|g| g * (1.0 - blend));
        let to_coarse = gradient.map(|g| g * blend);
        texels.levels[level].scatter(&fine_taps, &to_fine);
        texels.levels[level + 1].scatter(&coarse_taps, &to_coarse);
        let (f, c) = (fine.fetch(&fine_taps), coarse.fetch(&coarse_taps));
        let to_lod = (0..C).map(|k| gradient[k] * (c[k] - f[k])).sum();
        (fine.uv_adjoint(&fine_taps, &to_fine) + coarse.uv_adjoint(&coarse_taps, &to_coarse), to_lod)
    }

    /// Zeros in this pyramid's shape.
    pub fn zeros_like(&self) -> Self {
        let levels = self.levels.iter().map(|l| FloatImage::zeros(l.width, l.height)).collect();
        Self { levels, wrap: self.wrap }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(i: u64) -> f32 {
        let x = (i + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        ((x ^ (x >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 40) as f32 / (1u64 << 24) as f32
    }

    fn texture() -> Pyramid<2> {
        let texels = (0..8 * 4).map(|i| [noise(2 * i), noise(2 * i + 1)]).collect();
        let mut p = Pyramid::from_base(FloatImage { width: 8, height: 4, texels });
        p.wrap = [Wrap::Repeat, Wrap::Mirror];
        p
    }

    /// Protects the gradients to texels on every level, to uv and to lod.
    #[test]
    fn adjoint_matches_central_differences() {
        let p = texture();
        let g = [0.7, -1.2];
        let dot = |v: [f32; 2]| v[0] * g[0] + v[1] * g[1];
        for i in 0..200 {
            let uv = Vec2::new(noise(900 + i) * 3.0 - 1.0, noise(1900 + i) * 3.0 - 1.0);
            let lod = noise(2900 + i) * 4.0 - 1.0;
            let mut texels = p.zeros_like();
            let (to_uv, to_lod) = p.adjoint(uv, lod, &g, &mut texels);
            for (l, level) in p.levels.iter().enumerate() {
                for t in 0..level.texels.len() {
                    let mut q = p.clone();
                    q.levels[l].texels[t][0] += 1.0;
                    let numeric = dot(q.fetch(uv, lod)) - dot(p.fetch(uv, lod));
                    assert!((numeric - texels.levels[l].texels[t][0]).abs() < 1e-5);
                }
            }
            let h = 1e-3;
            // A kink lies where the step crosses a texel centre of any level: skip it.
            let kink = (0..3).any(|l| {
                let cell = |v: f32, n: usize| ((v * n as f32) - 0.5).floor();
                let (w, hh) = (8 >> l, (4 >> l).max(1));
                cell(uv.x - h, w) != cell(uv.x + h, w) || cell(uv.y - h, hh) != cell(uv.y + h, hh)
            });
            if !kink {
                let nx =
                    (dot(p.fetch(uv + Vec2::X * h, lod)) - dot(p.fetch(uv - Vec2::X * h, lod))) / (2.0 * h);
                let ny =
                    (dot(p.fetch(uv + Vec2::Y * h, lod)) - dot(p.fetch(uv - Vec2::Y * h, lod))) / (2.0 * h);
                assert!((nx - to_uv.x).abs() < 5e-3 * nx.abs().max(1.0), "{nx} {to_uv}");
                assert!((ny - to_uv.y).abs() < 5e-3 * ny.abs().max(1.0), "{ny} {to_uv}");
            }
            if lod.fract() > 2.0 * h && lod.fract() < 1.0 - 2.0 * h && lod > 0.0 && lod < 3.0 {
                let numeric = (dot(p.fetch(uv, lod + h)) - dot(p.fetch(uv, lod - h))) / (2.0 * h);
                assert!((numeric - to_lod).abs() < 2e-3);
            }
        }
    }

    /// Protects the way that reads three channels as four lanes: it blends the same numbers, also at the last texel, after which
    /// there is no fourth.
    #[test]
    fn three_channels_are_read_alike() {
        let texels: Vec<[f32; 3]> =
            (0..12).map(|i| [noise(3 * i), noise(3 * i + 1), noise(3 * i + 2)]).collect();
        let image = FloatImage { width: 4, height: 3, texels };
        for i in 0..60 {
            let uv = Vec2::new(noise(100 + i), noise(300 + i));
            let taps = taps(uv, 4, 3, [Wrap::Repeat, Wrap::Clamp]);
            let (w, four) = (taps.weights(), image.four(&taps));
            let blend =
                |k: usize| four[0][k] * w[0] + four[1][k] * w[1] + four[2][k] * w[2] + four[3][k] * w[3];
            assert_eq!(image.fetch(&taps), [blend(0), blend(1), blend(2)]);
        }
        let last = taps(Vec2::new(0.99, 0.99), 4, 3, [Wrap::Clamp; 2]);
        assert!(last.index.contains(&11) && image.four_wide(&last).is_none());
    }

    /// Protects the three wrap modes at and far beyond the border.
    #[test]
    fn wrap_modes_follow_gltf() {
        let ring = |wrap| (-5..6).map(|i| wrapped(i, 3, wrap)).collect::<Vec<_>>();
        assert_eq!(ring(Wrap::Repeat), [1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2]);
        assert_eq!(ring(Wrap::Mirror), [1, 2, 2, 1, 0, 0, 1, 2, 2, 1, 0]);
        assert_eq!(ring(Wrap::Clamp), [0, 0, 0, 0, 0, 0, 1, 2, 2, 2, 2]);
    }
}
