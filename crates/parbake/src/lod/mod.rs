//! A chain of levels of detail from one model, from fine to coarse.
//!
//! ```text
//! model ─ HighPoly (once) ─┬ triangles (low_poly.rs) ─ bake ─ level ─ figures, switch (evaluate/screen_size.rs) ─┐
//!                          └ … the next level may start from the triangles of this one ◁───────────┘
//! ```
//!
//! `ways.rs` makes a level in several ways and takes the best (`delivered.rs`: those that keep the model's layout).
//! `target.rs` makes a level of several bakes where a PSNR is asked for; `maker.rs` has the steps of both, `chain.rs` is
//! progress and time.
//!
//! Each level is made for a size on screen. From that follow how far its surface may be off, hence its triangles, and
//! how many texels it needs.
//!
//! Contract: levels have fewer and fewer triangles. Each is finished before the next one begins, and handed over;
//! a chain that is stopped keeps those that are finished. Deterministic.

mod candidate;
pub(crate) mod chain;
mod delivered;
pub mod document;
pub mod layout;
mod level;
mod maker;
pub mod options;
mod picture_score;
mod scaled;
pub mod target;
mod ways;
mod written;

use crate::error::BakeError;
pub use candidate::{Candidate, Way};
use chain::Chain;
pub use level::{Level, LevelReport};
use maker::{Draft, Maker, largest_texture, texels_of};
use options::LodOptions;
use parbake_evaluate::renderer::PlacedModel;
use parbake_levels::face_frames::with_face_tangents;
pub use parbake_levels::search;
use parbake_mesh::parts::{draw_calls, part_reports, with_kept_parts, with_parted_materials};
use parbake_model::Model;
use parbake_progress::{Message, Watcher};
use parbake_views::alpha_in_effect::with_alpha_in_effect;
use std::borrow::Cow;
use std::time::Instant;
use written::as_written;

/// Makes the levels of a model one by one and hands each over as soon as it is finished. Returns how many there are:
/// fewer than asked for where the watcher said stop, or where a level would have no fewer triangles than the one
/// before.
///
/// # Errors
/// An option out of range; a model without extent; parts that are not there, or too many for so few triangles; what
/// `on_level` returns.
pub fn make_levels<E: From<BakeError>>(
    model: &Model,
    options: &LodOptions,
    watcher: &dyn Watcher,
    mut on_level: impl FnMut(Level) -> Result<(), E>,
) -> Result<usize, E> {
    options.check()?;
    let start = Instant::now();
    let kept = with_kept_parts(model, &options.keep_parts).map_err(BakeError::from)?;
    let parted = with_parted_materials(&kept);
    let model = &*with_settled_alpha(&parted, watcher);
    let maker = Maker::new(model, options)?;
    let sizes = (0..options.screen_size.len())
        .map(|level| (maker.wanted[level], maker.texture_size(model, options.screen_size[level])));
    let mut chain = Chain::new(watcher, start, options, &sizes.collect::<Vec<_>>());
    let mut before: Option<(Model, PlacedModel)> = None;
    let mut count = 0;
    for index in 0..options.screen_size.len() {
        let finer = before.as_ref().map(|(low, _)| low);
        let made = match options.target_psnr {
            Some(target) => target::find(&maker, &mut chain, index, finer, target)?
                .map(|found| (found.draft, found.write, Some(found.report))),
            None => {
                let most = finer.map_or(maker.high.triangles, |low| low.mesh.triangles.len());
                let (wanted, until) = (maker.wanted[index].min(most), chain.level_until(index));
                let draft = ways::draft(&maker, &mut chain, index, finer, wanted, until)?;
                draft.map(|draft| (draft, options.write, None))
            }
        };
        let Some((draft, write, target)) = made else { break };
        let begin = Instant::now();
        let written = as_written(&draft.baked.model, &write, options.normal_y)?.model;
        let placed = maker.screens.place(&with_face_tangents(&written)).map_err(BakeError::from)?;
        let figures = maker.figures(index, &placed, before.as_ref().map(|(_, placed)| placed))?;
        let Draft { low, layers, baked, way, candidates, seconds: [chosen, fitted, compared] } = draft;
        let mip = baked.report.options.smallest_mip.unwrap_or(0.0);
        let gutter = baked.report.uv.gutter.as_ref().map(|gutter| (gutter.texels, mip));
        let report = LevelReport {
            level: index,
            screen_size: options.screen_size[index],
            triangles: baked.model.mesh.triangles.len(),
            texture_size: largest_texture(&baked.model),
            texels: texels_of(&baked.model),
            gutter: gutter.map(|(texels, _)| texels),
            smallest_gutter: gutter.map(|(texels, mip)| texels / mip.exp2()),
            draw_calls: draw_calls(&baked.model),
            parts: part_reports(&baked.model),
            way,
            candidates,
            low_poly: layers,
            at_screen_size: figures.at_screen_size,
            switch_pixels: figures.switch_pixels,
            switch_coverage: figures.switch_pixels.map(|pixels| (pixels / options.viewport_height).min(1.0)),
            against_before: figures.against_before,
            target,
            stopped_early: baked.report.stopped_early,
            seconds: [chosen, fitted, compared + begin.elapsed().as_secs_f64()],
        };
        before = Some((low, placed));
        count += 1;
        on_level(Level { baked, write, report })?;
    }
    Ok(count)
}

/// The model with the alpha modes that have an effect; levels that keep its materials have them, too.
fn with_settled_alpha<'a>(model: &'a Model, watcher: &dyn Watcher) -> Cow<'a, Model> {
    let (materials, told) = with_alpha_in_effect(model);
    let Some(told) = told else { return Cow::Borrowed(model) };
    watcher.message(Message::Warning(format!("{}: {told}", model.name)));
    Cow::Owned(Model { materials: materials.into_owned(), ..model.clone() })
}
