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

use crate::problem::{Problem, Response, respond};
use crate::robust_loss::Loss;
use parbake_image::display::{Curve, Display};
use parbake_image::display_table::DisplayTable;
use parbake_image::{MapKind, MapValues};
use parbake_model::glam::Vec4;
use parbake_render::shade::Jacobian;
use parbake_views::chart_labels::Atlas;
use parbake_views::material_sample::MaterialSample;
use parbake_views::samples::{Fetched, SampleSet};

/// The samples' materials.
pub struct MaterialProblem<'a> {
    samples: &'a SampleSet<MaterialSample>,
    atlas: &'a Atlas,
    srgb: DisplayTable,
    kinds: Vec<MapKind>,
}

impl<'a> MaterialProblem<'a> {
    /// For these kinds of maps.
    pub fn new(
        samples: &'a SampleSet<MaterialSample>,
        atlas: &'a Atlas,
        kinds: impl Iterator<Item = MapKind>,
    ) -> Self {
        let srgb = DisplayTable::new(&Display { gain: 1.0, curve: Curve::Srgb });
        Self { samples, atlas, srgb, kinds: kinds.collect() }
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

    fn is_coupled(&self, _kind: MapKind) -> bool {
        false
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::Cpu;
    use crate::schedule::{Schedule, fit_maps};
    use parbake_image::{FloatImage, MapSet};
    use parbake_model::glam::vec2;

    const SIZE: usize = 8;

    fn values(color: Vec4, roughness: f32, metallic: f32) -> MapValues {
        let mut values = MapValues::NEUTRAL;
        values[MapKind::BaseColor] = color;
        values[MapKind::MetallicRoughness] = Vec4::new(0.0, roughness, metallic, 0.0);
        values
    }

    /// The maps that fit these values, each seen in the middle of every texel with two weights.
    fn fitted(wanted: &[(MapValues, [f32; 2])]) -> Vec<(MapKind, [u8; 4])> {
        let mut bands = vec![Vec::new()];
        for texel in 0..SIZE * SIZE {
            let uv = vec2((texel % SIZE) as f32 + 0.5, (texel / SIZE) as f32 + 0.5) / SIZE as f32;
            bands[0].extend(wanted.iter().map(|(v, weights)| MaterialSample::new(uv, SIZE, v, *weights)));
        }
        let samples = SampleSet::new(SIZE, &bands);
        let atlas = Atlas { size: SIZE, label: vec![0; SIZE * SIZE], covered: vec![true; SIZE * SIZE] };
        let mut start =
            MapSet::of(FloatImage::solid(SIZE, Vec4::splat(0.5)), FloatImage::solid(SIZE, Vec4::Z));
        start.insert(MapKind::MetallicRoughness, FloatImage::solid(SIZE, Vec4::splat(0.5)));
        let problem = MaterialProblem::new(&samples, &atlas, start.kinds());
        let schedule = Schedule { damping: 0.0, ..Schedule::default() };
        let fitted = fit_maps(&problem, &start, &Cpu, true, &schedule, &());
        fitted.images.iter().map(|(kind, image)| (*kind, image.pixels[3 * SIZE + 3])).collect()
    }

    fn of(maps: &[(MapKind, [u8; 4])], kind: MapKind) -> [u8; 4] {
        maps.iter().find(|(own, _)| *own == kind).expect("it was fitted").1
    }

    /// Protects every channel: what all views agree on is written.
    #[test]
    fn what_views_agree_on_is_found() {
        let mut wanted = values(Vec4::new(0.5, 0.25, 0.1, 1.0), 0.3, 1.0);
        wanted[MapKind::Normal] = Vec4::new(0.6, 0.0, 0.8, 0.0);
        let maps = fitted(&[(wanted, [1.0, 0.0])]);
        let [_, roughness, metallic, _] = of(&maps, MapKind::MetallicRoughness);
        assert!(roughness.abs_diff(77) <= 1 && metallic >= 254, "{roughness} {metallic}");
        let [x, y, z, _] = of(&maps, MapKind::Normal);
        assert!(x.abs_diff(204) <= 1 && y.abs_diff(128) <= 1 && z.abs_diff(230) <= 1, "{x} {y} {z}");
        let [red, green, ..] = of(&maps, MapKind::BaseColor);
        assert!(red.abs_diff(188) <= 1 && green.abs_diff(137) <= 1, "{red} {green}");
    }

    /// Protects borders of metal: a texel that is half gold and half black plastic reflects like gold, and
    /// has no diffuse colour that neither of them has.
    #[test]
    fn metal_counts_by_its_colour() {
        let gold = values(Vec4::new(1.0, 0.78, 0.34, 1.0), 0.4, 1.0);
        let plastic = values(Vec4::new(0.0, 0.0, 0.0, 1.0), 0.4, 0.0);
        let maps = fitted(&[(gold, [1.0, 0.0]), (plastic, [1.0, 0.0])]);
        let metallic = of(&maps, MapKind::MetallicRoughness)[2];
        assert!(metallic > 245, "{metallic}");
    }

    /// Protects what is cut out: gaps ask for opacity alone, and colour stays what is there.
    #[test]
    fn gaps_have_no_colour() {
        let leaf = values(Vec4::new(0.2, 0.6, 0.1, 1.0), 0.9, 0.0);
        let maps = fitted(&[(leaf, [1.0, 1.0]), (MapValues::ZERO, [0.0, 1.0])]);
        let [_, green, _, alpha] = of(&maps, MapKind::BaseColor);
        assert!(green.abs_diff(203) <= 1 && alpha.abs_diff(128) <= 2, "{green} {alpha}");
    }
}
