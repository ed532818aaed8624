//! The mip levels of a picture that is written with them: the 2 × 2 box average that Parbake's own renderer
//! makes (`parbake_image::mip`), of colours in linear light, of normals as vectors that are then made unit, of all
//! other channels, alpha included, as they are.
//!
//! What is cut out by its alpha would wear away, since averages of thin things fall below the cutoff. So the alpha
//! of each level is scaled until as large a share of its texels passes as of the picture's own (Castaño,
//! "Computing Alpha Mipmaps", 2010). His bisection finds the scale that brings the texel at that share to the
//! cutoff; here texels are sorted instead, which finds it at once, and half-way between that texel and the next,
//! so that a codec's error moves as few of them as can be over the cutoff.
//!
//! Contract: the picture itself is the first level, unchanged; levels halve down to 1 × 1.

use parbake_image::FloatImage;
use parbake_image::display::{decode_srgb, encode_srgb};
use parbake_model::Image;
use parbake_model::glam::Vec3;
use rayon::prelude::*;

/// What the red, green and blue of a picture stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// Colours in sRGB.
    Color,
    /// Unit vectors, from −1 to 1 stored as 0 to 255.
    Normal,
    /// Numbers that have nothing to do with each other.
    Values,
}

/// All levels of a picture. With a `cutoff`, the share of texels with at least this alpha stays that of the
/// picture.
pub(super) fn levels(image: &Image, content: Content, cutoff: Option<f32>) -> Vec<Image> {
    let cut = cutoff.and_then(|cutoff| Cut::of(image, cutoff));
    let mut level = decoded(image, content);
    let mut levels = vec![image.clone()];
    while level.width > 1 || level.height > 1 {
        level = level.halved();
        levels.push(encoded(&level, content, cut));
    }
    levels
}

fn decoded(image: &Image, content: Content) -> FloatImage<[f32; 4]> {
    let table: [f32; 256] = std::array::from_fn(|stored| {
        let x = stored as f32 / 255.0;
        match content {
            Content::Color => decode_srgb(x),
            Content::Normal => 2.0 * x - 1.0,
            Content::Values => x,
        }
    });
    let decode = |&[r, g, b, a]: &[u8; 4]| {
        let [r, g, b] = [r, g, b].map(|stored| table[usize::from(stored)]);
        [r, g, b, f32::from(a) / 255.0]
    };
    let texels = image.pixels.par_iter().map(decode).collect();
    FloatImage { width: image.width, height: image.height, texels }
}

fn encoded(level: &FloatImage<[f32; 4]>, content: Content, cut: Option<Cut>) -> Image {
    let store = |&[r, g, b, a]: &[f32; 4]| {
        let [r, g, b] = match content {
            Content::Color => [r, g, b].map(encode_srgb),
            Content::Normal => (0.5 * Vec3::new(r, g, b).normalize_or(Vec3::Z) + 0.5).to_array(),
            Content::Values => [r, g, b],
        };
        [r, g, b, a].map(eight_bits)
    };
    let mut pixels: Vec<[u8; 4]> = level.texels.par_iter().map(store).collect();
    if let Some(cut) = cut {
        let alpha: Vec<f32> = level.texels.iter().map(|texel| texel[3]).collect();
        for (pixel, alpha) in pixels.iter_mut().zip(cut.kept(&alpha)) {
            pixel[3] = alpha;
        }
    }
    Image { name: String::new(), width: level.width, height: level.height, pixels }
}

fn eight_bits(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// What passes in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cut {
    /// The least stored alpha that passes.
    least: u8,
    /// The share of texels that do.
    share: f64,
}

impl Cut {
    /// None where all or nothing passes, whatever alpha is.
    fn of(image: &Image, cutoff: f32) -> Option<Self> {
        let least = (cutoff * 255.0).ceil();
        let least = (1.0..=255.0).contains(&least).then_some(least as u8)?;
        let passing = image.pixels.iter().filter(|p| p[3] >= least).count();
        Some(Self { least, share: passing as f64 / image.pixels.len() as f64 })
    }

    /// The stored alpha of a level, so that as near as can be the same share passes.
    fn kept(self, alpha: &[f32]) -> Vec<u8> {
        let mut sorted = alpha.to_vec();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let count = sorted.len();
        // Those that are alike pass together or not at all. What has no alpha cannot be scaled to any.
        let divides = |k: usize| match (k.checked_sub(1).map(|i| sorted[i]), sorted.get(k)) {
            (Some(last), _) if last <= 0.0 => false,
            (Some(last), Some(&next)) => last > next,
            _ => true,
        };
        let wanted = self.share * count as f64;
        let distance = |&k: &usize| (k as f64 - wanted).abs();
        let passing = (0..=count).filter(|&k| divides(k)).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let passing = passing.unwrap_or(0);
        let (least, now) = (f32::from(self.least) / 255.0, f32::from(self.least) - 0.5);
        let as_it_is = sorted.iter().filter(|&&a| 255.0 * a >= now).count() == passing;
        let scale = match (passing.checked_sub(1).map(|i| sorted[i]), sorted.get(passing)) {
            _ if as_it_is => 1.0,
            (Some(last), Some(next)) => (now / 255.0) / (0.5 * (last + next)),
            (Some(last), None) => least / last,
            (None, _) => (least - 1.0 / 255.0) / sorted[0],
        };
        // Rounding takes no texel to the other side.
        let threshold = passing.checked_sub(1).map_or(f32::INFINITY, |i| sorted[i]);
        let store = |&alpha: &f32| {
            let stored = eight_bits(alpha * scale);
            if alpha >= threshold { stored.max(self.least) } else { stored.min(self.least - 1) }
        };
        alpha.iter().map(store).collect()
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    fn coverage(image: &Image, least: u8) -> f64 {
        image.pixels.iter().filter(|p| p[3] >= least).count() as f64 / image.pixels.len() as f64
    }

    /// Thin blades that lean, with soft edges: what loses most in mip levels.
    pub fn foliage(size: usize) -> Image {
        let texel = |i: usize| {
            let (x, y) = ((i % size) as f32, (i / size) as f32);
            let blade = (0.9 * x + 0.23 * y + 3.0 * (0.05 * y).sin()).sin() * (0.31 * y - 0.11 * x).cos();
            let shade = |base: f32| (base + 40.0 * blade) as u8;
            [shade(90.0), shade(120.0), shade(60.0), (255.0 * (2.0 * blade - 0.6).clamp(0.0, 1.0)) as u8]
        };
        Image {
            name: "leaf".into(),
            width: size,
            height: size,
            pixels: (0..size * size).map(texel).collect(),
        }
    }

    /// Protects foliage from wearing away with distance: a quarter of it would be gone at the first level.
    #[test]
    fn coverage_is_kept_at_every_level() {
        let image = foliage(128);
        for cutoff in [0.2f32, 0.5, 0.8] {
            let least = (cutoff * 255.0).ceil() as u8;
            let base = coverage(&image, least);
            let plain = levels(&image, Content::Color, None);
            let kept = levels(&image, Content::Color, Some(cutoff));
            assert_eq!((kept.len(), &kept[0]), (8, &image));
            for (level, plain) in kept.iter().zip(&plain) {
                let texel = 1.0 / level.pixels.len() as f64;
                // Texels of equal alpha pass together.
                assert!(
                    (coverage(level, least) - base).abs() <= 0.5 * texel + 0.001,
                    "{cutoff} {}",
                    level.width
                );
                assert!(level.pixels.iter().zip(&plain.pixels).all(|(a, b)| a[..3] == b[..3]));
            }
            let lost =
                plain[1..5].iter().map(|level| (coverage(level, least) - base).abs()).fold(0.0, f64::max);
            assert!(lost > 0.08, "the test is easy: {cutoff} loses {lost}");
        }
    }

    /// Protects alpha from a scale where it says nothing: nothing, or all, passes.
    #[test]
    fn what_cannot_be_kept_is_left() {
        let image = Image::solid("a", 8, 8, [9, 9, 9, 100]);
        for cutoff in [-1.0, 0.0, 0.2, 1.5] {
            let levels = levels(&image, Content::Color, Some(cutoff));
            assert!(levels.iter().all(|level| level.pixels.iter().all(|p| p[3] == 100)), "{cutoff}");
        }
        // Nothing passes, and nothing does at any level.
        assert!(levels(&image, Content::Color, Some(0.5)).iter().all(|level| coverage(level, 128) == 0.0));
    }

    /// Protects light and normals: black and white average to half the light, stored as 188; two slopes to a unit
    /// vector between them.
    #[test]
    fn levels_are_averages_of_what_is_stored() {
        let mut image = Image::solid("a", 2, 1, [0, 0, 255, 255]);
        image.pixels[1] = [255, 0, 255, 55];
        let at = |content| levels(&image, content, None)[1].pixels[0];
        assert_eq!(at(Content::Color), [188, 0, 255, 155]);
        assert_eq!(at(Content::Values), [128, 0, 255, 155]);
        let [x, y, z, _] = at(Content::Normal).map(|c| f32::from(c) / 127.5 - 1.0);
        assert!(
            (Vec3::new(x, y, z).length() - 1.0).abs() < 0.01 && x.abs() < 0.01 && y < -0.7,
            "{x} {y} {z}"
        );
        let sides = |w, h| levels(&Image::solid("a", w, h, [1; 4]), Content::Values, None).len();
        assert_eq!([sides(1, 1), sides(12, 4), sides(4, 64)], [1, 4, 7]);
    }
}
