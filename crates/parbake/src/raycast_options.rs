//! Options of `parbake raycast`.

use crate::error::BakeError;
#[cfg(feature = "clap")]
use crate::options::heading;
use crate::options::{BakeOptions, UvMode};
#[cfg(feature = "clap")]
use crate::texels::parse_texels;
use crate::texels::texels;
use parbake_files::NormalY;
use parbake_files::WriteOptions;
use parbake_raycast::{CastOptions, GeometryMap};
use parbake_views::projection::Search;
use serde::{Deserialize, Serialize};

/// How the low-poly's texture coordinates are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum RaycastUv {
    /// Keep UVs as they are.
    Keep,
    /// Repair what overlaps, is mirrored or lies outside the square; keep sound UVs, make missing ones.
    #[default]
    Repair,
    /// Replace UVs by a new unwrap.
    Unwrap,
}

/// Which point of the high-poly a texel shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Match {
    /// Along the ray, within the cage, what is nearest to the low-poly.
    #[default]
    Nearest,
    /// Along the ray what comes first from outside the cage: parts that float over the surface are baked.
    Outermost,
    /// The closest point in space, without rays.
    ClosestPoint,
}

/// Directions of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum RayNormals {
    /// The low-poly's own normals: nothing is slanted on flat sides, gaps at hard edges take the closest point.
    #[default]
    Own,
    /// Normals averaged over all triangles at a vertex: no gaps at hard edges.
    Averaged,
}

/// Options of [`crate::raycast`]. [`RaycastOptions::check`] checks ranges.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct RaycastOptions {
    /// Side of the baked textures in texels, 16 to 8192; 1k, 2k, 4k and 8k mean 1024, 2048, 4096 and 8192
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 512, value_parser = parse_texels, help_heading = heading::QUALITY))]
    #[serde(deserialize_with = "texels")]
    pub texture_size: usize,

    /// Samples a texel, 1 to 64
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 2, help_heading = heading::QUALITY))]
    pub samples: usize,

    /// UV mode: how the low-poly's texture coordinates are treated
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = RaycastUv::Repair, help_heading = heading::UV))]
    pub uv: RaycastUv,

    /// Padding between charts (UV islands) in texels, 0 to 64, where UVs are made or packed anew
    /// [default: texture size / 256, at least 1, at most 8]
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "TEXELS", help_heading = heading::UV))]
    pub gutter: Option<f64>,

    /// Cage: distance to either side of the low-poly within which rays look for the high-poly, as a share of
    /// the high-poly's longest side, 0 to 1
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "SHARE", default_value_t = 0.05, help_heading = RAYS))]
    pub max_distance: f32,

    /// Which point of the high-poly a texel shows
    #[cfg_attr(feature = "clap", arg(long = "match", value_enum, default_value_t = Match::Nearest, help_heading = RAYS))]
    pub r#match: Match,

    /// Directions of rays
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = RayNormals::Own, help_heading = RAYS))]
    pub ray_normals: RayNormals,

    /// Maps of shape to write beside the output as 16-bit PNG, a list with commas: OUTPUT_occlusion.png and
    /// so on
    #[cfg_attr(feature = "clap", arg(long, value_enum, value_delimiter = ',', value_name = "MAPS", help_heading = MAPS))]
    pub maps: Vec<GeometryMap>,

    /// Put ambient occlusion into the material, in the place of what the high-poly's materials say of it
    #[cfg_attr(feature = "clap", arg(long, help_heading = MAPS))]
    pub occlusion_texture: bool,

    /// Rays a texel for occlusion, bent normals and thickness, 1 to 65536
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 64, help_heading = MAPS))]
    pub rays: usize,

    /// How far away things occlude, as a share of the high-poly's longest side, 0 to 10
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "SHARE", default_value_t = 1.0, help_heading = MAPS))]
    pub occlusion_distance: f32,

    /// Scale of the curvature map, as a share of the high-poly's longest side, 0.0001 to 1: a hard edge is a
    /// line so wide to either side
    #[cfg_attr(feature = "clap", arg(long, allow_negative_numbers = true, value_name = "SHARE", default_value_t = 0.01, help_heading = MAPS))]
    pub curvature_radius: f32,

    /// How a file of the result is written; a bake itself does not depend on it
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub write: WriteOptions,

    /// Make materials double-sided only where the high-poly's are. By default closed surfaces are, too, so that small
    /// holes of the low-poly do not show
    #[cfg_attr(feature = "clap", arg(long, help_heading = heading::ADVANCED))]
    pub keep_sides: bool,

    /// Direction of the green channel of tangent-space normal maps that are written
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = NormalY::Up, help_heading = heading::ADVANCED))]
    pub normal_y: NormalY,

    /// Number of threads, 0 to 256; 0 is one a core. The result does not depend on it
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 0, help_heading = heading::ADVANCED))]
    pub threads: usize,
}

/// Headings in `--help`.
#[cfg(feature = "clap")]
const RAYS: &str = "Rays";
#[cfg(feature = "clap")]
const MAPS: &str = "Maps of shape";

impl Default for RaycastOptions {
    fn default() -> Self {
        Self {
            texture_size: 512,
            samples: 2,
            uv: RaycastUv::Repair,
            gutter: None,
            max_distance: 0.05,
            r#match: Match::Nearest,
            ray_normals: RayNormals::Own,
            maps: Vec::new(),
            occlusion_texture: false,
            rays: 64,
            occlusion_distance: 1.0,
            curvature_radius: 0.01,
            write: WriteOptions::default(),
            keep_sides: false,
            normal_y: NormalY::Up,
            threads: 0,
        }
    }
}

impl RaycastOptions {
    /// Checks every range; the error names the option and what it may be.
    ///
    /// # Errors
    /// [`BakeError::Option`].
    pub fn check(&self) -> Result<(), BakeError> {
        self.as_bake().check()?;
        let within = |option: &'static str, value: f64, low: f64, high: f64| match (low..=high)
            .contains(&value)
        {
            true => Ok(()),
            false => {
                Err(BakeError::Option { option, value: value.to_string(), range: format!("{low} to {high}") })
            }
        };
        within("samples", self.samples as f64, 1.0, 64.0)?;
        within("rays", self.rays as f64, 1.0, 65_536.0)?;
        within("occlusion-distance", f64::from(self.occlusion_distance), 0.0, 10.0)?;
        // As they are typed: 0.0001 in single precision is a little less.
        within("curvature-radius", f64::from(self.curvature_radius), 0.000_099_999, 1.0)
    }

    /// A bake's options for what both have in common.
    pub(crate) fn as_bake(&self) -> BakeOptions {
        BakeOptions {
            texture_size: self.texture_size,
            uv: self.uv_mode(),
            gutter: self.gutter,
            max_distance: self.max_distance,
            threads: self.threads,
            write: self.write,
            ..BakeOptions::default()
        }
    }

    /// The mode of the stage of texture coordinates.
    pub(crate) fn uv_mode(&self) -> UvMode {
        match self.uv {
            RaycastUv::Keep => UvMode::Keep,
            RaycastUv::Repair => UvMode::Repair,
            RaycastUv::Unwrap => UvMode::Unwrap,
        }
    }

    /// The maps of shape that are written as pictures, each once.
    pub(crate) fn pictures(&self) -> Vec<GeometryMap> {
        GeometryMap::ALL.into_iter().filter(|map| self.maps.contains(map)).collect()
    }

    /// What is cast.
    pub(crate) fn cast(&self) -> CastOptions {
        let mut maps = self.pictures();
        if self.occlusion_texture && !maps.contains(&GeometryMap::Occlusion) {
            maps.push(GeometryMap::Occlusion);
        }
        CastOptions {
            samples: self.samples,
            search: match self.r#match {
                Match::Nearest => Search::Nearest,
                Match::Outermost => Search::Outermost,
                Match::ClosestPoint => Search::ClosestPoint,
            },
            smooth_rays: self.ray_normals == RayNormals::Averaged,
            maps,
            rays: self.rays,
            // The longest side is 2 there.
            occlusion_distance: 2.0 * self.occlusion_distance,
            curvature_radius: 2.0 * self.curvature_radius,
        }
    }
}
