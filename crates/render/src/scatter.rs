//! Scattering the texels' gradients of many samples into a mip pyramid, in parallel
//! and always in the same order.
//!
//! The adjoint of [`Pyramid::fetch`] by its texels: each tap receives its weight times
//! the sample's gradient. Instead of atomics or a copy of the texture for each thread,
//! the samples are sorted by the strips of texel rows that they touch; then each strip
//! is filled by itself, its samples in their order. A texture without mip levels, as fits of the
//! shape use, takes one tap where others take up to two and a choice between levels: sorting would
//! cost more than adding, and such fits have other views to keep the other threads busy.
//!
//! Contract: adds to what is there; the result does not depend on the number of
//! threads, only on the samples' order and their division into bands.

use parbake_image::pyramid::{Pyramid, taps};
use parbake_model::Wrap;
use parbake_model::glam::Vec2;
use rayon::prelude::*;

/// Where one sample fetched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fetch {
    /// The coordinate.
    pub uv: Vec2,
    /// The level of detail.
    pub lod: f32,
}

/// Strips a level has at most; more would only cost bookkeeping.
const MOST_STRIPS: usize = 64;
/// Texel rows a strip has at least.
const LEAST_ROWS: usize = 16;

/// Rows of each strip of a level.
fn strip_rows(height: usize) -> usize {
    height.div_ceil(MOST_STRIPS).max(LEAST_ROWS)
}

/// The samples of one band, sorted by strip: strip s owns `order[starts[s]..starts[s + 1]]`.
#[derive(Debug)]
struct Sorted {
    starts: Vec<u32>,
    order: Vec<u32>,
}

/// Fetches sorted by the strips that they touch, good for every pyramid of one shape.
#[derive(Debug)]
pub struct Scatter<'a> {
    layout: Layout,
    bands: Vec<&'a [Fetch]>,
    /// Of each band; none of a texture without mip levels.
    sorted: Vec<Sorted>,
}

/// For each level: its first strip, rows of a strip, width, height.
#[derive(Debug)]
struct Layout {
    levels: Vec<[usize; 4]>,
    strips: usize,
    wrap: [Wrap; 2],
}

impl Layout {
    fn of<const C: usize>(pyramid: &Pyramid<C>) -> Self {
        let mut strips = 0;
        let levels = (pyramid.levels.iter())
            .map(|level| {
                let rows = strip_rows(level.height);
                let first = strips;
                strips += level.height.div_ceil(rows);
                [first, rows, level.width, level.height]
            })
            .collect();
        Self { levels, strips, wrap: pyramid.wrap }
    }

    /// The strips of the two rows of taps on a level; twice the same where both rows
    /// lie in one.
    #[inline]
    fn touched(&self, level: usize, uv: Vec2) -> [usize; 2] {
        let [first, rows, width, height] = self.levels[level];
        let index = taps(uv, width, height, self.wrap).index;
        [index[0], index[2]].map(|i| first + i as usize / (rows * width))
    }
}

fn sort<const C: usize>(pyramid: &Pyramid<C>, layout: &Layout, samples: &[Fetch]) -> Sorted {
    let mut touches: Vec<(u32, u32)> = Vec::with_capacity(3 * samples.len());
    let mut starts = vec![0u32; layout.strips + 1];
    for (i, sample) in samples.iter().enumerate() {
        let (level, blend) = pyramid.split(sample.lod);
        for level in level..=level + usize::from(blend > 0.0) {
            let [a, b] = layout.touched(level, sample.uv);
            starts[a] += 1;
            touches.push((a as u32, i as u32));
            if b != a {
                starts[b] += 1;
                touches.push((b as u32, i as u32));
            }
        }
    }
    // Counts to ends; filling backwards turns them into starts and keeps the order.
    let mut end = 0;
    for start in &mut starts {
        end += *start;
        *start = end;
    }
    let mut order = vec![0; touches.len()];
    for &(strip, sample) in touches.iter().rev() {
        starts[strip as usize] -= 1;
        order[starts[strip as usize] as usize] = sample;
    }
    Sorted { starts, order }
}

impl<'a> Scatter<'a> {
    /// Sorts the fetches from this pyramid, or one of its shape.
    pub fn new<const C: usize>(pyramid: &Pyramid<C>, bands: impl IntoIterator<Item = &'a [Fetch]>) -> Self {
        let layout = Layout::of(pyramid);
        let bands: Vec<&[Fetch]> = bands.into_iter().collect();
        let sorted = match pyramid.levels.len() {
            1 => Vec::new(),
            _ => bands.par_iter().map(|band| sort(pyramid, &layout, band)).collect(),
        };
        Self { layout, bands, sorted }
    }

    /// Adds the gradients of all fetched values, band by band and fetch by fetch, to
    /// the texels.
    pub fn add<const C: usize>(&self, gradients: &[&[[f32; C]]], into: &mut Pyramid<C>) {
        if let [level] = into.levels.as_mut_slice() {
            for (fetch, gradient) in self.bands.iter().zip(gradients).flat_map(|(f, g)| f.iter().zip(*g)) {
                level.scatter(&taps(fetch.uv, level.width, level.height, self.layout.wrap), gradient);
            }
            return;
        }
        let top = into.levels.len() - 1;
        let strips: Vec<(usize, usize, &mut [[f32; C]])> = (into.levels.iter_mut().enumerate())
            .flat_map(|(l, level)| {
                let [first, rows, width, _] = self.layout.levels[l];
                let chunks = level.texels.chunks_mut(rows * width).enumerate();
                chunks.map(move |(s, texels)| (l, first + s, texels))
            })
            .collect();
        strips.into_par_iter().with_max_len(1).for_each(|(l, strip, texels)| {
            let [first, rows, width, height] = self.layout.levels[l];
            let base = ((strip - first) * rows * width) as u32;
            for ((band, sorted), gradients) in self.bands.iter().zip(&self.sorted).zip(gradients) {
                let range = sorted.starts[strip] as usize..sorted.starts[strip + 1] as usize;
                for &i in &sorted.order[range] {
                    let (fetch, gradient) = (&band[i as usize], &gradients[i as usize]);
                    let lod = fetch.lod.clamp(0.0, top as f32);
                    let (level, blend) = (lod as usize, lod - (lod as usize) as f32);
                    let share = if level == l { 1.0 - blend } else { blend };
                    let at = taps(fetch.uv, width, height, self.layout.wrap);
                    for (index, weight) in at.index.into_iter().zip(at.weights()) {
                        // Taps of a neighbouring strip are that strip's to add.
                        if let Some(texel) = texels.get_mut(index.wrapping_sub(base) as usize) {
                            for (texel, gradient) in texel.iter_mut().zip(gradient) {
                                *texel += weight * share * gradient;
                            }
                        }
                    }
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_image::FloatImage;

    fn number(i: usize) -> f32 {
        ((i * 7919 + 13) % 1009) as f32 / 1009.0
    }

    /// The same texels' gradients as one fetch after the other.
    fn agrees(mut pyramid: Pyramid<2>) {
        pyramid.wrap = [Wrap::Repeat, Wrap::Clamp];
        let samples = |band: usize| (0..200).map(move |i| 6 * (200 * band + i));
        let fetch = |i| Fetch {
            uv: Vec2::new(number(i) * 3.0 - 1.0, number(i + 1) * 3.0 - 1.0),
            lod: number(i + 2) * 9.0 - 1.0,
        };
        let gradient = |i| [number(i + 3) - 0.5, number(i + 4)];
        let fetches: Vec<Vec<_>> = (0..5).map(|band| samples(band).map(fetch).collect()).collect();
        let gradients: Vec<Vec<_>> = (0..5).map(|band| samples(band).map(gradient).collect()).collect();
        let (mut own, mut plain) = (pyramid.zeros_like(), pyramid.zeros_like());
        let slices: Vec<&[_]> = gradients.iter().map(Vec::as_slice).collect();
        Scatter::new(&pyramid, fetches.iter().map(Vec::as_slice)).add(&slices, &mut own);
        for (f, g) in fetches.iter().flatten().zip(gradients.iter().flatten()) {
            pyramid.adjoint(f.uv, f.lod, g, &mut plain);
        }
        for (a, b) in own.levels.iter().zip(&plain.levels) {
            for (a, b) in a.texels.iter().zip(&b.texels) {
                assert!((a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4, "{a:?} {b:?}");
            }
        }
    }

    /// Protects every texel's gradient, on many levels and on one.
    #[test]
    fn agrees_with_the_adjoint_of_each_fetch() {
        agrees(Pyramid::from_base(FloatImage::zeros(40, 70)));
        agrees(Pyramid::single(FloatImage::zeros(40, 70)));
    }
}
