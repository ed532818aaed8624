//! A finished level, and what `lods.json` holds of it.

use super::candidate::{Candidate, Way};
use super::target::TargetReport;
use crate::bake::Baked;
use parbake_evaluate::screen_size::AtSize;
use parbake_files::WriteOptions;
use parbake_mesh::parts::PartReport;
use parbake_simplify::LayerReport;
use serde::{Deserialize, Serialize};

/// A finished level.
#[derive(Clone, Debug)]
pub struct Level {
    /// The bake, with the model.
    pub baked: Baked,
    /// How its file is to be written: as asked for, with a lower quality of textures where a target allows that.
    pub write: WriteOptions,
    /// What there is to say of it.
    pub report: LevelReport,
}

/// What `lods.json` holds of a level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelReport {
    /// Its place in the chain; 0 is the finest.
    pub level: usize,
    /// Pixels that it was made for.
    pub screen_size: f64,
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side of its textures.
    pub texture_size: usize,
    /// Texels of all its textures.
    pub texels: usize,
    /// Texels between the two charts that come nearest, at the texture's own size; none where there is one chart.
    #[serde(default)]
    pub gutter: Option<f64>,
    /// The same at the smallest mip level that the level is meant for: where it is as small as the next level's size, or
    /// as half of the last one's own.
    #[serde(default)]
    pub smallest_gutter: Option<f64>,
    /// Draw calls: one for each material, of each part that stays apart and of the rest.
    pub draw_calls: usize,
    /// The nodes that stay apart.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartReport>,
    /// How it was made.
    #[serde(default)]
    pub way: Way,
    /// The ways that were tried; that with finer maps up to twice more.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub candidates: Vec<Candidate>,
    /// How the triangles of each layer (opaque, cut out, blended, transmitting) were found; empty where it has the
    /// model's own vertices.
    pub low_poly: Vec<LayerReport>,
    /// Against the original, at the size that it was made for; of what the file holds.
    pub at_screen_size: AtSize,
    /// Pixels that the model spans below which this level cannot be told from the one before, nor from the
    /// original; none where it always can.
    pub switch_pixels: Option<f64>,
    /// The same as a share of the screen's height.
    pub switch_coverage: Option<f64>,
    /// Against the level before (the original for the first), at that size.
    pub against_before: Option<AtSize>,
    /// How the search for a PSNR went, where one was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetReport>,
    /// Whether a time budget or a signal ended a step early.
    #[serde(default)]
    pub stopped_early: bool,
    /// Seconds that triangles, bake and figures took; of a search for a PSNR those of all its bakes. Ways that were not
    /// taken count with the figures. What was found while the level before was baked counts with both.
    pub seconds: [f64; 3],
}
