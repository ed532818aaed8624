//! What a level may keep of its model, without a bake: fewer of its own vertices, its layout, and its own maps with fewer texels.
//!
//! Nothing here depends on the level before, so it may be made while that one is baked (`mod.rs`).
//!
//! Contract: a watcher that says stop is heeded between pictures, and so is the end of a share of a time budget; what was measured
//! until then counts.

use super::delivered::{Coarser, coarser, may_keep_vertices};
use super::maker::Maker;
use super::picture_score::{PictureScore, Tried};
use super::scaled::{scaled, scaled_draft};
use crate::error::BakeError;
use parbake_levels::screen::texels_of;
use parbake_progress::Watcher;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Share of a level's time budget for collapses and scaled maps.
const TRYING: f64 = 0.2;

/// What a level may keep, and the pictures by which all of its ways are compared.
pub(crate) struct OwnVertices<'m> {
    /// The most triangles that it may have.
    pub triangles: usize,
    pub score: PictureScore<'m>,
    /// Fewer vertices; none where an option says where triangles go, or where seams leave too many.
    pub coarser: Option<Coarser>,
    /// With the model's own maps; none where these cannot be moved.
    pub scaled: Option<Tried>,
    /// Whether there was too little time for all that might have been tried.
    pub is_cut: bool,
    /// That finding all this took.
    pub seconds: f64,
}

/// What a level of at most so many triangles may keep, found within a share of the time until `until`; none where there is nothing
/// to compare a new layout with.
pub(crate) fn own_vertices<'m>(
    maker: &'m Maker<'m>,
    level: usize,
    triangles: usize,
    until: Option<Instant>,
    watcher: &dyn Watcher,
) -> Result<Option<OwnVertices<'m>>, BakeError> {
    let begin = Instant::now();
    let keeps = may_keep_vertices(maker);
    // One bake, whose maps cannot grow either.
    if !keeps && (until.is_some() || texels_of(maker.model) == 0) {
        return Ok(None);
    }
    let score = PictureScore::new(maker, maker.options.screen_size[level])?;
    let enough = until.map(|until| begin + until.saturating_duration_since(begin).mul_f64(TRYING));
    let is_cut = AtomicBool::new(false);
    let is_over = || {
        let is_over = watcher.stopped() || enough.is_some_and(|enough| Instant::now() > enough);
        is_cut.fetch_or(is_over, Ordering::Relaxed);
        is_over
    };
    let side = maker.texels_along(maker.model, maker.options.screen_size[level]);
    let coarser = match keeps {
        true => coarser(maker, &score, triangles, side, until.is_none(), &is_over)?,
        false => None,
    };
    let model = coarser.as_ref().map(|own| scaled(maker, &score, own, side, &is_over)).transpose()?.flatten();
    let scaled = model.map(|model| {
        score.tried(scaled_draft(maker, level, model, side, [begin.elapsed().as_secs_f64(), 0.0, 0.0]))
    });
    let scaled = scaled.transpose()?;
    let is_cut = is_cut.load(Ordering::Relaxed);
    Ok(Some(OwnVertices {
        triangles,
        score,
        coarser,
        scaled,
        is_cut,
        seconds: begin.elapsed().as_secs_f64(),
    }))
}
