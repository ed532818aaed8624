//! The HTML report of a chain of levels of detail: one page that needs no other file and no network.
//!
//! ```text
//! original, levels ─ pictures ─┬ overview (all levels, where each is shown) ─┐
//!                              └ level (looks, figures, triangles, textures) ─┼ page
//! lods.json ─ tables, search (trials of a target, as plot and table) ─────────┘
//! ```
//!
//! Contract: as of a bake's report: the same for any number of threads, names escaped, no "NaN". `Watcher::stopped` is
//! not asked: who stopped a chain wants to see what came of it.

mod level;
mod overview;
mod pictures;
mod search;
#[cfg(test)]
mod tests;

use crate::page::document;
use crate::page::text::model_name;
use parbake::lod::document::LodDocument;
use parbake::{BakeError, LodOptions, Message, Stage, Watcher};
use parbake_model::Model;
use pictures::Gallery;

/// Draws a self-contained page about a chain: `levels` are the models of the document's levels.
///
/// Runs on rayon's current thread pool, for some seconds; the watcher is told of progress as [`Stage::Evaluate`] and
/// cannot stop it.
///
/// # Errors
/// An original without extent.
pub fn lod_report(
    original: &Model,
    document_of_chain: &LodDocument,
    levels: &[Model],
    options: &LodOptions,
    watcher: &dyn Watcher,
) -> Result<String, BakeError> {
    let chain = document_of_chain;
    let name = model_name(&chain.name);
    let gallery = Gallery::new(original, levels, options)?;
    let total = levels.len() + 1;
    let original_picture = gallery.original()?;
    watcher.message(Message::Progress { stage: Stage::Evaluate, done: 1, total });
    let mut sections = String::new();
    let mut thumbnails = Vec::new();
    for (index, (entry, model)) in chain.levels.iter().zip(levels).enumerate() {
        let looks = gallery.looks(index, entry.report.screen_size)?;
        sections += &level::level(chain, entry, model, &looks)?;
        thumbnails.push(looks.thumbnail);
        watcher.message(Message::Progress { stage: Stage::Evaluate, done: index + 2, total });
    }
    let body = overview::overview(&name, chain, options, &original_picture, &thumbnails) + &sections;
    Ok(document(&name, &body))
}
