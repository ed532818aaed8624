//! A chain of levels of detail from one model, from fine to coarse.
//!
//! ```text
//! model ─ HighPoly (once) ─┬ triangles (low_poly.rs) ─ bake ─ level ─ figures, switch (switch.rs) ─┐
//!                          └ … the next level may start from the triangles of this one ◁───────────┘
//! ```
//!
//! Each level is made for a size on screen. From that follow how far its surface may be off, hence its triangles, and
//! how many texels it needs.
//!
//! Contract: levels have fewer and fewer triangles. Each is finished before the next one begins, and handed over;
//! a chain that is stopped keeps those that are finished. Deterministic.

pub mod document;
pub mod layout;
pub mod options;
pub mod switch;

use crate::bake::{Baked, bake_as, prepare_high_poly};
use crate::error::BakeError;
use crate::low_poly::low_poly;
use crate::report::Work;
use crate::rigs::with_parted_materials;
use options::LodOptions;
use parbake_model::Model;
use parbake_progress::Watcher;
use parbake_simplify::LayerReport;
use parbake_simplify::start::triangles_within;
use parbake_views::high_poly::HighPoly;
use serde::{Deserialize, Serialize};
use switch::{AtSize, Lineup};

/// A finished level.
#[derive(Clone, Debug)]
pub struct Level {
    /// The bake, with the model.
    pub baked: Baked,
    /// What there is to say of it.
    pub report: LevelReport,
}

/// What `lods.json` holds of a level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelReport {
    /// Its place in the chain; 0 is the finest.
    pub level: usize,
    /// Pixels that it was made for.
    pub screen_size: f64,
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side of its textures.
    pub texture_size: usize,
    /// Texels of all its textures.
    pub texels: usize,
    /// Draw calls: one for each material.
    pub draw_calls: usize,
    /// How the triangles of each layer (opaque, cut out, blended, transmitting) were found.
    pub low_poly: Vec<LayerReport>,
    /// Against the original, at the size that it was made for.
    pub at_screen_size: AtSize,
    /// Pixels that the model spans below which this level cannot be told from the one before, nor from the
    /// original; none where it always can.
    pub switch_pixels: Option<f64>,
    /// The same as a share of the screen's height.
    pub switch_coverage: Option<f64>,
    /// Against the level before (the original for the first), at that size.
    pub against_before: Option<AtSize>,
    /// Seconds that triangles, bake and figures took.
    pub seconds: [f64; 3],
}

/// Makes the levels of a model one by one and hands each over as soon as it is finished. Returns how many there are:
/// fewer than asked for where the watcher said stop, or where a level would have no fewer triangles than the one
/// before.
///
/// # Errors
/// An option out of range; a model without extent; what `on_level` returns.
pub fn make_levels<E: From<BakeError>>(
    model: &Model,
    options: &LodOptions,
    watcher: &dyn Watcher,
    mut on_level: impl FnMut(Level) -> Result<(), E>,
) -> Result<usize, E> {
    options.check()?;
    let model = &*with_parted_materials(model);
    let high = prepare_high_poly(model, &options.bake(options.max_texture_size))?;
    let lineup = Lineup::new(model, options.shading);
    let original = lineup.subject(model)?;
    let mut before: Option<(Model, switch::Subject)> = None;
    let mut count = 0;
    for (index, &screen_size) in options.screen_size.iter().enumerate() {
        let begin = std::time::Instant::now();
        let most = before.as_ref().map_or(high.triangles, |(low, _)| low.mesh.triangles.len());
        let wanted = wanted_triangles(&high, options, index, screen_size).min(most);
        let finer = before.as_ref().map(|(low, _)| low);
        let (low, found) = low_poly(&high, model, finer, wanted, options.preset, watcher);
        if watcher.stopped() {
            // There may be too many triangles still.
            break;
        }
        let chosen = begin.elapsed().as_secs_f64();
        let texture_size = texture_size(&high, &low, screen_size, options.max_texture_size);
        let baked = bake_as(Work::Level, &high, &low, &options.bake(texture_size), watcher)?;
        let finished = begin.elapsed().as_secs_f64();

        let subject = lineup.subject(&baked.model)?;
        let at_screen_size = lineup.compare(&original, &subject, screen_size, true)?;
        let others = [Some(&original), before.as_ref().map(|(_, subject)| subject)];
        let others: Vec<_> = others.into_iter().flatten().collect();
        let switch_pixels = lineup.largest_same(&subject, &others, screen_size, options.switch_psnr)?;
        let last = others[others.len() - 1];
        let against_before = switch_pixels.map(|pixels| lineup.compare(last, &subject, pixels, true));
        let report = LevelReport {
            level: index,
            screen_size,
            triangles: baked.model.mesh.triangles.len(),
            texture_size,
            texels: baked.model.images.iter().map(|image| image.width * image.height).sum(),
            draw_calls: baked.model.materials.len(),
            low_poly: found,
            at_screen_size,
            switch_pixels,
            switch_coverage: switch_pixels.map(|pixels| (pixels / options.viewport_height).min(1.0)),
            against_before: against_before.transpose()?,
            seconds: [chosen, finished - chosen, begin.elapsed().as_secs_f64() - finished],
        };
        before = Some((low, subject));
        count += 1;
        on_level(Level { baked, report })?;
    }
    Ok(count)
}

fn wanted_triangles(high: &HighPoly, options: &LodOptions, level: usize, screen_size: f64) -> usize {
    let least = 4;
    match (options.triangles.get(level), options.ratio.get(level)) {
        (Some(&count), _) => count,
        (None, Some(share)) => ((share * high.triangles as f64).round() as usize).max(least),
        (None, None) => {
            // The longest side is 2 long in the common frame.
            let error = 2.0 * options.error / screen_size;
            triangles_within(high.scene.mesh(), error as f32).max(least)
        }
    }
}

/// About a texel for each pixel that the surface covers at this size, where charts fill three quarters of the
/// texture; a power of two.
fn texture_size(high: &HighPoly, low: &Model, screen_size: f64, most: usize) -> usize {
    let area: f64 =
        (0..low.mesh.triangles.len()).map(|t| 0.5 * f64::from(low.mesh.area_normal(t).length())).sum();
    let pixels_per_unit = 0.5 * screen_size * f64::from(high.frame.scale);
    let side = (area * pixels_per_unit.powi(2) / 0.75).sqrt();
    let side = 2f64.powf(side.max(1.0).log2().round()) as usize;
    side.clamp(32, most)
}
