//! Texture coordinates in two bytes (glTF 2.0, section 3.6.2.2, normalised unsigned shorts): the
//! 65535ths from 0 to 1.

use glam::Vec2;

/// Vertices from which on coordinates are written in two bytes where they are all 65535ths: in
/// smaller meshes that saves nothing worth a reader's trouble.
const MANY: usize = 10_000;

/// Whether coordinates of so many vertices are written in two bytes where they are all 65535ths.
pub fn short_uvs_pay(vertices: usize) -> bool {
    vertices >= MANY
}

/// The nearest coordinate that a file can hold in two bytes, as it is read back: within the unit
/// square at most 1/131070 away, 0.002 texels of 256 in a row.
pub fn short_uv(uv: Vec2) -> Vec2 {
    Vec2::from_array(uv.to_array().map(|x| f32::from(nearest_short(x)) / 65535.0))
}

/// The nearest of 65535ths.
pub fn nearest_short(x: f32) -> u16 {
    // The cast saturates: what lies outside goes to the border.
    (x * 65535.0).round() as u16
}

/// True where two bytes hold a coordinate to the bit.
pub fn is_short(uv: &Vec2) -> bool {
    short_uv(*uv).to_array().map(f32::to_bits) == uv.to_array().map(f32::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects what a proof says of rounded coordinates: all of them come back to the bit, and
    /// others are not taken for such.
    #[test]
    fn every_short_is_held_to_the_bit() {
        for short in 0..=u16::MAX {
            let x = f32::from(short) / 65535.0;
            assert_eq!(nearest_short(x), short);
            assert!(is_short(&Vec2::splat(x)));
        }
        for x in [-0.25, 1.5, 0.3, -0.0, f32::NAN] {
            assert!(!is_short(&Vec2::new(x, 0.0)));
        }
        assert!((short_uv(Vec2::splat(0.3)) - Vec2::splat(0.3)).abs().max_element() < 1.0 / 131_070.0);
    }
}
