//! How much closer a bake comes to the high-poly than a ray-cast bake does: the figures that the terminal,
//! the HTML report and the JSON report show.
//!
//! Contract: the views, conventions and code of [`evaluate`](crate::evaluate()), hence the figures that
//! `eval HIGH BAKED --views 8` (4 after `fast`) gives under the convention and the shading of the bake.

use crate::bake::Baked;
pub use crate::comparison_figures::{BACKGROUNDS, BeforeAndAfter, Comparison, OnBackground, OnChannel};
use crate::error::BakeError;
use crate::options::{BakeOptions, Preset};
use parbake_evaluate::channels::Channel;
pub use parbake_evaluate::evaluate::Detail;
use parbake_evaluate::evaluate::{Compared, ComparedView, evaluate_each};
use parbake_evaluate::figures::{ViewFigures, mean};
use parbake_evaluate::options::EvaluateOptions;
use parbake_model::Model;
use parbake_progress::Watcher;

/// Views that are compared: enough for a mean, few enough that it takes seconds.
const COMPARED_VIEWS: usize = 8;
/// The same after a bake by [`Preset::Fast`], which would otherwise take a fifth of its time for this.
const FEW_COMPARED_VIEWS: usize = 4;

/// The conventions of a comparison after a bake with these options.
pub fn compared_as(options: &BakeOptions) -> EvaluateOptions {
    EvaluateOptions {
        views: match options.preset {
            Preset::Fast => FEW_COMPARED_VIEWS,
            _ => COMPARED_VIEWS,
        },
        convention: options.convention,
        shading: options.shading,
        ..EvaluateOptions::default()
    }
}

/// Compares both models of a bake with the high-poly, under the convention and the shading of the bake. Runs on
/// rayon's current thread pool; the watcher is told of progress as
/// [`Stage::Evaluate`](crate::Stage::Evaluate) and cannot stop it.
///
/// # Errors
/// A high-poly without extent.
pub fn compare_bake(
    high: &Model,
    baked: &Baked,
    detail: Detail,
    watcher: &dyn Watcher,
) -> Result<Comparison, BakeError> {
    let options = EvaluateOptions { no_flip: !detail.metrics.flip, ..compared_as(&baked.report.options) };
    let both = [&baked.ray_cast, &baked.model];
    let Compared { shading, channels, views } =
        evaluate_each(high, &both, &options, &BACKGROUNDS, detail, watcher)?;
    let mean_of = |pairs: &[BeforeAndAfter]| {
        let of = |one: fn(&BeforeAndAfter) -> ViewFigures| mean(&pairs.iter().map(one).collect::<Vec<_>>());
        BeforeAndAfter { ray_cast: of(|p| p.ray_cast), baked: of(|p| p.baked) }
    };
    let of = |k: usize| {
        let pairs =
            views.iter().map(|view| BeforeAndAfter { ray_cast: view.seen[0][k], baked: view.seen[1][k] });
        let pairs: Vec<BeforeAndAfter> = pairs.collect();
        OnBackground { background: BACKGROUNDS[k].into(), mean: mean_of(&pairs), views: pairs }
    };
    let of_channel = |(k, &channel): (usize, &Channel)| {
        let pair = |view: &ComparedView| BeforeAndAfter {
            ray_cast: view.channels[0][k],
            baked: view.channels[1][k],
        };
        OnChannel { channel, mean: mean_of(&views.iter().map(pair).collect::<Vec<_>>()) }
    };
    let channels = channels.iter().enumerate().map(of_channel).collect();
    Ok(Comparison { backgrounds: (0..BACKGROUNDS.len()).map(of).collect(), options, shading, channels })
}
