//! A training view's pixels before their coordinates shift: what fits of maps and checks of them
//! read again and again, so that no view has to be walked for them twice.
//!
//! Contract: directions and light are rounded to 32767ths, which moves a shift by up to some ten
//! thousandths of its length, where sight is grazing; pixels are in the walk's order (`view_sampler.rs`).

use crate::packing::{packed, unpacked};
use crate::reference::Reference;
use crate::view_sampler::ViewSampler;
use parbake_model::glam::{Vec2, Vec3};
use parbake_render::directions::ViewDirection;
use parbake_render::frame::TangentLight;
use rayon::prelude::*;

/// One pixel, as in `Sample` but for where it is fetched: 44 bytes.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct ViewSample {
    /// Where it falls on the texture.
    pub uv: Vec2,
    /// Direction to the viewer and cosine, in 32767ths.
    pub(crate) view_direction: [i16; 4],
    /// As [`packed`] leaves it.
    pub(crate) light: [i16; 9],
    /// Wanted display value of red, green and blue, in 65535ths of 1.
    pub target: [u16; 3],
    /// How much this pixel counts, in 65535ths.
    pub weight: u16,
}

const STEP: f32 = 1.0 / 32767.0;

impl ViewSample {
    /// A pixel at this place of the texture that asks for nothing, for hand-made scenes.
    pub fn at(uv: Vec2) -> Self {
        Self { uv, view_direction: [0; 4], light: [0; 9], target: [0; 3], weight: 0 }
    }

    /// From where it is seen.
    #[inline]
    pub fn view_direction(&self) -> ViewDirection {
        let [x, y, z, cosine] = self.view_direction.map(|v| f32::from(v) * STEP);
        ViewDirection { direction: Vec3::new(x, y, z), cosine }
    }

    /// How the light meets it.
    #[inline]
    pub fn light(&self) -> TangentLight {
        unpacked(self.light)
    }
}

/// The pixels of each of these views.
pub fn sample_views(sampler: &ViewSampler, references: &[Reference]) -> Vec<Vec<ViewSample>> {
    let rounded = |x: f32| (x.clamp(-1.0, 1.0) * 32767.0).round_ties_even() as i16;
    (references.par_iter())
        .map(|reference| {
            let mut out = Vec::with_capacity(reference.pixels.len() / 3);
            sampler.fragments(reference, |seen| {
                let [x, y, z] = seen.view_direction.direction.to_array();
                out.push(ViewSample {
                    uv: seen.uv,
                    view_direction: [x, y, z, seen.view_direction.cosine].map(rounded),
                    light: packed(&seen.light),
                    target: seen.target,
                    weight: seen.weight,
                });
            });
            out.shrink_to_fit();
            out
        })
        .collect()
}
