//! How close the textures come to the high-poly, in numbers, before and after.
//!
//! Contract: the same views, conventions and code as [`evaluate`](crate::evaluate()),
//! hence the same figures; but each view is rendered once for all backgrounds.

use super::scenes::Scenes;
use parbake::Convention;
use parbake::evaluate::options::EvaluateOptions;
use parbake::evaluate::{ViewFigures, compare, mean};
use parbake::studio::shown;
use parbake_model::glam::Vec3;
use parbake_render::camera::{Camera, fibonacci_sphere};
use parbake_render::shade::Lambert;
use rayon::prelude::*;

/// Views that are compared: enough for a mean, few enough that the page is there
/// within seconds (FLIP takes most of the time).
pub const VIEWS: usize = 8;

/// Backgrounds: name and linear light, as `evaluate` knows them. The first is the
/// one that `evaluate` takes unless told otherwise.
pub const BACKGROUNDS: [(&str, f32); 3] =
    [("black", 0.0), ("grey", parbake::evaluate::options::GREY), ("white", 1.0)];

/// Figures of one kind of texture before each of the [`BACKGROUNDS`].
pub type Figures = [ViewFigures; BACKGROUNDS.len()];

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
    /// The options with which `evaluate` gives the same figures on black.
    pub options: EvaluateOptions,
    /// Means over all views.
    pub mean: Comparison,
    /// Each view's.
    pub views: Vec<Comparison>,
}

/// The conventions of a comparison after this bake.
pub fn options(convention: Convention) -> EvaluateOptions {
    EvaluateOptions { views: VIEWS, convention, ..EvaluateOptions::default() }
}

/// Compares; `tick` is called after each view.
pub fn evaluated(scenes: &Scenes, convention: Convention, tick: impl Fn() + Sync) -> Evaluated {
    let options = options(convention);
    let views: Vec<Comparison> = fibonacci_sphere(options.views, 0.0)
        .into_par_iter()
        .map(|direction| {
            let view = view(scenes, &options, direction);
            tick();
            view
        })
        .collect();
    let mean = |of: fn(&Comparison) -> &Figures| {
        std::array::from_fn(|k| mean(&views.iter().map(|v| of(v)[k]).collect::<Vec<ViewFigures>>()))
    };
    let mean = Comparison { projected: mean(|v| &v.projected), baked: mean(|v| &v.baked) };
    Evaluated { options, mean, views }
}

fn view(scenes: &Scenes, options: &EvaluateOptions, direction: Vec3) -> Comparison {
    let camera = Camera::towards_origin(direction, options.radius, options.projection());
    let [high, projected, baked] = [&scenes.high, &scenes.projected, &scenes.baked]
        .map(|scene| scene.render(&Lambert, &camera, options.resolution, options.supersample));
    let pairs = BACKGROUNDS.map(|(_, level)| {
        let before = |picture| shown(picture, &scenes.display, [level; 3]);
        let high = before(&high);
        let figures = |low| compare(&high, &before(low), !options.no_flip);
        (figures(&projected), figures(&baked))
    });
    Comparison { projected: pairs.map(|p| p.0), baked: pairs.map(|p| p.1) }
}
