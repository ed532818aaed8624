//! A part of a texture with another number of texels, for textures that are put into one (`fast_image_resize`).
//!
//! Where the number stays, texels are copied; where it halves, they are those of the next mip level. Between, Catmull and Rom's
//! cubic reads that level which has up to twice the texels.
//!
//! Contract: what lies outside of the texture is as its wrap modes say. Values overshoot a little where a map jumps.

use crate::FloatImage;
use crate::pyramid::wrapped;
use fast_image_resize::images::{TypedImage, TypedImageRef};
use fast_image_resize::pixels::F32x4;
use fast_image_resize::{FilterType, ResizeAlg, ResizeOptions, Resizer};
use glam::DVec2;
use parbake_model::Wrap;
use std::borrow::Cow;

/// Texels around a part that filters read.
const AROUND: f64 = 5.0;
/// Corners within so many texels of whole ones are whole: what rounding makes of them.
const ROUNDED: f64 = 1e-6;

/// The part of a map from `low` to `high`, in texture coordinates, with `size` texels along u and v.
pub fn window(
    map: &FloatImage<[f32; 4]>,
    wrap: [Wrap; 2],
    [low, high]: [DVec2; 2],
    size: [usize; 2],
) -> FloatImage<[f32; 4]> {
    let texels = vec![[0.0; 4]; size[0] * size[1]];
    let mut out = FloatImage { width: size[0], height: size[1], texels };
    if map.texels.is_empty() || out.texels.is_empty() {
        return out;
    }
    let wanted = DVec2::new(size[0] as f64, size[1] as f64) / (high - low);
    let map = &*coarsest(map, wanted);
    let texels = DVec2::new(map.width as f64, map.height as f64);
    let snapped = |x: f64| if (x - x.round()).abs() < ROUNDED { x.round() } else { x };
    let [low, high] = [low, high].map(|corner| DVec2::from((corner * texels).to_array().map(snapped)));
    let [first, last] = [(low - AROUND).floor(), (high + AROUND).ceil()];
    let [w, h] = (last - first).to_array().map(|side| side as usize);
    let column = |x: usize| wrapped(first.x as i64 + x as i64, map.width as i64, wrap[0]) as usize;
    let row = |y: usize| wrapped(first.y as i64 + y as i64, map.height as i64, wrap[1]) as usize;
    let columns: Vec<usize> = (0..w).map(column).collect();
    let part: Vec<F32x4> = (0..h)
        .flat_map(|y| {
            let row = &map.texels[row(y) * map.width..][..map.width];
            columns.iter().map(|&x| F32x4::new(row[x]))
        })
        .collect();
    let part = FloatImage { width: w, height: h, texels: part };
    out.texels = resized(&part, [low - first, high - low], size);
    out
}

/// The coarsest mip level that has at least `wanted` texels for each unit of its coordinates.
fn coarsest(map: &FloatImage<[f32; 4]>, wanted: DVec2) -> Cow<'_, FloatImage<[f32; 4]>> {
    let mut map = Cow::Borrowed(map);
    let has_enough = |side: usize, wanted: f64| side as f64 >= wanted - ROUNDED;
    while map.width > 1
        && map.height > 1
        && has_enough(map.width / 2, wanted.x)
        && has_enough(map.height / 2, wanted.y)
    {
        let is_even = map.width.is_multiple_of(2) && map.height.is_multiple_of(2);
        map = Cow::Owned(if is_even { map.halved() } else { with_powers_of_two(&map) });
    }
    map
}

/// A map whose sides do not halve, with the next smaller sides that do.
fn with_powers_of_two(map: &FloatImage<[f32; 4]>) -> FloatImage<[f32; 4]> {
    let [width, height] = [map.width, map.height].map(|side| 1 << side.ilog2());
    let texels = map.texels.iter().map(|&t| F32x4::new(t)).collect();
    let part = FloatImage { width: map.width, height: map.height, texels };
    let whole = [DVec2::ZERO, DVec2::new(map.width as f64, map.height as f64)];
    FloatImage { width, height, texels: resized(&part, whole, [width, height]) }
}

/// The part of a map that begins at `corner` and is so large, in texels, with `size` texels.
fn resized(from: &FloatImage<F32x4>, [corner, extent]: [DVec2; 2], size: [usize; 2]) -> Vec<[f32; 4]> {
    let filter = ResizeAlg::Convolution(FilterType::CatmullRom);
    let options = ResizeOptions::new().resize_alg(filter).use_alpha(false);
    let options = options.crop(corner.x, corner.y, extent.x, extent.y);
    let mut to = TypedImage::new(size[0] as u32, size[1] as u32);
    // The part lies within, and there are as many texels as its sides say: nothing of this fails.
    if let Ok(from) = TypedImageRef::new(from.width as u32, from.height as u32, &from.texels) {
        let _ = Resizer::new().resize_typed(&from, &mut to, &options);
    }
    to.pixels().iter().map(|pixel| pixel.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    fn map(width: usize, height: usize) -> FloatImage<[f32; 4]> {
        let texel = |i: usize| [(i % width) as f32, (i / width) as f32, ((i * 7) % 5) as f32, 1.0];
        FloatImage { width, height, texels: (0..width * height).map(texel).collect() }
    }

    /// Protects drawings: a part with as many texels is a copy, around the border as well, and with half of them the next
    /// mip level.
    #[test]
    fn texels_are_copied() {
        let map = map(16, 8);
        let out = window(&map, [Wrap::Repeat, Wrap::Clamp], [dvec2(-0.25, 0.5), dvec2(0.25, 1.25)], [8, 6]);
        for (i, texel) in out.texels.iter().enumerate() {
            let (x, y) = ((i % 8 + 12) % 16, (i / 8 + 4).min(7));
            assert_eq!(*texel, map.texels[y * 16 + x], "texel {i}");
        }
        let half = window(&map, [Wrap::Repeat; 2], [DVec2::ZERO, DVec2::ONE], [8, 4]);
        assert_eq!(half, map.halved());
    }

    /// Protects from shifts and brighter or darker maps: a ramp stays a ramp at any scale, with fewer texels than a repeated
    /// texture has and with more.
    #[test]
    fn ramps_stay_ramps() {
        let ramp = FloatImage {
            width: 64,
            height: 64,
            texels: (0..4096).map(|i| [(i % 64) as f32 + 0.5, (i / 64) as f32 + 0.5, 3.0, 1.0]).collect(),
        };
        for side in [7, 19, 31, 40] {
            let out = window(&ramp, [Wrap::Repeat; 2], [DVec2::splat(0.25), DVec2::splat(0.75)], [side; 2]);
            for (i, [u, v, constant, one]) in out.texels.iter().enumerate() {
                let at = |k: usize| 16.0 + 32.0 * (k as f32 + 0.5) / side as f32;
                assert!((u - at(i % side)).abs() < 0.2 && (v - at(i / side)).abs() < 0.2, "{side}: {u} {v}");
                assert!((constant - 3.0).abs() < 1e-4 && (one - 1.0).abs() < 1e-4);
            }
        }
        for width in [8, 9] {
            let many = window(&map(width, 8), [Wrap::Repeat; 2], [DVec2::ZERO, DVec2::splat(400.0)], [5, 5]);
            let middle = 0.5 * (width - 1) as f32;
            assert!(many.texels.iter().all(|t| (t[0] - middle).abs() < 1.0), "{:?}", many.texels);
        }
        assert!(
            window(&FloatImage::default(), [Wrap::Repeat; 2], [DVec2::ZERO, DVec2::ONE], [2, 2]).texels[0]
                == [0.0; 4]
        );
    }
}
