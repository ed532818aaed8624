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
//! What shifts made up for with a coarse texture may have been its blur rather than depth: a map
//! that hardly betters the next, finer texture begins anew with it.
//!
//! Contract: maps are as they come back from 8 bits.

use crate::backend::Backend;
use crate::chart_ownership::{ChartOwnership, clamp_to_chart};
use crate::cutout::{CutoutOptions, examples, fit_cutout};
use crate::parallax::{ParallaxOptions, State, fit_parallax, mean_square};
use crate::schedule::{Comparison, Schedule, fit_textures};
use parbake_image::MapSet;
use parbake_image::display_table::DisplayTable;
use parbake_image::quantise::from_image;
use parbake_mesh::charts;
use parbake_model::{Image, Model, ParallaxMap};
use parbake_progress::{PackedParallax, Portion, Showing, Snapshot, Stage, Watcher};
use parbake_render::cutout::CutoutCoefficients;
use parbake_render::parallax::ParallaxCoefficients;
use parbake_render::shade::Brdf;
use parbake_views::PrepareError;
use parbake_views::chart_labels::Atlas;
use parbake_views::high_poly::HighPoly;
use parbake_views::low_poly::LowPoly;
use parbake_views::projection::{ProjectedMaps, project};
use parbake_views::reference::Reference;
use parbake_views::view_sample::ViewSample;
use parbake_views::view_sampler::ViewSampler;
use serde::{Deserialize, Serialize};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallaxPlan {
    /// Views of the pool that the maps are fitted to.
    pub views: usize,
    /// How the cutout is fitted; none for a low-poly that is all there.
    pub cutout: Option<CutoutOptions>,
    /// How the parallax map is fitted, but for what passes say.
    pub parallax: ParallaxOptions,
    /// With which textures, from coarse to fine; passes without steps are left out.
    pub passes: [ParallaxPass; 3],
}

/// One pass of the parallax map's fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallaxPass {
    /// Texels along a side of the textures that are fitted along. Coarse ones let shifts find
    /// far ways, fine ones show what they blur.
    pub texture_size: usize,
    /// Steps of Adam.
    pub steps: usize,
    /// Its rate for coefficients.
    pub rate: f32,
}

/// The maps, as a reader of the file sees them.
#[derive(Clone, Debug)]
pub struct ParallaxMaps {
    /// How coordinates shift.
    pub parallax: ParallaxCoefficients,
    /// What is left out.
    pub cutout: Option<CutoutCoefficients>,
}

impl ParallaxMaps {
    /// As a file holds them: adds their images to these.
    pub fn pack(&self, images: &mut Vec<Image>) -> ParallaxMap {
        let mut map = self.parallax.pack(images);
        map.cutout = self.cutout.as_ref().map(|cutout| cutout.pack(images));
        if map.basis.is_tangent() {
            map.fade = FADE;
        }
        map
    }
}

/// What the maps are fitted to.
#[derive(Clone, Copy)]
pub struct ParallaxInput<'a> {
    /// The low-poly.
    pub low: &'a Model,
    /// It as it was prepared for the texture that is to be written.
    pub prepared: &'a LowPoly,
    /// The high-poly's maps, projected for the same texture.
    pub projected: &'a ProjectedMaps,
    /// The high-poly.
    pub high: &'a HighPoly,
    /// It from the training views.
    pub references: &'a [Reference],
    /// Looks at the low-poly without a cutout from there.
    pub sampler: &'a ViewSampler<'a>,
}

/// What was done.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParallaxReport {
    /// Share of the pixels near silhouettes that show the low-poly where the high-poly is
    /// not, or the other way round, without the cutout and with it.
    pub misplaced: Option<[f64; 2]>,
    /// Share of pixels whose shift led into another chart, before such shifts were made smaller
    /// and after.
    pub cross_chart: [f64; 2],
    /// Steps that the parallax map took.
    pub steps: usize,
    /// Passes that began anew, because the coarser pass's map did too little for their textures.
    #[serde(default)]
    pub begun_anew: usize,
    /// For each pass over the textures' sizes, the mean squared display difference of its first
    /// steps' views and of its last ones'.
    pub mean_square: Vec<[f64; 2]>,
    /// The same of some views, before the map was rounded to 8 bits and after, with the textures
    /// as they were; those that are written are solved for after the rounding.
    #[serde(default)]
    pub rounding: [f64; 2],
}

/// Maps, and how they came about.
pub struct FittedMaps {
    /// The maps.
    pub maps: ParallaxMaps,
    /// What the first views of the pool show of the low-poly, with the cutout: those that maps were
    /// fitted to.
    pub views: Vec<Vec<ViewSample>>,
    /// What was done; none for maps that were given.
    pub report: Option<ParallaxReport>,
}

impl FittedMaps {
    /// A parallax map that is not to be fitted.
    pub fn given(parallax: ParallaxCoefficients) -> Self {
        Self { maps: ParallaxMaps { parallax, cutout: None }, views: Vec::new(), report: None }
    }
}

/// Footprint of a pixel, in texture widths, from which maps fade. They still help a model of 17 pixels (+0.3 dB on
/// black, +1.3 on white), whose pixels are half as wide; far below, they are not worth their fetches.
const FADE: f32 = 1.0 / 16.0;

/// Texels along a side of the map that says which chart is nearest.
const OWNERSHIP_SIZE: usize = 256;

/// Rounds of the solve for the small textures, and views that it is made of: they only have to
/// begin well. With all 480 views instead of 160 maps are 0.03 dB better, and take a third longer.
const ROUNDS: usize = 2;
const BEGIN_VIEWS: usize = 160;

/// A coarser pass's map is kept where it leaves less than this share of the squared differences
/// that the finer texture has without one (0.5 dB): one that is worth less is mostly the coarse
/// texture's blur (lemon, LOD-1), one that shows depth is worth 1.4 dB and more.
const WORTH_KEEPING: f64 = 0.89;

/// Share of a pass's time that the solve for its textures takes.
const BEGINNING: f64 = 0.25;

/// One view in so many tells what a map is worth, and what rounding costs.
const JUDGED: usize = 12;

/// Steps at either end whose mean the report gives.
const REPORTED: usize = 10;

/// Fits the maps of a low-poly; `comparison` says with which BRDF, and on which backend. References were
/// rendered with the same BRDF.
///
/// # Errors
/// Where the low-poly's texture coordinates have no area.
pub fn fit_parallax_maps<B: Brdf, K: Backend>(
    input: &ParallaxInput,
    comparison: &Comparison<B, K>,
    plan: &ParallaxPlan,
    watcher: &dyn Watcher,
) -> Result<FittedMaps, PrepareError> {
    let &ParallaxInput { low, prepared, projected, high, references, sampler } = input;
    let &Comparison { backend, brdf, display, srgb } = comparison;
    let sampler = &sampler.clone().in_basis(plan.parallax.basis);
    let references = &references[..references.len().min(plan.views)];
    let mut report = ParallaxReport::default();
    let cutout = plan.cutout.map(|options| {
        let (map, misplaced) = fit_cutout(&examples(sampler, references, options.size), &options, watcher);
        report.misplaced = Some(misplaced);
        map.as_stored()
    });
    let sampler = sampler.clone().with_cutout(cutout.as_ref());
    let is_cut = |mut shift: PackedParallax| {
        shift.map.cutout = cutout.as_ref().map(|cutout| cutout.pack(&mut shift.images));
        shift
    };

    let views = backend.sample_views(&sampler, references);
    let display = DisplayTable::new(&display);
    let mut map = ParallaxCoefficients::zeros(plan.parallax.basis, plan.parallax.size);
    let mut losses = Vec::new();
    let mut textures = None;
    let mut coarser = None;
    let judged: Vec<_> = views.iter().step_by(JUDGED).cloned().collect();
    let all_steps: usize = plan.passes.iter().map(|pass| pass.steps).sum();
    let mut steps_before = 0;
    for pass in plan.passes.iter().filter(|pass| pass.steps > 0) {
        let share = |steps: f64| (steps_before as f64 + steps) / all_steps as f64;
        let own_steps = pass.steps as f64;
        let begun = share(BEGINNING * own_steps);
        let beginning = Portion::new(watcher, share(0.0)..begun).of_stage(Stage::Solve, Stage::Parallax);
        let moving = Portion::new(watcher, begun..share(own_steps));
        steps_before += pass.steps;
        // Later passes only better what the first one found.
        if coarser.is_some() && watcher.stopped() {
            break;
        }
        let made;
        let (own, start) = if prepared.map.size == pass.texture_size {
            (prepared, projected)
        } else {
            let low = LowPoly::for_parallax(low, &high.frame, pass.texture_size)?;
            let start = project(&low, high);
            made = (low, start);
            (&made.0, &made.1)
        };
        let solved_with = |map: ParallaxCoefficients| {
            let watcher = &Showing::new(&beginning, |snapshot| match snapshot {
                Snapshot::Maps { maps, .. } => {
                    let parallax = Some(is_cut(PackedParallax::new(|images| map.pack(images))));
                    Some(Snapshot::Maps { maps, parallax })
                }
                other => Some(other),
            });
            let some = views.iter().take(BEGIN_VIEWS).collect();
            let samples = backend.shifted_view_samples(some, pass.texture_size, &map, watcher);
            let schedule = Schedule { rounds: ROUNDS, final_steps: 0, ..Schedule::default() };
            let begin = fit_textures(&samples, &own.atlas, &start.maps, comparison, &schedule, watcher);
            let mut maps = MapSet::new(pass.texture_size);
            for (kind, image) in &begin.images {
                maps.insert(*kind, from_image(*kind, image, srgb));
            }
            State { map, maps }
        };
        let mut state = solved_with(map);
        if coarser.is_some_and(|size| size < pass.texture_size) {
            let anew = solved_with(ParallaxCoefficients::zeros(plan.parallax.basis, plan.parallax.size));
            let [with, without] =
                [&state, &anew].map(|state| mean_square(backend, &judged, state, brdf, &display));
            // Textures of a solve that was cut short say nothing of the map.
            if with > WORTH_KEEPING * without && !watcher.stopped() {
                state = anew;
                report.begun_anew += 1;
            }
        }
        let options = ParallaxOptions { steps: pass.steps, rate: pass.rate, ..plan.parallax };
        let showing = Showing::new(&moving, |snapshot| match snapshot {
            Snapshot::Maps { maps, parallax } => {
                Some(Snapshot::Maps { maps, parallax: parallax.map(is_cut) })
            }
            other => Some(other),
        });
        losses.push(fit_parallax(backend, &views, &mut state, brdf, &display, &options, &showing));
        coarser = Some(pass.texture_size);
        map = state.map;
        textures = Some(state.maps);
    }
    let mean = |losses: &[f64]| losses.iter().sum::<f64>() / losses.len().max(1) as f64;
    let ends = |losses: &Vec<f64>| {
        let few = REPORTED.min(losses.len());
        [mean(&losses[..few]), mean(&losses[losses.len() - few..])]
    };
    report.steps = losses.iter().map(Vec::len).sum();
    report.mean_square = losses.iter().map(ends).collect();
    let LowPoly { placed, map: texels, .. } = LowPoly::for_parallax(low, &high.frame, OWNERSHIP_SIZE)?;
    let chart_ownership = ChartOwnership::new(&Atlas::new(&texels, &charts(&placed), OWNERSHIP_SIZE));
    report.cross_chart = clamp_to_chart(&views, &chart_ownership, &mut map);
    let parallax = map.as_stored();
    if let Some(maps) = textures {
        let mut state = State { map, maps };
        report.rounding[0] = mean_square(backend, &judged, &state, brdf, &display);
        state.map = parallax.clone();
        report.rounding[1] = mean_square(backend, &judged, &state, brdf, &display);
    }
    Ok(FittedMaps { maps: ParallaxMaps { parallax, cutout }, views, report: Some(report) })
}
