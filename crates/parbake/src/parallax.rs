//! The parallax map of a bake: how texture coordinates shift with the direction of sight.
//!
//! ```text
//! samples without shifts ─ solve ─ small textures ─┐
//! views' pixels ───────────────────────────────────┴ fit ─ coefficients ─ 8 bits
//! ```
//!
//! The textures that are fitted along are small and are thrown away: what is written is
//! solved for afterwards, with the shifts that a reader of the file will see.
//!
//! Contract: the result is what [`parbake_render::parallax_images`] gives back after rounding.

use crate::error::BakeError;
use crate::low::LowPoly;
use crate::shape::Target;
use parbake_fit::parallax::{ParallaxOptions, State, fit_parallax, sighted_views};
use parbake_fit::quantise::{color_canvas, normal_canvas};
use parbake_fit::reference::Reference;
use parbake_fit::samples::collect_samples;
use parbake_fit::schedule::{Schedule, fit_textures};
use parbake_fit::start::project;
use parbake_fit::view_walk::Walker;
use parbake_fit::watch::Watch;
use parbake_model::{Model, Placement};
use parbake_render::display_table::DisplayTable;
use parbake_render::parallax::ShParallax;
use serde::{Deserialize, Serialize};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallaxPlan {
    /// Views of the pool that the map is fitted to.
    pub views: usize,
    /// Texels along a side of the textures that are fitted along.
    pub texture_size: usize,
    /// The fit's own.
    pub fit: ParallaxOptions,
}

/// What was done.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParallaxReport {
    /// Steps that the map took.
    pub steps: usize,
    /// Mean squared display difference of the first steps' views and of the last ones'.
    pub mean_square: [f64; 2],
}

/// Rounds of the solve for the small textures: they only have to begin well.
const ROUNDS: usize = 2;

/// Steps at either end whose mean the report gives.
const REPORTED: usize = 10;

/// Fits the map of a low-poly that `frame` places.
///
/// # Errors
/// Where its texture coordinates have no area.
pub fn parallax(
    low: &Model,
    frame: &Placement,
    target: &Target,
    references: &[Reference],
    walker: &Walker,
    srgb: bool,
    plan: &ParallaxPlan,
    watch: &impl Watch,
) -> Result<(ShParallax, ParallaxReport), BakeError> {
    let LowPoly { placed, map, atlas, .. } = LowPoly::new(low, frame, plan.texture_size)?;
    let start = project(&placed, &map, &atlas, target.scene, target.surface, target.reach);
    let references = &references[..references.len().min(plan.views)];
    let samples = collect_samples(walker, references, plan.texture_size, None, watch);
    let schedule = Schedule { rounds: ROUNDS, final_steps: 0, ..Schedule::default() };
    let begin = fit_textures(&samples, &atlas, &start, target.display, srgb, &schedule, watch);
    drop(samples);
    let mut state = State {
        map: ShParallax::zeros(plan.fit.order, plan.fit.size),
        color: color_canvas(&begin.color, srgb),
        normal: normal_canvas(&begin.normal),
    };
    let views = sighted_views(walker, references);
    let display = DisplayTable::new(&target.display);
    let losses = fit_parallax(&views, &mut state, &display, &plan.fit, watch);
    let mean = |losses: &[f64]| losses.iter().sum::<f64>() / losses.len().max(1) as f64;
    let few = REPORTED.min(losses.len());
    let report = ParallaxReport {
        steps: losses.len(),
        mean_square: [mean(&losses[..few]), mean(&losses[losses.len() - few..])],
    };
    let mut images = Vec::new();
    let packed = state.map.pack(&mut images);
    // What a reader sees is what textures are solved for.
    let map = ShParallax::unpack(&packed, &images).unwrap_or(state.map);
    Ok((map, report))
}
