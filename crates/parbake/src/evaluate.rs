//! Compares two models picture by picture: PSNR, MS-SSIM and FLIP over views spread
//! around them.

use crate::error::BakeError;
use crate::message::{Message, Stage, Watcher};
use crate::studio::Studio;
use parbake_metric::Rgb;
use parbake_model::Model;
use parbake_render::camera::{Projection, fibonacci_sphere};
use parbake_render::scene::Interpretation;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Conventions of an evaluation. The defaults ("preset B") are those that agree best
/// with the paper's figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct EvaluateOptions {
    /// Views on a Fibonacci sphere, 1 to 4096
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 48))]
    pub views: usize,

    /// Side of a picture in pixels, 16 to 4096
    #[cfg_attr(feature = "clap", arg(long, value_name = "PIXELS", default_value_t = 512))]
    pub resolution: usize,

    /// Samples along a side of each pixel, 1 to 8
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 2))]
    pub supersample: usize,

    /// Distance of the cameras in half lengths of the high-poly's longest side, 1.8 to 100
    #[cfg_attr(feature = "clap", arg(long, value_name = "DISTANCE", default_value_t = 3.5))]
    pub radius: f32,

    /// Field of view in degrees, 1 to 170
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEGREES", default_value_t = 43.602_818))]
    pub fov: f32,

    /// Half the width of an orthographic view, in half lengths, instead of perspective, 0.001 to 100
    /// [default: perspective]
    #[cfg_attr(feature = "clap", arg(long, value_name = "HALF_WIDTH"))]
    pub ortho: Option<f32>,

    /// Strength of the light, 0.001 to 100
    #[cfg_attr(feature = "clap", arg(long, default_value_t = 1.59))]
    pub gain: f32,

    /// Decode base colour from sRGB before shading, as glTF says
    #[cfg_attr(feature = "clap", arg(long))]
    pub decode_srgb: bool,

    /// Fetch textures on their finest level only
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_mips: bool,

    /// Ignore parallax maps and their cutouts, as viewers without the extension do
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_parallax: bool,

    /// Background: black, white, grey, or three numbers from 0 to 1 as R,G,B, of linear light
    #[cfg_attr(feature = "clap", arg(long, default_value = "black"))]
    pub background: String,

    /// Leave FLIP out, which takes most of the time
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_flip: bool,
}

impl Default for EvaluateOptions {
    fn default() -> Self {
        Self {
            views: 48,
            resolution: 512,
            supersample: 2,
            radius: 3.5,
            fov: 43.602_818,
            ortho: None,
            gain: 1.59,
            decode_srgb: false,
            no_mips: false,
            no_parallax: false,
            background: "black".into(),
            no_flip: false,
        }
    }
}

impl EvaluateOptions {
    /// Checks every range; the error names the option and what it may be.
    pub fn check(&self) -> Result<(), BakeError> {
        self.checked_background().map(|_| ())
    }

    pub(crate) fn checked_background(&self) -> Result<[f32; 3], BakeError> {
        let fail = |option, value: String, range: &str| {
            Err(BakeError::Option { option, value, range: range.into() })
        };
        let ranges = [
            ("views", self.views as f64, 1.0, 4096.0),
            ("resolution", self.resolution as f64, 16.0, 4096.0),
            ("supersample", self.supersample as f64, 1.0, 8.0),
            ("radius", f64::from(self.radius), 1.8, 100.0),
            ("fov", f64::from(self.fov), 1.0, 170.0),
            ("ortho", f64::from(self.ortho.unwrap_or(1.0)), 1e-3, 100.0),
            ("gain", f64::from(self.gain), 1e-3, 100.0),
        ];
        for (option, value, low, high) in ranges {
            if !(low..=high).contains(&value) {
                return fail(option, value.to_string(), &format!("{low} to {high}"));
            }
        }
        match self.background.as_str() {
            "black" => Ok([0.0; 3]),
            "white" => Ok([1.0; 3]),
            "grey" | "gray" => Ok([GREY; 3]),
            other => {
                let numbers: Result<Vec<f32>, _> = other.split(',').map(|n| n.trim().parse()).collect();
                let numbers = numbers.unwrap_or_default();
                match numbers[..] {
                    [r, g, b] if numbers.iter().all(|n| (0.0..=1.0).contains(n)) => Ok([r, g, b]),
                    _ => fail("background", other.into(), "black, white, grey or R,G,B"),
                }
            }
        }
    }

    pub(crate) fn projection(&self) -> Projection {
        match self.ortho {
            Some(half_width) => Projection::Orthographic(half_width),
            None => Projection::Perspective((self.fov.to_radians() * 0.5).tan()),
        }
    }

    /// How textures are read.
    pub fn interpretation(&self) -> Interpretation {
        Interpretation {
            decode_srgb: self.decode_srgb,
            trilinear: !self.no_mips,
            parallax: !self.no_parallax,
        }
    }
}

/// Figures of one view.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewFigures {
    /// Decibels, higher is better.
    pub psnr: f64,
    /// 0 … 1, higher is better; none below 161 pixels.
    pub ms_ssim: Option<f64>,
    /// Mean FLIP, 0 … 1, lower is better; none when left out.
    pub flip: Option<f64>,
}

/// Figures of a pair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// The conventions.
    pub options: EvaluateOptions,
    /// Averages over the views.
    pub mean: ViewFigures,
    /// Each view's figures.
    pub views: Vec<ViewFigures>,
}

/// Linear light of a grey background, the independent evaluator's too.
pub const GREY: f32 = 0.5;

/// FLIP's viewing distance: pixels per degree of its authors' default monitor.
const PIXELS_PER_DEGREE: f32 = 67.020_64;

/// Compares `low` with `high`.
///
/// # Errors
/// An option out of range; a high-poly without extent.
pub fn evaluate(
    high: &Model,
    low: &Model,
    options: &EvaluateOptions,
    watcher: &impl Watcher,
) -> Result<Evaluation, BakeError> {
    let mut all = evaluate_before(high, low, options, &[&options.background], watcher)?;
    Ok(all.remove(0))
}

/// Compares them before several backgrounds in turn, each as `options.background` has it; a view
/// is rendered once for all of them.
///
/// # Errors
/// As of [`evaluate`].
pub fn evaluate_before(
    high: &Model,
    low: &Model,
    options: &EvaluateOptions,
    backgrounds: &[&str],
    watcher: &impl Watcher,
) -> Result<Vec<Evaluation>, BakeError> {
    let asked: Vec<EvaluateOptions> = backgrounds
        .iter()
        .map(|&name| EvaluateOptions { background: name.into(), ..options.clone() })
        .collect();
    let colors: Vec<[f32; 3]> =
        asked.iter().map(EvaluateOptions::checked_background).collect::<Result<_, _>>()?;
    let studio = Studio::new(high, options)?;
    let (high, low) = (studio.subject(high), studio.subject(low));
    let done = AtomicUsize::new(0);
    let views: Vec<Vec<ViewFigures>> = fibonacci_sphere(options.views, 0.0)
        .into_par_iter()
        .map(|direction| {
            let shots = [&high, &low].map(|subject| studio.shot(subject, direction));
            let figures = colors.iter().map(|&color| {
                let [high, low] = shots.each_ref().map(|shot| studio.develop(shot, color));
                compare(&high, &low, !options.no_flip)
            });
            let figures = figures.collect();
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            watcher.message(Message::Progress { stage: Stage::Evaluate, done, total: options.views });
            figures
        })
        .collect();
    Ok(asked
        .into_iter()
        .enumerate()
        .map(|(k, options)| {
            let views: Vec<ViewFigures> = views.iter().map(|view| view[k]).collect();
            Evaluation { options, mean: mean(&views), views }
        })
        .collect())
}

/// All figures of one pair of pictures of equal size.
pub(crate) fn compare(high: &Rgb, low: &Rgb, with_flip: bool) -> ViewFigures {
    let error = parbake_metric::mean_squared_error(high, low).unwrap_or(f64::NAN);
    ViewFigures {
        psnr: parbake_metric::psnr_from_mse(error),
        ms_ssim: parbake_metric::ms_ssim(high, low).ok().flatten(),
        flip: with_flip.then(|| parbake_metric::flip(high, low, PIXELS_PER_DEGREE).ok()).flatten(),
    }
}

pub(crate) fn mean(views: &[ViewFigures]) -> ViewFigures {
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
