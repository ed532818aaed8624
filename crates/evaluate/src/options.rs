//! Options of an evaluation, as plain data for library, command line and files.

use crate::conventions::{Convention, GREY, Shading, check_shading};
use crate::error::EvaluateError;
use parbake_image::display::Display;
use parbake_model::glam::Vec3;
use parbake_render::camera::{Projection, fibonacci_sphere};
use parbake_render::interpretation::Interpretation;
use serde::{Deserialize, Serialize};

/// Conventions of an evaluation. The defaults are those that a bake fits by default: glTF's.
/// [`EvaluateOptions::paper`] are those of the paper's figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct EvaluateOptions {
    /// Views on a Fibonacci sphere around the model, 1 to 4096
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 48))]
    pub views: usize,

    /// Side of a view in pixels, 16 to 4096
    #[cfg_attr(feature = "clap", arg(long, value_name = "PIXELS", default_value_t = 512))]
    pub resolution: usize,

    /// Samples along each side of a pixel, 1 to 8
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 2))]
    pub supersample: usize,

    /// Distance of the cameras, 1.8 to 100; the unit is half of the high-poly's longest side
    #[cfg_attr(feature = "clap", arg(long, value_name = "DISTANCE", default_value_t = 3.5))]
    pub radius: f32,

    /// Field of view in degrees, 1 to 170
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEGREES", default_value_t = 43.602_818))]
    pub fov: f32,

    /// Orthographic instead of perspective views: half their width, 0.001 to 100; unit as of --radius
    /// [default: perspective]
    #[cfg_attr(feature = "clap", arg(long, value_name = "HALF_WIDTH"))]
    pub ortho: Option<f32>,

    /// Shading convention of the comparison; use the one that was baked with
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Convention::Gltf))]
    pub convention: Convention,

    /// What of the materials is shown; pbr is the whole metallic-roughness material under a built-in light, lambert
    /// colours, normals and emission under a headlight, auto pbr where a material of the high-poly has more than these,
    /// else lambert. Use the value that was baked with
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Shading::Auto))]
    pub shading: Shading,

    /// Strength of the light, 0.001 to 100 [default: 1, with --convention paper 1.59]
    #[cfg_attr(feature = "clap", arg(long, value_name = "FACTOR"))]
    pub gain: Option<f32>,

    /// Use no mip levels
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_mips: bool,

    /// Ignore parallax maps and their cutouts, as viewers without the extension do
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_parallax: bool,

    /// Background: black, white, grey, or R,G,B in linear light, each 0 to 1
    #[cfg_attr(feature = "clap", arg(long, default_value = "black"))]
    pub background: String,

    /// Leave out FLIP, which takes most of the time
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_flip: bool,
}

impl Default for EvaluateOptions {
    fn default() -> Self {
        Self {
            views: 48,
            resolution: 512,
            supersample: 2,
            radius: 3.5,
            fov: 43.602_818,
            ortho: None,
            convention: Convention::Gltf,
            shading: Shading::Auto,
            gain: None,
            no_mips: false,
            no_parallax: false,
            background: "black".into(),
            no_flip: false,
        }
    }
}

impl EvaluateOptions {
    /// The conventions that agree best with the paper's figures: [`Convention::Paper`], all else by default.
    pub fn paper() -> Self {
        Self { convention: Convention::Paper, ..Self::default() }
    }

    /// Light strength and display curve.
    pub fn display(&self) -> Display {
        let own = self.convention.display();
        Display { gain: self.gain.unwrap_or(own.gain), ..own }
    }

    /// Directions from the model to the cameras, of unit length: one for each view.
    pub fn directions(&self) -> Vec<Vec3> {
        fibonacci_sphere(self.views, 0.0)
    }

    /// Checks every range; the error names the option and what it may be.
    ///
    /// # Errors
    /// An option out of range.
    pub fn check(&self) -> Result<(), EvaluateError> {
        self.checked_background().map(|_| ())
    }

    /// Checks every range; gives the background in linear light.
    ///
    /// # Errors
    /// An option out of range.
    pub fn checked_background(&self) -> Result<[f32; 3], EvaluateError> {
        check_shading(self.shading, self.convention)?;
        let fail = |option, value: String, range: &str| {
            Err(EvaluateError::Option { option, value, range: range.into() })
        };
        let ranges = [
            ("views", self.views as f64, 1.0, 4096.0),
            ("resolution", self.resolution as f64, 16.0, 4096.0),
            ("supersample", self.supersample as f64, 1.0, 8.0),
            ("radius", f64::from(self.radius), 1.8, 100.0),
            ("fov", f64::from(self.fov), 1.0, 170.0),
            ("ortho", f64::from(self.ortho.unwrap_or(1.0)), 1e-3, 100.0),
            ("gain", f64::from(self.display().gain), 1e-3, 100.0),
        ];
        for (option, value, low, high) in ranges {
            if !(low..=high).contains(&value) {
                return fail(option, value.to_string(), &format!("{low} to {high}"));
            }
        }
        match self.background.as_str() {
            "black" => Ok([0.0; 3]),
            "white" => Ok([1.0; 3]),
            "grey" | "gray" => Ok([GREY; 3]),
            other => {
                let numbers: Result<Vec<f32>, _> = other.split(',').map(|n| n.trim().parse()).collect();
                let numbers = numbers.unwrap_or_default();
                match numbers[..] {
                    [r, g, b] if numbers.iter().all(|n| (0.0..=1.0).contains(n)) => Ok([r, g, b]),
                    _ => fail("background", other.into(), "black, white, grey or R,G,B"),
                }
            }
        }
    }

    /// How the views project.
    pub fn projection(&self) -> Projection {
        match self.ortho {
            Some(half_width) => Projection::Orthographic(half_width),
            None => Projection::Perspective((self.fov.to_radians() * 0.5).tan()),
        }
    }

    /// How textures are read.
    pub fn interpretation(&self) -> Interpretation {
        Interpretation {
            decode_srgb: self.convention.decodes_srgb(),
            trilinear: !self.no_mips,
            parallax: !self.no_parallax,
            extensions: false,
        }
    }
}
