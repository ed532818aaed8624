//! Maps fitted to the high-poly's own maps as views see them: what viewers of any light and any BRDF
//! agree on.
//!
//! Each sample wants values of base colour, normal, metallic-roughness, emission and occlusion, and each
//! map is its own least squares over the same samples and bilinear weights. Colours and emission are
//! compared as sRGB shows them, all else as it is. What a map is worth depends on the others:
//! metal counts by how bright its base colour is, since of a mixture F₀ = E[m c] and diffuse colour
//! E[(1 − m) c] shall be right: m = E[m |c|] / E[|c|].
//!
//! Contract: no map depends on another but the metallic channel on the sample's own colour, so maps may
//! be solved for in any order.

use crate::outliers::Loss;
use crate::problem::{Problem, Response, respond};
use parbake_image::display::{Curve, Display};
use parbake_image::display_table::DisplayTable;
use parbake_image::{MapKind, MapSet, MapValues};
use parbake_model::glam::Vec4;
use parbake_render::shade::Jacobian;
use parbake_views::chart_labels::Atlas;
use parbake_views::material_samples::MaterialSample;
use parbake_views::samples::{Fetched, SampleSet};

/// The samples' materials.
pub struct MaterialProblem<'a> {
    samples: &'a SampleSet<MaterialSample>,
    atlas: &'a Atlas,
    srgb: DisplayTable,
    kinds: Vec<MapKind>,
}

impl<'a> MaterialProblem<'a> {
    /// For the kinds of maps that are in `start`.
    pub fn new(samples: &'a SampleSet<MaterialSample>, atlas: &'a Atlas, start: &MapSet) -> Self {
        let srgb = DisplayTable::new(&Display { gain: 1.0, curve: Curve::Srgb });
        Self { samples, atlas, srgb, kinds: start.kinds().collect() }
    }

    /// What the map has and what is wanted, and how much each channel counts.
    #[inline]
    fn compare(&self, kind: MapKind, sample: &MaterialSample, values: &MapValues) -> (Response, Vec4) {
        let (value, target, weight) = (values[kind], sample.target(kind), sample.weight());
        match kind {
            MapKind::BaseColor => {
                let mut response = respond(&self.srgb, value, target);
                (response.residual.w, response.slope.w) = (value.w - target.w, 1.0);
                (response, Vec4::new(weight, weight, weight, sample.opacity_weight()))
            }
            MapKind::Emissive => (respond(&self.srgb, value, target), Vec4::splat(weight)),
            MapKind::MetallicRoughness => {
                let brightest = sample.target(MapKind::BaseColor).truncate().max_element();
                let weights = Vec4::new(0.0, weight, weight * brightest.max(DARKEST), 0.0);
                (Response { residual: value - target, slope: Vec4::ONE }, weights)
            }
            MapKind::Normal | MapKind::Occlusion => {
                let lanes = if kind == MapKind::Normal { Vec4::new(1.0, 1.0, 1.0, 0.0) } else { Vec4::X };
                (Response { residual: value - target, slope: Vec4::ONE }, lanes * weight)
            }
        }
    }
}

/// What the metallic channel of black counts against that of white.
const DARKEST: f32 = 0.02;

fn loss(response: &Response, weights: Vec4) -> Loss {
    let square = f64::from((response.residual * response.residual).dot(weights));
    Loss { minimised: square, square }
}

impl Problem for MaterialProblem<'_> {
    type Sample = MaterialSample;

    fn samples(&self) -> &SampleSet<MaterialSample> {
        self.samples
    }

    fn atlas(&self) -> &Atlas {
        self.atlas
    }

    fn reads(&self, kind: MapKind) -> bool {
        self.kinds.contains(&kind)
    }

    #[inline]
    fn linearise(
        &self,
        kind: MapKind,
        sample: &MaterialSample,
        values: &MapValues,
    ) -> (Jacobian, Response, Vec4, Loss) {
        let (response, weights) = self.compare(kind, sample, values);
        (Jacobian::Diagonal(Vec4::ONE), response, weights, self.loss_at(sample, values))
    }

    #[inline]
    fn loss_at(&self, sample: &MaterialSample, values: &MapValues) -> Loss {
        let of = |kind: &MapKind| {
            let (response, weights) = self.compare(*kind, sample, values);
            loss(&response, weights)
        };
        self.kinds.iter().map(of).sum()
    }
}
