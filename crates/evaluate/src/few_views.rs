//! One figure for a model beside its original: mean PSNR over a few views and backgrounds, to choose between models.
//!
//! Contract: as of [`Renderer`]; the original is rendered anew each time, so that nothing has to be kept.

use crate::error::EvaluateError;
use crate::options::EvaluateOptions;
use crate::renderer::{PlacedModel, Renderer};
use parbake_metric::{mean_squared_error, psnr_from_mse};
use parbake_model::Model;
use parbake_model::glam::Vec3;
use parbake_render::camera::fibonacci_sphere;
use rayon::prelude::*;

/// Compares models with an original.
pub struct FewViews<'a> {
    renderer: Renderer,
    directions: Vec<Vec3>,
    original: PlacedModel,
    backgrounds: &'a [[f32; 3]],
}

impl<'a> FewViews<'a> {
    /// As many views as `options` say, each on all `backgrounds`, which are in linear light.
    ///
    /// # Errors
    /// As of [`Renderer::new`].
    pub fn new(
        original: &Model,
        options: &EvaluateOptions,
        backgrounds: &'a [[f32; 3]],
    ) -> Result<Self, EvaluateError> {
        let renderer = Renderer::new(original, options)?;
        let original = renderer.place(original);
        Ok(Self { renderer, directions: fibonacci_sphere(options.views, 0.0), original, backgrounds })
    }

    /// PSNR in dB, the mean over views and backgrounds.
    pub fn psnr(&self, model: &Model) -> f64 {
        let Self { renderer, directions, original, backgrounds } = self;
        let placed = renderer.place(model);
        let of_view = |&direction: &Vec3| -> Vec<f64> {
            let views = [original, &placed].map(|model| renderer.render(model, direction));
            let on = |behind: &[f32; 3]| {
                let [a, b] = [0, 1].map(|k: usize| renderer.tonemap(&views[k], *behind));
                psnr_from_mse(mean_squared_error(&a, &b).unwrap_or(f64::NAN))
            };
            backgrounds.iter().map(on).collect()
        };
        let figures: Vec<Vec<f64>> = directions.par_iter().map(of_view).collect();
        figures.iter().flatten().sum::<f64>() / (backgrounds.len() * figures.len()) as f64
    }
}
