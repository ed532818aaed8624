//! Options of a turntable.

use super::FilmFormat;
use super::layout::Layout;
use parbake::BakeError;
use parbake::Convention;
use parbake::EvaluateOptions;
use serde::{Deserialize, Serialize};

/// Options of a turntable; all models are filmed alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct TurntableOptions {
    /// Frames of one turn, 2 to 720
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 60))]
    pub frames: usize,

    /// Seconds of one turn, 1 to 100; a frame is shown for at least 0.02 s
    #[cfg_attr(feature = "clap", arg(long, value_name = "SECONDS", default_value_t = 6.0))]
    pub seconds: f64,

    /// Side of one model's picture in pixels, 32 to 2048
    #[cfg_attr(feature = "clap", arg(long, value_name = "PIXELS", default_value_t = 384))]
    pub resolution: usize,

    /// Samples along each side of a pixel, 1 to 8
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 2))]
    pub supersample: usize,

    /// Elevation of the camera in degrees, -87 to 87
    #[cfg_attr(
        feature = "clap",
        arg(long, allow_negative_numbers = true, value_name = "DEGREES", default_value_t = 15.0)
    )]
    pub height: f32,

    /// Distance of the camera, 1.8 to 100; the unit is half of the high-poly's longest side
    #[cfg_attr(feature = "clap", arg(long, value_name = "DISTANCE", default_value_t = 3.5))]
    pub radius: f32,

    /// Field of view in degrees, 1 to 170
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEGREES", default_value_t = 43.602_818))]
    pub fov: f32,

    /// Shading convention
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t = Convention::Gltf))]
    pub convention: Convention,

    /// Background: black, white, grey, or R,G,B in linear light, each 0 to 1; by default dark grey
    #[cfg_attr(feature = "clap", arg(long, default_value = DARK_GREY))]
    pub background: String,

    /// Ignore parallax maps and their cutouts, as viewers without the extension do
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_parallax: bool,

    /// Leave out the models' names
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_captions: bool,

    /// Number of threads, 0 to 256; 0 is one a core. The film does not depend on it
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT", default_value_t = 0))]
    pub threads: usize,
}

/// As in most 3D applications' viewports: black would swallow outlines, white outshine the model.
const DARK_GREY: &str = "0.04,0.04,0.04";

/// Viewers take shorter times for a mistake and show such frames for a tenth of a second.
const SHORTEST_FRAME: f64 = 0.02;

impl Default for TurntableOptions {
    fn default() -> Self {
        Self {
            frames: 60,
            seconds: 6.0,
            resolution: 384,
            supersample: 2,
            height: 15.0,
            radius: 3.5,
            fov: 43.602_818,
            convention: Convention::Gltf,
            background: DARK_GREY.into(),
            no_parallax: false,
            no_captions: false,
            threads: 0,
        }
    }
}

impl TurntableOptions {
    /// Checks every range.
    ///
    /// # Errors
    /// Names the option and what it may be.
    pub fn check(&self) -> Result<(), BakeError> {
        let ranges = [
            ("frames", self.frames as f64, 2.0, 720.0),
            ("seconds", self.seconds, 1.0, 100.0),
            ("resolution", self.resolution as f64, 32.0, 2048.0),
            // Above, "upright" would turn with the model.
            ("height", f64::from(self.height), -87.0, 87.0),
            ("threads", self.threads as f64, 0.0, parbake::MOST_THREADS as f64),
        ];
        match ranges.into_iter().find(|(_, value, low, high)| !(low..=high).contains(&value)) {
            Some((option, value, low, high)) => {
                Err(BakeError::Option { option, value: value.to_string(), range: format!("{low} to {high}") })
            }
            None => self.background().map(|_| ()),
        }
    }

    /// Checks that so many models beside each other fit into the format.
    pub(super) fn check_size(&self, models: usize, format: FilmFormat) -> Result<(), BakeError> {
        let most = match format {
            FilmFormat::Apng => i32::MAX as usize,
            FilmFormat::Gif => usize::from(u16::MAX),
        };
        let layout = Layout::new(self.resolution, models, !self.no_captions);
        if layout.width.max(layout.height) <= most {
            return Ok(());
        }
        let range = format!("smaller, for {models} models beside each other are wider than {most} pixels");
        Err(BakeError::Option { option: "resolution", value: self.resolution.to_string(), range })
    }

    /// The background's linear light; checks what the renderer asks for as well.
    pub(super) fn background(&self) -> Result<[f32; 3], BakeError> {
        Ok(self.views_of(self.resolution, self.supersample).checked_background()?)
    }

    /// Options of pictures of this size.
    pub(super) fn views_of(&self, resolution: usize, supersample: usize) -> EvaluateOptions {
        EvaluateOptions {
            resolution,
            supersample,
            radius: self.radius,
            fov: self.fov,
            convention: self.convention,
            no_parallax: self.no_parallax,
            background: self.background.clone(),
            ..EvaluateOptions::default()
        }
    }

    /// Seconds of a turn as it is shown.
    pub(super) fn shown_seconds(&self) -> f64 {
        self.seconds.max(self.frames as f64 * SHORTEST_FRAME)
    }

    /// How long frame `index` stays, in ticks of which a second has so many. Ticks are rounded such
    /// that no error adds up over the turn.
    pub(super) fn ticks(&self, index: usize, a_second: f64) -> u16 {
        let until = |index: usize| {
            (index as f64 / self.frames.max(1) as f64 * self.shown_seconds() * a_second).round()
        };
        (until(index + 1) - until(index)) as u16
    }
}
