//! A stored map with fewer texels, averaged in what its numbers mean: colours in linear light, normals as vectors.

use crate::FloatImage;
use crate::maps::MapKind;
use crate::quantise::{from_image, to_image};
use glam::Vec4;
use parbake_model::Image;

/// The map with its sides halved so many times; all other channels than the kind's own go along. `srgb` as in
/// [`from_image`].
pub fn reduced(kind: MapKind, image: &Image, srgb: bool, halvings: usize) -> Image {
    if halvings == 0 {
        return image.clone();
    }
    let FloatImage { width, height, texels } = from_image(kind, image, srgb);
    let fine = FloatImage { width, height, texels: texels.iter().map(Vec4::to_array).collect() };
    let FloatImage { width, height, texels } = (0..halvings).fold(fine, |map, _| map.halved());
    let map = FloatImage { width, height, texels: texels.into_iter().map(Vec4::from).collect() };
    Image { name: image.name.clone(), ..to_image(kind, &map, srgb) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects brightness: black and white average to the grey that is half as bright, not to the middle number.
    #[test]
    fn colours_average_in_linear_light() {
        let board = |side: usize| {
            let value = |k: usize| if (k + k / side).is_multiple_of(2) { 255 } else { 0 };
            let pixels = (0..side * side).map(|k| [value(k), value(k), value(k), 255]).collect();
            Image { name: "board".into(), width: side, height: side, pixels }
        };
        let small = reduced(MapKind::BaseColor, &board(8), true, 2);
        assert_eq!((small.width, small.height, small.name.as_str()), (2, 2, "board"));
        assert_eq!(small.pixels, [[188, 188, 188, 255]; 4]);
        assert_eq!(reduced(MapKind::MetallicRoughness, &board(8), true, 1).pixels[0], [128, 128, 128, 255]);
    }
}
