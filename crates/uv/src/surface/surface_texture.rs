//! The texture of a model's own surface, solved for without any view.
//!
//! ```text
//! surface ─ signal, once ─┬─ delivered coordinates ─┐
//!                         ├─ mended ────────────────┼─ best texture in bytes, what it leaves
//!                         └─ moved: on pieces ──────┘
//! ```
//!
//! Contract: textures are compared by the same samples, whatever the coordinates.

use super::finer::divided;
use super::surface_signal::{FORESHORTENED, FULL_AND_HALF, Size, Source, showings};
use super::{Unfolded, mapped, runs};
use crate::best_texture::{Solve, best_texture_in_bytes, rough_texture};
use crate::shown::shown_errors;
use crate::signal::Signal;
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
pub struct SurfaceSignal {
    /// One for each of [`FORESHORTENED`], by the surface's F triangles.
    showings: Vec<Signal>,
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

impl SurfaceSignal {
    /// Of a surface in the common frame, which is the source's own. None where it has no area.
    pub fn new(surface: &Mesh, source: &Source, size: usize) -> Option<Self> {
        let [fewest, most] = FEWEST_AND_MOST;
        let most = (SAMPLES_PER_TEXEL * size * size).clamp(fewest, most);
        let showings = showings(surface, &Layout::new(surface).rest, source, &FORESHORTENED, most);
        (!showings[0].samples.is_empty()).then_some(Self { showings, size })
    }

    /// Solves for the texture of what became of the surface's coordinates, mip levels included.
    pub fn best_texture(&self, low: &Unfolded) -> SurfaceTexture {
        let mut showings = Cow::Borrowed(&self.showings);
        if !low.pieces.is_empty() {
            showings = Cow::Owned(self.showings.iter().map(|signal| divided(signal, &low.pieces)).collect());
        }
        let layout = Layout::new(&low.model.mesh);
        let runs = runs(&layout, &showings);
        let mapped = mapped(&layout, &showings, &runs);
        let start = rough_texture(&mapped, self.size);
        let least_gain = LEAST_GAIN * shown_errors(&mapped, &start).iter().sum::<f64>();
        let texture = best_texture_in_bytes(&mapped, start, &Solve { least_gain, ..Solve::FINAL });
        let left = shown_errors(&mapped, &texture);
        let errors = FULL_AND_HALF.map(|at| {
            let own = |(size, _): &(&Size, &f64)| size.width == at.width;
            let found = FORESHORTENED.iter().zip(&left).find(own);
            found.map_or(0.0, |(size, left)| left / (3.0 * size.share))
        });
        SurfaceTexture { texture, errors, samples: showings.iter().map(|s| s.samples.len()).sum() }
    }
}
