//! Where a level may take the place of the one before: the largest size on screen at which nobody can tell the two,
//! found by rendering both at that size.
//!
//! Both are rendered from some directions as viewers show them: whole materials under the built-in light, 2 × 2 samples
//! a pixel, each shaded, on the grey 128 of 255, or on what is asked for. The figure is the PSNR over whole pictures in which the model's longest
//! side spans five sevenths of the width, the mean over the directions. Sizes are tried in steps of a fifth from the one
//! that the level was made for; the largest that passes before one does not counts.
//!
//! Contract: deterministic, and the same for the same models, whatever the bake was.

use crate::conventions::Shading;
use crate::error::EvaluateError;
use crate::figures::{self, Metrics};
use crate::options::EvaluateOptions;
use crate::renderer::{PlacedModel, Renderer};
use parbake_metric::Rgb;
use parbake_model::Model;
use parbake_model::glam::Vec3;
use parbake_render::camera::fibonacci_sphere;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Directions that models are seen from.
const VIEWS: usize = 6;
/// The same in small pictures, in which edges that fall between samples make a difference by luck.
const VIEWS_OF_FEW_PIXELS: usize = 16;
/// Pixels below which pictures are small.
const FEW_PIXELS: f64 = 150.0;
/// Samples along a side of a pixel, each shaded.
const SAMPLES: usize = 2;
/// The grey that viewers show as the number 128 of 255, in linear light.
const GREY: &[[f32; 3]] = &[[0.2159; 3]];
/// Black and white: whatever colour a model has, its outline shows before one of both.
pub const BLACK_AND_WHITE: &[[f32; 3]] = &[[0.0; 3], [1.0; 3]];
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

/// A model's pictures at one size.
pub struct Pictures {
    renderer: Renderer,
    pixels: f64,
    backgrounds: &'static [[f32; 3]],
    /// For each direction one on each background.
    views: Vec<Vec<Rgb>>,
}

/// A model beside another one's pictures.
pub struct Compared {
    /// PSNR in dB, the mean over the pictures.
    pub psnr: f64,
    /// For each direction the squared difference of display values, 0 to 1, at each pixel, row 0 on top: the mean over channels and
    /// backgrounds.
    pub errors: Vec<Vec<f32>>,
}

/// Compares models at sizes on screen, as viewers show them, in the frame of the original.
pub struct ScreenComparison {
    original: Arc<Model>,
}

impl ScreenComparison {
    /// In the original's frame.
    pub fn new(original: &Model) -> Self {
        Self { original: Arc::new(original.clone()) }
    }

    fn renderer(&self, pixels: f64) -> Result<Renderer, EvaluateError> {
        let resolution = (PICTURE * pixels).round().max(16.0) as usize;
        let shading = Shading::Pbr;
        let options =
            EvaluateOptions { resolution, supersample: SAMPLES, shading, ..EvaluateOptions::default() };
        Ok(Renderer::new(&self.original, &options)?.as_viewers_do())
    }

    /// Makes a model ready for pictures.
    ///
    /// # Errors
    /// Where the original has no extent.
    pub fn place(&self, model: &Model) -> Result<PlacedModel, EvaluateError> {
        Ok(self.renderer(SIZES[0])?.place(model))
    }

    /// The same for a model that has the materials and images of one that is ready: in less time.
    ///
    /// # Errors
    /// Where the original has no extent.
    pub fn place_like(&self, model: &Model, placed: &PlacedModel) -> Result<PlacedModel, EvaluateError> {
        Ok(self.renderer(SIZES[0])?.place_like(model, placed))
    }

    /// Takes a model's pictures at a size, on grey, to compare any number of others with.
    ///
    /// # Errors
    /// Where the original has no extent.
    pub fn pictures(&self, model: &PlacedModel, pixels: f64) -> Result<Pictures, EvaluateError> {
        self.pictures_on(model, pixels, GREY)
    }

    /// The same on other backgrounds, at least one, in linear light: figures are then means over these.
    ///
    /// # Errors
    /// Where the original has no extent.
    pub fn pictures_on(
        &self,
        model: &PlacedModel,
        pixels: f64,
        backgrounds: &'static [[f32; 3]],
    ) -> Result<Pictures, EvaluateError> {
        let mut pictures =
            Pictures { renderer: self.renderer(pixels)?, pixels, backgrounds, views: Vec::new() };
        let directions = directions(pixels).into_par_iter();
        pictures.views = directions.map(|direction| pictures.taken(model, direction)).collect();
        Ok(pictures)
    }

    /// PSNR in dB of a model against another one's pictures: on grey that of [`ScreenComparison::compare`].
    pub fn psnr(&self, pictures: &Pictures, model: &PlacedModel) -> f64 {
        self.compared(pictures, model).psnr
    }

    /// The same from some of the directions, which together see every side: enough to compare maps of one surface.
    pub fn psnr_of_some(&self, pictures: &Pictures, model: &PlacedModel) -> f64 {
        let count = pictures.views.len();
        let some: Vec<_> = pictures.seen_from().enumerate().filter(|(k, _)| is_of_some(*k, count)).collect();
        let own = |(_, (direction, others)): &(usize, (Vec3, &Vec<Rgb>))| {
            mean_psnr(others, &pictures.taken(model, *direction))
        };
        let figures: Vec<f64> = some.par_iter().map(own).collect();
        figures.iter().sum::<f64>() / figures.len() as f64
    }

    /// PSNR in dB as [`ScreenComparison::psnr`], with the errors of all pixels.
    pub fn compared(&self, pictures: &Pictures, model: &PlacedModel) -> Compared {
        let own = |(direction, others): (Vec3, &Vec<Rgb>)| {
            let own = pictures.taken(model, direction);
            (mean_psnr(others, &own), squared_differences(others, &own))
        };
        let (figures, errors): (Vec<f64>, Vec<_>) = pictures.seen_from().map(own).unzip();
        Compared { psnr: figures.iter().sum::<f64>() / figures.len() as f64, errors }
    }

    /// Compares two models at a size.
    ///
    /// # Errors
    /// Where the original has no extent.
    pub fn compare(&self, a: &PlacedModel, b: &PlacedModel, pixels: f64) -> Result<AtSize, EvaluateError> {
        let pictures = self.pictures(a, pixels)?;
        let own = |(direction, others): (Vec3, &Vec<Rgb>)| -> Vec<_> {
            let own = pictures.taken(b, direction);
            others.iter().zip(own).map(|(other, own)| figures::compare(other, &own, Metrics::ALL)).collect()
        };
        let views: Vec<_> = pictures.seen_from().flat_map_iter(own).collect();
        let mean = figures::mean(&views);
        Ok(AtSize { pixels, psnr: mean.psnr, ms_ssim: mean.ms_ssim, flip: mean.flip })
    }

    /// The largest size, in steps of a fifth from `start` on, at which `level` agrees with all of `others` by `same` decibels, before one at
    /// which it does not; none where it does not even at the least size. Large levels that agree at the largest size are taken to
    /// agree at those before: differences show less the smaller they are.
    ///
    /// # Errors
    /// Where the original has no extent.
    pub fn largest_same(
        &self,
        level: &PlacedModel,
        others: &[&PlacedModel],
        start: f64,
        same: f64,
    ) -> Result<Option<f64>, EvaluateError> {
        let passes = |pixels: f64| -> Result<bool, EvaluateError> {
            let pictures = self.pictures(level, pixels)?;
            Ok(others.iter().all(|other| self.psnr(&pictures, other) >= same))
        };
        let start = start.clamp(SIZES[0], SIZES[1]);
        let sizes = |step: f64, most: usize| {
            let next =
                move |pixels: &f64| Some(pixels * step).filter(|next| (SIZES[0]..=SIZES[1]).contains(next));
            std::iter::successors(Some(start), next).skip(1).take(most)
        };
        if !passes(start)? {
            for pixels in sizes(1.0 / STEP, MOST_STEPS[1]) {
                if passes(pixels)? {
                    return Ok(Some(pixels));
                }
            }
            return Ok(None);
        }
        let mut larger: Vec<f64> = sizes(STEP, MOST_STEPS[0]).collect();
        // Small sizes take little time, and pictures from other directions begin among them.
        if start >= FEW_PIXELS
            && let Some(largest) = larger.pop()
            && passes(largest)?
        {
            return Ok(Some(largest));
        }
        let mut most = start;
        for pixels in larger {
            if !passes(pixels)? {
                break;
            }
            most = pixels;
        }
        Ok(Some(most))
    }
}

impl Pictures {
    /// A model as it is seen from a direction, on each background.
    fn taken(&self, model: &PlacedModel, direction: Vec3) -> Vec<Rgb> {
        let view = self.renderer.render(model, direction);
        self.backgrounds.iter().map(|&background| self.renderer.tonemap(&view, background)).collect()
    }

    /// The pictures, each with the direction that it was taken from.
    fn seen_from(&self) -> impl IndexedParallelIterator<Item = (Vec3, &Vec<Rgb>)> {
        self.directions().into_par_iter().zip(&self.views)
    }

    /// The directions that they were taken from.
    pub(crate) fn directions(&self) -> Vec<Vec3> {
        directions(self.pixels)
    }

    /// What took them.
    pub(crate) fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// Pixels along a side of each.
    pub(crate) fn size(&self) -> usize {
        self.renderer.size().0
    }
}

/// Directions from which a model of so many pixels is seen.
fn directions(pixels: f64) -> Vec<Vec3> {
    fibonacci_sphere(if pixels < FEW_PIXELS { VIEWS_OF_FEW_PIXELS } else { VIEWS }, 0.0)
}

/// Whether a direction is one of some: every other one, and of six one more, without which a side would not be seen.
fn is_of_some(direction: usize, count: usize) -> bool {
    direction.is_multiple_of(2) || direction == count / 2
}

/// The squared differences at each pixel, the mean over channels and over pairs of pictures.
fn squared_differences(some: &[Rgb], others: &[Rgb]) -> Vec<f32> {
    let mut sums = vec![0.0; some.first().map_or(0, |picture| picture.pixels.len())];
    for (a, b) in some.iter().zip(others) {
        for ((sum, a), b) in sums.iter_mut().zip(&a.pixels).zip(&b.pixels) {
            *sum += a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
        }
    }
    let count = 3.0 * some.len() as f32;
    sums.iter_mut().for_each(|sum| *sum /= count);
    sums
}

/// PSNR in dB, the mean over pairs of pictures.
fn mean_psnr(some: &[Rgb], others: &[Rgb]) -> f64 {
    let psnr = |(a, b): (&Rgb, &Rgb)| {
        parbake_metric::psnr_from_mse(parbake_metric::mean_squared_error(a, b).unwrap_or(f64::NAN))
    };
    some.iter().zip(others).map(psnr).sum::<f64>() / others.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects maps that show on one side alone, such as a label in front: each side is seen from one of the directions by which maps
    /// are compared, from where cameras stand.
    #[test]
    fn some_directions_see_every_side() {
        for pixels in [100.0, 300.0] {
            let all = directions(pixels);
            let some = || (0..all.len()).filter(|&k| is_of_some(k, all.len())).map(|k| all[k]);
            for side in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
                assert!(some().any(|direction| direction.dot(side) > 1.0 / 3.5), "{side} of {pixels}");
            }
            assert!(some().count() < all.len());
        }
    }
}
