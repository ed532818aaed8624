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
//! What shifts mended with a coarse texture may have been its blur rather than depth: a map
//! that hardly betters the next, finer texture begins anew with it.
//!
//! Contract: maps are as they come back from 8 bits.

use crate::error::BakeError;
use crate::low::LowPoly;
use crate::shape::Target;
use parbake_fit::atlas::Atlas;
use parbake_fit::cutout::{CutoutOptions, examples, fit_cutout};
use parbake_fit::parallax::{ParallaxOptions, State, fit_parallax, mean_square};
use parbake_fit::quantise::{color_canvas, normal_canvas};
use parbake_fit::reference::Reference;
use parbake_fit::samples::shifted_samples;
use parbake_fit::schedule::{Schedule, fit_textures};
use parbake_fit::sighted::{Sighted, sighted_views};
use parbake_fit::start::project;
use parbake_fit::territory::{Territory, keep_at_home};
use parbake_fit::view_walk::Walker;
use parbake_fit::watch::Watch;
use parbake_mesh::charts;
use parbake_model::{Image, Model, Placement, ShParallaxMap};
use parbake_render::cutout::ShCutout;
use parbake_render::display_table::DisplayTable;
use parbake_render::parallax::ShParallax;
use serde::{Deserialize, Serialize};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthPlan {
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
    /// Share of pixels whose shift led into another chart, before such shifts were made smaller
    /// and after.
    pub strayed: [f64; 2],
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
pub struct Depth {
    /// The maps.
    pub maps: DepthMaps,
    /// What the first views of the pool show of the low-poly, with the cutout: those that maps were
    /// fitted to.
    pub views: Vec<Vec<Sighted>>,
    /// What was done; none for maps that were given.
    pub report: Option<DepthReport>,
}

impl Depth {
    /// A parallax map that is not to be fitted.
    pub fn given(parallax: ShParallax) -> Self {
        Self { maps: DepthMaps { parallax, cutout: None }, views: Vec::new(), report: None }
    }
}

/// Texels along a side of the map that says which chart is nearest.
const TERRITORY: usize = 256;

/// Rounds of the solve for the small textures, and views that it is made of: they only have to
/// begin well. With all 480 views instead of 160 maps are 0.03 dB better, and take a third longer.
const ROUNDS: usize = 2;
const BEGIN_VIEWS: usize = 160;

/// A coarser pass's map is kept where it leaves less than this share of the squared differences
/// that the finer texture has without one (0.5 dB): one that is worth less is mostly the coarse
/// texture's blur (lemon, LOD-1), one that shows depth is worth 1.4 dB and more.
const WORTH_KEEPING: f64 = 0.89;

/// One view in so many tells what a map is worth, and what rounding costs.
const JUDGED: usize = 12;

/// Steps at either end whose mean the report gives.
const REPORTED: usize = 10;

/// Fits the maps of a low-poly that `frame` places; `walker` looks at it without a cutout.
///
/// # Errors
/// Where its texture coordinates have no area.
pub fn fit_depth(
    low: &Model,
    frame: &Placement,
    target: &Target,
    references: &[Reference],
    walker: &Walker,
    plan: &DepthPlan,
    watch: &impl Watch,
) -> Result<Depth, BakeError> {
    let references = &references[..references.len().min(plan.views)];
    let mut report = DepthReport::default();
    let cutout = plan.cutout.map(|options| {
        let (map, misplaced) = fit_cutout(&examples(walker, references, options.size), &options, watch);
        report.misplaced = Some(misplaced);
        map.as_stored()
    });
    let walker = walker.clone().with_cutout(cutout.as_ref());

    let views = sighted_views(&walker, references);
    let display = DisplayTable::new(&target.display);
    let mut map = ShParallax::zeros(plan.parallax.order, plan.parallax.size);
    let mut losses = Vec::new();
    let mut textures = None;
    let mut coarser = None;
    let judged: Vec<_> = views.iter().step_by(JUDGED).cloned().collect();
    for pass in plan.passes.iter().filter(|pass| pass.steps > 0) {
        // Later passes only better what the first one found.
        if coarser.is_some() && watch.should_stop() {
            break;
        }
        let LowPoly { placed, map: texels, atlas, .. } = LowPoly::new(low, frame, pass.texture_size)?;
        let start = project(&placed, &texels, &atlas, target.scene, target.surface, target.reach);
        let solved_with = |map: ShParallax| {
            let some = &views[..views.len().min(BEGIN_VIEWS)];
            let samples = shifted_samples(some, pass.texture_size, &map, watch);
            let schedule = Schedule { rounds: ROUNDS, final_steps: 0, ..Schedule::default() };
            let begin = fit_textures(&samples, &atlas, &start, target.display, target.srgb, &schedule, watch);
            let (color, normal) = (color_canvas(&begin.color, target.srgb), normal_canvas(&begin.normal));
            State { map, color, normal }
        };
        let mut state = solved_with(map);
        if coarser.is_some_and(|size| size < pass.texture_size) {
            let anew = solved_with(ShParallax::zeros(plan.parallax.order, plan.parallax.size));
            let [with, without] = [&state, &anew].map(|state| mean_square(&judged, state, &display));
            // Textures of a solve that was cut short say nothing of the map.
            if with > WORTH_KEEPING * without && !watch.should_stop() {
                state = anew;
                report.begun_anew += 1;
            }
        }
        let options = ParallaxOptions { steps: pass.steps, rate: pass.rate, ..plan.parallax };
        losses.push(fit_parallax(&views, &mut state, &display, &options, watch));
        coarser = Some(pass.texture_size);
        map = state.map;
        textures = Some((state.color, state.normal));
    }
    let mean = |losses: &[f64]| losses.iter().sum::<f64>() / losses.len().max(1) as f64;
    let ends = |losses: &Vec<f64>| {
        let few = REPORTED.min(losses.len());
        [mean(&losses[..few]), mean(&losses[losses.len() - few..])]
    };
    report.steps = losses.iter().map(Vec::len).sum();
    report.mean_square = losses.iter().map(ends).collect();
    let LowPoly { placed, map: texels, .. } = LowPoly::new(low, frame, TERRITORY)?;
    let territory = Territory::new(&Atlas::new(&texels, &charts(&placed), TERRITORY));
    report.strayed = keep_at_home(&views, &territory, &mut map);
    let parallax = map.as_stored();
    if let Some((color, normal)) = textures {
        let mut state = State { map, color, normal };
        report.rounding[0] = mean_square(&judged, &state, &display);
        state.map = parallax.clone();
        report.rounding[1] = mean_square(&judged, &state, &display);
    }
    Ok(Depth { maps: DepthMaps { parallax, cutout }, views, report: Some(report) })
}

#[cfg(test)]
mod tests {
    use crate::options::{BakeOptions, Parallax, Preset};
    use crate::{Baked, EvaluateOptions, bake, demo_pair, evaluate, with_threads};
    use parbake_model::Model;

    fn quick(parallax: Parallax) -> BakeOptions {
        BakeOptions {
            texture_size: 32,
            preset: Preset::Fast,
            parallax,
            parallax_size: 16,
            cutout_size: 32,
            views: Some(48),
            view_size: Some(64),
            rounds: Some(1),
            ..BakeOptions::default()
        }
    }

    /// With enough to see that what maps gain does not hang on the seed: 0.3 dB and more.
    fn baked(high: &Model, low: &Model, parallax: Parallax, threads: usize) -> Baked {
        let options = BakeOptions { texture_size: 64, views: Some(96), ..quick(parallax) };
        with_threads(threads, || bake(high, low, &options, &())).unwrap().unwrap()
    }

    /// Protects what maps are for: on any background the model looks better with them; and
    /// the bytes, which must not depend on the number of threads.
    #[test]
    fn maps_improve_the_look_whatever_the_number_of_threads() {
        let (high, low) = demo_pair();
        let with = baked(&high, &low, Parallax::Sh, 1);
        assert!(with.model == baked(&high, &low, Parallax::Sh, 3).model, "threads change the result");
        let without = baked(&high, &low, Parallax::None, 2);
        assert!(without.model.materials[0].parallax.is_none());
        for background in ["white", "0.9,0.1,0.2"] {
            let options = EvaluateOptions {
                views: 6,
                resolution: 96,
                background: background.into(),
                no_flip: true,
                decode_srgb: true,
                gain: 1.0,
                ..EvaluateOptions::default()
            };
            let psnr = |low: &Model| evaluate(&high, low, &options, &()).unwrap().mean.psnr;
            let (better, worse) = (psnr(&with.model), psnr(&without.model));
            assert!(better > worse, "{background}: {better} {worse}");
        }
        let report = with.report.depth.unwrap();
        let [before, after] = report.misplaced.unwrap();
        assert!(after < before && report.strayed[1] <= report.strayed[0]);
        assert!(report.mean_square.iter().all(|[first, last]| last < first));
        let [exact, rounded] = report.rounding;
        assert!(exact > 0.0 && rounded < 1.1 * exact, "8 bits do: {exact} {rounded}");
    }

    /// Protects textures from maps that only mend a coarse one's blur: where high-poly and low-poly
    /// are the same there is no depth to show, and the finer pass begins anew; where they are not,
    /// what the coarse pass found is kept.
    #[test]
    fn a_map_without_depth_to_show_begins_anew() {
        let (high, low) = demo_pair();
        // More than the first pass's 128 texels, so that there is a finer texture.
        let options = BakeOptions { texture_size: 256, ..quick(Parallax::Sh) };
        let begun_anew = |high: &Model, low: &Model| {
            let baked = bake(high, low, &options, &()).unwrap();
            baked.report.depth.unwrap().begun_anew
        };
        assert_eq!(begun_anew(&high, &low), 0);
        assert_eq!(begun_anew(&low, &low), 1);
    }
}
