//! The textures of a fit of shifts, albedo and normal of a texel side by side: whoever reads one
//! reads the other, and both then come with one line of the cache.
//!
//! Forward: a bilinear fetch. Adjoint: each of the four texels receives its weight times the
//! gradient, and the coordinate what the slopes say.

use crate::canvas::Canvas;
use parbake_model::Wrap;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_render::texture::{Taps, taps};
use rayon::prelude::*;

/// Albedo, 0 … 1, and unit tangent-space normal; or their gradients.
pub(super) type Texel = [Vec4; 2];

/// Texels of one task.
pub(super) const BAND: usize = 4096;

/// A square texture that repeats.
pub(super) struct Texels {
    pub size: usize,
    /// size² texels, row 0 on top.
    pub texels: Vec<Texel>,
}

/// What a fetch gives: values, and how they change with the coordinate, for a texture's width.
#[derive(Clone, Copy, Default)]
pub(super) struct Fetched {
    pub value: Texel,
    pub per_u: Texel,
    pub per_v: Texel,
}

impl Texels {
    pub fn new(color: &Canvas, normal: &Canvas) -> Self {
        let pairs = color.texels.par_iter().zip(&normal.texels);
        Self { size: color.size, texels: pairs.map(|(color, normal)| [*color, *normal]).collect() }
    }

    /// Writes both textures back.
    pub fn write(&self, color: &mut Canvas, normal: &mut Canvas) {
        let both = color.texels.par_iter_mut().zip(&mut normal.texels);
        both.zip(&self.texels).for_each(|((color, normal), texel)| [*color, *normal] = *texel);
    }

    /// Where a coordinate is fetched.
    #[inline]
    pub fn taps(&self, uv: Vec2) -> Taps {
        taps(uv, self.size, self.size, [Wrap::Repeat; 2])
    }

    /// The blend of four texels, and its slopes.
    #[inline]
    pub fn fetch(&self, at: &Taps) -> Fetched {
        let [a, b, c, d] = at.index;
        let [a, b, c, d] = [a, b, c, d].map(|i| &self.texels[i as usize]);
        let mut out = Fetched::default();
        for k in 0..2 {
            let (across_above, across_below) = (b[k] - a[k], d[k] - c[k]);
            let above = a[k] + across_above * at.fx;
            let down = c[k] + across_below * at.fx - above;
            out.value[k] = above + down * at.fy;
            out.per_u[k] = across_above + (across_below - across_above) * at.fy;
            out.per_v[k] = down;
        }
        out
    }

    /// Brings albedos back between 0 and 1, and normals to unit length, in front of their surface.
    pub fn bring_back(&mut self) {
        self.texels.par_chunks_mut(BAND).flatten_iter().for_each(|[color, normal]| {
            *color = color.clamp(Vec4::ZERO, Vec4::ONE);
            let [x, y, z, _] = normal.to_array();
            *normal = Vec3::new(x, y, z.max(0.02)).normalize().extend(0.0);
        });
    }
}

impl Fetched {
    /// Gradient of the coordinate, given that of the values, for texels of this many in a row.
    #[inline]
    pub fn by_coordinate(&self, gradient: &Texel, size: usize) -> Vec2 {
        let along = |slope: &Texel| (slope[0] * gradient[0] + slope[1] * gradient[1]).element_sum();
        Vec2::new(along(&self.per_u), along(&self.per_v)) * size as f32
    }
}

/// Adds the gradient of a fetch to the texels that it blended.
#[inline]
pub(super) fn scatter(at: &Taps, gradient: &Texel, into: &mut [Texel]) {
    for (index, weight) in at.index.into_iter().zip(at.weights()) {
        let texel = &mut into[index as usize];
        texel[0] += gradient[0] * weight;
        texel[1] += gradient[1] * weight;
    }
}

/// Adds the gradients of others to these, one after the other, and leaves zeros in their places:
/// they are wanted next, and are in the cache now.
pub(super) fn gather<'a>(into: &mut [Texel], others: impl Iterator<Item = &'a mut [Texel]>) {
    let mut by_band: Vec<Vec<&mut [Texel]>> = Vec::new();
    by_band.resize_with(into.len().div_ceil(BAND), Vec::new);
    for other in others {
        by_band.iter_mut().zip(other.chunks_mut(BAND)).for_each(|(band, other)| band.push(other));
    }
    into.par_chunks_mut(BAND).zip(by_band).for_each(|(into, others)| {
        for other in others {
            for (into, from) in into.iter_mut().zip(other) {
                into[0] += from[0];
                into[1] += from[1];
                *from = [Vec4::ZERO; 2];
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(i: usize) -> f32 {
        ((i * 37 + 11) % 101) as f32 / 50.0 - 1.0
    }

    fn lane(i: usize) -> Vec4 {
        Vec4::new(noise(i), noise(i + 7), noise(i + 31), 0.0)
    }

    /// Protects both gradients of a fetch, also across the seam of a texture that repeats.
    #[test]
    fn adjoints_match_central_differences() {
        let canvas =
            |first: usize| Canvas { size: 4, texels: (0..16).map(|i| lane(first + 3 * i)).collect() };
        let texels = Texels::new(&canvas(0), &canvas(100));
        let gradient = [lane(5), lane(9)];
        let value = |texels: &Texels, uv: Vec2| {
            let Fetched { value, .. } = texels.fetch(&texels.taps(uv));
            value[0].dot(gradient[0]) + value[1].dot(gradient[1])
        };
        for uv in [Vec2::new(0.4, 0.55), Vec2::new(0.97, 0.02)] {
            let at = texels.taps(uv);
            let slope = texels.fetch(&at).by_coordinate(&gradient, 4);
            for (axis, slope) in [(Vec2::X, slope.x), (Vec2::Y, slope.y)] {
                let h = 1e-2;
                let difference = (value(&texels, uv + axis * h) - value(&texels, uv - axis * h)) / (2.0 * h);
                assert!((slope - difference).abs() < 1e-3, "{uv}: {slope} {difference}");
            }
            let mut into = vec![[Vec4::ZERO; 2]; 16];
            scatter(&at, &gradient, &mut into);
            for (i, slope) in into.iter().enumerate() {
                let mut moved = Texels { size: 4, texels: texels.texels.clone() };
                moved.texels[i][1].y += 1.0;
                assert!((slope[1].y - (value(&moved, uv) - value(&texels, uv))).abs() < 1e-5);
            }
        }
    }

    /// Protects gradients: none is lost at the seams of bands, and none is added twice.
    #[test]
    fn sums_are_whole() {
        let plane = |value| vec![[Vec4::splat(value), Vec4::splat(-value)]; 2 * BAND + 7];
        let (mut first, mut others) = (plane(1.0), [plane(2.0), plane(4.0)]);
        gather(&mut first, others.iter_mut().map(Vec::as_mut_slice));
        assert!(first.iter().all(|texel| *texel == [Vec4::splat(7.0), Vec4::splat(-7.0)]));
        assert!(others == [plane(0.0), plane(0.0)]);
    }
}
