//! What came of an experiment, as plain data.

use crate::relighting::Relit;
use crate::variants::VariantFigures;
use serde::{Deserialize, Serialize};

/// Backgrounds that models are judged before: the paper's, then "any".
pub const BACKGROUNDS: [&str; 4] = ["black", "white", "grey", "0.9,0.1,0.2"];

/// How well a result agrees, on one background or at one size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// The background; for pictures full, half or quarter.
    pub seen: String,
    /// Mean over the views, in decibels.
    pub psnr: f64,
    /// The same, 0 … 1; none where it was not measured.
    pub ms_ssim: Option<f64>,
}

/// A point of a convergence plot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Iterations so far.
    pub iteration: usize,
    /// L_diff: mean squared difference.
    pub loss: f64,
    /// L_I∘UV.
    pub content: f64,
    /// Whether coordinates moved in it.
    pub moving: bool,
}

/// A result.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// As the title of its experiment has it.
    pub title: String,
    /// Scores in the order of [`BACKGROUNDS`], or of sizes; none for a comparison of variants.
    pub scores: Vec<Score>,
    /// Wall seconds from files to file, without the comparison.
    pub seconds: f64,
    /// Wall seconds with the comparison.
    pub seconds_in_all: f64,
    /// Bytes of the file that was written; 0 where there is none.
    pub bytes: u64,
    /// Iterations that vertices took, and in the paper's method coordinates and textures too.
    pub iterations: usize,
    /// Triangles that lie on another one or are mirrored in the written layout.
    pub unsound: usize,
    /// What the paper's optimiser went through.
    pub convergence: Vec<Point>,
    /// Figures of each kind of parallax mapping; their pictures lie beside this.
    pub variants: Vec<VariantFigures>,
    /// Figures under random lights; their pictures lie beside this.
    #[serde(default)]
    pub relit: Vec<Relit>,
    /// What the product warned of.
    pub warnings: Vec<String>,
    /// Who made it: a digest of the program.
    pub build: String,
}

impl Outcome {
    /// On black, or at full size.
    pub fn psnr(&self) -> f64 {
        self.scores.first().map_or(f64::NAN, |score| score.psnr)
    }

    /// The mean over all but the first: on other backgrounds, or minified.
    pub fn psnr_elsewhere(&self) -> f64 {
        let others = self.scores.get(1..).unwrap_or_default();
        others.iter().map(|score| score.psnr).sum::<f64>() / others.len() as f64
    }

    /// On black, or at full size.
    pub fn ms_ssim(&self) -> Option<f64> {
        self.scores.first().and_then(|score| score.ms_ssim)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the two figures that all tables are made of.
    #[test]
    fn means_are_of_the_right_backgrounds() {
        let score = |psnr| Score { seen: String::new(), psnr, ms_ssim: Some(0.5) };
        let outcome = Outcome { scores: [30.0, 10.0, 11.0, 15.0].map(score).into(), ..Outcome::default() };
        assert_eq!((outcome.psnr(), outcome.psnr_elsewhere(), outcome.ms_ssim()), (30.0, 12.0, Some(0.5)));
        assert!(Outcome::default().psnr().is_nan() && Outcome::default().psnr_elsewhere().is_nan());
    }
}
