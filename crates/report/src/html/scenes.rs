//! The three models of a bake, made ready for rendering once for the whole page.

use parbake::BakeError;
use parbake::Baked;
use parbake_image::display::Display;
use parbake_model::Model;
use parbake_render::scene::Scene;
use parbake_views::frame::{common_frame, scene};

/// Scenes in the high-poly's frame, read by the bake's own convention.
pub struct Scenes {
    /// The detailed model.
    pub high: Scene,
    /// What a ray-cast baker delivers.
    pub ray_cast: Scene,
    /// The coarse model with fitted textures.
    pub baked: Scene,
    /// Light strength and display curve of the convention.
    pub display: Display,
}

impl Scenes {
    /// Places and unpacks all three.
    pub fn new(high: &Model, baked: &Baked) -> Result<Self, BakeError> {
        let convention = baked.report.options.convention;
        let frame = common_frame(high)?;
        let scene = |model: &Model| scene(model, &frame, convention.interpretation());
        Ok(Self {
            high: scene(high),
            ray_cast: scene(&baked.ray_cast),
            baked: scene(&baked.model),
            display: convention.display(),
        })
    }
}
