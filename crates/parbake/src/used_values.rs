//! Values that a run used where its options say how much at most, or leave them open.
//!
//! Contract: an option that could do nothing in the run has none here, nor has one that the run did not come to.

use crate::idle_options::idle_options;
use crate::options::UvMode;
use crate::report::BakeReport;
use crate::work::Work;
use serde::Serialize;

/// What a run made of its options; the names are theirs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct UsedValues {
    /// Training views that were rendered.
    pub views: Option<usize>,
    /// Pixels along a side of each.
    pub view_size: Option<usize>,
    /// Rounds of the texture solve, at most.
    pub rounds: Option<usize>,
    /// Texels between charts; none where these are as they were delivered.
    pub gutter: Option<f64>,
    /// Steps in which texture coordinates were refined.
    pub uv_steps: Option<usize>,
    /// Triangles that were added.
    pub more_triangles: Option<usize>,
    /// Weight of pixels beyond the high-poly's outline.
    pub silhouette: Option<f32>,
    /// Scale of the robust loss, in display units.
    pub robust_scale: Option<f32>,
    /// The side of the textures of viewers without parallax maps in texels; 0 where the maps' own serve all.
    pub fallback_size: Option<usize>,
}

impl BakeReport {
    /// The values that this run used.
    pub fn used(&self) -> UsedValues {
        let (options, plan, uv_stage) = (&self.options, self.options.plan(), self.uv_stage.as_ref());
        let idle = idle_options(options, self.work);
        let acts = |name: &str| !idle.iter().any(|(own, _)| *own == name);
        let is_seen = self.views > 0;
        UsedValues {
            views: Some(self.views),
            view_size: is_seen.then_some(plan.reference.size),
            rounds: is_seen.then_some(plan.schedule.rounds),
            gutter: match uv_stage {
                Some(uv_stage) => Some(uv_stage.gutter),
                None => (options.uv != UvMode::Keep).then(|| options.gutter_texels()),
            },
            uv_steps: acts("uv_steps").then(|| uv_stage.map_or(0, |uv_stage| uv_stage.steps)),
            more_triangles: (self.work == Work::Compress)
                .then(|| self.low_triangles.saturating_sub(self.high_triangles)),
            silhouette: (is_seen && acts("silhouette")).then(|| options.silhouette_weight()),
            robust_scale: (is_seen && acts("robust_scale")).then_some(plan.schedule.robust_scale),
            fallback_size: self.fallback.as_ref().map(|fallback| fallback.side.unwrap_or(0)),
        }
    }
}
