//! The texture of a model's own surface, solved for without any view.
//!
//! ```text
//! surface ─ signal, once ─┬─ delivered coordinates ─┐
//!                         ├─ repaired ──────────────┼─ best texture in bytes, what it leaves
//!                         └─ moved: on pieces ──────┘
//! ```
//!
//! Contract: textures are compared by the same samples, whatever the coordinates.

use super::finer::divided;
use super::surface_samples::{FORESHORTENED, FULL_AND_HALF, Size, Source, signal_scales};
use super::{UvStageResult, mapped, runs};
use crate::least_squares_texture::{Solve, least_squares_texture_in_bytes, rough_texture};
use crate::signal::Signal;
use crate::trilinear_error::trilinear_errors;
use glam::Vec4;
use parbake_atlas::Layout;
use parbake_image::FloatImage;
use parbake_model::Mesh;
use std::borrow::Cow;

/// Samples for each texel, of up to 512²; 2048² have to do with one.
const SAMPLES_PER_TEXEL: usize = 8;
/// Samples where they are as wide as views' from straight above: of small textures, and at most.
const FEWEST_AND_MOST: [usize; 2] = [1 << 21, 1 << 22];
/// Share of a rough texture's error that a step of the solver must take off to be followed by another: a
/// hundred steps more would gain 0.01 dB.
const LEAST_GAIN: f64 = 2e-5;

/// What a texture of size² texels is solved for: the surface as it is seen from all around.
pub struct SurfaceSamples {
    /// One for each of [`FORESHORTENED`], by the surface's F triangles.
    signal_scales: Vec<Signal>,
    size: usize,
}

/// A texture solved for on the surface alone.
#[derive(Clone)]
pub struct SurfaceTexture {
    /// Its stored values, 255ths.
    pub texture: FloatImage<Vec4>,
    /// Mean squared errors of the three colour channels at full size and half.
    pub errors: [f64; 2],
    /// Samples it was solved for.
    pub samples: usize,
}

impl SurfaceSamples {
    /// Of a surface in the common frame, which is the source's own. None where it has no area.
    pub fn new(surface: &Mesh, source: &Source, size: usize) -> Option<Self> {
        let [fewest, most] = FEWEST_AND_MOST;
        let most = (SAMPLES_PER_TEXEL * size * size).clamp(fewest, most);
        let signal_scales = signal_scales(surface, &Layout::new(surface).rest, source, &FORESHORTENED, most);
        (!signal_scales[0].samples.is_empty()).then_some(Self { signal_scales, size })
    }

    /// Solves for the texture of what became of the surface's coordinates, mip levels included.
    pub fn least_squares_texture(&self, low: &UvStageResult) -> SurfaceTexture {
        let mut signal_scales = Cow::Borrowed(&self.signal_scales);
        if !low.pieces.is_empty() {
            signal_scales =
                Cow::Owned(self.signal_scales.iter().map(|signal| divided(signal, &low.pieces)).collect());
        }
        let layout = Layout::new(&low.model.mesh);
        let runs = runs(&layout, &signal_scales);
        let mapped = mapped(&layout, &signal_scales, &runs);
        let start = rough_texture(&mapped, self.size);
        let least_gain = LEAST_GAIN * trilinear_errors(&mapped, &start).iter().sum::<f64>();
        let texture = least_squares_texture_in_bytes(&mapped, start, &Solve { least_gain, ..Solve::FINAL });
        let left = trilinear_errors(&mapped, &texture);
        let errors = FULL_AND_HALF.map(|at| {
            let own = |(size, _): &(&Size, &f64)| size.width == at.width;
            let found = FORESHORTENED.iter().zip(&left).find(own);
            found.map_or(0.0, |(size, left)| left / (3.0 * size.share))
        });
        SurfaceTexture { texture, errors, samples: signal_scales.iter().map(|s| s.samples.len()).sum() }
    }
}
