//! SH parallax maps to and from images of 8 bits a channel, as `docs/parallax_format.md`
//! has them (and the packing in short: `parbake_model::ShParallaxMap`).
//!
//! Forward (pack): with a and b the least and the greatest value of a channel,
//! `stored = round(255 (value − a) / (b − a))`, offset a, scale b − a; a channel of one
//! value has scale 0 and stores 0. Back (unpack): `value = offset + scale · stored / 255`.
//!
//! Contract: the rounding error is at most half a step, scale / 510, up to the precision of
//! floats. Values are finite, and so is their span; where they are not, the map's own check
//! refuses what comes of them.

use crate::parallax::ShParallax;
use crate::spherical_harmonics::{HIGHEST_ORDER, functions};
use crate::texture::Level;
use parbake_model::glam::Vec2;
use parbake_model::{DepthMap, Image, ShParallaxMap};

const _: () = assert!(HIGHEST_ORDER == ShParallaxMap::HIGHEST_ORDER);

/// Least value and span of a channel.
fn range(values: impl Iterator<Item = f32>) -> (f32, f32) {
    let (low, high) =
        values.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    // A channel of one value, or of none.
    if low >= high { (low, 0.0) } else { (low, high - low) }
}

fn stored(value: f32, offset: f32, scale: f32) -> u8 {
    // The cast saturates, and makes NaN 0.
    if scale > 0.0 { (255.0 * ((value - offset) / scale)).round() as u8 } else { 0 }
}

/// What each stored number of a channel stands for.
fn values(offset: f32, scale: f32) -> [f32; 256] {
    std::array::from_fn(|stored| offset + scale * (stored as f32 / 255.0))
}

impl ShParallax {
    /// Rounds to 8 bits: adds the images to these and returns the map that names them
    /// there. It has no textures of its own yet. What a reader of the file sees is
    /// [`ShParallax::unpack`] of the two.
    pub fn pack(&self, images: &mut Vec<Image>) -> ShParallaxMap {
        let (count, channels) = (functions(self.order), ShParallaxMap::channel_count(self.order));
        let ranges: Vec<(f32, f32)> = (0..channels)
            .map(|c| range(self.coefficients.iter().skip(c / 2).step_by(count).map(|&t| t[c % 2])))
            .collect();
        let first = images.len();
        for i in 0..ShParallaxMap::image_count(self.order) {
            let texel = |texel: &[Vec2]| {
                let mut pixel = [0, 0, 0, 255];
                for (c, (offset, scale)) in ranges.iter().enumerate().skip(3 * i).take(3) {
                    pixel[c % 3] = stored(texel[c / 2][c % 2], *offset, *scale);
                }
                pixel
            };
            let pixels = self.coefficients.chunks_exact(count).map(texel).collect();
            images.push(Image {
                name: format!("parallax {i}"),
                width: self.width,
                height: self.height,
                pixels,
            });
        }
        let last = images.len();
        let depth = self.depth.as_ref().map(|map| {
            let (offset, scale) = range(map.texels.iter().map(|t| t[0]));
            let pixels = map.texels.iter().map(|t| [stored(t[0], offset, scale), 0, 0, 255]).collect();
            images.push(Image {
                name: "parallax depth".into(),
                width: map.width,
                height: map.height,
                pixels,
            });
            DepthMap { image: last, scale, offset }
        });
        ShParallaxMap {
            order: self.order,
            images: (first..last).collect(),
            scale: ranges.iter().map(|r| r.1).collect(),
            offset: ranges.iter().map(|r| r.0).collect(),
            limit: self.limit,
            depth,
            wrap: self.wrap,
            ..ShParallaxMap::default()
        }
    }

    /// The coefficients that a map's images hold; `None` where the map breaks its contract.
    pub fn unpack(map: &ShParallaxMap, images: &[Image]) -> Option<Self> {
        map.check(images).ok()?;
        let first = &images[map.images[0]];
        let count = functions(map.order);
        let mut coefficients = vec![Vec2::ZERO; first.pixels.len() * count];
        for (c, (offset, scale)) in map.offset.iter().zip(&map.scale).enumerate() {
            let values = values(*offset, *scale);
            let texels = coefficients.iter_mut().skip(c / 2).step_by(count);
            for (to, pixel) in texels.zip(&images[map.images[c / 3]].pixels) {
                to[c % 2] = values[pixel[c % 3] as usize];
            }
        }
        let depth = map.depth.map(|depth| {
            let (image, values) = (&images[depth.image], values(depth.offset, depth.scale));
            let texels = image.pixels.iter().map(|p| [values[p[0] as usize]]).collect();
            Level { width: image.width, height: image.height, texels }
        });
        let (width, height) = (first.width, first.height);
        let (order, limit, wrap) = (map.order, map.limit, map.wrap);
        Some(Self { order, width, height, coefficients, depth, limit, wrap })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallax::Sight;
    use crate::spherical_harmonics::{MOST_FUNCTIONS, evaluate};
    use parbake_model::Wrap;
    use parbake_model::glam::Vec3;

    fn noise(i: usize) -> f32 {
        ((i * 37 + 11) % 101) as f32 / 50.0 - 1.0
    }

    fn map(order: usize) -> ShParallax {
        let mut map = ShParallax { width: 5, height: 3, ..ShParallax::zeros(order, 0) };
        map.coefficients =
            (0..15 * functions(order)).map(|i| Vec2::new(0.02 * noise(i), 3.0 * noise(3 * i + 1))).collect();
        let texels = (0..8).map(|i| [1.0 + 0.5 * noise(5 * i)]).collect();
        map.depth = Some(Level { width: 2, height: 4, texels });
        map.limit = 0.1;
        map.wrap = [Wrap::Repeat, Wrap::Clamp];
        map
    }

    /// Protects the loss that the format promises, in each channel of every order, and that
    /// images are added behind those that are there.
    #[test]
    fn rounding_is_half_a_step() {
        for order in 0..=HIGHEST_ORDER {
            let from = map(order);
            let mut images = vec![Image::solid("colour", 1, 1, [7; 4])];
            let packed = from.pack(&mut images);
            assert_eq!(packed.images, (1..=ShParallaxMap::image_count(order)).collect::<Vec<_>>());
            assert!(images[1..].iter().all(|i| i.pixels.iter().all(|p| p[3] == 255)));
            let back = ShParallax::unpack(&packed, &images).unwrap();
            assert_eq!((back.width, back.height, back.limit, back.wrap), (5, 3, from.limit, from.wrap));
            for (i, (a, b)) in from.coefficients.iter().zip(&back.coefficients).enumerate() {
                let channel = 2 * (i % functions(order));
                for axis in 0..2 {
                    let (error, step) = ((a[axis] - b[axis]).abs(), packed.scale[channel + axis] / 255.0);
                    assert!(error <= 0.5001 * step, "{order} {i}: {error} {step}");
                }
            }
            let (a, b) = (from.depth.unwrap(), back.depth.unwrap());
            assert!(a.texels.iter().zip(&b.texels).all(|(a, b)| (a[0] - b[0]).abs() < 1.0 / 500.0));
        }
    }

    /// Protects channels of one value, which have no span: they come back exactly, and what
    /// lies behind the last channel is 0.
    #[test]
    fn constant_channels_come_back() {
        let mut from = ShParallax::zeros(0, 2);
        from.coefficients = [1.0, 2.0, 3.0, 4.0].map(|v| Vec2::new(0.3, v)).to_vec();
        let mut images = Vec::new();
        let packed = from.pack(&mut images);
        assert_eq!((&packed.scale[..], &packed.offset[..]), (&[0.0, 3.0][..], &[0.3, 1.0][..]));
        assert_eq!(images[0].pixels, [0, 85, 170, 255].map(|v| [0, v, 0, 255]));
        assert_eq!(ShParallax::unpack(&packed, &images), Some(from));
        assert_eq!(ShParallax::unpack(&packed, &[]), None);
    }

    /// Protects the sizes that the format page promises: 64², order 2.
    #[test]
    fn a_default_map_is_small() {
        let mut images = Vec::new();
        ShParallax::zeros(2, 64).pack(&mut images);
        assert_eq!(images.iter().map(|i| 3 * i.pixels.len()).sum::<usize>(), 73_728);
    }

    /// Protects readers written from the format page: the numbers of its worked example.
    #[test]
    fn the_worked_example_of_the_format_page() {
        let image = |texels: [[u8; 3]; 2]| {
            let pixels = texels.map(|[r, g, b]| [r, g, b, 255]).to_vec();
            Image { width: 2, height: 1, pixels, ..Image::default() }
        };
        let mut images = vec![
            image([[0, 255, 51], [255, 102, 51]]),
            image([[204, 0, 255], [0, 51, 255]]),
            image([[255, 153, 0], [51, 0, 0]]),
        ];
        let mut map = ShParallaxMap {
            order: 1,
            images: vec![0, 1, 2],
            scale: vec![0.2, 0.1, 0.1, 0.4, 0.5, 0.2, 0.1, 0.3],
            offset: vec![-0.1, 0.0, -0.05, -0.2, -0.25, -0.1, 0.0, -0.15],
            ..ShParallaxMap::default()
        };
        let uv = Vec2::new(0.4, 0.5);
        let sights = [
            Sight { direction: Vec3::new(0.48, -0.6, 0.64), cosine: 0.64 },
            Sight { direction: Vec3::new(0.6, 0.8, 0.0), cosine: 0.0 },
        ];
        let close = |have: Vec2, want: Vec2| assert!(have.distance(want) < 2e-6, "{have} {want}");
        let shift = |map: &ShParallaxMap, images: &[Image]| {
            let unpacked = ShParallax::unpack(map, images).unwrap();
            sights.map(|sight| unpacked.shift(uv, &sight))
        };
        let [facing, grazing] = shift(&map, &images);
        close(facing, FACING);
        close(grazing, GRAZING);
        images.push(Image::solid("depth", 1, 1, [51, 0, 0, 255]));
        map.depth = Some(DepthMap { image: 3, scale: 2.0, offset: 0.1 });
        close(shift(&map, &images)[0], FACING * 0.5);
    }

    const FACING: Vec2 = Vec2::new(-0.083531, 0.065215);
    const GRAZING: Vec2 = Vec2::new(-0.002920, 0.101908);

    /// Protects readers that use the page's polynomials for orders up to 3, or check what they
    /// have for the others against its numbers.
    #[test]
    fn the_functions_of_the_format_page() {
        let d = Vec3::new(0.48, -0.6, 0.64);
        let Vec3 { x, y, z } = d;
        let third = [
            0.590_043_6 * y * (3.0 * x * x - y * y),
            2.890_611_4 * x * y * z,
            0.457_045_8 * y * (5.0 * z * z - 1.0),
            0.373_176_3 * z * (5.0 * z * z - 3.0),
            0.457_045_8 * x * (5.0 * z * z - 1.0),
            1.445_305_7 * z * (x * x - y * y),
            0.590_043_6 * x * (x * x - 3.0 * y * y),
        ];
        let mut values = [0.0; MOST_FUNCTIONS];
        evaluate(7, d, &mut values);
        for (have, want) in values[9..16].iter().zip(third) {
            assert!((have - want).abs() < 1e-6, "{have} {want}");
        }
        let others = [
            (17, -0.225_127),
            (20, -0.361_361),
            (32, -0.045_485),
            (36, 0.110_730),
            (52, 0.230_542),
            (63, 0.111_817),
        ];
        for (k, want) in others {
            assert!((values[k] - want).abs() < 1e-6, "{k}: {} {want}", values[k]);
        }
    }
}
