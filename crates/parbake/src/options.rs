//! What a user can ask for: one plain struct for the library, the command line and
//! the options file. Every field states its unit, range and default; `None` in a
//! quality field means "as the preset says".

use crate::error::BakeError;
use parbake_image::display::{Curve, Display};
use parbake_render::interpretation::Interpretation;
pub use parbake_uv::mode::{Method, UvMode};
use serde::{Deserialize, Serialize};

/// How much time a bake may take for how much quality.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// A look within seconds.
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

/// What becomes of vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum ShapeMode {
    /// They stay as they are.
    Keep,
    /// They move along their normals, as in the paper.
    Normal,
    /// They move anywhere, held together by a Laplacian term as in earlier work, for comparison.
    Laplacian,
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

/// Checks that the paper's switch is only used with the paper's method.
pub(crate) fn check_content_aware(method: Method, no_content_aware: bool) -> Result<(), BakeError> {
    if no_content_aware && method != Method::Paper {
        let range = "false, unless --method is paper".into();
        return Err(BakeError::Option { option: "no-content-aware", value: "true".into(), range });
    }
    Ok(())
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
            Backdrop::Grey => [crate::evaluate::options::GREY; 3],
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
    #[cfg_attr(feature = "clap", arg(long, value_name = "ORDER", default_value_t = 4))]
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

    /// Least distance between charts in texels, 0 to 64 [default: a 256th of the side, 1 to 8;
    /// with a parallax map two of its texels where charts are few: 16 for a map of 64²]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "TEXELS"))]
    pub gutter: Option<f64>,

    /// Steps in which texture coordinates are moved, 0 to 10000 [default: by preset 10, 30, 60,
    /// eight times as many where a model is compressed; with --method paper 800]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT"))]
    pub uv_steps: Option<usize>,

    /// Triangles that a compressed model may have more than it had, 0 to 1000000: those with the largest
    /// errors are halved, so that texture coordinates can bend within them. The surface stays [default: one for
    /// each 32 texels of the texture, at most 2000]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT"))]
    pub more_triangles: Option<usize>,

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

    /// Length of a pixel's display difference (three channels from 0 to 1) at which it counts half in
    /// the textures, since no texture can please it, 0.01 to 1000; twice as much where it is too dark.
    /// Less keeps surfaces clean where views contradict each other, 1000 is as good as plain least
    /// squares [default: 1, with parallax maps 0.5, with --method paper 1000]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "DIFFERENCE"))]
    pub outlier: Option<f32>,

    /// How far to either side of the low-poly projection looks for the high-poly, as a share of
    /// the high-poly's longest side, 0 to 1
    #[cfg_attr(
        feature = "clap",
        arg(long, allow_negative_numbers = true, value_name = "SHARE", default_value_t = 0.05)
    )]
    pub reach: f32,

    /// Training views, 1 to 4096 [default: by preset 240, 960, 1280]
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
    /// a library from the call of `bake`. Projection is always finished; below 8 seconds vertices stay
    /// and texture coordinates are only mended, and with any budget maps learn from 96 views
    /// [default: no limit]
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
            cutout_order: 4,
            cutout_size: 128,
            method: Method::Fit,
            no_content_aware: false,
            gutter: None,
            uv_steps: None,
            more_triangles: None,
            convention: Convention::Gltf,
            backdrop: Backdrop::Black,
            silhouette: None,
            keep_normals: false,
            outlier: None,
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

impl BakeOptions {
    /// The distance between charts in texels: as asked, or by the texture's size.
    pub fn gutter_texels(&self) -> f64 {
        self.gutter.unwrap_or((self.texture_size as f64 / 256.0).clamp(1.0, 8.0))
    }

    /// The triangles that a compressed model may have more: as asked, or by the texture's size. Each takes
    /// some 25 bytes; what they gain falls with the texture's size, what texels gain does not.
    pub fn more_triangles(&self) -> usize {
        self.more_triangles.unwrap_or((self.texture_size * self.texture_size / 32).min(2000))
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
        within("outlier", f64::from(self.outlier.unwrap_or(1.0)), 0.01, 1000.0)?;
        within("views", self.views.unwrap_or(1) as f64, 1.0, 4096.0)?;
        within("view-size", self.view_size.unwrap_or(32) as f64, 32.0, 2048.0)?;
        within("rounds", self.rounds.unwrap_or(0) as f64, 0.0, 100.0)?;
        within("gutter", self.gutter.unwrap_or(0.0), 0.0, 64.0)?;
        within("uv-steps", self.uv_steps.unwrap_or(0) as f64, 0.0, 10_000.0)?;
        within("more-triangles", self.more_triangles.unwrap_or(0) as f64, 0.0, 1e6)?;
        within("parallax-order", self.parallax_order as f64, 0.0, 7.0)?;
        within("parallax-size", self.parallax_size as f64, 4.0, 1024.0)?;
        within("cutout-order", self.cutout_order as f64, 0.0, 7.0)?;
        within("cutout-size", self.cutout_size as f64, 4.0, 1024.0)?;
        within("threads", self.threads as f64, 0.0, crate::threads::MOST_THREADS as f64)?;
        within("time-budget", self.time_budget.unwrap_or(0.0), 0.0, 1e9)?;
        if self.shape == ShapeMode::Laplacian && self.method == Method::Paper {
            let range = "keep or normal with --method paper".into();
            return Err(BakeError::Option { option: "shape", value: "laplacian".into(), range });
        }
        check_content_aware(self.method, self.no_content_aware)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_uv::paper::Guide;

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

    /// Protects the paper's method from our loss, and what a user asks for from defaults.
    #[test]
    fn outliers_count_as_the_method_says() {
        let scale = |options: BakeOptions| options.plan().schedule.outlier;
        let own = BakeOptions::default;
        assert_eq!(scale(own()), 1.0);
        assert_eq!(scale(BakeOptions { parallax: Parallax::Sh, ..own() }), 0.5);
        assert_eq!(scale(BakeOptions { parallax: Parallax::Sh, method: Method::Paper, ..own() }), 1000.0);
        assert_eq!(scale(BakeOptions { parallax: Parallax::Sh, outlier: Some(0.2), ..own() }), 0.2);
        assert!(BakeOptions { outlier: Some(0.0), ..own() }.check().is_err());
    }
}
