//! What the samples of all views ask of the maps.
//!
//! [`Problem`] is what a step has to know: the samples, and what each of them says of one map. Two
//! implementations: [`ShadedProblem`] compares a sample's light with what the high-poly shows in its
//! place; `material_problem.rs` compares the maps' values with those of the high-poly itself.
//!
//! A shaded sample shows `e = curve(gain · light)` with the light of a [`Brdf`] at the bilinear blend of four
//! texels of each map. Clipping at 1: a texel that is too bright is pulled down although the clipped
//! picture no longer moves with it; where both saturate nothing is asked.

use crate::robust_loss::{Cauchy, Loss};
use parbake_image::display_table::DisplayTable;
use parbake_image::{MapKind, MapSet, MapValues};
use parbake_model::glam::Vec4;
use parbake_render::shade::{Brdf, Jacobian};
use parbake_solve::grid::{block, weights};
use parbake_views::chart_labels::Atlas;
use parbake_views::samples::{Fetched, Sample, SampleSet};
use rayon::prelude::*;

/// What the samples ask of the maps.
pub trait Problem: Sync {
    /// What a pixel of a view says.
    type Sample: Fetched + Sync;

    /// All samples.
    fn samples(&self) -> &SampleSet<Self::Sample>;

    /// Chart labels of the texture.
    fn atlas(&self) -> &Atlas;

    /// Whether a kind of map has a say.
    fn reads(&self, kind: MapKind) -> bool;

    /// Whether the channels of this map depend on each other, as a normal's do in the light they make.
    /// Where they do not, a step's matrix is a third smaller.
    fn is_coupled(&self, _kind: MapKind) -> bool {
        true
    }

    /// Half of a step's linear model: how what is compared changes with one map, what it is and what
    /// was wanted, how much each channel counts, and the sample's part of the loss.
    fn linearise(
        &self,
        kind: MapKind,
        sample: &Self::Sample,
        values: &MapValues,
    ) -> (Jacobian, Response, Vec4, Loss);

    /// A sample's part of the loss.
    fn loss_at(&self, sample: &Self::Sample, values: &MapValues) -> Loss;

    /// The loss of all samples.
    fn loss(&self, maps: &MapSet) -> Loss {
        let samples = self.samples();
        let of_band = |band: usize| -> Loss {
            let samples_of_band = samples.band(band).iter();
            samples_of_band
                .map(|s| {
                    let (texels, w) = footprint(s, samples.size);
                    self.loss_at(s, &maps.blend(texels, w))
                })
                .sum()
        };
        let bands: Vec<Loss> = (0..samples.bands()).into_par_iter().map(of_band).collect();
        bands.into_iter().sum()
    }
}

/// What views show: light by a BRDF, as a display shows it.
pub struct ShadedProblem<'a, B> {
    /// The samples of the training views.
    pub samples: &'a SampleSet,
    /// Chart labels.
    pub atlas: &'a Atlas,
    /// Gain and curve of the comparison.
    pub display: &'a DisplayTable,
    /// How maps become light.
    pub brdf: &'a B,
    /// The robust loss.
    pub robust: Cauchy,
}

impl<B: Brdf> ShadedProblem<'_, B> {
    /// Compares the light at a sample with what it wants: the answer, how much each channel of it
    /// counts in a step of least squares, and its part of the loss.
    #[inline]
    pub fn respond(&self, light: Vec4, sample: &Sample) -> (Response, Vec4, Loss) {
        let response = respond(self.display, light, sample.target());
        let ((robust, weights), weight) = (self.robust.weigh(response.residual), sample.weight());
        let loss = Loss {
            minimised: f64::from(robust * weight),
            square: f64::from(response.residual.length_squared() * weight),
        };
        (response, weights * weight, loss)
    }
}

impl<B: Brdf> Problem for ShadedProblem<'_, B> {
    type Sample = Sample;

    fn samples(&self) -> &SampleSet {
        self.samples
    }

    fn atlas(&self) -> &Atlas {
        self.atlas
    }

    fn reads(&self, kind: MapKind) -> bool {
        self.brdf.reads(kind)
    }

    #[inline]
    fn linearise(
        &self,
        kind: MapKind,
        sample: &Sample,
        values: &MapValues,
    ) -> (Jacobian, Response, Vec4, Loss) {
        let (light, jacobian) = self.brdf.jacobian(kind, &sample.light(), values);
        let (response, weights, loss) = self.respond(light, sample);
        (jacobian, response, weights, loss)
    }

    #[inline]
    fn loss_at(&self, sample: &Sample, values: &MapValues) -> Loss {
        let light = self.brdf.light(&sample.light(), values);
        self.respond(light.extend(0.0), sample).2
    }
}

/// Residual and slope of each channel's display value.
#[derive(Clone, Copy, Debug, Default)]
pub struct Response {
    /// Shown minus wanted, both clipped at 1.
    pub residual: Vec4,
    /// Change of the shown value with linear light; 0 where nothing is asked.
    pub slope: Vec4,
}

/// Below this much light the curve's slope is taken as here: the true one, up to
/// 13 times the gain, would let a few dark samples outweigh all others.
const DARK: f32 = 0.01;

/// Compares what linear `light` shows with what was wanted.
#[inline]
pub(crate) fn respond(display: &DisplayTable, light: Vec4, target: Vec4) -> Response {
    let mut out = Response::default();
    for lane in 0..3 {
        let (mut shown, slope) = display.encode_with_derivative(light[lane].max(DARK));
        if light[lane] < DARK {
            shown = display.encode_with_derivative(light[lane]).0;
        }
        if shown < 1.0 || target[lane] < 1.0 {
            out.residual[lane] = shown.min(1.0) - target[lane];
            out.slope[lane] = slope;
        }
    }
    out
}

/// A sample's four texels and their bilinear weights.
#[inline]
pub fn footprint(sample: &impl Fetched, size: usize) -> ([usize; 4], [f32; 4]) {
    let ([fx, fy], texel) = (sample.fractions(), sample.texel());
    (block(texel, size), weights(fx, fy))
}

/// The four places of a sample in a band's local rows (see [`parbake_solve::grid::gather`]).
#[inline]
pub fn local_places(texels: [usize; 4], first: usize, size: usize) -> [usize; 4] {
    let (a, b) = (texels[0] - first, texels[1] - first);
    [a, b, a + size, b + size]
}
