//! What follows from a user's options: every number settled that a preset leaves open, stage
//! by stage.

use crate::options::{BakeOptions, Convention, Method, Parallax, Preset, Shading, ShapeMode, UvMode};
use crate::work::Work;
use parbake_fit::cutout::CutoutOptions;
use parbake_fit::parallax::ParallaxOptions;
use parbake_fit::parallax_maps::{ParallaxPass, ParallaxPlan};
use parbake_fit::schedule::Schedule;
use parbake_fit::separate_maps::SeparateSchedule;
use parbake_model::Basis;
use parbake_shape::paper::PaperOptions as PaperJointOptions;
use parbake_shape::paper_joint_fit::PaperJointPlan;
use parbake_shape::stage::{ShapePlan, ShapeReport};
use parbake_shape::{Motion, ShapeOptions};
use parbake_uv::paper::PaperOptions;
use parbake_uv::surface::UvStageOptions;
use parbake_views::reference::Sampling;
use parbake_views::view_sampler::UncoveredPixels;

impl Plan {
    /// How much work the maps of whole materials get.
    pub(crate) fn material_schedule(&self) -> SeparateSchedule {
        let own = SeparateSchedule::default();
        let normal_steps = if self.schedule.normal_steps > 0 { own.normal_steps } else { 0 };
        SeparateSchedule { is_fitted: self.schedule.rounds > 0, normal_steps, ..own }
    }
}

/// Options with every number settled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Training views.
    pub views: usize,
    /// How the high-poly is sampled in them.
    pub reference: Sampling,
    /// The order of the fit.
    pub schedule: Schedule,
}

/// Views that maps are fitted to within a time budget.
const HURRIED_VIEWS: usize = 96;

/// Side in pixels of the views in the paper's Algorithm 1: with 160 its maps blur what pictures
/// show, and 0.5 to 0.8 dB are lost.
const ALGORITHM_VIEW_SIZE: usize = 256;

/// Weight of the Laplacian term where it is asked for.
const LAPLACIAN: f32 = 10.0;

/// Where a model is compressed, texture coordinates are all that takes time, and take more steps by this factor.
const OWN_STEPS: usize = 8;

impl BakeOptions {
    /// Of a stage's views, those that the user's number leaves.
    fn at_most_views(&self, own: usize) -> usize {
        self.views.map_or(own, |views| views.min(own))
    }

    /// A stage's view size, or the user's where that is smaller.
    fn at_most_pixels(&self, own: usize) -> usize {
        self.view_size.map_or(own, |size| size.min(own))
    }

    /// Whether there is only time for textures.
    fn hurried(&self) -> bool {
        crate::budget::is_hurried(self)
    }

    /// Whether normals are fitted to what a headlight shows of them, as in the paper; else to the
    /// high-poly's own normals, so that they are right under any light.
    pub(crate) fn fits_normals_to_headlight(&self) -> bool {
        let is_headlight_meant = self.shading == Shading::Lambert || self.convention == Convention::Paper;
        is_headlight_meant || self.method == Method::Paper || self.hurried()
    }

    /// What to do with vertices; none where they stay.
    pub(crate) fn shape_plan(&self) -> Option<ShapePlan> {
        let motion = match self.shape {
            ShapeMode::Keep => return None,
            ShapeMode::Normal => Motion::Normal,
            ShapeMode::Free | ShapeMode::Laplacian => Motion::Free,
        };
        // Where triangles are many, outlines are a fraction of a pixel apart, and larger pictures
        // bring vertices closer: with some 900 triangles 0.4 dB from 160 to 256 pixels, 0.2 from 256
        // to 320. The larger the pictures, the fewer samples a pixel needs.
        let (views, view_size, largest_size, samples, texture_size, steps) = match self.preset {
            Preset::Fast => (64, 160, 256, 3, 128, 60),
            Preset::Balanced => (192, 320, 320, 2, 256, 200),
            Preset::Best => (384, 384, 384, 2, 256, 400),
        };
        let laplacian = if self.shape == ShapeMode::Laplacian { LAPLACIAN } else { 0.0 };
        (self.method == Method::Fit && !self.hurried()).then_some(ShapePlan {
            views: self.at_most_views(views),
            view_size: self.at_most_pixels(view_size),
            largest_size: self.at_most_pixels(largest_size),
            texture_size,
            samples,
            fit: ShapeOptions { motion, steps, laplacian, seed: self.seed, ..ShapeOptions::default() },
        })
    }

    /// How far vertices reach beyond the high-poly for a cutout to take away; none where nothing is cut, or vertices stay.
    /// `shape` is how they moved before.
    pub(crate) fn growth_plan(&self, shape: Option<&ShapeReport>) -> Option<ShapePlan> {
        let plan = self.shape_plan().filter(|_| self.cuts())?;
        // As far as outlines of the delivered shape were apart: those of the moved one hardly are.
        let gap = shape.map_or(0.0, |shape| 2.0 * shape.gap[0]);
        // Overhang counts little, for it will be cut out; what is missing cannot be put there. Vertices are nearly there,
        // so half of the steps do. No artist has chosen offsets, so any gain is worth them.
        let fit = ShapeOptions {
            overhang_discount: 0.9,
            least_gap: gap,
            steps: plan.fit.steps / 2,
            worth_moving: 1.0,
            ..plan.fit
        };
        Some(ShapePlan { fit, ..plan })
    }

    /// How cutout and parallax map are fitted; none where there are none.
    pub(crate) fn parallax_plan(&self) -> Option<ParallaxPlan> {
        let (views, cutout_steps, steps) = match self.preset {
            Preset::Fast => (240, 120, [100, 60, 0]),
            Preset::Balanced => (960, 300, [400, 250, 400]),
            Preset::Best => (960, 500, [800, 500, 600]),
        };
        let own = ParallaxOptions::default();
        let pass = |texture_size: usize, steps, rate| ParallaxPass {
            texture_size: self.texture_size.min(texture_size),
            steps,
            rate,
        };
        let (of_shift, of_cutout, cutout_rate) = match self.parallax {
            Parallax::None => return None,
            Parallax::Tangent => (Basis::TangentShift, Basis::TangentCutout, CutoutOptions::default().rate),
            // A step of harmonics moves the opacity less: their first function is 0.28.
            Parallax::Sh => (Basis::Harmonics(self.parallax_order), Basis::Harmonics(self.cutout_order), 0.3),
        };
        (self.method == Method::Fit).then_some(ParallaxPlan {
            // What cannot be stopped half-way costs by the view.
            views: if self.time_budget.is_some() { views.min(HURRIED_VIEWS) } else { views },
            cutout: (!self.no_cutout).then_some(CutoutOptions {
                basis: of_cutout,
                rate: cutout_rate,
                size: self.cutout_size,
                steps: cutout_steps,
                ..CutoutOptions::default()
            }),
            parallax: ParallaxOptions { basis: of_shift, size: self.parallax_size, ..own },
            // A texel is half as wide in each pass as in the one before; the rate falls faster,
            // for less is left to be moved.
            passes: [
                pass(128, steps[0], own.rate),
                pass(256, steps[1], 0.3 * own.rate),
                pass(512, steps[2], 0.1 * own.rate),
            ],
        })
    }

    /// Whether the low-poly is cut at the high-poly's silhouettes.
    fn cuts(&self) -> bool {
        self.parallax != Parallax::None && self.method == Method::Fit && !self.no_cutout
    }

    /// Whether there are textures for viewers that do not know parallax maps.
    pub fn has_fallback(&self) -> bool {
        self.parallax != Parallax::None && self.method == Method::Fit && self.fallback_size != Some(0)
    }

    /// The paper's optimiser for vertices and parallax; none where neither is asked for.
    pub(crate) fn paper_joint_plan(&self) -> Option<PaperJointPlan> {
        let (own, paper) = (PaperJointOptions::default(), PaperOptions::default());
        let rounds = self.uv_steps.unwrap_or(paper.rounds);
        let fit = PaperJointOptions {
            motion: (self.shape != ShapeMode::Keep).then_some(Motion::Normal),
            parallax: (self.parallax == Parallax::Sh).then_some((self.parallax_order, self.parallax_size)),
            texture_size: self.texture_size.min(256),
            steps: paper.first_steps + rounds * paper.steps_in_round,
            ..own
        };
        let moves = fit.motion.is_some() || fit.parallax.is_some();
        (self.method == Method::Paper && moves).then_some(PaperJointPlan {
            views: self.at_most_views(256),
            view_size: self.at_most_pixels(ALGORITHM_VIEW_SIZE),
            fit,
        })
    }

    /// How much pixels count beyond the high-poly's silhouette: none where they are cut out.
    pub fn silhouette_weight(&self) -> f32 {
        self.silhouette.unwrap_or(if self.cuts() { 0.0 } else { 0.5 })
    }

    /// What pixels beyond the high-poly's silhouette ask of the textures.
    pub(crate) fn uncovered_pixels(&self) -> UncoveredPixels {
        match self.silhouette_weight() {
            0.0 => UncoveredPixels::Ignore,
            weight => UncoveredPixels::Background(self.silhouette_background.light(), weight),
        }
    }

    /// Length of a pixel's display difference at which it counts half. What contradicts itself in a
    /// texel that is shifted is a stray pixel, and is worth little; without shifts it is most
    /// of what views show of depth, and to count it less costs decibels.
    fn robust_scale(&self) -> f32 {
        let own = match (self.method, self.parallax) {
            (Method::Paper, _) => 1000.0,
            (Method::Fit, Parallax::Tangent | Parallax::Sh) => 0.5,
            (Method::Fit, Parallax::None) => 1.0,
        };
        self.robust_scale.unwrap_or(own)
    }

    /// What to do with texture coordinates in another mode.
    pub(crate) fn uv_stage_as(&self, mode: UvMode) -> UvStageOptions {
        UvStageOptions { mode, ..self.uv_stage() }
    }

    /// What to do with texture coordinates.
    pub(crate) fn uv_stage(&self) -> UvStageOptions {
        let steps = match (self.method, self.preset) {
            (Method::Paper, _) => PaperOptions::default().rounds,
            (Method::Fit, Preset::Fast) => 10,
            (Method::Fit, Preset::Balanced) => 30,
            (Method::Fit, Preset::Best) => 60,
        };
        UvStageOptions {
            mode: if self.hurried() && self.uv == UvMode::Optimize { UvMode::Repair } else { self.uv },
            method: self.method,
            guide: Method::guide(self.no_content_aware),
            texture_size: self.texture_size,
            gutter: self.gutter_texels(),
            gutter_required: self.gutter.is_some(),
            smallest_mip: self.smallest_mip,
            parallax_size: (self.parallax != Parallax::None).then_some(self.parallax_size),
            steps: self.uv_steps.unwrap_or(steps),
            refines_scarce_only: self.preset != Preset::Best && self.uv_steps.is_none(),
            more_triangles: self.more_triangles(),
        }
    }

    /// Steps in which texture coordinates are refined at most: as asked, or as preset, method and command say.
    pub fn settled_uv_steps(&self, work: Work) -> usize {
        self.uv_stage_for(work).steps
    }

    /// What to do with texture coordinates in this work.
    pub(crate) fn uv_stage_for(&self, work: Work) -> UvStageOptions {
        let own = self.uv_stage();
        let factor = if (self.method, work) == (Method::Fit, Work::Compress) { OWN_STEPS } else { 1 };
        UvStageOptions { steps: self.uv_steps.unwrap_or(factor * own.steps), ..own }
    }

    /// Settles what the preset leaves open.
    pub fn plan(&self) -> Plan {
        // Views matter more than their pixels: what a texel looks like depends on the
        // side it is seen from, and few sides are learnt by heart. From 640 to 960 views maps gain
        // 0.4 dB at 900 triangles, textures alone 0.1; from 960 to 1280 both gain 0.05.
        let (views, view_size, rounds, final_steps) = match self.preset {
            // Parallax maps are fitted to the same views.
            Preset::Fast => (if self.parallax == Parallax::None { 160 } else { 240 }, 192, 3, 1),
            Preset::Balanced => (960, 192, 5, 2),
            Preset::Best => (1280, 256, 8, 3),
        };
        // A texel that hardly a sample reads is noise: views grow with textures larger than this, though by less than the
        // texture, or bakes would take for ever. `fast` with 1024 texels: 0.1 to 0.2 dB more in three.js.
        let served = if self.preset == Preset::Fast { 512.0 } else { 1024.0 };
        let finer = (self.texture_size as f32 / served).max(1.0).sqrt();
        let view_size = self.view_size.unwrap_or((view_size as f32 * finer) as usize);
        let rounds = self.rounds.unwrap_or(rounds);
        // A projection without maps is only looked at, to report its loss.
        let views = if rounds == 0 && self.parallax == Parallax::None { 16 } else { views };
        Plan {
            views: self.views.unwrap_or(views),
            reference: Sampling {
                size: view_size,
                // Half a texel wide where the texture fills the picture: averaging is the
                // solver's work, over all the samples that meet in a texel.
                filter: (0.5 * view_size as f32 / self.texture_size as f32).clamp(1.0 / 16.0, 1.0),
                samples: 1,
            },
            schedule: Schedule {
                rounds,
                normal_steps: if self.keep_normals { 0 } else { Schedule::default().normal_steps },
                final_steps: if rounds == 0 { 0 } else { final_steps },
                robust_scale: self.robust_scale(),
                ..Schedule::default()
            },
        }
    }
}
