//! Where a level may take the place of the one before: the largest size on screen at which nobody can tell the two,
//! found by rendering both at that size.
//!
//! Both are photographed from some directions, by the whole material under the built-in light where there is one, on
//! grey. The figure is the PSNR over whole pictures in which the model's longest side spans five sevenths of the
//! width, the mean over the directions. Sizes are tried in steps of a fifth from the one that the level was made for;
//! the largest that passes before one does not counts.
//!
//! Contract: deterministic, and the same for the same models, whatever the bake was.

use crate::error::BakeError;
use crate::evaluate::options::{EvaluateOptions, GREY};
use crate::options::Shading;
use crate::studio::Studio;
pub use crate::studio::Subject;
use parbake_metric::Rgb;
use parbake_model::Model;
use parbake_render::camera::fibonacci_sphere;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Directions that models are seen from.
const VIEWS: usize = 6;
/// The same with few samples in small pictures, in which edges that fall between samples make a difference by luck.
const VIEWS_OF_FEW_PIXELS: usize = 16;
/// Pixels below which pictures are small.
const FEW_PIXELS: f64 = 150.0;
/// Pixels that samples are enough for at small sizes, where thin parts flicker with fewer, and samples along a side of
/// a pixel at least and at most.
const SAMPLED: f64 = 480.0;
const SAMPLES: [f64; 2] = [2.0, 6.0];
/// Pixels of a picture for each that the model spans, as cameras stand (3.5 from the middle, half a width of 0.4).
const PICTURE: f64 = 1.4;
/// From one size to the next.
const STEP: f64 = 1.2;
/// The least and the largest size that is tried, in pixels.
const SIZES: [f64; 2] = [12.0, 2048.0];
/// Steps from the level's own size at most, to larger ones, which cost more and more, and to smaller ones.
const MOST_STEPS: [usize; 2] = [3, 16];

/// Figures of two models at one size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AtSize {
    /// Pixels that the model's longest side spans.
    pub pixels: f64,
    /// PSNR in dB.
    pub psnr: f64,
    /// MS-SSIM, 0 to 1; none where pictures are too small for it.
    pub ms_ssim: Option<f64>,
    /// FLIP, 0 to 1, lower is better.
    pub flip: Option<f64>,
}

/// The grey that viewers show as the number 128 of 255, in linear light: outlines count as they do there.
const VIEWER_GREY: f32 = 0.2159;

/// A model's pictures at one size.
pub struct Pictures {
    studio: Studio,
    views: Vec<Rgb>,
}

/// Models in front of cameras.
pub struct Lineup {
    original: Arc<Model>,
    options: EvaluateOptions,
    /// Samples along a side of a pixel of viewers; none for as many as small sizes need.
    viewer_samples: Option<usize>,
}

impl Lineup {
    /// Around the original.
    pub fn new(original: &Model, shading: Shading) -> Self {
        let options = EvaluateOptions { shading, ..EvaluateOptions::default() };
        Self { original: Arc::new(original.clone()), options, viewer_samples: None }
    }

    /// The same for pictures as viewers make them: of whole materials, which a bake may be told not to fit, and with so many
    /// samples along a side of a pixel.
    pub fn as_viewers_do(&self, samples: usize) -> Self {
        let options = EvaluateOptions { shading: Shading::Pbr, ..self.options.clone() };
        Self { original: self.original.clone(), options, viewer_samples: Some(samples) }
    }

    fn studio(&self, pixels: f64) -> Result<Studio, BakeError> {
        let resolution = (PICTURE * pixels).round().max(16.0) as usize;
        let usual = || (SAMPLED / pixels).clamp(SAMPLES[0], SAMPLES[1]) as usize;
        let supersample = self.viewer_samples.unwrap_or_else(usual);
        let options = EvaluateOptions { resolution, supersample, ..self.options.clone() };
        let studio = Studio::new(&self.original, &options)?;
        Ok(if self.viewer_samples.is_some() { studio.as_viewers_do() } else { studio })
    }

    /// What is behind the model, in linear light.
    fn background(&self) -> [f32; 3] {
        [if self.viewer_samples.is_some() { VIEWER_GREY } else { GREY }; 3]
    }

    /// Makes a model ready for pictures.
    ///
    /// # Errors
    /// Where the original has no extent.
    pub fn subject(&self, model: &Model) -> Result<Subject, BakeError> {
        Ok(self.studio(SIZES[0])?.subject(model))
    }

    /// Takes a model's pictures at a size, to compare any number of others with.
    ///
    /// # Errors
    /// Where the original has no extent.
    pub fn pictures(&self, subject: &Subject, pixels: f64) -> Result<Pictures, BakeError> {
        let studio = self.studio(pixels)?;
        let is_small = self.viewer_samples.is_some() && pixels < FEW_PIXELS;
        let views = fibonacci_sphere(if is_small { VIEWS_OF_FEW_PIXELS } else { VIEWS }, 0.0)
            .into_par_iter()
            .map(|direction| studio.develop(&studio.shot(subject, direction), self.background()))
            .collect();
        Ok(Pictures { studio, views })
    }

    /// PSNR in dB of a model against another one's pictures: that of [`Lineup::compare`].
    pub fn psnr(&self, pictures: &Pictures, subject: &Subject) -> f64 {
        let Pictures { studio, views } = pictures;
        let figures: Vec<f64> = (fibonacci_sphere(views.len(), 0.0).into_par_iter().zip(views))
            .map(|(direction, other)| {
                psnr(other, &studio.develop(&studio.shot(subject, direction), self.background()))
            })
            .collect();
        figures.iter().sum::<f64>() / figures.len() as f64
    }

    /// Compares two models at a size; FLIP and MS-SSIM only if asked for.
    ///
    /// # Errors
    /// Where the original has no extent.
    pub fn compare(
        &self,
        a: &Subject,
        b: &Subject,
        pixels: f64,
        with_all: bool,
    ) -> Result<AtSize, BakeError> {
        let studio = self.studio(pixels)?;
        let views: Vec<_> = fibonacci_sphere(VIEWS, 0.0)
            .into_par_iter()
            .map(|direction| {
                let [a, b]: [Rgb; 2] =
                    [a, b].map(|subject| studio.develop(&studio.shot(subject, direction), [GREY; 3]));
                if with_all {
                    return crate::evaluate::compare(&a, &b, true);
                }
                crate::ViewFigures { psnr: psnr(&a, &b), ms_ssim: None, flip: None }
            })
            .collect();
        let mean = crate::evaluate::mean(&views);
        Ok(AtSize { pixels, psnr: mean.psnr, ms_ssim: mean.ms_ssim, flip: mean.flip })
    }

    /// The largest size at which `level` agrees with all of `others` by `same` decibels, searched from `start` on;
    /// none where it does not even at the least size.
    ///
    /// # Errors
    /// Where the original has no extent.
    pub fn largest_same(
        &self,
        level: &Subject,
        others: &[&Subject],
        start: f64,
        same: f64,
    ) -> Result<Option<f64>, BakeError> {
        let passes = |pixels: f64| -> Result<bool, BakeError> {
            let studio = self.studio(pixels)?;
            let errors: Vec<Vec<f64>> = fibonacci_sphere(VIEWS, 0.0)
                .into_par_iter()
                .map(|direction| {
                    let picture =
                        |subject: &Subject| studio.develop(&studio.shot(subject, direction), [GREY; 3]);
                    let own = picture(level);
                    others.iter().map(|other| psnr(&picture(other), &own)).collect()
                })
                .collect();
            let mean = |other: usize| errors.iter().map(|of| of[other]).sum::<f64>() / VIEWS as f64;
            Ok((0..others.len()).all(|other| mean(other) >= same))
        };
        let mut pixels = start.clamp(SIZES[0], SIZES[1]);
        let goes_up = passes(pixels)?;
        for _ in 0..MOST_STEPS[usize::from(!goes_up)] {
            let next = if goes_up { pixels * STEP } else { pixels / STEP };
            if !(SIZES[0]..=SIZES[1]).contains(&next) {
                break;
            }
            match (goes_up, passes(next)?) {
                (true, true) | (false, false) => pixels = next,
                (true, false) => return Ok(Some(pixels)),
                (false, true) => return Ok(Some(next)),
            }
        }
        Ok(goes_up.then_some(pixels))
    }
}

fn psnr(a: &Rgb, b: &Rgb) -> f64 {
    parbake_metric::psnr_from_mse(parbake_metric::mean_squared_error(a, b).unwrap_or(f64::NAN))
}
