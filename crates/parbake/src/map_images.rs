//! Maps, rounded to the 8 bits of images.
//!
//! Contract: one image a map, in the order of the maps; colours are encoded if `srgb`.

use parbake_image::quantise::to_image;
use parbake_image::{MapKind, MapSet};
use parbake_model::Image;

/// Maps as files hold them.
pub(crate) fn images(maps: &MapSet, srgb: bool) -> Vec<(MapKind, Image)> {
    maps.iter().map(|(kind, map)| (kind, to_image(kind, map, srgb))).collect()
}
