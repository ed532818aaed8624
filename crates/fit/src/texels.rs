//! The maps of a parallax fit, those of a texel side by side: whoever reads one reads the others, and
//! all then come with one line of the cache.
//!
//! Forward: a bilinear fetch. Adjoint: each of the four texels receives its weight times the
//! gradient, and the coordinate what the slopes say.

use parbake_image::maps::lift_to_hemisphere;
use parbake_image::pyramid::{Taps, taps};
use parbake_image::{Domain, FloatImage, MapKind, MapSet, MapValues};
use parbake_model::Wrap;
use parbake_model::glam::{Vec2, Vec4};
use rayon::prelude::*;

/// The values of N maps at one texel; or their gradients.
pub type Texel<const N: usize> = [Vec4; N];

/// Texels of one task.
pub(crate) const BAND: usize = 4096;

/// N maps of a square texture that repeats.
pub struct Texels<const N: usize> {
    /// Texels along a side.
    pub size: usize,
    /// Which maps.
    pub kinds: [MapKind; N],
    /// size² texels, row 0 on top.
    pub texels: Vec<Texel<N>>,
}

/// What a fetch gives: values, and how they change with the coordinate, for a texture's width.
#[derive(Clone, Copy)]
pub(crate) struct Fetched<const N: usize> {
    pub value: Texel<N>,
    pub per_u: Texel<N>,
    pub per_v: Texel<N>,
}

impl<const N: usize> Default for Fetched<N> {
    fn default() -> Self {
        let zero = [Vec4::ZERO; N];
        Self { value: zero, per_u: zero, per_v: zero }
    }
}

impl<const N: usize> Texels<N> {
    /// Of a set that has N maps.
    pub fn new(maps: &MapSet) -> Self {
        let size = maps.size();
        let mut kinds = [MapKind::BaseColor; N];
        let mut texels = vec![[Vec4::ZERO; N]; size * size];
        for (k, (kind, map)) in maps.iter().enumerate().take(N) {
            kinds[k] = kind;
            texels.par_iter_mut().zip(&map.texels).for_each(|(texel, value)| texel[k] = *value);
        }
        Self { size, kinds, texels }
    }

    /// Writes all maps back.
    pub fn write(&self, maps: &mut MapSet) {
        for (k, kind) in self.kinds.into_iter().enumerate() {
            let texels = self.texels.par_iter().map(|texel| texel[k]).collect();
            maps.insert(kind, FloatImage::square(self.size, texels));
        }
    }

    /// The values of a texel as shading reads them.
    #[inline(always)]
    pub fn values(&self, texel: &Texel<N>) -> MapValues {
        let mut values = MapValues::NEUTRAL;
        for k in 0..N {
            values[self.kinds[k]] = texel[k];
        }
        values
    }

    /// Where a coordinate is fetched.
    #[inline]
    pub fn taps(&self, uv: Vec2) -> Taps {
        taps(uv, self.size, self.size, [Wrap::Repeat; 2])
    }

    /// The blend of four texels, and its slopes.
    #[inline]
    pub(crate) fn fetch(&self, at: &Taps) -> Fetched<N> {
        let [a, b, c, d] = at.index;
        let [a, b, c, d] = [a, b, c, d].map(|i| &self.texels[i as usize]);
        let mut out = Fetched::default();
        for k in 0..N {
            let (across_above, across_below) = (b[k] - a[k], d[k] - c[k]);
            let above = a[k] + across_above * at.fx;
            let down = c[k] + across_below * at.fx - above;
            out.value[k] = above + down * at.fy;
            out.per_u[k] = across_above + (across_below - across_above) * at.fy;
            out.per_v[k] = down;
        }
        out
    }

    /// Brings all values back into their domains.
    pub fn bring_back(&mut self) {
        let domains = self.kinds.map(|kind| kind.spec().domain);
        self.texels.par_chunks_mut(BAND).flatten_iter().for_each(|texel| {
            for k in 0..N {
                texel[k] = match domains[k] {
                    Domain::Box => texel[k].clamp(Vec4::ZERO, Vec4::ONE),
                    Domain::Hemisphere => lift_to_hemisphere(texel[k].truncate()).extend(0.0),
                };
            }
        });
    }
}

impl<const N: usize> Fetched<N> {
    /// Gradient of the coordinate, given that of the values, for texels of this many in a row.
    #[inline]
    pub fn by_coordinate(&self, gradient: &Texel<N>, size: usize) -> Vec2 {
        let along = |slope: &Texel<N>| {
            let mut sum = slope[0] * gradient[0];
            for k in 1..N {
                sum += slope[k] * gradient[k];
            }
            sum.element_sum()
        };
        Vec2::new(along(&self.per_u), along(&self.per_v)) * size as f32
    }
}

/// Adds the gradient of a fetch to the texels that it blended.
#[inline]
pub(crate) fn scatter<const N: usize>(at: &Taps, gradient: &Texel<N>, into: &mut [Texel<N>]) {
    for (index, weight) in at.index.into_iter().zip(at.weights()) {
        let texel = &mut into[index as usize];
        for k in 0..N {
            texel[k] += gradient[k] * weight;
        }
    }
}

/// Adds the gradients of others to these, one after the other, and leaves zeros in their places:
/// they are wanted next, and are in the cache now.
pub(crate) fn gather<'a, const N: usize>(
    into: &mut [Texel<N>],
    others: impl Iterator<Item = &'a mut [Texel<N>]>,
) {
    let mut by_band: Vec<Vec<&mut [Texel<N>]>> = Vec::new();
    by_band.resize_with(into.len().div_ceil(BAND), Vec::new);
    for other in others {
        by_band.iter_mut().zip(other.chunks_mut(BAND)).for_each(|(band, other)| band.push(other));
    }
    into.par_chunks_mut(BAND).zip(by_band).for_each(|(into, others)| {
        for other in others {
            for (into, from) in into.iter_mut().zip(other) {
                for k in 0..N {
                    into[k] += from[k];
                }
                *from = [Vec4::ZERO; N];
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
        let canvas = |first: usize| FloatImage::square(4, (0..16).map(|i| lane(first + 3 * i)).collect());
        let texels = Texels::<2>::new(&MapSet::of(canvas(0), canvas(100)));
        let gradient = [lane(5), lane(9)];
        let value = |texels: &Texels<2>, uv: Vec2| {
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
                let mut moved = Texels { texels: texels.texels.clone(), ..texels };
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
