//! A place to photograph models in: the frame of one high-poly, cameras around it, one way to
//! read textures and one display.
//!
//! ```text
//! high-poly ─ frame ─┬ scene(model) ─┬ picture(scene, direction) ─ on a background
//! conventions ───────┴───────────────┘
//! ```
//!
//! Contract: pictures are display-referred, row 0 on top, and depend on the arguments only. All
//! models of a studio stand in the high-poly's frame, so their pictures lie on each other.

use crate::error::BakeError;
use crate::evaluate::options::EvaluateOptions;
use parbake_image::display::Display;
use parbake_metric::Rgb;
use parbake_model::glam::Vec3;
use parbake_model::{Model, Placement};
use parbake_render::camera::Camera;
use parbake_render::scene::{Picture, Scene};
use parbake_render::shade::Lambert;
use parbake_views::frame::{common_frame, scene};

/// Where models are photographed.
#[derive(Clone, Debug)]
pub struct Studio {
    frame: Placement,
    options: EvaluateOptions,
}

/// A model made ready for its pictures.
pub struct Subject(Scene);

/// A picture whose background is still open.
pub struct Shot(Picture);

impl Studio {
    /// The studio of a high-poly; of `options` all but the number of views and the background.
    ///
    /// # Errors
    /// An option out of range; a model without extent.
    pub fn new(high: &Model, options: &EvaluateOptions) -> Result<Self, BakeError> {
        options.check()?;
        Ok(Self { frame: common_frame(high)?, options: options.clone() })
    }

    /// Brings a model in.
    pub fn subject(&self, model: &Model) -> Subject {
        Subject(scene(model, &self.frame, self.options.interpretation()))
    }

    /// Photographs it from `direction`, of unit length: the camera stands there and looks at the
    /// middle, +Y up.
    pub fn shot(&self, subject: &Subject, direction: Vec3) -> Shot {
        let camera = Camera::towards_origin(direction, self.options.radius, self.options.projection());
        Shot(subject.0.render(&Lambert, &camera, self.options.resolution, self.options.supersample))
    }

    /// The shot as a screen shows it before `background`, in linear light.
    pub fn develop(&self, shot: &Shot, background: [f32; 3]) -> Rgb {
        shown(&shot.0, &self.options.display(), background)
    }
}

/// A picture as a screen shows it; light strengthens the model and not what is behind it.
pub fn shown(picture: &Picture, display: &Display, background: [f32; 3]) -> Rgb {
    let after = Display { gain: 1.0, ..*display };
    let pixels = picture
        .rgba
        .iter()
        .map(|p| {
            std::array::from_fn(|k| {
                after.encode(p[k] * display.gain + (1.0 - p[3]) * background[k]).clamp(0.0, 1.0)
            })
        })
        .collect();
    Rgb { width: picture.size, height: picture.size, pixels }
}
