//! A map of heights below the surface, as a single step or a march fetches it.

use parbake_image::FloatImage;
use parbake_image::pyramid::{Taps, taps};
use parbake_model::Wrap;
use parbake_model::glam::Vec2;

/// The map, bilinear between texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    /// Heights below the surface in units of a scale, 0 … 1.
    pub level: FloatImage<[f32; 1]>,
    /// Wrap modes along u and v.
    pub wrap: [Wrap; 2],
}

impl Heights {
    /// Where a fetch at `uv` reads.
    #[inline]
    pub fn taps(&self, uv: Vec2) -> Taps {
        taps(uv, self.level.width, self.level.height, self.wrap)
    }

    /// The height at `uv`.
    #[inline]
    pub fn at(&self, uv: Vec2) -> f32 {
        self.level.fetch(&self.taps(uv))[0]
    }
}
