//! Options of a comparison of parallax variants.

use parbake::BakeError;
use parbake::Convention;
use parbake_fit::parallax::ParallaxOptions;
use parbake_fit::schedule::Schedule;
use parbake_render::parallax_variants::height::SCALE;
use parbake_views::reference::Sampling;
use serde::{Deserialize, Serialize};

/// Options of a comparison; all variants are treated alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct VariantsOptions {
    /// Side of the textures in texels, 16 to 4096
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 512, value_parser = parbake::parse_texels))]
    pub texture_size: usize,

    /// Side of the maps of spherical harmonics in texels, 4 to 512
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 64, value_parser = parbake::parse_texels))]
    pub parallax_size: usize,

    /// Side of the height maps in texels, 4 to 2048; with twice the side of the other maps they hold
    /// as much detail in fewer bytes
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXELS", default_value_t = 128, value_parser = parbake::parse_texels))]
    pub height_size: usize,

    /// Range of the heights in texture widths, 0.0001 to 1; by default the paper's
    #[cfg_attr(feature = "clap", arg(long, value_name = "WIDTHS", default_value_t = SCALE))]
    pub height_scale: f32,

    /// Measure heights and their scale along the normals instead of fitting them; other maps are still
    /// fitted
    #[cfg_attr(feature = "clap", arg(long))]
    pub measured_heights: bool,

    /// Steps of the fit of each map, 0 to 10000
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 300))]
    pub steps: usize,

    /// Training views, 1 to 4096
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 240))]
    pub views: usize,

    /// Side of a training view in pixels, 32 to 1024
    #[cfg_attr(feature = "clap", arg(long, value_name = "PIXELS", default_value_t = 144))]
    pub view_size: usize,

    /// Held-out views over which figures are averaged, 1 to 4096
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 8))]
    pub held_out: usize,

    /// Side of a held-out view in pixels, 16 to 4096
    #[cfg_attr(feature = "clap", arg(long, value_name = "PIXELS", default_value_t = 512))]
    pub resolution: usize,

    /// Shading convention of the comparison
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Convention::Gltf))]
    pub convention: Convention,

    /// Random seed of the training views, 0 to 2^64 - 1
    #[cfg_attr(feature = "clap", arg(long, value_name = "NUMBER", default_value_t = 0))]
    pub seed: u64,

    /// Number of threads, 0 to 256; 0 is one a core. The result does not depend on it
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 0))]
    pub threads: usize,
}

impl Default for VariantsOptions {
    fn default() -> Self {
        Self {
            texture_size: 512,
            parallax_size: 64,
            height_size: 128,
            height_scale: SCALE,
            measured_heights: false,
            steps: 300,
            views: 240,
            view_size: 144,
            held_out: 8,
            resolution: 512,
            convention: Convention::Gltf,
            seed: 0,
            threads: 0,
        }
    }
}

/// Side of the textures that are fitted along, at most.
const FITTED_TEXELS: usize = 256;

impl VariantsOptions {
    /// Checks every range.
    ///
    /// # Errors
    /// Names the option and what it may be.
    pub fn check(&self) -> Result<(), BakeError> {
        let ranges = [
            ("texture-size", self.texture_size, 16, 4096),
            ("parallax-size", self.parallax_size, 4, 512),
            ("height-size", self.height_size, 4, 2048),
            ("steps", self.steps, 0, 10_000),
            ("views", self.views, 1, 4096),
            ("view-size", self.view_size, 32, 1024),
            ("held-out", self.held_out, 1, 4096),
            ("resolution", self.resolution, 16, 4096),
            ("threads", self.threads, 0, parbake::MOST_THREADS),
        ];
        if !(1e-4..=1.0).contains(&self.height_scale) {
            let (value, range) = (self.height_scale.to_string(), "0.0001 to 1".into());
            return Err(BakeError::Option { option: "height-scale", value, range });
        }
        match ranges.into_iter().find(|(_, value, low, high)| !(low..=high).contains(&value)) {
            Some((option, value, low, high)) => {
                Err(BakeError::Option { option, value: value.to_string(), range: format!("{low} to {high}") })
            }
            None => Ok(()),
        }
    }

    /// Side of the textures that are fitted along with a map.
    pub(super) fn fitted_texels(&self) -> usize {
        self.texture_size.min(FITTED_TEXELS)
    }

    /// How reference pictures are sampled: half a texel wide where the texture fills them.
    pub(super) fn sampling(&self) -> Sampling {
        let filter = (0.5 * self.view_size as f32 / self.texture_size as f32).clamp(1.0 / 16.0, 1.0);
        Sampling { size: self.view_size, filter, samples: 1 }
    }

    /// How a map is fitted.
    pub(super) fn fit(&self) -> ParallaxOptions {
        // A plate would hold one kind of map only.
        ParallaxOptions { steps: self.steps, views_per_step: 8, bending: 0.0, ..ParallaxOptions::default() }
    }

    /// How textures are solved for.
    pub(super) fn schedule(&self) -> Schedule {
        Schedule { rounds: 3, final_steps: 1, ..Schedule::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects from sizes that no memory holds.
    #[test]
    fn ranges_are_checked() {
        assert!(VariantsOptions::default().check().is_ok());
        assert!(VariantsOptions { height_size: 100_000, ..VariantsOptions::default() }.check().is_err());
        assert!(VariantsOptions { views: 0, ..VariantsOptions::default() }.check().is_err());
    }
}
