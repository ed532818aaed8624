//! What a user can ask for: one plain struct for the library, the command line and
//! the options file. Every field states its unit, range and default; `None` in a
//! quality field means "as the preset says".

use crate::error::BakeError;
use crate::algorithm_one::AlgorithmPlan;
use crate::depth::DepthPlan;
use crate::shape::ShapePlan;
use crate::unfold::UnfoldOptions;
use parbake_fit::cutout::CutoutOptions;
use parbake_fit::parallax::ParallaxOptions;
use parbake_fit::reference::Sampling;
use parbake_fit::schedule::Schedule;
use parbake_render::display::{Curve, Display};
use parbake_render::scene::Interpretation;
use parbake_shape::paper::PaperOptions as AlgorithmOptions;
use parbake_shape::{Motion, ShapeOptions};
use parbake_uv::paper::{Guide, PaperOptions};
use serde::{Deserialize, Serialize};

/// How much time a bake may take for how much quality.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// A look within a second or two.
    Fast,
    /// What most bakes should use.
    #[default]
    Balanced,
    /// The last tenths of a decibel.
    Best,
}

/// How colours are understood when pictures are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Convention {
    /// As glTF says: base colour is decoded from sRGB, light has unit strength.
    #[default]
    Gltf,
    /// As in the paper's pictures: textures as stored, light of strength 1.59.
    Paper,
}

impl Convention {
    /// Whether base colour is decoded from sRGB before shading.
    pub fn decodes_srgb(self) -> bool {
        self == Convention::Gltf
    }

    /// How textures are read.
    pub fn interpretation(self) -> Interpretation {
        Interpretation { decode_srgb: self.decodes_srgb(), trilinear: true, parallax: true }
    }

    /// Light strength and display curve.
    pub fn display(self) -> Display {
        let gain = if self == Convention::Paper { 1.59 } else { 1.0 };
        Display { gain, curve: Curve::Srgb }
    }
}

/// What becomes of texture coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum UvMode {
    /// They stay as they are.
    Keep,
    /// What overlaps, is mirrored or lies outside is mended; sound ones stay.
    Repair,
    /// They are made anew.
    Unwrap,
    /// They are mended and then moved to where they show most.
    #[default]
    Optimize,
}

/// What becomes of vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum ShapeMode {
    /// They stay as they are.
    Keep,
    /// They move along their normals, as in the paper.
    Normal,
    /// They move where the pictures want them.
    #[default]
    Free,
}

/// How depth is shown without triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Parallax {
    /// Not at all: the file is plain glTF.
    #[default]
    None,
    /// By a map of spherical harmonics in a material extension (docs/parallax_format.md).
    Sh,
}

/// How texture coordinates are moved where they are optimised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// A start specialised to the signal, then variable projection: what the best texture
    /// leaves is reduced itself.
    #[default]
    Fit,
    /// The paper's alternation: steps of Adam on the texture, one step of L-BFGS on the
    /// coordinates.
    Paper,
}

impl Method {
    /// What moves coordinates in the paper's method, with and without its content-aware term
    /// (Table 3).
    pub(crate) fn guide(no_content_aware: bool) -> Guide {
        if no_content_aware { Guide::ImageLoss } else { Guide::ContentAware }
    }

    /// Checks that the paper's switch is only used with the paper's method.
    pub(crate) fn check(self, no_content_aware: bool) -> Result<(), BakeError> {
        if no_content_aware && self != Method::Paper {
            let range = "false, unless --method is paper".into();
            return Err(BakeError::Option { option: "no-content-aware", value: "true".into(), range });
        }
        Ok(())
    }
}

/// What lies behind the models while fitting: the low-poly is asked to look like this
/// where its silhouette goes beyond the high-poly's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Backdrop {
    /// Darkness, which shading at grazing light comes close to by itself.
    #[default]
    Black,
    /// Grey, of half the linear light of white.
    Grey,
    /// White.
    White,
}

impl Backdrop {
    /// Its linear light.
    pub fn light(self) -> [f32; 3] {
        match self {
            Backdrop::Black => [0.0; 3],
            Backdrop::Grey => [crate::evaluate::GREY; 3],
            Backdrop::White => [1.0; 3],
        }
    }
}

/// Options of a bake.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct BakeOptions {
    /// Side of the baked textures in texels, 16 to 8192
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 512))]
    pub texture_size: usize,

    /// How much time to spend for how much quality
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Preset::Balanced))]
    pub preset: Preset,

    /// What becomes of the low-poly's texture coordinates
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = UvMode::Optimize))]
    pub uv: UvMode,

    /// What becomes of the low-poly's vertices
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = ShapeMode::Free))]
    pub shape: ShapeMode,

    /// How depth is shown without triangles; viewers need to know the extension
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Parallax::None))]
    pub parallax: Parallax,

    /// Highest order of the parallax map's spherical harmonics, 0 to 7
    #[cfg_attr(feature = "clap", arg(long, value_name = "ORDER", default_value_t = 2))]
    pub parallax_order: usize,

    /// Keep what the low-poly shows beyond the high-poly's silhouette instead of cutting it out;
    /// only with --parallax sh
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_cutout: bool,

    /// Highest order of the cutout's spherical harmonics, 0 to 7
    #[cfg_attr(feature = "clap", arg(long, value_name = "ORDER", default_value_t = 2))]
    pub cutout_order: usize,

    /// Side of the cutout map in texels, 4 to 1024
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 128))]
    pub cutout_size: usize,

    /// Side of the parallax map in texels, 4 to 1024
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 64))]
    pub parallax_size: usize,

    /// How texture coordinates are moved; textures are fitted the same way after either
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Method::Fit))]
    pub method: Method,

    /// Leave out the paper's content-aware term; only with --method paper
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_content_aware: bool,

    /// Least distance between charts in texels, 0 to 64 [default: 1, from 512 on a 256th of the side]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "TEXELS"))]
    pub gutter: Option<f64>,

    /// Steps in which texture coordinates are moved, 0 to 10000 [default: by preset 10, 30, 60;
    /// with --method paper 800]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT"))]
    pub uv_steps: Option<usize>,

    /// How colours are understood when pictures are compared
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Convention::Gltf))]
    pub convention: Convention,

    /// What lies behind the models while fitting
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Backdrop::Black))]
    pub backdrop: Backdrop,

    /// How much pixels count where the low-poly reaches beyond the high-poly's silhouette, 0 to 1:
    /// 1 looks best on the backdrop's colour, 0 treats all backgrounds alike [default: 0.5, with a
    /// cutout 0]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "WEIGHT"))]
    pub silhouette: Option<f32>,

    /// Keep the projected normal map instead of fitting it
    #[cfg_attr(feature = "clap", arg(long))]
    pub keep_normals: bool,

    /// How far to either side of the low-poly projection looks for the high-poly, as a share of
    /// the high-poly's longest side, 0 to 1
    #[cfg_attr(
        feature = "clap",
        arg(long, allow_negative_numbers = true, value_name = "SHARE", default_value_t = 0.05)
    )]
    pub reach: f32,

    /// Training views, 1 to 4096 [default: by preset 240, 640, 1280]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT"))]
    pub views: Option<usize>,

    /// Side of a training view in pixels, 32 to 2048 [default: by preset 192, 192, 256, more for textures beyond 1024]
    #[cfg_attr(feature = "clap", arg(long, value_name = "PIXELS"))]
    pub view_size: Option<usize>,

    /// Turns that colours and normals take, 0 to 100, 0 for the projection as it is [default: by preset 3, 5, 8]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT"))]
    pub rounds: Option<usize>,

    /// Chooses the training views: another seed, another pool
    #[cfg_attr(feature = "clap", arg(long, value_name = "NUMBER", default_value_t = 0))]
    pub seed: u64,

    /// Threads to work with, 0 to 256, 0 for one a core; the result does not depend on it unless
    /// a time budget ends the run
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 0))]
    pub threads: usize,

    /// Seconds after which the best textures so far are written, 0 to 1e9; reading files counts, for
    /// a library from the call of `bake`. Projection is always finished [default: no limit]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "SECONDS"))]
    pub time_budget: Option<f64>,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            texture_size: 512,
            preset: Preset::Balanced,
            uv: UvMode::Optimize,
            shape: ShapeMode::Free,
            parallax: Parallax::None,
            parallax_order: 2,
            parallax_size: 64,
            no_cutout: false,
            cutout_order: 2,
            cutout_size: 128,
            method: Method::Fit,
            no_content_aware: false,
            gutter: None,
            uv_steps: None,
            convention: Convention::Gltf,
            backdrop: Backdrop::Black,
            silhouette: None,
            keep_normals: false,
            reach: 0.05,
            views: None,
            view_size: None,
            rounds: None,
            seed: 0,
            threads: 0,
            time_budget: None,
        }
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

/// Seconds below which a time budget is better spent on textures alone.
const LEAST_BUDGET: f64 = 8.0;

impl BakeOptions {
    /// The distance between charts in texels: as asked, or by the texture's size.
    pub fn gutter_texels(&self) -> f64 {
        self.gutter.unwrap_or((self.texture_size as f64 / 256.0).clamp(1.0, 8.0))
    }

    /// Whether there is only time for textures.
    fn hurried(&self) -> bool {
        self.time_budget.is_some_and(|seconds| seconds < LEAST_BUDGET)
    }

    /// What to do with vertices; none where they stay.
    pub(crate) fn shape_plan(&self) -> Option<ShapePlan> {
        let motion = match self.shape {
            ShapeMode::Keep => return None,
            ShapeMode::Normal => Motion::Normal,
            ShapeMode::Free => Motion::Free,
        };
        let (views, steps) = match self.preset {
            Preset::Fast => (96, 60),
            Preset::Balanced => (192, 160),
            Preset::Best => (384, 400),
        };
        let env = |name: &str, default: f32| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
        let fit = ShapeOptions {
            motion,
            steps: env("S_STEPS", steps as f32) as usize,
            rate: env("S_RATE", 4e-3),
            texture_rate: env("S_TRATE", 0.02),
            coverage: env("S_COV", 1.0),
            overhang_discount: env("S_OVER", if self.cuts() { 0.9 } else { 0.0 }),
            displacement: env("S_DISP", 0.0),
            views_per_step: env("S_VPS", 12.0) as usize,
            ..ShapeOptions::default()
        };
        (self.method == Method::Fit && !self.hurried()).then_some(ShapePlan {
            views: env("S_VIEWS", views as f32) as usize,
            view_size: env("S_SIZE", 160.0) as usize,
            texture_size: env("S_TEX", 128.0) as usize,
            samples: 3,
            fit,
        })
    }

    /// How cutout and parallax map are fitted; none where there are none.
    pub(crate) fn depth_plan(&self) -> Option<DepthPlan> {
        let (views, cutout_steps, steps) = match self.preset {
            Preset::Fast => (240, 200, 150),
            Preset::Balanced => (480, 300, 400),
            Preset::Best => (960, 500, 900),
        };
        let env = |name: &str, default: f32| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
        (self.parallax == Parallax::Sh && self.method == Method::Fit).then_some(DepthPlan {
            views: env("P_VIEWS", views as f32) as usize,
            texture_size: self.texture_size.min(env("P_TEX", 128.0) as usize),
            cutout: (!self.no_cutout).then_some(CutoutOptions {
                order: self.cutout_order,
                size: self.cutout_size,
                steps: env("C_STEPS", cutout_steps as f32) as usize,
                ..CutoutOptions::default()
            }),
            parallax: ParallaxOptions {
                order: self.parallax_order,
                size: self.parallax_size,
                steps: env("P_STEPS", steps as f32) as usize,
                rate: env("P_RATE", 3e-4),
                texture_rate: env("P_TRATE", 1e-2),
                ..ParallaxOptions::default()
            },
        })
    }

    /// Whether the low-poly is cut at the high-poly's silhouettes.
    fn cuts(&self) -> bool {
        self.parallax == Parallax::Sh && self.method == Method::Fit && !self.no_cutout
    }

    /// The paper's optimiser for vertices and parallax; none where neither is asked for.
    pub(crate) fn algorithm_plan(&self) -> Option<AlgorithmPlan> {
        let paper = AlgorithmOptions::default();
        let env = |name: &str, default: f32| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
        let fit = AlgorithmOptions {
            motion: (self.shape != ShapeMode::Keep).then_some(Motion::Normal),
            parallax: (self.parallax == Parallax::Sh).then_some((self.parallax_order, self.parallax_size)),
            texture_size: self.texture_size.min(256),
            displacement: env("A_DISP", paper.displacement),
            steps: env("A_STEPS", paper.steps as f32) as usize,
            vertex_rate: env("A_VRATE", paper.vertex_rate),
            coefficient_rate: env("A_CRATE", paper.coefficient_rate),
            views_per_step: env("A_VPS", paper.views_per_step as f32) as usize,
            ..paper
        };
        let moves = fit.motion.is_some() || fit.parallax.is_some();
        (self.method == Method::Paper && moves).then_some(AlgorithmPlan { views: 192, view_size: 160, fit })
    }

    /// How much pixels count beyond the high-poly's silhouette: none where they are cut out.
    pub(crate) fn silhouette_weight(&self) -> f32 {
        self.silhouette.unwrap_or(if self.cuts() { 0.0 } else { 0.5 })
    }

    /// What to do with texture coordinates in another mode.
    pub(crate) fn unfold_as(&self, mode: UvMode) -> UnfoldOptions {
        UnfoldOptions { mode, ..self.unfold() }
    }

    /// What to do with texture coordinates.
    pub(crate) fn unfold(&self) -> UnfoldOptions {
        let steps = match (self.method, self.preset) {
            (Method::Paper, _) => PaperOptions::default().rounds,
            (Method::Fit, Preset::Fast) => 10,
            (Method::Fit, Preset::Balanced) => 30,
            (Method::Fit, Preset::Best) => 60,
        };
        UnfoldOptions {
            mode: if self.hurried() && self.uv == UvMode::Optimize { UvMode::Repair } else { self.uv },
            method: self.method,
            guide: Method::guide(self.no_content_aware),
            texture_size: self.texture_size,
            gutter: self.gutter_texels(),
            gutter_asked: self.gutter.is_some(),
            steps: self.uv_steps.unwrap_or(steps),
        }
    }

    /// Checks every range; the error names the option and what it may be.
    pub fn check(&self) -> Result<(), BakeError> {
        let within = |option: &'static str, value: f64, low: f64, high: f64| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(BakeError::Option { option, value: value.to_string(), range: format!("{low} to {high}") })
            }
        };
        within("texture-size", self.texture_size as f64, 16.0, 8192.0)?;
        within("reach", f64::from(self.reach), 0.0, 1.0)?;
        within("silhouette", f64::from(self.silhouette.unwrap_or(0.0)), 0.0, 1.0)?;
        within("views", self.views.unwrap_or(1) as f64, 1.0, 4096.0)?;
        within("view-size", self.view_size.unwrap_or(32) as f64, 32.0, 2048.0)?;
        within("rounds", self.rounds.unwrap_or(0) as f64, 0.0, 100.0)?;
        within("gutter", self.gutter.unwrap_or(0.0), 0.0, 64.0)?;
        within("uv-steps", self.uv_steps.unwrap_or(0) as f64, 0.0, 10_000.0)?;
        within("parallax-order", self.parallax_order as f64, 0.0, 7.0)?;
        within("parallax-size", self.parallax_size as f64, 4.0, 1024.0)?;
        within("cutout-order", self.cutout_order as f64, 0.0, 7.0)?;
        within("cutout-size", self.cutout_size as f64, 4.0, 1024.0)?;
        within("threads", self.threads as f64, 0.0, crate::threads::MOST_THREADS as f64)?;
        within("time-budget", self.time_budget.unwrap_or(0.0), 0.0, 1e9)?;
        self.method.check(self.no_content_aware)
    }

    /// Settles what the preset leaves open.
    pub fn plan(&self) -> Plan {
        // Views matter more than their pixels: what a texel looks like depends on the
        // side it is seen from, and few sides are learnt by heart.
        let (views, view_size, rounds, final_steps) = match self.preset {
            Preset::Fast => (240, 192, 3, 1),
            Preset::Balanced => (640, 192, 5, 2),
            Preset::Best => (1280, 256, 8, 3),
        };
        // A texel that hardly a sample reads is noise: beyond 1024 texels views grow, though
        // by less than the texture, or bakes would take for ever.
        let finer = (self.texture_size as f32 / 1024.0).max(1.0).sqrt();
        let view_size = self.view_size.unwrap_or((view_size as f32 * finer) as usize);
        let rounds = self.rounds.unwrap_or(rounds);
        // A projection is only looked at, to report its loss.
        let views = if rounds == 0 { 16 } else { views };
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
                ..Schedule::default()
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects files that were written before there was a choice of methods.
    #[test]
    fn older_options_still_parse() {
        let options: BakeOptions = serde_json::from_str(r#"{"texture_size": 64, "uv_steps": 3}"#).unwrap();
        assert_eq!((options.method, options.no_content_aware), (Method::Fit, false));
        let options: crate::ImageOptions = serde_json::from_str(r#"{"grid": 20, "steps": 40}"#).unwrap();
        assert_eq!((options.method, options.steps), (Method::Fit, Some(40)));
    }

    /// Protects from a switch that does nothing: it belongs to the paper's method.
    #[test]
    fn the_papers_switch_needs_its_method() {
        let mut options = BakeOptions { no_content_aware: true, ..BakeOptions::default() };
        assert!(options.check().is_err());
        options.method = Method::Paper;
        assert!(options.check().is_ok());
        assert_eq!(options.unfold().guide, Guide::ImageLoss);
        assert_eq!(options.unfold().steps, 800);
        options.uv_steps = Some(7);
        assert_eq!(options.unfold().steps, 7);
        let picture = crate::ImageOptions { no_content_aware: true, ..crate::ImageOptions::default() };
        assert!(picture.check().is_err());
    }
}
