//! What a comparison of parallax variants found, as plain data.

use super::options::VariantsOptions;
use serde::{Deserialize, Serialize};

/// Figures of one variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariantFigures {
    /// What it is called.
    pub name: String,
    /// Mean over the held-out views, on black: decibels, higher is better.
    pub psnr: f64,
    /// The same, 0 … 1, higher is better.
    pub ms_ssim: Option<f64>,
    /// Mean squared display difference of the first and the last steps' views of the fit; none
    /// where nothing was fitted.
    pub fitted: Option<[f64; 2]>,
    /// Bytes of what is kept besides the textures.
    pub bytes: usize,
    /// Coordinates, one after the other, at which a pixel has to fetch from its map, at most:
    /// what Table 1 of the paper counts.
    pub places: usize,
    /// Images that it fetches from, over all places, at most.
    pub fetches: usize,
    /// Seconds that the fit and the solve for the textures took.
    pub seconds: f64,
}

/// A comparison.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariantsReport {
    /// What was asked.
    pub options: VariantsOptions,
    /// The variants in a fixed order, textures without parallax first. One that was stopped
    /// before its turn is not there.
    pub variants: Vec<VariantFigures>,
    /// Held-out views that figures are means of.
    pub views: usize,
    /// True when it was asked to stop.
    pub stopped_early: bool,
}
