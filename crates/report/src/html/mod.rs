//! The HTML report of a bake: one page that needs no other file and no network.
//!
//! ```text
//! models ─┬──────── figures ─ tables, view_chart ───┐
//!         └ scenes ┬ pictures ─ gallery ─────────────┤
//!                  └ channels ───────────────────────┤
//! report ─ loss_curve, tables, settings ─────────────┼─ page
//! textures ─ uv_layout, textures, uv_check, uv_moves ─┤
//! baked model ─ model_view ──────────────────────────┘
//! ```
//!
//! `variants.rs` is a page of its own, about a comparison of parallax variants.
//!
//! Contract: the page does not depend on the number of threads; all that comes from
//! models and options is escaped; no "NaN" stands on it. `Watcher::stopped` is not
//! asked: whoever stopped a bake wants to see what came of it, the more so, and
//! drawing takes a bounded time, which depends on the models' sizes only.

pub(crate) mod channels;
mod figures;
pub(crate) mod gallery;
mod loss_curve;
mod model_view;
pub(crate) mod page;
pub(crate) mod pictures;
mod scenes;
mod settings;
mod tables;
#[cfg(test)]
mod tests;
pub(crate) mod textures;
mod uv_check;
mod uv_moves;
mod view_chart;

pub use settings::flags;

use parbake::BakeError;
use parbake::Baked;
use parbake::{Message, Stage, Watcher, compared_as};
use parbake_model::Model;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Draws a self-contained page about a bake of `high`: pictures of four sides,
/// figures before and after, textures, times and settings.
///
/// Runs on rayon's current thread pool, for some seconds; the watcher is told of
/// progress as [`Stage::Evaluate`] and cannot stop it.
pub fn html_report(high: &Model, baked: &Baked, watcher: &dyn Watcher) -> Result<String, BakeError> {
    let (done, total) = (AtomicUsize::new(0), compared_as(&baked.report.options).views + pictures::SIDES);
    let tick = || {
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        watcher.message(Message::Progress { stage: Stage::Evaluate, done, total });
    };
    let scenes = scenes::Scenes::new(high, baked)?;
    let compared = figures::compared(high, baked, tick)?;
    let sides = pictures::sides(&scenes, tick);
    let channels = channels::rows(&scenes, &compared);
    drop(scenes);
    page::page(high, baked, &compared, &sides, &channels)
}
