//! Values that a run used for options that give a maximum, or that are left to the preset.
//!
//! Contract: none stands where the run did not come to an option, or keeps what was delivered.

use crate::report::BakeReport;
use crate::work::Work;
use serde::Serialize;

/// What a run made of its options; the names are theirs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct UsedValues {
    /// Training views that were rendered; none where a model was compressed without views.
    pub views: Option<usize>,
    /// Pixels along a side of each.
    pub view_size: Option<usize>,
    /// Texels between charts that were asked of the layout; a sound delivered one may have less. None where coordinates were kept.
    pub gutter: Option<f64>,
    /// Steps in which texture coordinates were refined; none where they were kept.
    pub uv_steps: Option<usize>,
    /// Triangles that `compress` added; none in other works.
    pub more_triangles: Option<usize>,
    /// The side of the textures of viewers without parallax maps in texels; 0 where the maps' own serve all, none where no others were
    /// tried.
    pub fallback_size: Option<usize>,
}

impl BakeReport {
    /// The values that this run used.
    pub fn used(&self) -> UsedValues {
        let uv_stage = self.uv_stage.as_ref();
        let is_seen = self.views > 0;
        UsedValues {
            views: is_seen.then_some(self.views),
            view_size: is_seen.then(|| self.options.plan().reference.size),
            gutter: uv_stage.map(|uv_stage| uv_stage.gutter),
            uv_steps: uv_stage.map(|uv_stage| uv_stage.steps),
            more_triangles: (self.work == Work::Compress)
                .then(|| self.low_triangles.saturating_sub(self.high_triangles)),
            fallback_size: self.fallback.as_ref().map(|fallback| fallback.side.unwrap_or(0)),
        }
    }
}
