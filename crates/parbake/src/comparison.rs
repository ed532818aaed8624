//! How much closer a bake comes to the high-poly than a ray-cast bake does: the figures that the terminal,
//! the HTML report and the JSON report show.
//!
//! Contract: the views, conventions and code of [`evaluate`](crate::evaluate()), hence the figures that
//! `eval HIGH BAKED --views 8` gives under the convention of the bake.

use crate::bake::Baked;
use crate::error::BakeError;
use crate::evaluate::options::EvaluateOptions;
use crate::evaluate::{ViewFigures, evaluate_each, mean};
use crate::options::Convention;
use parbake_model::Model;
use parbake_progress::Watcher;
use serde::{Deserialize, Serialize};

/// Views that are compared: enough for a mean, few enough that it takes seconds.
pub const COMPARED_VIEWS: usize = 8;

/// What lies behind the models, as `evaluate` knows it; the first is its default.
pub const BACKGROUNDS: [&str; 3] = ["black", "grey", "white"];

/// Figures of both models.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeforeAndAfter {
    /// Of [`Baked::ray_cast`].
    pub ray_cast: ViewFigures,
    /// Of [`Baked::model`].
    pub baked: ViewFigures,
}

/// Figures of both models on one background.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OnBackground {
    /// Its name, one of [`BACKGROUNDS`].
    pub background: String,
    /// Means over the views.
    pub mean: BeforeAndAfter,
    /// Each view's figures.
    pub views: Vec<BeforeAndAfter>,
}

/// Figures of a bake and of the ray-cast bake of the same pair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The options with which `evaluate` gives the same figures on the first background.
    pub options: EvaluateOptions,
    /// One for each of [`BACKGROUNDS`], in their order.
    pub backgrounds: Vec<OnBackground>,
}

/// The conventions of a comparison after a bake of this convention.
pub fn compared_as(convention: Convention) -> EvaluateOptions {
    EvaluateOptions { views: COMPARED_VIEWS, convention, ..EvaluateOptions::default() }
}

/// Compares both models of a bake with the high-poly, under the convention of the bake. FLIP takes most of
/// the time. Runs on rayon's current thread pool; the watcher is told of progress as
/// [`Stage::Evaluate`](crate::Stage::Evaluate) and cannot stop it.
///
/// # Errors
/// A high-poly without extent.
pub fn compare_bake(
    high: &Model,
    baked: &Baked,
    with_flip: bool,
    watcher: &dyn Watcher,
) -> Result<Comparison, BakeError> {
    let options = EvaluateOptions { no_flip: !with_flip, ..compared_as(baked.report.options.convention) };
    let views = evaluate_each(high, &[&baked.ray_cast, &baked.model], &options, &BACKGROUNDS, watcher)?;
    let of = |k: usize| {
        let pairs = views.iter().map(|view| BeforeAndAfter { ray_cast: view[0][k], baked: view[1][k] });
        let pairs: Vec<BeforeAndAfter> = pairs.collect();
        let mean_of =
            |one: fn(&BeforeAndAfter) -> ViewFigures| mean(&pairs.iter().map(one).collect::<Vec<_>>());
        let mean = BeforeAndAfter { ray_cast: mean_of(|p| p.ray_cast), baked: mean_of(|p| p.baked) };
        OnBackground { background: BACKGROUNDS[k].into(), mean, views: pairs }
    };
    Ok(Comparison { backgrounds: (0..BACKGROUNDS.len()).map(of).collect(), options })
}
