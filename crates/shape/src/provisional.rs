//! A texture that only serves a fit and is thrown away: colours and normals that follow gradients
//! of views by Adam.
//!
//! Contract: after every step colours lie in 0 … 1 and normals are unit vectors of the hemisphere
//! or sphere that the fit's own rule allows.

use glam::{Vec3, Vec4};
use parbake_image::FloatImage;
use parbake_image::pyramid::Pyramid;
use parbake_render::pipeline::Gradients;
use parbake_solve::adam::{Adam, AdamOptions};

/// A provisional texture: colours as shading sees them, normals in the fit's own frame.
#[derive(Clone, Debug)]
pub struct Provisional {
    /// 0 … 1.
    pub color: FloatImage<Vec4>,
    /// Unit vectors.
    pub normal: FloatImage<Vec4>,
}

impl Provisional {
    /// Colours and normals as the renderer fetches them.
    pub fn pyramids(&self) -> [Pyramid<3>; 2] {
        [pyramid(&self.color), pyramid(&self.normal)]
    }
}

fn pyramid(canvas: &FloatImage<Vec4>) -> Pyramid<3> {
    let texels = canvas.texels.iter().map(|t| [t.x, t.y, t.z]).collect();
    Pyramid::single(FloatImage { width: canvas.width, height: canvas.width, texels })
}

fn lanes(level: Option<&FloatImage<[f32; 3]>>) -> Vec<Vec4> {
    level.map(|l| l.texels.iter().map(|&[x, y, z]| Vec4::new(x, y, z, 0.0)).collect()).unwrap_or_default()
}

/// A texture on its way.
pub struct MovingTexture {
    /// As it is now.
    pub texture: Provisional,
    color: Adam,
    normal: Adam,
    /// The unit normal that a step's result stands for.
    unit: fn(Vec3) -> Vec3,
}

impl MovingTexture {
    /// From this start; `rate` is a value's change in a step at first, at most.
    pub fn new(start: Provisional, rate: f32, unit: fn(Vec3) -> Vec3) -> Self {
        let adam = |canvas: &FloatImage<Vec4>| {
            Adam::new(canvas.texels.len(), AdamOptions { rate, ..AdamOptions::default() })
        };
        Self { color: adam(&start.color), normal: adam(&start.normal), texture: start, unit }
    }

    /// Moves against the gradients, at `share` of the first rate.
    pub fn step(&mut self, gradients: &Gradients, share: f32) {
        let Provisional { color, normal } = &mut self.texture;
        self.color.step(&mut color.texels, &lanes(gradients.color.levels.first()), share);
        for texel in &mut color.texels {
            *texel = texel.clamp(Vec4::ZERO, Vec4::ONE);
        }
        let to_normal = gradients.normal.as_ref().and_then(|n| n.levels.first());
        self.normal.step(&mut normal.texels, &lanes(to_normal), share);
        for texel in &mut normal.texels {
            *texel = (self.unit)(texel.truncate()).extend(0.0);
        }
    }
}
