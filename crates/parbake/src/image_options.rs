//! Options of `parbake image`.

use crate::error::BakeError;
#[cfg(feature = "clap")]
use crate::options::heading;
use crate::options::{Method, check_content_aware};
#[cfg(feature = "clap")]
use crate::texels::parse_texels;
use parbake_uv::paper::PaperOptions;
use parbake_uv::picture::PictureOptions;
use serde::{Deserialize, Serialize};

/// How a plane's texture coordinates are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum PictureUv {
    /// Keep UVs: an ordinary, smaller texture, on two triangles unless --grid is given.
    Keep,
    /// Redistribute texels to minimise the rendered error.
    #[default]
    Optimize,
}

/// Options of [`crate::bake_image`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct ImageOptions {
    /// Side of the square texture in texels, 16 to 4096; 1k, 2k and 4k mean 1024, 2048 and 4096
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 256, value_parser = parse_texels, help_heading = heading::QUALITY))]
    pub texture_size: usize,

    /// Cells along a side of the plane, 4 to 400. More cells follow the picture better and make the file
    /// larger, by 18 to 40 bytes a cell [default: 200, from 128 texels on 240, from 256 on 400; with --method
    /// paper 50, with --uv keep 1]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", help_heading = heading::QUALITY))]
    pub grid: Option<usize>,

    /// UV mode: how the plane's texture coordinates are treated
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = PictureUv::Optimize, help_heading = heading::UV))]
    pub uv: PictureUv,

    /// UV optimiser; the texture is the least-squares one with either
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Method::Fit, help_heading = heading::RESEARCH))]
    pub method: Method,

    /// Leave out the content-aware term of the paper's UV optimiser; needs --method paper
    #[cfg_attr(feature = "clap", arg(long, help_heading = heading::RESEARCH))]
    pub no_content_aware: bool,

    /// Steps of the UV optimiser on each grid, coarse to fine, 0 to 10000 [default: 80, from 128 texels on
    /// 60, from 256 on 40; with --method paper, on its one grid, 800]
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", help_heading = heading::UV))]
    pub steps: Option<usize>,

    /// Number of threads, 0 to 256; 0 is one a core
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 0, help_heading = heading::ADVANCED))]
    pub threads: usize,
}

impl Default for ImageOptions {
    fn default() -> Self {
        Self {
            texture_size: 256,
            grid: None,
            uv: PictureUv::Optimize,
            method: Method::Fit,
            no_content_aware: false,
            steps: None,
            threads: 0,
        }
    }
}

impl ImageOptions {
    /// Cells as asked, or those of what is done.
    pub fn settled_grid(&self) -> usize {
        self.grid.unwrap_or(match (self.uv, self.method) {
            (PictureUv::Optimize, Method::Fit) => match self.texture_size {
                0..128 => 200,
                128..256 => 240,
                _ => 400,
            },
            (PictureUv::Optimize, Method::Paper) => 50,
            // A plane that nothing bends.
            _ => 1,
        })
    }

    /// Steps as asked, or those of the method.
    pub fn settled_steps(&self) -> usize {
        self.steps.unwrap_or(match self.method {
            Method::Fit => match self.texture_size {
                0..128 => 80,
                128..256 => 60,
                _ => 40,
            },
            Method::Paper => PaperOptions::default().rounds,
        })
    }

    /// What is asked of the picture's texture coordinates.
    pub(crate) fn for_picture(&self) -> PictureOptions {
        PictureOptions {
            texture_size: self.texture_size,
            grid: self.settled_grid(),
            steps: self.settled_steps(),
            guide: Method::guide(self.no_content_aware),
        }
    }

    /// Checks every range; the error names the option and what it may be.
    pub fn check(&self) -> Result<(), BakeError> {
        let within = |option: &'static str, value: usize, low: usize, high: usize| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(BakeError::Option { option, value: value.to_string(), range: format!("{low} to {high}") })
            }
        };
        within("texture-size", self.texture_size, 16, 4096)?;
        within("grid", self.grid.unwrap_or(4), 4, 400)?;
        within("steps", self.steps.unwrap_or(0), 0, 10_000)?;
        within("threads", self.threads, 0, crate::threads::MOST_THREADS)?;
        check_content_aware(self.method, self.no_content_aware)
    }
}
