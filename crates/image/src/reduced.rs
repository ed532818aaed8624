//! Maps with fewer texels, averaged in what their numbers mean: colours in linear light, normals as vectors.

use crate::FloatImage;
use crate::maps::{MapKind, MapSet};
use crate::quantise::{from_image, to_image};
use glam::Vec4;
use parbake_model::Image;
use rayon::prelude::*;

/// The map with its sides halved so many times, along u and along v; all other channels than the kind's own go along. `srgb`
/// as in [`from_image`].
pub fn reduced(kind: MapKind, image: &Image, srgb: bool, halvings: [usize; 2]) -> Image {
    if halvings == [0; 2] {
        return image.clone();
    }
    let FloatImage { width, height, texels } = from_image(kind, image, srgb);
    let fine = FloatImage { width, height, texels: texels.iter().map(Vec4::to_array).collect() };
    let FloatImage { width, height, texels } = {
        let steps = (0..halvings[0].max(halvings[1])).map(|step| halvings.map(|times| step < times));
        steps.fold(fine, |map, along| map.halved_along(along))
    };
    let map = FloatImage { width, height, texels: texels.into_iter().map(Vec4::from).collect() };
    Image { name: image.name.clone(), ..to_image(kind, &map, srgb) }
}

/// A square map of at most `side`² texels: each the mean of those that it stands for.
pub fn at_most(map: &FloatImage<Vec4>, side: usize) -> FloatImage<Vec4> {
    let size = map.width;
    if size <= side {
        return map.clone();
    }
    let range = |i: usize| i * size / side..(i + 1) * size / side;
    let mean = |x: usize, y: usize| {
        let rows = range(y).map(|y| &map.texels[y * size + range(x).start..y * size + range(x).end]);
        rows.flatten().sum::<Vec4>() / (range(x).len() * range(y).len()) as f32
    };
    FloatImage::square(side, (0..side * side).into_par_iter().map(|i| mean(i % side, i / side)).collect())
}

/// The same of all maps of a set.
pub fn all_at_most(maps: &MapSet, side: usize) -> MapSet {
    let mut reduced = MapSet::new(maps.size().min(side));
    maps.iter().for_each(|(kind, map)| reduced.insert(kind, at_most(map, side)));
    reduced
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects pictures of large maps: each texel counts, in one place, also where sides do not divide.
    #[test]
    fn every_texel_goes_into_one_mean() {
        let map = FloatImage::square(5, (0..25).map(|i| Vec4::splat(i as f32)).collect());
        assert_eq!(at_most(&map, 5), map);
        let small = at_most(&map, 2);
        // Columns 0 and 1 are the first, 2 to 4 the second; rows alike.
        assert_eq!(small.texels.iter().map(|t| t.x).collect::<Vec<_>>(), [3.0, 5.5, 15.5, 18.0]);
        let mut maps = MapSet::new(5);
        maps.insert(MapKind::Normal, map);
        let all = all_at_most(&maps, 2);
        assert_eq!((all.size(), all.get(MapKind::Normal)), (2, Some(&small)));
    }

    /// Protects brightness: black and white average to the grey that is half as bright, not to the middle number.
    #[test]
    fn colours_average_in_linear_light() {
        let board = |side: usize| {
            let value = |k: usize| if (k + k / side).is_multiple_of(2) { 255 } else { 0 };
            let pixels = (0..side * side).map(|k| [value(k), value(k), value(k), 255]).collect();
            Image { name: "board".into(), width: side, height: side, pixels }
        };
        let small = reduced(MapKind::BaseColor, &board(8), true, [2; 2]);
        assert_eq!((small.width, small.height, small.name.as_str()), (2, 2, "board"));
        assert_eq!(small.pixels, [[188, 188, 188, 255]; 4]);
        assert_eq!(
            reduced(MapKind::MetallicRoughness, &board(8), true, [1; 2]).pixels[0],
            [128, 128, 128, 255]
        );
        let wide = reduced(MapKind::BaseColor, &board(8), true, [0, 2]);
        assert_eq!((wide.width, wide.height, wide.pixels[0]), (8, 2, [188, 188, 188, 255]));
    }
}
