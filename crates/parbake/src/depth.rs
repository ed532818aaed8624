//! Depth without triangles: what the low-poly leaves out at its silhouettes, and how its
//! texture coordinates shift with the direction of sight.
//!
//! ```text
//! views' pixels, layer by layer ─ examples ─ cutout ─┐
//!                              ┌─────────────────────┘
//! views' pixels that are left ─┴ samples ─ solve ─ small textures ─┐
//!                              └───────────────────────────────────┴ fit ─ parallax
//! ```
//!
//! The textures that are fitted along are small and are thrown away: what is written is
//! solved for afterwards, with the cutout and the shifts that a reader of the file will see.
//!
//! Contract: maps are as they come back from 8 bits.

use crate::error::BakeError;
use crate::low::LowPoly;
use crate::shape::Target;
use parbake_fit::cutout::{CutoutOptions, examples, fit_cutout};
use parbake_fit::parallax::{ParallaxOptions, State, fit_parallax, sighted_views};
use parbake_fit::quantise::{color_canvas, normal_canvas};
use parbake_fit::reference::Reference;
use parbake_fit::samples::collect_samples;
use parbake_fit::schedule::{Schedule, fit_textures};
use parbake_fit::start::project;
use parbake_fit::view_walk::Walker;
use parbake_fit::watch::Watch;
use parbake_model::{Image, Model, Placement, ShParallaxMap, Wrap};
use parbake_render::cutout::ShCutout;
use parbake_render::display_table::DisplayTable;
use parbake_render::parallax::ShParallax;
use serde::{Deserialize, Serialize};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthPlan {
    /// Views of the pool that the maps are fitted to.
    pub views: usize,
    /// Texels along a side of the textures that are fitted along.
    pub texture_size: usize,
    /// How the cutout is fitted; none for a low-poly that is all there.
    pub cutout: Option<CutoutOptions>,
    /// How the parallax map is fitted.
    pub parallax: ParallaxOptions,
}

/// The maps, as a reader of the file sees them.
#[derive(Clone, Debug)]
pub struct DepthMaps {
    /// How coordinates shift.
    pub parallax: ShParallax,
    /// What is left out.
    pub cutout: Option<ShCutout>,
}

impl DepthMaps {
    /// As a file holds them: adds their images to these.
    pub fn pack(&self, images: &mut Vec<Image>) -> ShParallaxMap {
        let mut map = self.parallax.pack(images);
        map.cutout = self.cutout.as_ref().map(|cutout| cutout.pack(images));
        map
    }
}

/// What was done.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DepthReport {
    /// Share of the pixels near silhouettes that show the low-poly where the high-poly is
    /// not, or the other way round, without the cutout and with it.
    pub misplaced: Option<[f64; 2]>,
    /// Steps that the parallax map took.
    pub steps: usize,
    /// Mean squared display difference of its first steps' views and of its last ones'.
    pub mean_square: [f64; 2],
}

/// Maps, and how they came about.
pub struct Depth {
    /// The maps.
    pub maps: DepthMaps,
    /// What was done.
    pub report: DepthReport,
}

/// Rounds of the solve for the small textures: they only have to begin well.
const ROUNDS: usize = 2;

/// Steps at either end whose mean the report gives.
const REPORTED: usize = 10;

/// Fits the maps of a low-poly that `frame` places; `walker` looks at it without a cutout.
///
/// # Errors
/// Where its texture coordinates have no area.
#[expect(clippy::too_many_arguments, reason = "each is another part of the bake")]
pub fn fit_depth(
    low: &Model,
    frame: &Placement,
    target: &Target,
    references: &[Reference],
    walker: &Walker,
    srgb: bool,
    plan: &DepthPlan,
    watch: &impl Watch,
) -> Result<Depth, BakeError> {
    let references = &references[..references.len().min(plan.views)];
    let mut report = DepthReport::default();
    let cutout = plan.cutout.map(|options| {
        let (map, misplaced) = fit_cutout(&examples(walker, references, options.size), &options, watch);
        report.misplaced = Some(misplaced);
        let mut images = Vec::new();
        let packed = map.pack(&mut images);
        ShCutout::unpack(&packed, [Wrap::Clamp; 2], &images).unwrap_or(map)
    });
    let walker = walker.clone().with_cutout(cutout.as_ref());

    let LowPoly { placed, map, atlas, .. } = LowPoly::new(low, frame, plan.texture_size)?;
    let start = project(&placed, &map, &atlas, target.scene, target.surface, target.reach);
    let samples = collect_samples(&walker, references, plan.texture_size, None, watch);
    let schedule = Schedule { rounds: ROUNDS, final_steps: 0, ..Schedule::default() };
    let begin = fit_textures(&samples, &atlas, &start, target.display, srgb, &schedule, watch);
    drop(samples);
    let mut state = State {
        map: ShParallax::zeros(plan.parallax.order, plan.parallax.size),
        color: color_canvas(&begin.color, srgb),
        normal: normal_canvas(&begin.normal),
    };
    let views = sighted_views(&walker, references);
    let display = DisplayTable::new(&target.display);
    let losses = fit_parallax(&views, &mut state, &display, &plan.parallax, watch);
    let mean = |losses: &[f64]| losses.iter().sum::<f64>() / losses.len().max(1) as f64;
    let few = REPORTED.min(losses.len());
    report.steps = losses.len();
    report.mean_square = [mean(&losses[..few]), mean(&losses[losses.len() - few..])];
    let mut images = Vec::new();
    let packed = state.map.pack(&mut images);
    let parallax = ShParallax::unpack(&packed, &images).unwrap_or(state.map);
    Ok(Depth { maps: DepthMaps { parallax, cutout }, report })
}
