//! Materials, as far as Parbake renders them: base colour, tangent-space normals
//! (glTF 2.0, section 3.9; the OBJ reader maps MTL onto the same) and parallax maps.

use crate::ShParallaxMap;
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

/// How alpha is to be understood. Parbake bakes opaque surfaces; the mode is
/// kept so that a warning can say what was set aside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Cut out below a threshold.
    Mask,
    /// Blended over what is behind.
    Blend,
}

/// A surface's look.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// A name to show to people.
    pub name: String,
    /// Linear RGBA factor that multiplies the texture.
    pub base_color: [f32; 4],
    /// sRGB-encoded colour picture.
    pub base_color_texture: Option<TextureSlot>,
    /// Tangent-space normals, +Y up (green grows against v), `2 x − 1`.
    pub normal_texture: Option<TextureSlot>,
    /// Multiplies x and y of the normal before normalisation.
    pub normal_scale: f32,
    /// How alpha is to be understood.
    pub alpha_mode: AlphaMode,
    /// Shifts of the texture coordinates with the direction of view, and what is cut out.
    pub parallax: Option<ShParallaxMap>,
}

impl Material {
    /// All textures of the look: base colour and normals, and those that a parallax map has
    /// instead of them. The map's own images are not among these.
    pub fn texture_slots(&self) -> impl Iterator<Item = TextureSlot> + Clone {
        let own = self.parallax.as_ref().map_or([None; 2], |p| [p.base_color_texture, p.normal_texture]);
        [self.base_color_texture, self.normal_texture].into_iter().chain(own).flatten()
    }

    /// Whether shading needs tangents.
    pub fn has_normal_map(&self) -> bool {
        let own = self.parallax.as_ref().is_some_and(|p| p.normal_texture.is_some());
        self.normal_texture.is_some() || own
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 4],
            base_color_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            alpha_mode: AlphaMode::Opaque,
            parallax: None,
        }
    }
}
