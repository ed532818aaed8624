//! The HTML report of a comparison of two models, as `eval` makes it: one page that needs no other file and no network.
//!
//! ```text
//! models ─┬ views (those that differ most, the usual one, the best) ─ gallery ─┐
//!         └ channels of the front ─────────────────────────────────────────────┼ page
//! evaluation ─ headline, each view, tables ────────────────────────────────────┘
//! ```
//!
//! Contract: as of a bake's report: the same for any number of threads, names escaped, no "NaN". `Watcher::stopped` is
//! not asked, since drawing takes a bounded time.

mod page;
#[cfg(test)]
mod tests;
mod views;

use crate::html::channels::rows_of;
use crate::html::pictures::{PIXELS, front};
use parbake::{BakeError, Channel, EvaluateOptions, Evaluation, Message, Renderer, Stage, Watcher};
use parbake_model::Model;
use views::ShownView;

/// Draws a self-contained page about an evaluation of these two models: figures, pictures of the views in which they differ most, and
/// of each channel of whole materials.
///
/// Runs on rayon's current thread pool, for some seconds; the watcher is told of progress as [`Stage::Evaluate`] and
/// cannot stop it.
///
/// # Errors
/// An option of the evaluation out of range; a high-poly without extent.
pub fn evaluation_report(
    high: &Model,
    low: &Model,
    evaluation: &Evaluation,
    watcher: &dyn Watcher,
) -> Result<String, BakeError> {
    // Wide enough to look at, in a page of bounded size.
    let resolution = evaluation.options.resolution.min(PIXELS);
    let options = EvaluateOptions { resolution, shading: evaluation.shading, ..evaluation.options.clone() };
    let renderer = Renderer::new(high, &options)?;
    let placed = [high, low].map(|model| renderer.place(model));
    let chosen = views::chosen(&evaluation.views[..evaluation.views.len().min(options.views)]);
    let total = chosen.len() + 1;
    let mut shown: Vec<ShownView> = Vec::with_capacity(chosen.len());
    for view in &chosen {
        shown.push(views::shown(&renderer, &placed, &options, view)?);
        watcher.message(Message::Progress { stage: Stage::Evaluate, done: shown.len(), total });
    }
    let channels: Vec<Channel> = evaluation.channels.iter().map(|of| of.channel).collect();
    let rows = rows_of(&renderer, [&placed[0], &placed[1]], &front(&[&placed[0], &placed[1]]), &channels);
    watcher.message(Message::Progress { stage: Stage::Evaluate, done: total, total });
    drop(placed);
    page::page([high, low], evaluation, resolution, &shown, &rows)
}
