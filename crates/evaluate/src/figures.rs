//! Figures of a pair of pictures, and their averages over views.
//!
//! Contract: pictures are display-referred and of equal size.

use parbake_metric::Rgb;
use serde::{Deserialize, Serialize};

/// Figures of one view.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewFigures {
    /// Decibels, higher is better.
    pub psnr: f64,
    /// 0 … 1, higher is better; none below 161 pixels, or when left out.
    pub ms_ssim: Option<f64>,
    /// Mean FLIP, 0 … 1, lower is better; none when left out.
    pub flip: Option<f64>,
}

/// FLIP's viewing distance: pixels per degree of its authors' default monitor.
pub(crate) const PIXELS_PER_DEGREE: f32 = 67.020_64;

/// Which figures are made besides PSNR.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Metrics {
    /// MS-SSIM.
    pub ms_ssim: bool,
    /// FLIP, which takes longer than rendering both.
    pub flip: bool,
}

impl Metrics {
    /// All of them.
    pub const ALL: Self = Self { ms_ssim: true, flip: true };
}

/// The figures of one pair of pictures of equal size.
pub fn compare(high: &Rgb, low: &Rgb, metrics: Metrics) -> ViewFigures {
    let error = parbake_metric::mean_squared_error(high, low).unwrap_or(f64::NAN);
    ViewFigures {
        psnr: parbake_metric::psnr_from_mse(error),
        ms_ssim: metrics.ms_ssim.then(|| parbake_metric::ms_ssim(high, low).ok()).flatten().flatten(),
        flip: metrics.flip.then(|| parbake_metric::flip(high, low, PIXELS_PER_DEGREE).ok()).flatten(),
    }
}

/// Averages over views; a figure that a view lacks is left out.
pub fn mean(views: &[ViewFigures]) -> ViewFigures {
    let count = views.len().max(1) as f64;
    let optional = |of: fn(&ViewFigures) -> Option<f64>| {
        let all: Option<Vec<f64>> = views.iter().map(of).collect();
        all.map(|all| all.iter().sum::<f64>() / count)
    };
    ViewFigures {
        psnr: views.iter().map(|v| v.psnr).sum::<f64>() / count,
        ms_ssim: optional(|v| v.ms_ssim),
        flip: optional(|v| v.flip),
    }
}
