//! What a bake saw, as plain data: the JSON report, and what the HTML report shows.

use crate::depth::DepthReport;
use crate::message::Stage;
use crate::options::BakeOptions;
use crate::shape::ShapeReport;
use crate::unfold::UnfoldReport;
use parbake_atlas::UvCheck;
use parbake_fit::schedule::{LossPoint, Move};
use serde::{Deserialize, Serialize};

/// Seconds that a stage took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageTime {
    /// Which stage.
    pub stage: Stage,
    /// Wall seconds.
    pub seconds: f64,
}

/// The loss after a step of the fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LossStep {
    /// What moved: start, color, normal or rounding; where a model is compressed without views, delivered or
    /// mended for what coordinates were before they moved, and color.
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
            Move::Color => "color",
            Move::Normal => "normal",
            Move::Rounding => "rounding",
        };
        Self { moved: moved.into(), seconds: p.seconds, mean_square: p.mean_square }
    }
}

/// What a report is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Work {
    /// A high-poly's look on a low-poly.
    #[default]
    Bake,
    /// A model with a smaller texture.
    Compress,
}

impl Work {
    /// The command, as one types it, and what it takes.
    pub(crate) fn command(self) -> &'static str {
        match self {
            Self::Bake => "bake HIGH LOW",
            Self::Compress => "compress MODEL",
        }
    }
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
    /// How cutout and parallax map were fitted; none where there are none.
    #[serde(default)]
    pub depth: Option<DepthReport>,
    /// What was done with texture coordinates; none where they were kept.
    pub unfold: Option<UnfoldReport>,
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
    /// Texels on the surface for which projection found nothing within its reach; they took
    /// the closest point.
    pub missed_texels: usize,
    /// The check of the texture coordinates that are written.
    pub uv: UvCheck,
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
    pub(crate) fn start(&self) -> &'static str {
        match (self.views, self.losses.first().map(|loss| loss.moved.as_str())) {
            // Nothing was projected where nothing was looked at.
            (0, Some("mended")) => "the best texture of this size for coordinates that were only mended",
            (0, _) => "the best texture of this size for the coordinates as they were",
            _ => "what an ordinary baker delivers",
        }
    }
}
