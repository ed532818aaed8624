//! What maps cost once they are kept: their bytes, what rounding to these leaves of them, and
//! what a pixel has to fetch.

use parbake_render::parallax::ParallaxCoefficients;
use parbake_render::parallax_variants::height::HeightParallax;
use parbake_render::parallax_variants::march::LAYERS;
use parbake_render::parallax_variants::neural::NeuralParallax;
use parbake_render::parallax_variants::shift_map::{ShiftMap, Unshifted};

/// The cost of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// As kept, without a file's head or compression.
    pub bytes: usize,
    /// See `VariantFigures`.
    pub places: usize,
    /// See `VariantFigures`.
    pub fetches: usize,
}

/// A map that can be kept.
pub trait Stored: ShiftMap {
    /// The map as it comes back, and its cost.
    fn stored(self) -> (Self, Cost);

    /// Whether it is made of heights, which can be measured.
    fn is_height(&self) -> bool {
        false
    }
}

impl Stored for Unshifted {
    fn stored(self) -> (Self, Cost) {
        (self, Cost::default())
    }
}

impl Stored for ParallaxCoefficients {
    fn stored(self) -> (Self, Cost) {
        let mut images = Vec::new();
        let packed = self.pack(&mut images);
        let bytes = images.iter().map(|image| 3 * image.pixels.len()).sum();
        let back = ParallaxCoefficients::unpack(&packed, &images).unwrap_or(self);
        (back, Cost { bytes, places: 1, fetches: images.len() })
    }
}

impl Stored for HeightParallax {
    fn is_height(&self) -> bool {
        true
    }

    /// One byte a texel, from the least height to the greatest.
    fn stored(mut self) -> (Self, Cost) {
        let (least, most) = (self.heights.level.texels.iter())
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), t| (a.min(t[0]), b.max(t[0])));
        let step = (most - least) / 255.0;
        if step > 0.0 {
            for texel in &mut self.heights.level.texels {
                texel[0] = least + ((texel[0] - least) / step).round() * step;
            }
        }
        let places = if self.variant.marches() { LAYERS + 1 } else { 1 };
        let bytes = self.heights.level.texels.len();
        (self, Cost { bytes, places, fetches: places })
    }
}

impl Stored for NeuralParallax {
    /// Floats of 32 bits, which shaders would hold as constants.
    fn stored(self) -> (Self, Cost) {
        (self, Cost { bytes: 4 * Self::NUMBERS, places: 0, fetches: 0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_render::parallax_variants::height::Variant;

    /// Protects the costs that the report states, and that rounding is half a step at most.
    #[test]
    fn costs_are_as_kept() {
        assert_eq!(
            ParallaxCoefficients::zeros(parbake_model::Basis::Harmonics(3), 8).stored().1,
            Cost { bytes: 8 * 8 * 33, places: 1, fetches: 11 }
        );
        let mut map = HeightParallax::flat(Variant::Steep, 2, 1e-2);
        map.heights.level.texels = vec![[0.0], [0.3], [0.5], [1.0]];
        let (back, cost) = map.clone().stored();
        assert_eq!(cost, Cost { bytes: 4, places: 17, fetches: 17 });
        for (a, b) in map.heights.level.texels.iter().zip(&back.heights.level.texels) {
            assert!((a[0] - b[0]).abs() <= 0.5 / 255.0 + 1e-6);
        }
    }
}
