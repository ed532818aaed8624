//! What the size of a level on screen asks of it: triangles, texels, and the mip level at which it is last seen.
//!
//! Sizes are the pixels that the model's longest side spans. In the common frame that side is 2 long.
//!
//! Contract: pure functions of sizes; nothing is rendered.

use parbake_model::{Mesh, Model};

/// Share of a texture that charts fill, about.
const FILLED: f64 = 0.75;
/// The smallest texture, unless the largest one may not be so large.
const LEAST_TEXELS: usize = 32;
/// Triangles for each pixel of a square as wide as a level, at the default error: machines of many small parts would have
/// several under each pixel.
const TRIANGLES_A_PIXEL: f64 = 1.0;

/// The distance in the common frame that `pixels` are at this size.
pub fn distance_of_pixels(pixels: f64, screen_size: f64) -> f64 {
    2.0 * pixels / screen_size
}

/// Triangles that a level may have at most, where its surface may be `finer` times closer to the original than as a rule.
pub fn most_triangles(screen_size: f64, finer: f64) -> usize {
    (TRIANGLES_A_PIXEL * screen_size * screen_size * finer) as usize
}

/// Texels along a side of a square texture with about a texel for each pixel that the surface covers. `scale` takes the
/// mesh's unit to that of the common frame.
pub fn texels_along(mesh: &Mesh, scale: f64, screen_size: f64) -> f64 {
    let pixels_per_unit = 0.5 * screen_size * scale;
    (mesh.area() * pixels_per_unit.powi(2) / FILLED).sqrt().max(1.0)
}

/// The power of two that is nearest to so many texels, `most` at most.
pub fn texture_size(texels_along: f64, most: usize) -> usize {
    (2f64.powf(texels_along.log2().round()) as usize).clamp(LEAST_TEXELS.min(most), most)
}

/// The mip level with a texel for each pixel at the size where a level is no longer meant to be seen: that which the
/// next one is made for, or half of the last one's own. `share` is how many times as many texels along a side the
/// texture has as the level's own size needs.
pub fn smallest_mip(sizes: &[f64], level: usize, share: f64) -> f64 {
    let smaller = sizes.get(level + 1).copied().unwrap_or(0.5 * sizes[level]);
    (share * sizes[level] / smaller).log2().max(0.0)
}

/// Texels along the longest side of a model's textures; 0 where it has none.
pub fn largest_texture(model: &Model) -> usize {
    model.images.iter().map(|image| image.width.max(image.height)).max().unwrap_or(0)
}

/// Texels of all textures of a model.
pub fn texels_of(model: &Model) -> usize {
    model.images.iter().map(|image| image.width * image.height).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::Vec3;

    /// Protects small files and sharp levels: a square that fills the picture has a texel for each of its pixels, with room
    /// for gutters.
    #[test]
    fn texels_follow_pixels() {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let positions = vec![corner(0.0, 0.0), corner(10.0, 0.0), corner(10.0, 10.0), corner(0.0, 10.0)];
        let square = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
        // Ten units are the two of the common frame.
        let along = texels_along(&square, 0.2, 300.0);
        assert!((along * along * FILLED - 90_000.0).abs() < 0.1, "{along}");
        assert_eq!(
            [(along, 4096), (along, 256), (3.0, 4096), (3.0, 16)].map(|(a, m)| texture_size(a, m)),
            [256, 256, 32, 16]
        );
    }

    /// Protects gutters: charts are apart down to the mip level that a level shows when the next one takes over.
    #[test]
    fn the_smallest_mip_is_that_of_the_next_level() {
        let sizes = [300.0, 75.0];
        assert_eq!([smallest_mip(&sizes, 0, 1.0), smallest_mip(&sizes, 0, 2.0)], [2.0, 3.0]);
        assert_eq!([smallest_mip(&sizes, 1, 1.0), smallest_mip(&sizes, 1, 0.1)], [1.0, 0.0]);
        assert_eq!((most_triangles(50.0, 1.0), most_triangles(50.0, 0.5)), (2500, 1250));
        assert_eq!(distance_of_pixels(0.5, 100.0), 0.01);
    }
}
