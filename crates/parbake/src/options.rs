//! Options of a bake: one plain struct for the library, the command line and the options file.
//! Every field states its unit, range and default; `None` in a field means that preset, texture size
//! or other options decide.

use crate::error::BakeError;
#[cfg(feature = "clap")]
use crate::texels::parse_texels;
use crate::texels::{some_texels, texels};
use parbake_evaluate::conventions::check_shading;
pub use parbake_evaluate::conventions::{Convention, GREY, Shading};
use parbake_files::{NormalY, WriteOptions};
pub use parbake_uv::mode::{Method, UvMode};
use parbake_views::importance::Importance;
use serde::{Deserialize, Serialize};

/// Headings of options in `--help`.
#[cfg(feature = "clap")]
pub mod heading {
    /// Texture size, presets, views.
    pub const QUALITY: &str = "Quality";
    /// Texture coordinates.
    pub const UV: &str = "UV";
    /// Vertices and outlines.
    pub const SHAPE: &str = "Shape";
    /// Parallax maps and cutouts.
    pub const PARALLAX: &str = "Parallax";
    /// What few users need.
    pub const ADVANCED: &str = "Advanced";
    /// What reproduces earlier work or serves experiments.
    pub const RESEARCH: &str = "Research";
}

/// Time against quality.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// A preview within seconds.
    Fast,
    /// For most bakes.
    #[default]
    Balanced,
    /// A few tenths of a decibel more, for two to three times the time.
    Best,
}

/// How vertices are moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum ShapeMode {
    /// Vertices stay.
    Keep,
    /// Vertices move along their normals only.
    Normal,
    /// Research only: vertices move freely under a Laplacian term, as in earlier work.
    #[cfg_attr(feature = "clap", value(hide = true))]
    Laplacian,
    /// Vertices move until outlines agree.
    #[default]
    Free,
}

/// Whether depth is faked by maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Parallax {
    /// No maps: plain glTF.
    #[default]
    None,
    /// A parallax map and a cutout in the tangent frame: two textures and five fetches more than plain glTF, in the
    /// material extension PARBAKE_materials_parallax (docs/parallax_format.md).
    Tangent,
    /// The paper's: spherical harmonics in the mesh's axes, in PARBAKE_materials_parallax_sh
    /// (docs/parallax_sh_format.md); for research.
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

/// Background of the training views: what the low-poly shall look like where it overhangs the
/// high-poly's outline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum SilhouetteBackground {
    /// Black, which shading at grazing angles comes close to by itself.
    #[default]
    Black,
    /// Grey: half the linear light of white.
    Grey,
    /// White.
    White,
}

impl SilhouetteBackground {
    /// Its linear light.
    pub fn light(self) -> [f32; 3] {
        match self {
            SilhouetteBackground::Black => [0.0; 3],
            SilhouetteBackground::Grey => [GREY; 3],
            SilhouetteBackground::White => [1.0; 3],
        }
    }
}

/// Options of a bake.
///
/// [`BakeOptions::check`] checks ranges and combinations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct BakeOptions {
    /// Side of the baked textures in texels, 16 to 8192; 1k, 2k, 4k and 8k mean 1024, 2048, 4096 and 8192
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 512, value_parser = parse_texels, help_heading = heading::QUALITY))]
    #[serde(deserialize_with = "texels")]
    pub texture_size: usize,

    /// Trades time for quality
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Preset::Balanced, help_heading = heading::QUALITY))]
    pub preset: Preset,

    /// UV mode: how the low-poly's texture coordinates are treated
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = UvMode::Optimize, help_heading = heading::UV))]
    pub uv: UvMode,

    /// Shape mode: how the low-poly's vertices are moved
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = ShapeMode::Free, help_heading = heading::SHAPE))]
    pub shape: ShapeMode,

    /// Parallax maps, which fake depth and cut round outlines; viewers need to know the glTF extension
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Parallax::None, help_heading = heading::PARALLAX))]
    pub parallax: Parallax,

    /// Highest order of the parallax map's spherical harmonics, 0 to 7; needs --parallax sh
    #[cfg_attr(feature = "clap", arg(long, value_name = "ORDER", default_value_t = 2, help_heading = heading::PARALLAX))]
    pub parallax_order: usize,

    /// Fit no cutout (view-dependent opacity mask): outlines stay those of the triangles; needs --parallax
    #[cfg_attr(feature = "clap", arg(long, help_heading = heading::PARALLAX))]
    pub no_cutout: bool,

    /// Highest order of the cutout's spherical harmonics, 0 to 7; needs --parallax sh
    #[cfg_attr(feature = "clap", arg(long, value_name = "ORDER", default_value_t = 4, help_heading = heading::PARALLAX))]
    pub cutout_order: usize,

    /// Side of the cutout map in texels, 4 to 1024; needs --parallax
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 128, value_parser = parse_texels, help_heading = heading::PARALLAX))]
    #[serde(deserialize_with = "texels")]
    pub cutout_size: usize,

    /// Side in texels of base colour for viewers that do not know parallax maps, 16 to 8192; their normals have half of
    /// it, from 32 on. With 0 the maps' textures serve all viewers. Needs --parallax [default: the smallest of a quarter,
    /// half and all of --texture-size that is about as good; 0 if the maps' textures are]
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", value_parser = parse_texels, help_heading = heading::PARALLAX))]
    #[serde(deserialize_with = "some_texels")]
    pub fallback_size: Option<usize>,

    /// Side of the parallax map in texels, 4 to 1024; needs --parallax
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 64, value_parser = parse_texels, help_heading = heading::PARALLAX))]
    #[serde(deserialize_with = "texels")]
    pub parallax_size: usize,

    /// Padding between charts (UV islands) in texels, 0 to 64 [default: texture size / 256, at least 1, at most 8;
    /// with --parallax and few charts two texels of the parallax map]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "TEXELS", help_heading = heading::UV))]
    pub gutter: Option<f64>,

    /// Smallest mip level at which charts of a layout that is made here should be two texels apart, as far as they are few
    /// enough; levels of detail settle it
    #[cfg_attr(feature = "clap", arg(skip))]
    #[serde(skip)]
    pub smallest_mip: Option<f64>,

    /// Refinement steps of the UV optimiser, 0 to 10000 [default: by preset 10, 30, 60; `fast` and `balanced` do not refine
    /// low-polys with 80 texels or more a triangle; with --method paper 800]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", help_heading = heading::UV))]
    pub uv_steps: Option<usize>,

    /// Triangles that compress may add, 0 to 1000000: those with the largest error are halved so that UVs can
    /// bend more. The shape does not change [default: one for each 32 texels, at most 2000]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", hide = true, help_heading = heading::UV))]
    pub more_triangles: Option<usize>,

    /// Background of the training views, where the low-poly overhangs the high-poly's outline
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = SilhouetteBackground::Black, help_heading = heading::SHAPE))]
    pub silhouette_background: SilhouetteBackground,

    /// Weight of pixels where the low-poly overhangs the high-poly's outline, 0 to 1. High values darken the
    /// edges: best on black. 0 is neutral: best on varied backgrounds [default: 0.5, with a cutout 0]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "WEIGHT", help_heading = heading::SHAPE))]
    pub silhouette: Option<f32>,

    /// Training views, 1 to 4096 [default: by preset 160 (240 for parallax maps), 960, 1280]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", help_heading = heading::QUALITY))]
    pub views: Option<usize>,

    /// Side of a training view in pixels, 32 to 2048 [default: by preset 192, 192, 256, larger for textures
    /// above 1024, with `fast` above 512]
    #[cfg_attr(feature = "clap", arg(long, value_name = "PIXELS", help_heading = heading::QUALITY))]
    pub view_size: Option<usize>,

    /// Rounds of the texture solve, 0 to 100: each solves for every fitted map in turn. 0 writes the projected
    /// textures. Whole materials (--shading pbr) need one round, and more change nothing
    /// [default: by preset 3, 5, 8]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", help_heading = heading::QUALITY))]
    pub rounds: Option<usize>,

    /// How much a material of the high-poly counts, or with node:NAME=WEIGHT a node with its child nodes, 0.01 to 100, for
    /// texels and, with --triangles, for triangles; all else has 1. NAME may hold * and ?. May be given several times; the
    /// last that fits counts
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME=WEIGHT", help_heading = heading::QUALITY))]
    pub importance: Vec<Importance>,

    /// Vertex attribute of the high-poly in which importances are painted: COLOR_1 or another colour, whose red counts, or a
    /// number of your own such as _IMPORTANCE. From 0 to 1: 0 counts a sixteenth, 0.5 is neutral, 1 counts sixteen times
    #[cfg_attr(feature = "clap", arg(long, value_name = "ATTRIBUTE", help_heading = heading::QUALITY))]
    pub importance_attribute: Option<String>,

    /// Nodes of the high-poly that stay apart, with --triangles, each with its child nodes, as a part with its name,
    /// pivot and material's name; all share one set of textures. Nodes without triangles, such as sockets, stay in
    /// place. NAME may hold * and ?. A list, or several times
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", value_delimiter = ',', help_heading = heading::SHAPE))]
    pub keep_parts: Vec<String>,

    /// Seconds after which the best textures so far are written, 0 to 1e9, reading of files included. Below 8
    /// (34 at 2048², 135 at 4096²) vertices stay and UVs are only repaired [default: no limit]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "SECONDS", help_heading = heading::QUALITY))]
    pub time_budget: Option<f64>,

    /// How a file of the result is written; a bake itself does not depend on it
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub write: WriteOptions,

    /// Shading convention of the pictures that are fitted
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Convention::Gltf, help_heading = heading::ADVANCED))]
    pub convention: Convention,

    /// What of the high-poly's materials is fitted; pbr is the whole metallic-roughness material
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Shading::Auto, help_heading = heading::QUALITY))]
    pub shading: Shading,

    /// Keep the projected normal map instead of fitting it
    #[cfg_attr(feature = "clap", arg(long, help_heading = heading::ADVANCED))]
    pub keep_normals: bool,

    /// Make materials double-sided only where the high-poly's are. By default closed surfaces are, too, so that small
    /// holes of the low-poly do not show
    #[cfg_attr(feature = "clap", arg(long, help_heading = heading::ADVANCED))]
    pub keep_sides: bool,

    /// Direction of the green channel of the normal map that is written
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = NormalY::Up, help_heading = heading::ADVANCED))]
    pub normal_y: NormalY,

    /// Distance to either side of the low-poly within which projection looks for the high-poly, as a share of
    /// the high-poly's longest side, 0 to 1
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "SHARE", default_value_t = 0.05, help_heading = heading::ADVANCED))]
    pub max_distance: f32,

    /// Random seed of the training views, 0 to 2^64 - 1
    #[cfg_attr(feature = "clap", arg(long, value_name = "NUMBER", default_value_t = 0, help_heading = heading::ADVANCED))]
    pub seed: u64,

    /// Number of threads, 0 to 256; 0 is one a core. The result depends on it only if a time budget ends the run
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 0, help_heading = heading::ADVANCED))]
    pub threads: usize,

    /// UV optimiser, and with `paper` also that of vertices and parallax maps; textures are solved the same way
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Method::Fit, help_heading = heading::RESEARCH))]
    pub method: Method,

    /// Leave out the content-aware term of the paper's UV optimiser; needs --method paper
    #[cfg_attr(feature = "clap", arg(long, help_heading = heading::RESEARCH))]
    pub no_content_aware: bool,

    /// Scale of the robust (Cauchy) loss of the texture solve, in display units, 0.01 to 1000. Lower it if
    /// surfaces look mottled; 1000 is least squares [default: 1, with --parallax 0.5, with --method paper 1000]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "DIFFERENCE", help_heading = heading::RESEARCH))]
    pub robust_scale: Option<f32>,
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
            fallback_size: None,
            method: Method::Fit,
            no_content_aware: false,
            gutter: None,
            smallest_mip: None,
            uv_steps: None,
            more_triangles: None,
            convention: Convention::Gltf,
            silhouette_background: SilhouetteBackground::Black,
            shading: Shading::Auto,
            silhouette: None,
            keep_normals: false,
            keep_sides: false,
            normal_y: NormalY::Up,
            robust_scale: None,
            max_distance: 0.05,
            views: None,
            view_size: None,
            rounds: None,
            importance: Vec::new(),
            importance_attribute: None,
            keep_parts: Vec::new(),
            seed: 0,
            threads: 0,
            time_budget: None,
            write: WriteOptions::default(),
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

    /// Checks every range and combination; the error names the option and what it may be.
    ///
    /// # Errors
    /// [`BakeError::Option`].
    pub fn check(&self) -> Result<(), BakeError> {
        let within = |option: &'static str, value: f64, low: f64, high: f64| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(BakeError::Option { option, value: value.to_string(), range: format!("{low} to {high}") })
            }
        };
        within("texture-size", self.texture_size as f64, 16.0, 8192.0)?;
        within("max-distance", f64::from(self.max_distance), 0.0, 1.0)?;
        within("silhouette", f64::from(self.silhouette.unwrap_or(0.0)), 0.0, 1.0)?;
        within("robust-scale", f64::from(self.robust_scale.unwrap_or(1.0)), 0.01, 1000.0)?;
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
        if let Some(size) = self.fallback_size.filter(|&size| size > 0) {
            within("fallback-size", size as f64, 16.0, 8192.0)?;
        }
        within("threads", self.threads as f64, 0.0, crate::threads::MOST_THREADS as f64)?;
        within("time-budget", self.time_budget.unwrap_or(0.0), 0.0, 1e9)?;
        within("texture-quality", f64::from(self.write.texture_quality), 1.0, 100.0)?;
        check_shading(self.shading, self.convention)?;
        if self.parallax == Parallax::Tangent && self.method == Method::Paper {
            let range = "none or sh with --method paper".into();
            return Err(BakeError::Option { option: "parallax", value: "tangent".into(), range });
        }
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

    /// Protects files of options: formats stand beside all others, under the names of the command line; a name that
    /// nobody knows is refused, and so is a quality out of range.
    #[test]
    fn formats_are_options_like_others() {
        let text = r#"{"texture_format": "ktx2-etc1s", "texture_quality": 60, "mesh_compression": "meshopt", "seed": 3}"#;
        let options: BakeOptions = serde_json::from_str(text).unwrap();
        let write = WriteOptions {
            texture_format: parbake_files::TextureFormat::Ktx2Etc1s,
            texture_quality: 60,
            mesh_compression: parbake_files::MeshCompression::Meshopt,
            ..WriteOptions::default()
        };
        assert_eq!((options.write, options.seed), (write, 3));
        let json = serde_json::to_value(&options).unwrap();
        assert_eq!(json["texture_format"], "ktx2-etc1s");
        assert_eq!(serde_json::from_value::<BakeOptions>(json).unwrap(), options);
        for wrong in
            [r#"{"texture_fromat": "png"}"#, r#"{"texture_format": "bmp"}"#, r#"{"texture_quality": 300}"#]
        {
            assert!(serde_json::from_str::<BakeOptions>(wrong).is_err(), "{wrong}");
        }
        let none = WriteOptions { texture_quality: 0, ..WriteOptions::default() };
        assert!(BakeOptions { write: none, ..BakeOptions::default() }.check().is_err());
    }

    /// Protects from a switch that does nothing: it belongs to the paper's method.
    #[test]
    fn the_papers_switch_needs_its_method() {
        let mut options = BakeOptions { no_content_aware: true, ..BakeOptions::default() };
        assert!(options.check().is_err());
        options.method = Method::Paper;
        assert!(options.check().is_ok());
        assert_eq!(options.uv_stage().guide, Guide::ImageLoss);
        assert_eq!(options.uv_stage().steps, 800);
        options.uv_steps = Some(7);
        assert_eq!(options.uv_stage().steps, 7);
        let picture = crate::ImageOptions { no_content_aware: true, ..crate::ImageOptions::default() };
        assert!(picture.check().is_err());
    }

    /// Protects the paper's method from our loss, and what a user asks for from defaults.
    #[test]
    fn outliers_count_as_the_method_says() {
        let scale = |options: BakeOptions| options.plan().schedule.robust_scale;
        let own = BakeOptions::default;
        assert_eq!(scale(own()), 1.0);
        assert_eq!(scale(BakeOptions { parallax: Parallax::Sh, ..own() }), 0.5);
        assert_eq!(scale(BakeOptions { parallax: Parallax::Tangent, ..own() }), 0.5);
        assert_eq!(scale(BakeOptions { parallax: Parallax::Sh, method: Method::Paper, ..own() }), 1000.0);
        assert_eq!(scale(BakeOptions { parallax: Parallax::Sh, robust_scale: Some(0.2), ..own() }), 0.2);
        assert!(BakeOptions { robust_scale: Some(0.0), ..own() }.check().is_err());
    }
}
