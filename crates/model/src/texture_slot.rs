//! One use of an image by a material: which image, which texture coordinates, how these are transformed
//! (`KHR_texture_transform`), and what is beyond the image's borders.

use glam::Vec2;

/// What happens to texture coordinates outside `[0, 1)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The picture repeats. OBJ's and glTF's default.
    #[default]
    Repeat,
    /// Every second copy is mirrored.
    Mirror,
    /// The border texel goes on for ever.
    Clamp,
}

/// KHR_texture_transform: `uv' = offset + R(rotation) · (scale ∘ uv)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    /// Added last, in texture widths.
    pub offset: Vec2,
    /// Radians, counter-clockwise as the extension defines it (v down).
    pub rotation: f32,
    /// Applied first.
    pub scale: Vec2,
}

impl Default for UvTransform {
    fn default() -> Self {
        Self { offset: Vec2::ZERO, rotation: 0.0, scale: Vec2::ONE }
    }
}

impl UvTransform {
    /// The transformed coordinate.
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        let (sin, cos) = self.rotation.sin_cos();
        let s = uv * self.scale;
        self.offset + Vec2::new(cos * s.x + sin * s.y, cos * s.y - sin * s.x)
    }
}

/// One use of an image by a material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TextureSlot {
    /// Index into `Model::images`.
    pub image: usize,
    /// Which of the mesh's texture coordinate sets it reads: 0 or 1.
    pub uv_set: u8,
    /// Wrap modes along u and v.
    pub wrap: [Wrap; 2],
    /// Moves the coordinates before the fetch.
    pub transform: UvTransform,
}
