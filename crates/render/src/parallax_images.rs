//! Parallax maps to and from images of 8 bits a channel, as the format pages
//! have them (and the packing in short: `parbake_model::ParallaxMap`).
//!
//! Each function has two channels, u and v, stored as `channels.rs` does; the depth is the red
//! channel of an image of its own, which spans its least to its greatest value, too.
//!
//! Contract: as of `channels.rs`.

use crate::channels::{Span, listed, pack, spans, unpack};
use crate::parallax::ParallaxCoefficients;
use crate::spherical_harmonics::HIGHEST_ORDER;
use parbake_image::FloatImage;
use parbake_model::glam::Vec2;
use parbake_model::{Basis, DepthMap, Image, ParallaxMap};

const _: () = assert!(HIGHEST_ORDER == Basis::HIGHEST_ORDER);

impl ParallaxCoefficients {
    /// Rounds to 8 bits: adds the images to these and returns the map that names them
    /// there. It has no textures of its own yet, and no cutout. What a reader of the file sees
    /// is [`ParallaxCoefficients::unpack`] of the two.
    pub fn pack(&self, images: &mut Vec<Image>) -> ParallaxMap {
        let (count, channels) = (self.basis.count(), ParallaxMap::channel_count(self.basis));
        let channel = |c: usize| self.coefficients.iter().skip(c / 2).step_by(count).map(move |t| t[c % 2]);
        let packed: Vec<Span> = (0..channels).map(|c| Span::of(channel(c))).collect();
        let value = |texel: usize, c: usize| self.coefficients[texel * count + c / 2][c % 2];
        let name = |i| if self.basis.is_tangent() { "parallax".into() } else { format!("parallax {i}") };
        let places = pack(self.basis, &packed, [self.width, self.height], name, images, value);
        let [scale, offset] = listed(&packed);
        let depth = self.depth.as_ref().map(|map| {
            let span = Span::of(map.texels.iter().map(|t| t[0]));
            let (size, name) = ([map.width, map.height], |_| "parallax depth".into());
            let image =
                pack(Basis::Harmonics(0), &[span], size, name, images, |texel, _| map.texels[texel][0])[0];
            DepthMap { image, scale: span.scale, offset: span.offset }
        });
        let (basis, limit, wrap) = (self.basis, self.limit, self.wrap);
        ParallaxMap { basis, images: places, scale, offset, limit, depth, wrap, ..ParallaxMap::default() }
    }

    /// The map as a reader of the file sees it, rounded to 8 bits. Numbers that no file holds stay.
    pub fn as_stored(&self) -> Self {
        let mut images = Vec::new();
        let packed = self.pack(&mut images);
        Self::unpack(&packed, &images).unwrap_or_else(|| self.clone())
    }

    /// The coefficients that a map's images hold; `None` where the map breaks its contract.
    pub fn unpack(map: &ParallaxMap, images: &[Image]) -> Option<Self> {
        map.check(images).ok()?;
        let first = &images[map.images[0]];
        let (basis, count) = (map.basis, map.basis.count());
        let height = first.height / basis.layers(ParallaxMap::channel_count(basis));
        let mut coefficients = vec![Vec2::ZERO; first.width * height * count];
        let image = |i: usize| &images[map.images[i]];
        unpack(basis, first.width * height, spans(&map.scale, &map.offset), image, |texel, c, value| {
            coefficients[texel * count + c / 2][c % 2] = value;
        });
        let depth = map.depth.map(|DepthMap { image, scale, offset }| {
            let (image, values) = (&images[image], Span { offset, scale }.values());
            let texels = image.pixels.iter().map(|p| [values[p[0] as usize]]).collect();
            FloatImage { width: image.width, height: image.height, texels }
        });
        let (width, limit, wrap) = (first.width, map.limit, map.wrap);
        Some(Self { basis, width, height, coefficients, depth, limit, wrap })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cutout::CutoutCoefficients;
    use crate::directions::ViewDirection;
    use crate::spherical_harmonics::{MOST_FUNCTIONS, evaluate, functions};
    use parbake_model::glam::Vec3;
    use parbake_model::{CutoutMap, Wrap};

    fn noise(i: usize) -> f32 {
        ((i * 37 + 11) % 101) as f32 / 50.0 - 1.0
    }

    fn map(order: usize) -> ParallaxCoefficients {
        let mut map = ParallaxCoefficients {
            width: 5,
            height: 3,
            ..ParallaxCoefficients::zeros(Basis::Harmonics(order), 0)
        };
        map.coefficients =
            (0..15 * functions(order)).map(|i| Vec2::new(0.02 * noise(i), 3.0 * noise(3 * i + 1))).collect();
        let texels = (0..8).map(|i| [1.0 + 0.5 * noise(5 * i)]).collect();
        map.depth = Some(FloatImage { width: 2, height: 4, texels });
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
            assert_eq!(packed.images, (1..=(2 * functions(order)).div_ceil(3)).collect::<Vec<_>>());
            assert!(images[1..].iter().all(|i| i.pixels.iter().all(|p| p[3] == 255)));
            let back = ParallaxCoefficients::unpack(&packed, &images).unwrap();
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
        let mut from = ParallaxCoefficients::zeros(Basis::Harmonics(0), 2);
        from.coefficients = [1.0, 2.0, 3.0, 4.0].map(|v| Vec2::new(0.3, v)).to_vec();
        let mut images = Vec::new();
        let packed = from.pack(&mut images);
        assert_eq!((&packed.scale[..], &packed.offset[..]), (&[0.0, 3.0][..], &[0.3, 1.0][..]));
        assert_eq!(images[0].pixels, [0, 85, 170, 255].map(|v| [0, v, 0, 255]));
        assert_eq!(ParallaxCoefficients::unpack(&packed, &images), Some(from));
        assert_eq!(ParallaxCoefficients::unpack(&packed, &[]), None);
    }

    /// Protects the sizes that the format page promises: 64², order 2.
    #[test]
    fn a_default_map_is_small() {
        let mut images = Vec::new();
        ParallaxCoefficients::zeros(Basis::Harmonics(2), 64).pack(&mut images);
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
        let mut map = ParallaxMap {
            basis: Basis::Harmonics(1),
            images: vec![0, 1, 2],
            scale: vec![0.2, 0.1, 0.1, 0.4, 0.5, 0.2, 0.1, 0.3],
            offset: vec![-0.1, 0.0, -0.05, -0.2, -0.25, -0.1, 0.0, -0.15],
            ..ParallaxMap::default()
        };
        let uv = Vec2::new(0.4, 0.5);
        let view_directions = [
            ViewDirection { direction: Vec3::new(0.48, -0.6, 0.64), cosine: 0.64 },
            ViewDirection { direction: Vec3::new(0.6, 0.8, 0.0), cosine: 0.0 },
        ];
        let close = |have: Vec2, want: Vec2| assert!(have.distance(want) < 2e-6, "{have} {want}");
        let shift = |map: &ParallaxMap, images: &[Image]| {
            let unpacked = ParallaxCoefficients::unpack(map, images).unwrap();
            view_directions.map(|view_direction| unpacked.shift(uv, &view_direction))
        };
        let [facing, grazing] = shift(&map, &images);
        close(facing, FACING);
        close(grazing, GRAZING);
        images.push(Image::solid("depth", 1, 1, [51, 0, 0, 255]));
        map.depth = Some(DepthMap { image: 3, scale: 2.0, offset: 0.1 });
        close(shift(&map, &images)[0], FACING * 0.5);
        let image = |texels: [[u8; 3]; 2]| Image { width: 1, height: 2, ..image(texels) };
        images.extend([image([[102, 204, 153], [51, 0, 204]]), image([[51, 0, 0], [102, 0, 0]])]);
        let (scale, offset) = (vec![5.0, 2.0, 4.0, 3.0], vec![-1.0, -1.0, -2.0, -1.5]);
        map.cutout = Some(CutoutMap { basis: Basis::Harmonics(1), images: vec![4, 5], scale, offset });
        assert_eq!(map.check(&images), Ok(()));
        let cutout = CutoutCoefficients::unpack(map.cutout.as_ref().unwrap(), map.wrap, &images).unwrap();
        for (view_direction, opacity) in view_directions.into_iter().zip([0.309_127, -0.113_026]) {
            assert!((cutout.opacity(uv, view_direction.direction) - opacity).abs() < 2e-6);
        }
    }

    /// Protects readers written from the page of the tangent frame: the numbers of its worked example.
    #[test]
    fn the_worked_example_of_the_tangent_frame() {
        let image = |rows: &[[[u8; 4]; 2]]| {
            let pixels = rows.concat();
            Image { width: 2, height: rows.len(), pixels, ..Image::default() }
        };
        let images = [
            image(&[[[0, 255, 51, 204], [255, 102, 51, 0]], [[153, 0, 255, 51], [0, 51, 204, 255]]]),
            image(&[
                [[102, 204, 153, 51], [204, 0, 255, 102]],
                [[51, 255, 0, 153], [153, 51, 102, 0]],
                [[0, 102, 204, 255], [255, 153, 51, 0]],
            ]),
        ];
        let map = ParallaxMap {
            basis: Basis::TangentShift,
            images: vec![0],
            scale: vec![0.2, 0.1, 0.1, 0.4, 0.5, 0.2, 0.1, 0.3],
            offset: vec![-0.1, 0.0, -0.05, -0.2, -0.25, -0.1, 0.0, -0.15],
            cutout: Some(CutoutMap {
                basis: Basis::TangentCutout,
                images: vec![1],
                scale: vec![5.0, 2.0, 4.0, 3.0, 1.0, 1.0, 2.0, 2.0, 1.0, 1.0, 0.5, 0.5],
                offset: vec![-1.0, -1.0, -2.0, -1.5, -0.5, -0.5, -1.0, -1.0, -0.5, -0.5, -0.25, -0.25],
            }),
            ..ParallaxMap::default()
        };
        assert_eq!(map.check(&images), Ok(()));
        let shift = ParallaxCoefficients::unpack(&map, &images).unwrap();
        let cutout = map.cutout.as_ref().unwrap();
        let cutout = CutoutCoefficients::unpack(cutout, map.wrap, &images).unwrap();
        let uv = Vec2::new(0.4, 0.5);
        let lines = [Vec3::new(0.48, -0.6, 0.64), Vec3::new(0.6, 0.8, 0.0)];
        let want = [(Vec2::new(-0.077_475, 0.007_560), 0.677_141), (Vec2::new(-0.192, 0.2736), 6.985_007)];
        for (line, (shifted, opacity)) in lines.into_iter().zip(want) {
            let have = shift.shift(uv, &ViewDirection { direction: line, cosine: line.z });
            assert!(have.distance(shifted) < 2e-6, "{have} {shifted}");
            assert!((cutout.opacity(uv, line) - opacity).abs() < 1e-5, "{}", cutout.opacity(uv, line));
        }
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
