//! Options of a chain of levels of detail.

use crate::error::BakeError;
#[cfg(feature = "clap")]
use crate::options::heading;
use crate::options::{BakeOptions, Preset, Shading};
use parbake_files::NormalY;
use parbake_files::WriteOptions;
use parbake_views::importance::Importance;
use serde::{Deserialize, Serialize};

/// Options of a chain of levels of detail: one plain struct for library, command line and file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct LodOptions {
    /// Size on screen that each level is made for: pixels that the model's longest side spans, 16 to 4096, from large
    /// to small
    #[cfg_attr(feature = "clap", arg(long, value_delimiter = ',', value_name = "PIXELS", default_values_t = [300.0, 100.0, 50.0], help_heading = LEVELS))]
    pub screen_size: Vec<f64>,

    /// Triangles of each level, at most, 4 or more; as many numbers as levels [default: as many as --error needs, at most
    /// one for each pixel of a square of that size]
    #[cfg_attr(feature = "clap", arg(long, value_delimiter = ',', value_name = "COUNT", conflicts_with = "ratio", help_heading = LEVELS))]
    pub triangles: Vec<usize>,

    /// Triangles of each level as a share of the model's, above 0 to 1; as many numbers as levels
    #[cfg_attr(feature = "clap", arg(long, value_delimiter = ',', value_name = "SHARE", help_heading = LEVELS))]
    pub ratio: Vec<f64>,

    /// How far a level's surface may be off, in pixels at the level's size, 0.01 to 10; models of many small parts may
    /// be farther off
    #[cfg_attr(feature = "clap", arg(long, value_name = "PIXELS", default_value_t = 0.25, help_heading = LEVELS))]
    pub error: f64,

    /// PSNR in dB against the original that each level is to reach at its size, 15 to 60: triangles, texels and maps
    /// are searched for the smallest file that does, with at most 8 bakes a level
    #[cfg_attr(feature = "clap", arg(long, value_name = "DECIBELS", conflicts_with_all = ["triangles", "ratio", "error"], help_heading = LEVELS))]
    pub target_psnr: Option<f64>,

    /// Largest texture of a level, in texels along a side, 16 to 8192; textures follow the size on screen: about a texel
    /// for each pixel, more where finer maps show or charts need room
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 2048, value_parser = crate::texels::parse_texels, help_heading = LEVELS))]
    #[serde(deserialize_with = "crate::texels::texels")]
    pub max_texture_size: usize,

    /// Nodes of the model that stay apart, each with its child nodes, as a part with its name, pivot and material's name;
    /// all share one set of textures. Nodes without triangles, such as sockets, stay in place. NAME may hold * and ?. A
    /// list, or several times
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", value_delimiter = ',', help_heading = LEVELS))]
    pub keep_parts: Vec<String>,

    /// Keep parts that no view from outside shows, such as a motor inside its housing. By default they are left out, unless
    /// the model has a skin, morph targets or animations, or --keep-parts is used
    #[cfg_attr(feature = "clap", arg(long, help_heading = LEVELS))]
    pub keep_hidden: bool,

    /// PSNR in dB from which on a level cannot be told from the one before, 10 to 60; says where levels switch
    #[cfg_attr(feature = "clap", arg(long, value_name = "DECIBELS", default_value_t = 35.0, help_heading = LEVELS))]
    pub switch_psnr: f64,

    /// Height in pixels of the screen that coverages are shares of, 100 to 100000
    #[cfg_attr(feature = "clap", arg(long, value_name = "PIXELS", default_value_t = 1080.0, help_heading = LEVELS))]
    pub viewport_height: f64,

    /// Trades time for quality
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Preset::Fast, help_heading = heading::QUALITY))]
    pub preset: Preset,

    /// What of the model's materials is fitted; pbr is the whole metallic-roughness material
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Shading::Auto, help_heading = heading::QUALITY))]
    pub shading: Shading,

    /// How much a material of the model counts, or with node:NAME=WEIGHT a node with its child nodes, 0.01 to 100, for
    /// texels and triangles; all else has 1. NAME may hold * and ?. May be given several times; the last that fits counts
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME=WEIGHT", help_heading = heading::QUALITY))]
    pub importance: Vec<Importance>,

    /// Vertex attribute of the model in which importances are painted: COLOR_1 or another colour, whose red counts, or a
    /// number of your own such as _IMPORTANCE. From 0 to 1: 0 counts a sixteenth, 0.5 is neutral, 1 counts sixteen times
    #[cfg_attr(feature = "clap", arg(long, value_name = "ATTRIBUTE", help_heading = heading::QUALITY))]
    pub importance_attribute: Option<String>,

    /// Seconds after which levels are finished with what there is, 0 to 1e9, reading of files included: fewer steps,
    /// fewer ways to make a level and smaller textures, no level less [default: no limit]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "SECONDS", help_heading = heading::QUALITY))]
    pub time_budget: Option<f64>,

    /// How files are written
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub write: WriteOptions,

    /// Make materials double-sided only where the high-poly's are. By default closed surfaces are, too, so that small
    /// holes of the low-poly do not show
    #[cfg_attr(feature = "clap", arg(long, help_heading = heading::ADVANCED))]
    pub keep_sides: bool,

    /// Direction of the green channel of the normal maps that are written
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = NormalY::Up, help_heading = heading::ADVANCED))]
    pub normal_y: NormalY,

    /// Random seed of all views, 0 to 2^64 - 1
    #[cfg_attr(feature = "clap", arg(long, value_name = "NUMBER", default_value_t = 0, help_heading = heading::ADVANCED))]
    pub seed: u64,

    /// Number of threads, 0 to 256; 0 is one a core. The result depends on it only if a time
    /// budget ends the run
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 0, help_heading = heading::ADVANCED))]
    pub threads: usize,
}

/// Heading in `--help`.
#[cfg(feature = "clap")]
const LEVELS: &str = "Levels";

impl Default for LodOptions {
    fn default() -> Self {
        Self {
            screen_size: vec![300.0, 100.0, 50.0],
            triangles: Vec::new(),
            ratio: Vec::new(),
            error: 0.25,
            target_psnr: None,
            keep_parts: Vec::new(),
            keep_hidden: false,
            max_texture_size: 2048,
            switch_psnr: 35.0,
            viewport_height: 1080.0,
            preset: Preset::Fast,
            shading: Shading::Auto,
            importance: Vec::new(),
            importance_attribute: None,
            time_budget: None,
            write: WriteOptions::default(),
            keep_sides: false,
            normal_y: NormalY::Up,
            seed: 0,
            threads: 0,
        }
    }
}

/// Most levels of a chain: Unity reads no more.
const MOST_LEVELS: usize = 8;

impl LodOptions {
    /// Checks every range and combination.
    ///
    /// # Errors
    /// [`BakeError::Option`].
    pub fn check(&self) -> Result<(), BakeError> {
        let refuse = |option: &'static str, value: String, range: &str| {
            Err(BakeError::Option { option, value, range: range.into() })
        };
        let listed = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let sizes = &self.screen_size;
        if sizes.is_empty() || sizes.len() > MOST_LEVELS || !sizes.iter().all(|s| (16.0..=4096.0).contains(s))
        {
            return refuse("screen-size", listed(sizes), "1 to 8 numbers of 16 to 4096 pixels");
        }
        if sizes.windows(2).any(|pair| pair[0] <= pair[1]) {
            return refuse("screen-size", listed(sizes), "in descending order, as 300,100,50");
        }
        let count = format!("{} numbers, one for each --screen-size", sizes.len());
        if !self.triangles.is_empty() && self.triangles.len() != sizes.len() {
            let given: Vec<String> = self.triangles.iter().map(usize::to_string).collect();
            return refuse("triangles", given.join(","), &count);
        }
        if let Some(few) = self.triangles.iter().find(|&&count| count < 4) {
            return refuse("triangles", few.to_string(), "4 or more");
        }
        if !self.ratio.is_empty() && self.ratio.len() != sizes.len() {
            return refuse("ratio", listed(&self.ratio), &count);
        }
        if let Some(share) = self.ratio.iter().find(|&&share| !(share > 0.0 && share <= 1.0)) {
            return refuse("ratio", share.to_string(), "above 0, up to 1");
        }
        let ranges = [
            ("error", self.error, 0.01, 10.0),
            ("max-texture-size", self.max_texture_size as f64, 16.0, 8192.0),
            ("switch-psnr", self.switch_psnr, 10.0, 60.0),
            ("viewport-height", self.viewport_height, 100.0, 1e5),
            ("target-psnr", self.target_psnr.unwrap_or(30.0), 15.0, 60.0),
            ("time-budget", self.time_budget.unwrap_or(0.0), 0.0, 1e9),
        ];
        if let Some(target) = self.target_psnr.filter(|_| self.triangles.len() + self.ratio.len() > 0) {
            let range = "left out where triangles or ratio say how large levels are";
            return refuse("target-psnr", target.to_string(), range);
        }
        for (option, value, low, high) in ranges {
            if !(low..=high).contains(&value) {
                return refuse(option, value.to_string(), &format!("{low} to {high}"));
            }
        }
        self.bake(self.max_texture_size).check()
    }

    /// The options of a level's bake.
    pub fn bake(&self, texture_size: usize) -> BakeOptions {
        BakeOptions {
            texture_size,
            preset: self.preset,
            shading: self.shading,
            importance: self.importance.clone(),
            importance_attribute: self.importance_attribute.clone(),
            keep_sides: self.keep_sides,
            normal_y: self.normal_y,
            seed: self.seed,
            threads: self.threads,
            write: self.write,
            ..BakeOptions::default()
        }
    }
}
