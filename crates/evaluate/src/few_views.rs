//! One figure for a model beside its original: mean PSNR over a few views and backgrounds, to choose between models.
//!
//! Contract: as of [`Renderer`]. Pictures of the original are kept: 16 bytes a pixel and view.

use crate::error::EvaluateError;
use crate::options::EvaluateOptions;
use crate::renderer::{RenderedView, Renderer};
use parbake_metric::{mean_squared_error, psnr_from_mse};
use parbake_model::Model;
use parbake_model::glam::Vec3;
use rayon::prelude::*;

/// Compares models with an original.
pub struct FewViews<'a> {
    renderer: Renderer,
    /// The original, seen from each direction.
    views: Vec<(Vec3, RenderedView)>,
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
        let directions = options.directions().into_par_iter();
        let views = directions.map(|direction| (direction, renderer.render(&original, direction))).collect();
        Ok(Self { renderer, views, backgrounds })
    }

    /// PSNR in dB, the mean over views and backgrounds.
    pub fn psnr(&self, model: &Model) -> f64 {
        let Self { renderer, views, backgrounds } = self;
        let placed = renderer.place(model);
        let of_view = |(direction, wanted): &(Vec3, RenderedView)| -> Vec<f64> {
            let own = renderer.render(&placed, *direction);
            let on = |behind: &[f32; 3]| {
                let [a, b] = [wanted, &own].map(|view| renderer.tonemap(view, *behind));
                psnr_from_mse(mean_squared_error(&a, &b).unwrap_or(f64::NAN))
            };
            backgrounds.iter().map(on).collect()
        };
        let figures: Vec<Vec<f64>> = views.par_iter().map(of_view).collect();
        figures.iter().flatten().sum::<f64>() / (backgrounds.len() * figures.len()) as f64
    }
}
