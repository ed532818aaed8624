//! The last step of both textures: eight bits a channel, as files hold them.

use crate::canvas::Canvas;
use parbake_model::Image;
use parbake_model::glam::{Vec3, Vec4};
use parbake_render::display::{decode_srgb, encode_srgb};
use rayon::prelude::*;

fn round(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Albedo to a base colour picture. `srgb`: texels are linear and the file holds
/// sRGB, as glTF says; otherwise they are stored as they are.
pub fn color_image(name: &str, canvas: &Canvas, srgb: bool) -> Image {
    let pixels = canvas
        .texels
        .par_iter()
        .map(|t| {
            let [r, g, b, _] = t.to_array().map(|x| {
                let x = x.clamp(0.0, 1.0);
                round(if srgb { encode_srgb(x) } else { x })
            });
            [r, g, b, 255]
        })
        .collect();
    Image { name: name.into(), width: canvas.size, height: canvas.size, pixels }
}

/// The albedo that a reader of [`color_image`] finds.
pub fn color_canvas(image: &Image, srgb: bool) -> Canvas {
    let table: Vec<f32> =
        (0..=255u32).map(|i| if srgb { decode_srgb(i as f32 / 255.0) } else { i as f32 / 255.0 }).collect();
    let texels = image
        .pixels
        .par_iter()
        .map(|p| Vec4::new(table[p[0] as usize], table[p[1] as usize], table[p[2] as usize], 0.0))
        .collect();
    Canvas { size: image.width, texels }
}

/// Unit normals to a tangent-space normal map, `(m + 1) / 2`.
pub fn normal_image(name: &str, canvas: &Canvas) -> Image {
    let pixels = canvas
        .texels
        .par_iter()
        .map(|t| {
            let m = t.truncate().normalize_or(Vec3::Z);
            let [x, y, z] = m.to_array().map(|x| round(0.5 * x + 0.5));
            [x, y, z, 255]
        })
        .collect();
    Image { name: name.into(), width: canvas.size, height: canvas.size, pixels }
}

/// The normals that a reader of [`normal_image`] finds, not quite of unit length.
pub fn normal_canvas(image: &Image) -> Canvas {
    let texels = image
        .pixels
        .par_iter()
        .map(|p| {
            let [x, y, z] = [p[0], p[1], p[2]].map(|v| f32::from(v) * (2.0 / 255.0) - 1.0);
            Vec4::new(x, y, z, 0.0)
        })
        .collect();
    Canvas { size: image.width, texels }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects what is written from drifting away from what was fitted.
    #[test]
    fn rounding_is_within_half_a_step() {
        let canvas =
            Canvas { size: 2, texels: (0..4).map(|i| Vec4::new(0.1 * i as f32, 0.37, 0.9, 0.0)).collect() };
        for srgb in [false, true] {
            let back = color_canvas(&color_image("", &canvas, srgb), srgb);
            for (a, b) in canvas.texels.iter().zip(&back.texels) {
                assert!((*a - *b).abs().max_element() < 0.005);
            }
        }
        let m = Vec3::new(0.3, -0.2, 0.93).normalize();
        let canvas = Canvas::solid(1, m.extend(0.0));
        let back = normal_canvas(&normal_image("", &canvas));
        assert!((back.texels[0].truncate() - m).length() < 0.005);
    }
}
