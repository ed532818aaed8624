//! The last step of every map: eight bits a channel, as files hold them; and back.

use crate::FloatImage;
use crate::display::{decode_srgb, encode_srgb};
use crate::maps::{Encoding, MapKind};
use glam::{Vec3, Vec4};
use parbake_model::Image;
use rayon::prelude::*;

fn round(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// What a stored number of a map stands for, by number; `srgb` tells whether files hold sRGB of
/// colours, as glTF says, or colours as they are.
pub fn decoded(kind: MapKind, srgb: bool) -> [f32; 256] {
    std::array::from_fn(|stored| {
        let x = stored as f32 / 255.0;
        match kind.spec().encoding {
            Encoding::Srgb if srgb => decode_srgb(x),
            Encoding::Srgb | Encoding::Linear => x,
            Encoding::Signed => stored as f32 * (2.0 / 255.0) - 1.0,
        }
    })
}

/// A map as a file holds it: RGB, and the base colour's opacity as alpha, 1 for all other maps. Normals
/// are stored at unit length.
pub fn to_image(kind: MapKind, map: &FloatImage<Vec4>, srgb: bool) -> Image {
    let encoding = kind.spec().encoding;
    let store = |t: &Vec4| {
        let values = match encoding {
            Encoding::Signed => t.truncate().normalize_or(Vec3::Z).extend(0.0),
            _ => *t,
        };
        let [r, g, b, _] = values.to_array().map(|x| match encoding {
            Encoding::Srgb if srgb => round(encode_srgb(x.clamp(0.0, 1.0))),
            Encoding::Srgb | Encoding::Linear => round(x),
            Encoding::Signed => round(0.5 * x + 0.5),
        });
        let alpha = if kind == MapKind::BaseColor { round(t.w) } else { 255 };
        [r, g, b, alpha]
    };
    let pixels = map.texels.par_iter().map(store).collect();
    Image { name: kind.spec().name.into(), width: map.width, height: map.height, pixels }
}

/// The map that a reader of [`to_image`] finds; normals are not quite of unit length.
pub fn from_image(kind: MapKind, image: &Image, srgb: bool) -> FloatImage<Vec4> {
    let table = decoded(kind, srgb);
    let opacity = |stored: u8| if kind == MapKind::BaseColor { f32::from(stored) / 255.0 } else { 0.0 };
    let read = |p: &[u8; 4]| {
        Vec4::new(table[p[0] as usize], table[p[1] as usize], table[p[2] as usize], opacity(p[3]))
    };
    let texels = image.pixels.par_iter().map(read).collect();
    FloatImage { width: image.width, height: image.height, texels }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects what is written from drifting away from what was fitted.
    #[test]
    fn rounding_is_within_half_a_step() {
        let map = FloatImage::square(2, (0..4).map(|i| Vec4::new(0.1 * i as f32, 0.37, 0.9, 0.0)).collect());
        for (kind, srgb) in [
            (MapKind::BaseColor, false),
            (MapKind::BaseColor, true),
            (MapKind::Emissive, true),
            (MapKind::MetallicRoughness, true),
        ] {
            let back = from_image(kind, &to_image(kind, &map, srgb), srgb);
            for (a, b) in map.texels.iter().zip(&back.texels) {
                assert!((*a - *b).abs().max_element() < 0.005, "{kind:?}: {a} {b}");
            }
        }
        let m = Vec3::new(0.3, -0.2, 0.93).normalize();
        let map = FloatImage::solid(1, m.extend(0.0));
        let back = from_image(MapKind::Normal, &to_image(MapKind::Normal, &map, true), true);
        assert!((back.texels[0].truncate() - m).length() < 0.005);
    }
}
