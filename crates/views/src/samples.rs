//! Where each pixel of the training views falls on the low-poly's texture, how the
//! light meets it there, and what the high-poly shows in its place.
//!
//! Forward: a walk over the views' pixels (`view_sampler.rs`), or those of an earlier walk and the
//! shift of the coordinate where there is a parallax map (`view_sample.rs`); what is left for the solvers
//! is a bilinear fetch and the shading. Samples are binned by texture tile (a stable counting sort a
//! group of views, then groups in order within a tile), so that bands of the texture can be summed by many
//! threads without atomics and always in the same order, and each band's texels stay in cache.
//!
//! Contract: the low-poly has normals, tangents and texture coordinates (wrapped by
//! repetition); fetches are bilinear on the finest level.

use crate::packing::{packed, unpacked};
use crate::reference::Reference;
use crate::view_sample::ViewSample;
use crate::view_sampler::ViewSampler;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_progress::{Stage, Watcher};
use parbake_render::frame::TangentLight;
use parbake_render::parallax_variants::shift_map::{ShiftMap, TangentView};
use parbake_solve::grid::{BAND, bands};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// One pixel of a training view, as the texture sees it: 36 bytes, since a fit reads
/// millions of them in every step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Sample {
    /// Upper left texel of the bilinear fetch.
    pub texel: u32,
    /// Fractions towards the right and lower texels, in 65536ths.
    pub fraction: [u16; 2],
    /// How the light meets the surface: the light's three numbers and the Gram
    /// matrix's six, in 32767ths of 1, which none of them exceeds.
    light: [i16; 9],
    /// Wanted display value of red, green and blue, in 65535ths of 1.
    pub target: [u16; 3],
    /// How much this sample counts, in 65535ths.
    pub weight: u16,
}

/// What is fetched from a texture by four texels and their bilinear weights.
pub trait Fetched {
    /// Upper left texel of the fetch.
    fn texel(&self) -> usize;

    /// Fractions towards the right and lower texels, in [0, 1).
    fn fractions(&self) -> [f32; 2];

    /// How much it counts, 0 … 1.
    fn weight(&self) -> f32;
}

/// All samples, by band of the texture, in one flat buffer.
#[derive(Clone, Debug, Default)]
pub struct SampleSet<S = Sample> {
    /// Texels along a side of the texture.
    pub size: usize,
    /// Where each band's samples begin, and the end of the last one's.
    first: Vec<usize>,
    /// Samples whose fetch begins in the first band, then in the second …, each in a fixed order.
    samples: Vec<S>,
}

impl Sample {
    /// A pixel that is fetched at this coordinate; the rest as it is kept.
    #[inline]
    fn at(uv: Vec2, size: usize, light: [i16; 9], target: [u16; 3], weight: u16) -> Self {
        let (texel, fraction) = place(uv, size);
        Self { texel, fraction, light, target, weight }
    }

    /// How the light meets the surface.
    #[inline]
    pub fn light(&self) -> TangentLight {
        unpacked(self.light)
    }

    /// Wanted display value.
    #[inline]
    pub fn target(&self) -> Vec4 {
        let [r, g, b] = self.target.map(|t| f32::from(t) * (1.0 / 65535.0));
        Vec4::new(r, g, b, 0.0)
    }
}

impl Fetched for Sample {
    #[inline]
    fn texel(&self) -> usize {
        self.texel as usize
    }

    #[inline]
    fn fractions(&self) -> [f32; 2] {
        self.fraction.map(|f| f32::from(f) * (1.0 / 65536.0))
    }

    #[inline]
    fn weight(&self) -> f32 {
        f32::from(self.weight) * (1.0 / 65535.0)
    }
}

impl Sample {
    /// A pixel that sees one texel from straight above, for hand-made scenes.
    pub fn facing(texel: u32, target: f32) -> Self {
        let straight = TangentLight { light: Vec3::Z, gram: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0] };
        let target = [(target * 65535.0) as u16; 3];
        Self { texel, fraction: [0; 2], light: packed(&straight), target, weight: u16::MAX }
    }
}

impl<S: Clone> SampleSet<S> {
    /// Of hand-made bands.
    pub fn new(size: usize, bands: &[Vec<S>]) -> Self {
        let mut first = vec![0];
        first.extend(bands.iter().scan(0, |end, band| {
            *end += band.len();
            Some(*end)
        }));
        Self { size, first, samples: bands.concat() }
    }
}

impl<S> SampleSet<S> {
    /// How many samples there are.
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// True when no view saw anything.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// All samples, band after band.
    pub fn iter(&self) -> std::slice::Iter<'_, S> {
        self.samples.iter()
    }

    /// Changes each sample by itself; where it falls on the texture stays.
    pub fn update(&mut self, change: impl Fn(&mut S) + Sync + Send)
    where
        S: Send,
    {
        self.samples.par_iter_mut().for_each(change);
    }

    /// How many bands there are.
    pub fn bands(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// The samples of a band; none where there is no such band.
    #[inline]
    pub fn band(&self, band: usize) -> &[S] {
        match self.first.get(band..band + 2) {
            Some(&[from, to]) => &self.samples[from..to],
            _ => &[],
        }
    }
}

/// Texels along a tile's width; its height is [`BAND`].
const TILE: usize = 32;

struct Layout {
    size: usize,
    tiles_across: usize,
}

impl Layout {
    fn tiles(&self) -> usize {
        self.tiles_across * bands(self.size)
    }

    fn tile(&self, texel: usize) -> usize {
        (texel / self.size / BAND) * self.tiles_across + texel % self.size / TILE
    }
}

/// Views whose samples are kept together. Those of one are a few megabytes, which allocators keep for others
/// when they are freed: at 4096² texels 1.7 GB stayed behind.
const GROUP: usize = 32;

/// The samples of some views in tile order, and where each tile's begin.
struct Sorted<S> {
    samples: Vec<S>,
    begin: Vec<u32>,
}

/// Collects the samples of all references on a texture of `texture_size`².
pub fn collect_samples(
    sampler: &ViewSampler,
    references: &[Reference],
    texture_size: usize,
    watcher: &dyn Watcher,
) -> SampleSet {
    collect(references.par_iter(), texture_size, watcher, |reference, out| {
        sampler.fragments(reference, |seen| {
            out.push(Sample::at(seen.uv, texture_size, packed(&seen.light), seen.target, seen.weight));
        });
    })
}

/// The same of views that were walked before, their coordinates shifted by a map. Views that are
/// handed over rather than lent are gone as soon as they were read.
pub fn shifted_samples<V: AsRef<[ViewSample]>>(
    views: impl IntoParallelIterator<Item = V, Iter: IndexedParallelIterator>,
    texture_size: usize,
    map: &impl ShiftMap,
    watcher: &dyn Watcher,
) -> SampleSet {
    collect(views.into_par_iter(), texture_size, watcher, |view, out| {
        out.extend(view.as_ref().iter().map(|seen| {
            let from = TangentView::under_headlight(seen.view_direction(), &seen.light());
            let uv = seen.uv + map.shift(seen.uv, &from);
            Sample::at(uv, texture_size, seen.light, seen.target, seen.weight)
        }));
    })
}

pub(crate) fn collect<V, S: Fetched + Copy + Default + Send + Sync>(
    views: impl IndexedParallelIterator<Item = V>,
    texture_size: usize,
    watcher: &dyn Watcher,
    of_view: impl Fn(V, &mut Vec<S>) + Sync,
) -> SampleSet<S> {
    let layout = Layout { size: texture_size, tiles_across: texture_size.div_ceil(TILE) };
    let (done, all) = (AtomicUsize::new(0), views.len());
    // The order is that of views whatever the groups.
    let group = (all / (4 * rayon::current_num_threads())).clamp(1, GROUP);
    let views: Vec<Sorted<S>> = views
        .fold_chunks(group, Vec::new, |mut samples, view| {
            of_view(view, &mut samples);
            watcher.progress(Stage::Sampling, done.fetch_add(1, Ordering::Relaxed) + 1, all);
            samples
        })
        .map(|samples| sort(samples, &layout))
        .collect();
    let tiles = |band: usize| band * layout.tiles_across..(band + 1) * layout.tiles_across;
    let of = |v: &Sorted<S>, tile: usize| v.begin[tile] as usize..v.begin[tile + 1] as usize;
    let mut first = vec![0];
    for band in 0..bands(texture_size) {
        let tiles = tiles(band);
        let count = |v: &Sorted<S>| of(v, tiles.end - 1).end - of(v, tiles.start).start;
        first.push(first[band] + views.iter().map(count).sum::<usize>());
    }
    let mut samples = vec![S::default(); first.last().copied().unwrap_or_default()];
    let (mut rest, mut parts) = (samples.as_mut_slice(), Vec::with_capacity(first.len()));
    for ends in first.windows(2) {
        let (part, others) = rest.split_at_mut(ends[1] - ends[0]);
        parts.push(part);
        rest = others;
    }
    parts.into_par_iter().enumerate().for_each(|(band, part)| {
        let mut at = 0;
        for tile in tiles(band) {
            for view in &views {
                let from = &view.samples[of(view, tile)];
                part[at..at + from.len()].copy_from_slice(from);
                at += from.len();
            }
        }
    });
    SampleSet { size: texture_size, first, samples }
}

fn sort<S: Fetched + Copy + Default>(samples: Vec<S>, layout: &Layout) -> Sorted<S> {
    let mut begin = vec![0u32; layout.tiles() + 1];
    for s in &samples {
        begin[layout.tile(s.texel()) + 1] += 1;
    }
    for i in 1..begin.len() {
        begin[i] += begin[i - 1];
    }
    let mut next = begin.clone();
    let mut sorted = vec![S::default(); samples.len()];
    for s in samples {
        let place = &mut next[layout.tile(s.texel())];
        sorted[*place as usize] = s;
        *place += 1;
    }
    Sorted { samples: sorted, begin }
}

/// The upper left texel of a coordinate's fetch, and the fractions.
pub(crate) fn place(uv: Vec2, size: usize) -> (u32, [u16; 2]) {
    let along = |t: f32| {
        let x = t * size as f32 - 0.5;
        let first = x.floor();
        ((first as i64).rem_euclid(size as i64) as u32, ((x - first) * 65536.0).min(65535.0) as u16)
    };
    let ((x, fx), (y, fy)) = (along(uv.x), along(uv.y));
    (y * size as u32 + x, [fx, fy])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the wrap of fetches that straddle the texture's border.
    #[test]
    fn places_wrap_around() {
        assert_eq!(place(Vec2::new(0.0, 0.0), 4), (15, [32768, 32768]));
        assert_eq!(place(Vec2::new(0.375, 0.125), 4), (1, [0, 0]));
        assert_eq!(place(Vec2::new(-0.875, 1.125), 4), (0, [0, 0]));
    }
}
