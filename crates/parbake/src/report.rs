//! What a bake saw, as plain data: the JSON report, and what the HTML report shows.

use crate::comparison_figures::Comparison;
use crate::fallback::FallbackReport;
use crate::options::BakeOptions;
use crate::work::Work;
use parbake_atlas::UvCheck;
use parbake_files::Written;
use parbake_fit::parallax_maps::ParallaxReport;
use parbake_fit::schedule::{LossPoint, Move};
use parbake_image::MapKind;
use parbake_progress::StageTime;
use parbake_shape::stage::ShapeReport;
use parbake_uv::surface::UvStageReport;
use serde::{Deserialize, Serialize};

/// The loss after a step of the fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LossStep {
    /// What moved: start, color, normal or rounding; where a model is compressed without views, delivered or
    /// repaired for what coordinates were before they moved, and color.
    pub moved: String,
    /// Seconds since the fit began.
    pub seconds: f64,
    /// Mean squared display difference over all samples and channels.
    pub mean_square: f64,
}

impl From<&LossPoint> for LossStep {
    fn from(p: &LossPoint) -> Self {
        let moved = match p.moved {
            Move::Start => "start",
            Move::Map(MapKind::BaseColor) => "color",
            Move::Map(MapKind::Normal) => "normal",
            Move::Map(MapKind::MetallicRoughness) => "metallic roughness",
            Move::Map(MapKind::Emissive) => "emissive",
            Move::Map(MapKind::Occlusion) => "occlusion",
            Move::Rounding => "rounding",
        };
        Self { moved: moved.into(), seconds: p.seconds, mean_square: p.mean_square }
    }
}

/// A word to the user about a layout that a bake has written, if it is not sound.
pub(crate) fn layout_warning(model: &str, uv: &UvCheck) -> Option<String> {
    let problems = uv.problems();
    (!problems.is_empty())
        .then(|| format!("{model}: the baked texture coordinates are not one to one. {}", problems.join(" ")))
}

/// What a bake saw.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BakeReport {
    /// What it is of.
    #[serde(default)]
    pub work: Work,
    /// What was done with vertices; none where they were kept.
    #[serde(default)]
    pub shape: Option<ShapeReport>,
    /// How far vertices reach beyond the high-poly for the cutout; none where nothing is cut or vertices were kept.
    #[serde(default)]
    pub growth: Option<ShapeReport>,
    /// How cutout and parallax map were fitted; none where there are none.
    #[serde(default)]
    pub parallax_maps: Option<ParallaxReport>,
    /// The textures for viewers without the maps; none where there are no maps, or no such textures are asked for.
    #[serde(default)]
    pub fallback: Option<FallbackReport>,
    /// What was done with texture coordinates; none where they were kept.
    pub uv_stage: Option<UvStageReport>,
    /// What was asked.
    pub options: BakeOptions,
    /// Triangles of the high-poly.
    pub high_triangles: usize,
    /// Triangles of the low-poly.
    pub low_triangles: usize,
    /// Training views that were rendered.
    pub views: usize,
    /// Pixels of those views that show the low-poly.
    pub samples: usize,
    /// Texels whose centre lies on the surface.
    pub covered_texels: usize,
    /// Those among them that no view saw; they were filled inside their chart.
    pub unseen_texels: usize,
    /// Texels that several triangles claim.
    pub overlapping_texels: usize,
    /// Texels on the surface for which projection found nothing within `max_distance`; they took
    /// the closest point.
    pub missed_texels: usize,
    /// The check of the texture coordinates that are written.
    pub uv: UvCheck,
    /// How much closer the result comes to the high-poly than a ray-cast bake; none until
    /// [`compare_bake`](crate::compare_bake) was asked.
    #[serde(default)]
    pub comparison: Option<Comparison>,
    /// What the written GLB file holds and what its formats lost; none until it was written.
    #[serde(default)]
    pub written: Option<Written>,
    /// Loss of the start and after each step.
    pub losses: Vec<LossStep>,
    /// Seconds by stage.
    pub stages: Vec<StageTime>,
    /// True when a time budget or a signal ended a stage early.
    pub stopped_early: bool,
    /// What the user was warned of.
    pub warnings: Vec<String>,
    /// Peak resident memory of the process in bytes, where the system tells.
    pub peak_memory: Option<u64>,
}

impl BakeReport {
    /// What the textures are that the result is compared with.
    pub fn start(&self) -> &'static str {
        match (self.views, self.losses.first().map(|loss| loss.moved.as_str())) {
            // Nothing was ray-cast where nothing was looked at.
            (0, Some("repaired")) => "the best texture of this size for UVs that were only repaired",
            (0, _) => "the best texture of this size for the coordinates as they were",
            _ => "what a ray-cast baker makes of the low-poly as it was delivered",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_atlas::check_mesh;
    use parbake_model::Mesh;
    use parbake_model::glam::{Vec3, vec2};

    /// Protects the word to the user: two triangles on the same texels are worth one, one alone is not.
    #[test]
    fn a_sound_layout_needs_no_warning() {
        let mut mesh = Mesh {
            positions: [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (3.0, 0.0), (4.0, 0.0), (3.0, 1.0)]
                .map(|(x, y)| Vec3::new(x, y, 0.0))
                .to_vec(),
            uvs: [(0.1, 0.9), (0.9, 0.9), (0.1, 0.1)]
                .repeat(2)
                .into_iter()
                .map(|(u, v)| vec2(u, v))
                .collect(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        };
        assert!(layout_warning("low", &check_mesh(&mesh, 64)).is_some_and(|text| text.starts_with("low: ")));
        mesh.triangles.truncate(1);
        assert_eq!(layout_warning("low", &check_mesh(&mesh, 64)), None);
    }
}
