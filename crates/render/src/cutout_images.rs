//! Cutouts to and from images of 8 bits a channel, as the format pages have them
//! (and the packing in short: `parbake_model::CutoutMap`): one channel for each function,
//! stored as `channels.rs` does.
//!
//! A cutout's sign is all that is seen of it, and most of it is opaque from everywhere. What
//! such texels hold ([`CutoutCoefficients::opaque`]) is kept by the rounding, so that no texel of a
//! surface that shall be whole gets a hole, however far others are from it.
//!
//! Contract: as of `channels.rs`; a channel with a value to be kept in it has steps that are
//! coarser by at most 1 part in 100.

use crate::channels::{Span, listed, pack, spans, unpack};
use crate::cutout::CutoutCoefficients;
use parbake_model::{CutoutMap, Image, Wrap};

impl CutoutCoefficients {
    /// Rounds to 8 bits: adds the images to these and returns the map that names them
    /// there. What a reader of the file sees is [`CutoutCoefficients::unpack`] of the two.
    pub fn pack(&self, images: &mut Vec<Image>) -> CutoutMap {
        let count = self.basis.count();
        let channel = |c: usize| self.coefficients.iter().skip(c).step_by(count).copied();
        let whole = Self::opaque(self.basis, 1).coefficients;
        let packed: Vec<Span> = (whole.iter().enumerate())
            .map(|(c, &kept)| {
                let span = Span::of(channel(c));
                if channel(c).any(|v| v == kept) { span.keeping(kept) } else { span }
            })
            .collect();
        let value = |texel: usize, c: usize| self.coefficients[texel * count + c];
        let name = |i| if self.basis.is_tangent() { "cutout".into() } else { format!("cutout {i}") };
        let images = pack(self.basis, &packed, [self.width, self.height], name, images, value);
        let [scale, offset] = listed(&packed);
        CutoutMap { basis: self.basis, images, scale, offset }
    }

    /// The cutout as a reader of the file sees it, rounded to 8 bits. Numbers that no file holds stay.
    pub fn as_stored(&self) -> Self {
        let mut images = Vec::new();
        let packed = self.pack(&mut images);
        Self::unpack(&packed, self.wrap, &images).unwrap_or_else(|| self.clone())
    }

    /// The coefficients that a map's images hold; `None` where the map breaks its contract.
    /// `wrap` is that of the parallax map which the cutout is part of.
    pub fn unpack(map: &CutoutMap, wrap: [Wrap; 2], images: &[Image]) -> Option<Self> {
        map.check(images).ok()?;
        let first = &images[map.images[0]];
        let (basis, count) = (map.basis, map.basis.count());
        let (width, height) = (first.width, first.height / basis.layers(count));
        let mut coefficients = vec![0.0; width * height * count];
        let image = |i: usize| &images[map.images[i]];
        unpack(basis, width * height, spans(&map.scale, &map.offset), image, |texel, c, value| {
            coefficients[texel * count + c] = value;
        });
        Some(Self { basis, width, height, coefficients, wrap })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spherical_harmonics::functions;
    use parbake_model::Basis;
    use parbake_model::glam::{Vec2, Vec3};

    fn noise(i: usize) -> f32 {
        ((i * 37 + 11) % 101) as f32 / 50.0 - 1.0
    }

    /// 5 × 3 texels, every second one opaque, the others anything up to `strength`.
    fn map(order: usize, strength: f32) -> CutoutCoefficients {
        let mut map = CutoutCoefficients {
            width: 5,
            height: 3,
            ..CutoutCoefficients::opaque(Basis::Harmonics(order), 0)
        };
        let count = functions(order);
        map.coefficients = (0..15)
            .flat_map(|texel| match texel % 2 {
                0 => CutoutCoefficients::opaque(Basis::Harmonics(order), 1).coefficients,
                _ => (0..count).map(|k| strength * noise(texel * count + k)).collect(),
            })
            .collect();
        map
    }

    /// Protects the loss that the format page promises, in each channel of every order, and
    /// that images are added behind those that are there.
    #[test]
    fn rounding_is_half_a_step() {
        for order in 0..=7 {
            let from = map(order, 6.0);
            let mut images = vec![Image::solid("colour", 1, 1, [7; 4])];
            let packed = from.pack(&mut images);
            assert_eq!(packed.images, (1..=functions(order).div_ceil(3)).collect::<Vec<_>>());
            assert!(images[1..].iter().all(|i| i.pixels.iter().all(|p| p[3] == 255)));
            let wrap = [Wrap::Mirror, Wrap::Repeat];
            let back = CutoutCoefficients::unpack(&packed, wrap, &images).unwrap();
            assert_eq!((back.basis, back.width, back.height, back.wrap), (from.basis, 5, 3, wrap));
            for (i, (a, b)) in from.coefficients.iter().zip(&back.coefficients).enumerate() {
                let step = packed.scale[i % functions(order)] / 255.0;
                assert!((a - b).abs() <= 0.501 * step, "{order} {i}: {a} {b} {step}");
            }
        }
    }

    /// Protects whole surfaces from holes: texels that are opaque from everywhere stay so,
    /// although 8 bits for what lies beside them are far coarser than their opacity.
    #[test]
    fn opaque_texels_stay_opaque() {
        for order in 0..=7 {
            for strength in [0.1, 6.0, 1e4] {
                let mut images = Vec::new();
                let packed = map(order, strength).pack(&mut images);
                let back = CutoutCoefficients::unpack(&packed, [Wrap::Clamp; 2], &images).unwrap();
                for texel in (0..15).step_by(2) {
                    let center = Vec2::new((texel % 5) as f32 + 0.5, (texel / 5) as f32 + 0.5);
                    for d in [Vec3::X, Vec3::NEG_Z, Vec3::new(0.48, -0.6, 0.64)] {
                        let opacity = back.opacity(center / Vec2::new(5.0, 3.0), d);
                        assert!((opacity - 1.0).abs() < 1e-2, "{order} {strength} {texel}: {opacity}");
                    }
                }
            }
        }
    }

    /// Protects a surface without a hole, which has no spans, and readers of broken maps.
    #[test]
    fn whole_maps_and_broken_ones() {
        let from = CutoutCoefficients::opaque(Basis::Harmonics(2), 4);
        let mut images = Vec::new();
        let packed = from.pack(&mut images);
        assert_eq!((images.len(), &packed.scale), (3, &vec![0.0; 9]));
        assert_eq!(CutoutCoefficients::unpack(&packed, from.wrap, &images), Some(from.clone()));
        assert_eq!(CutoutCoefficients::unpack(&packed, from.wrap, &images[..2]), None);
        assert_eq!(
            CutoutCoefficients::unpack(
                &CutoutMap { basis: Basis::Harmonics(9), ..packed },
                from.wrap,
                &images
            ),
            None
        );
    }
}
