//! Materials: the metallic-roughness model of glTF 2.0 (section 3.9; the OBJ reader maps MTL onto
//! the same), with `KHR_materials_emissive_strength` and `KHR_materials_unlit`, and parallax maps.
//!
//! Files carry all of it. What the renderer and the fit use of it is said there.

use crate::{MaterialExtensions, ParallaxMap, TextureSlot};

/// How alpha is to be understood (glTF 2.0, section 3.9.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Cut out where alpha is below [`Material::alpha_cutoff`].
    Mask,
    /// Blended over what is behind.
    Blend,
}

/// A surface's look.
///
/// Factors are linear and without unit; each multiplies its texture. A texture that is not
/// there is 1 everywhere. Writers clamp factors to the ranges given here.
///
/// Contract: factors are finite and in range.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// A name to show to people.
    pub name: String,
    /// Linear RGBA factor that multiplies the texture, each from 0 to 1.
    pub base_color: [f32; 4],
    /// Base colour: RGB is sRGB-encoded, A is linear opacity.
    pub base_color_texture: Option<TextureSlot>,
    /// Tangent-space normals, +Y up (green grows against v), `2 x − 1`.
    pub normal_texture: Option<TextureSlot>,
    /// Multiplies x and y of the normal before normalisation. Counts only with a normal texture.
    pub normal_scale: f32,
    /// From 0, a dielectric, to 1, a metal. glTF's default is 1, ours is 0.
    pub metallic: f32,
    /// Perceptual roughness, the square root of the microfacet distribution's α: from 0, a
    /// mirror, to 1. The default is 1.
    pub roughness: f32,
    /// Linear: G multiplies the roughness, B the metallic factor; R and A say nothing here.
    pub metallic_roughness_texture: Option<TextureSlot>,
    /// Linear: R is the share of ambient light that arrives, from 0 to 1; the other channels say
    /// nothing here. Often the same image as the metallic-roughness texture.
    pub occlusion_texture: Option<TextureSlot>,
    /// From 0, no occlusion, to 1: `1 + strength · (R − 1)` multiplies ambient light. Counts only
    /// with an occlusion texture. The default is 1.
    pub occlusion_strength: f32,
    /// Linear RGB factor of the emitted light, each from 0 to 1. The default is 0: nothing is
    /// emitted, whatever the texture says.
    pub emissive: [f32; 3],
    /// Emitted light, sRGB-encoded RGB; A says nothing.
    pub emissive_texture: Option<TextureSlot>,
    /// Multiplies factor and texture, so that emitted light can exceed 1; from 0, with no upper
    /// limit. The default is 1 (`KHR_materials_emissive_strength`).
    pub emissive_strength: f32,
    /// How alpha is to be understood.
    pub alpha_mode: AlphaMode,
    /// Surfaces with less alpha are cut out; from 0, and above 1 everything is. Counts only with
    /// [`AlphaMode::Mask`]. The default is 0.5.
    pub alpha_cutoff: f32,
    /// Whether the back of a triangle is shown, with its normal turned over. glTF's default is no,
    /// ours is yes.
    pub double_sided: bool,
    /// Whether the base colour is shown as it is, without lights (`KHR_materials_unlit`).
    pub unlit: bool,
    /// Shifts of the texture coordinates with the direction of view, and what is cut out.
    pub parallax: Option<ParallaxMap>,
    /// What extensions say beyond all this; bakes project it and do not fit it.
    pub extensions: MaterialExtensions,
}

impl Material {
    /// What glTF understands by a material that says nothing: metal, and seen from the front
    /// only. All else is as in [`Material::default`].
    pub fn gltf_default() -> Self {
        Self { metallic: 1.0, double_sided: false, ..Self::default() }
    }

    /// The textures of the look that Parbake renders: base colour and normals, and those that a
    /// parallax map has instead of them. The map's own images are not among these.
    pub fn texture_slots(&self) -> impl Iterator<Item = TextureSlot> + Clone {
        let own = self.parallax.as_ref().map_or([None; 2], |p| [p.base_color_texture, p.normal_texture]);
        [self.base_color_texture, self.normal_texture].into_iter().chain(own).flatten()
    }

    /// All textures: those of [`Material::texture_slots`], then metallic-roughness, occlusion,
    /// emission and the extensions'. A parallax map's own images are not among these.
    pub fn all_texture_slots(&self) -> impl Iterator<Item = TextureSlot> + Clone {
        let others = [self.metallic_roughness_texture, self.occlusion_texture, self.emissive_texture];
        let extensions = self.extensions.textures().map(|(slot, _)| slot);
        self.texture_slots().chain(others.into_iter().flatten()).chain(extensions)
    }

    /// Visits every index into `Model::images`, those of a parallax map included.
    pub fn for_each_image(&mut self, mut visit: impl FnMut(&mut usize)) {
        let own = [
            &mut self.base_color_texture,
            &mut self.normal_texture,
            &mut self.metallic_roughness_texture,
            &mut self.occlusion_texture,
            &mut self.emissive_texture,
        ];
        let extensions = self.extensions.textures_mut().into_iter().map(|(slot, _)| slot);
        own.into_iter().chain(extensions).flatten().for_each(|slot| visit(&mut slot.image));
        if let Some(parallax) = &mut self.parallax {
            let slots = [&mut parallax.base_color_texture, &mut parallax.normal_texture];
            slots.into_iter().flatten().for_each(|slot| visit(&mut slot.image));
            parallax.images.iter_mut().for_each(&mut visit);
            parallax.depth.iter_mut().for_each(|depth| visit(&mut depth.image));
            parallax.cutout.iter_mut().flat_map(|cutout| &mut cutout.images).for_each(visit);
        }
    }

    /// Whether shading needs tangents.
    pub fn has_normal_map(&self) -> bool {
        let own = self.parallax.as_ref().is_some_and(|p| p.normal_texture.is_some());
        let clearcoat = self.extensions.clearcoat.is_some_and(|c| c.normal_texture.is_some());
        let turns = self.parallax.as_ref().is_some_and(|p| p.basis.is_tangent());
        self.normal_texture.is_some() || own || turns || clearcoat || self.extensions.anisotropy.is_some()
    }
}

impl Default for Material {
    /// White, rough, not metallic and seen from both sides: what carries a baked look, which has
    /// its shading from nowhere else, and what MTL describes where it says nothing.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 4],
            base_color_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            occlusion_texture: None,
            occlusion_strength: 1.0,
            emissive: [0.0; 3],
            emissive_texture: None,
            emissive_strength: 1.0,
            alpha_mode: AlphaMode::Opaque,
            alpha_cutoff: 0.5,
            double_sided: true,
            unlit: false,
            parallax: None,
            extensions: MaterialExtensions::default(),
        }
    }
}
