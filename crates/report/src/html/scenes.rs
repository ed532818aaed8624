//! The three models of a bake, made ready for rendering once for the whole page.

use parbake::{BakeError, Baked, PlacedModel, Renderer, compared_as};
use parbake_model::Model;

/// Models in the high-poly's frame, read and shaded as the bake's figures are.
pub struct Scenes {
    /// What renders them.
    pub renderer: Renderer,
    /// The detailed model.
    pub high: PlacedModel,
    /// What a ray-cast baker delivers.
    pub ray_cast: PlacedModel,
    /// The coarse model with fitted textures.
    pub baked: PlacedModel,
}

impl Scenes {
    /// Places and unpacks all three.
    pub fn new(high: &Model, baked: &Baked) -> Result<Self, BakeError> {
        let renderer = Renderer::new(high, &compared_as(&baked.report.options))?;
        let [high, ray_cast, baked] =
            [high, &baked.ray_cast, &baked.model].map(|model| renderer.place(model));
        Ok(Self { renderer, high, ray_cast, baked })
    }

    /// All three.
    pub fn all(&self) -> [&PlacedModel; 3] {
        [&self.high, &self.baked, &self.ray_cast]
    }
}
