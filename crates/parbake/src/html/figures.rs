//! How close the textures come to the high-poly, in numbers, before and after.
//!
//! The same views, conventions and code as [`evaluate`](crate::evaluate()), but each
//! view is rendered once for both textures and all backgrounds.

use super::scenes::Scenes;
use crate::evaluate::{EvaluateOptions, ViewFigures, compare, shown};
use crate::options::Convention;
use parbake_metric::{Rgb, mean_squared_error, psnr_from_mse};
use parbake_model::glam::Vec3;
use parbake_render::camera::{Camera, fibonacci_sphere};
use parbake_render::scene::Picture;
use parbake_render::shade::Lambert;
use rayon::prelude::*;

/// Views that are compared.
pub const VIEWS: usize = 12;

/// Backgrounds besides black: name and linear light, as `evaluate` knows them.
pub const OTHER_BACKGROUNDS: [(&str, f32); 2] = [("grey", 0.5), ("white", 1.0)];

/// Figures of one kind of texture.
#[derive(Clone, Copy, Debug)]
pub struct Figures {
    /// All of them, before black.
    pub on_black: ViewFigures,
    /// Decibels before the other backgrounds.
    pub psnr: [f64; OTHER_BACKGROUNDS.len()],
}

/// Figures of one view, or of all.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    /// Of the projected textures.
    pub projected: Figures,
    /// Of the baked ones.
    pub baked: Figures,
}

/// What was compared.
pub struct Evaluated {
    /// The options with which `evaluate` gives the same figures.
    pub options: EvaluateOptions,
    /// Means over all views.
    pub mean: Comparison,
    /// Each view's.
    pub views: Vec<Comparison>,
}

/// The conventions of a comparison after this bake.
pub fn options(convention: Convention) -> EvaluateOptions {
    EvaluateOptions {
        views: VIEWS,
        gain: convention.display().gain,
        decode_srgb: convention.decodes_srgb(),
        ..EvaluateOptions::default()
    }
}

/// Compares; `tick` is called after each view. None when `stopped` said so.
pub fn evaluated(
    scenes: &Scenes,
    convention: Convention,
    stopped: impl Fn() -> bool + Sync,
    tick: impl Fn() + Sync,
) -> Option<Evaluated> {
    let options = options(convention);
    let views: Vec<Comparison> = fibonacci_sphere(options.views, 0.0)
        .into_par_iter()
        .map(|direction| {
            let view = (!stopped()).then(|| view(scenes, &options, direction));
            tick();
            view
        })
        .collect::<Option<_>>()?;
    let mean = Comparison { projected: mean(&views, |v| v.projected), baked: mean(&views, |v| v.baked) };
    Some(Evaluated { options, mean, views })
}

fn view(scenes: &Scenes, options: &EvaluateOptions, direction: Vec3) -> Comparison {
    let camera = Camera::towards_origin(direction, options.radius, options.projection());
    let [high, projected, baked] = [&scenes.high, &scenes.projected, &scenes.baked]
        .map(|scene| scene.render(&Lambert, &camera, options.resolution, options.supersample));
    let before = |picture: &Picture, level: f32| shown(picture, &scenes.display, [level; 3]);
    let black = before(&high, 0.0);
    let others = OTHER_BACKGROUNDS.map(|(_, level)| (level, before(&high, level)));
    let figures = |low: &Picture| Figures {
        on_black: compare(&black, &before(low, 0.0), true),
        psnr: [0, 1].map(|i: usize| {
            let (level, ref high): (f32, Rgb) = others[i];
            psnr_from_mse(mean_squared_error(high, &before(low, level)).unwrap_or(f64::NAN))
        }),
    };
    Comparison { projected: figures(&projected), baked: figures(&baked) }
}

fn mean(views: &[Comparison], of: impl Fn(&Comparison) -> Figures) -> Figures {
    let all: Vec<Figures> = views.iter().map(of).collect();
    let on_black: Vec<ViewFigures> = all.iter().map(|f| f.on_black).collect();
    let count = all.len().max(1) as f64;
    Figures {
        on_black: crate::evaluate::mean(&on_black),
        psnr: [0, 1].map(|i: usize| all.iter().map(|f| f.psnr[i]).sum::<f64>() / count),
    }
}
