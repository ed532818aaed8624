//! What glTF's material extensions say beyond the metallic-roughness material: their factors and
//! textures. Files carry all of it; bakes project it onto their texture and do not fit it.
//!
//! The fields are those of the extensions, by their names, with the extensions' defaults. Textures
//! multiply their factors; those of colours are sRGB-encoded, all others linear.

use crate::TextureSlot;

/// The extensions that a material has; `Default` has none.
///
/// Contract: numbers are finite and in the extensions' ranges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialExtensions {
    /// A clearcoat on top (`KHR_materials_clearcoat`).
    pub clearcoat: Option<Clearcoat>,
    /// The gloss of cloth at grazing angles (`KHR_materials_sheen`).
    pub sheen: Option<Sheen>,
    /// Light that passes a thin surface (`KHR_materials_transmission`).
    pub transmission: Option<Transmission>,
    /// Scattered light that passes a thin surface (`KHR_materials_diffuse_transmission`).
    pub diffuse_transmission: Option<DiffuseTransmission>,
    /// The inside of what light passes (`KHR_materials_volume`).
    pub volume: Option<Volume>,
    /// Colours of a thin film (`KHR_materials_iridescence`).
    pub iridescence: Option<Iridescence>,
    /// Highlights that are stretched, as on brushed metal (`KHR_materials_anisotropy`).
    pub anisotropy: Option<Anisotropy>,
    /// Strength and colour of a dielectric's reflection (`KHR_materials_specular`).
    pub specular: Option<Specular>,
    /// Index of refraction, 0 or from 1; without the extension 1.5 (`KHR_materials_ior`).
    pub ior: Option<f32>,
    /// 20 divided by the Abbe number, from 0 (`KHR_materials_dispersion`).
    pub dispersion: Option<f32>,
}

impl MaterialExtensions {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Whether any changes what is seen.
    pub fn show(&self) -> bool {
        self.clearcoat.is_some_and(|c| c.factor > 0.0)
            || self.sheen.is_some_and(|s| s.color != [0.0; 3])
            || self.transmission.is_some_and(|t| t.factor > 0.0)
            || self.diffuse_transmission.is_some_and(|d| d.factor > 0.0)
            || self.iridescence.is_some_and(|i| i.factor > 0.0)
            || self.anisotropy.is_some_and(|a| a.strength > 0.0)
            || self.specular.is_some_and(|s| s != Specular::default())
            || self.ior.is_some_and(|ior| ior != 1.5)
    }

    /// All textures, and whether their red, green and blue are colours in sRGB; else they are linear.
    pub fn textures(&self) -> impl Iterator<Item = (TextureSlot, bool)> + Clone + use<> {
        let mut own = self.clone();
        let slots: Vec<_> =
            own.textures_mut().into_iter().filter_map(|(s, is_color)| Some(((*s)?, is_color))).collect();
        slots.into_iter()
    }

    /// The places of the textures of the extensions that are there, and whether they hold colours.
    pub fn textures_mut(&mut self) -> Vec<(&mut Option<TextureSlot>, bool)> {
        let mut all = Vec::new();
        if let Some(c) = &mut self.clearcoat {
            let own = [&mut c.texture, &mut c.roughness_texture, &mut c.normal_texture];
            all.extend(own.map(|slot| (slot, false)));
        }
        if let Some(s) = &mut self.sheen {
            all.extend([(&mut s.color_texture, true), (&mut s.roughness_texture, false)]);
        }
        all.extend(self.transmission.as_mut().map(|t| (&mut t.texture, false)));
        if let Some(d) = &mut self.diffuse_transmission {
            all.extend([(&mut d.texture, false), (&mut d.color_texture, true)]);
        }
        all.extend(self.volume.as_mut().map(|v| (&mut v.texture, false)));
        if let Some(i) = &mut self.iridescence {
            all.extend([(&mut i.texture, false), (&mut i.thickness_texture, false)]);
        }
        all.extend(self.anisotropy.as_mut().map(|a| (&mut a.texture, false)));
        if let Some(s) = &mut self.specular {
            all.extend([(&mut s.texture, false), (&mut s.color_texture, true)]);
        }
        all
    }
}

/// `KHR_materials_clearcoat`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// Strength of the layer, 0 to 1.
    pub factor: f32,
    /// Its red channel multiplies the strength.
    pub texture: Option<TextureSlot>,
    /// Perceptual roughness of the layer, 0 to 1.
    pub roughness: f32,
    /// Its green channel multiplies the roughness.
    pub roughness_texture: Option<TextureSlot>,
    /// The layer's own normals; without it they are those of the mesh.
    pub normal_texture: Option<TextureSlot>,
    /// Multiplies x and y of these normals.
    pub normal_scale: f32,
}

impl Default for Clearcoat {
    fn default() -> Self {
        let (texture, roughness_texture, normal_texture) = (None, None, None);
        Self { factor: 0.0, texture, roughness: 0.0, roughness_texture, normal_texture, normal_scale: 1.0 }
    }
}

/// `KHR_materials_sheen`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sheen {
    /// Linear RGB, each from 0 to 1.
    pub color: [f32; 3],
    /// Multiplies the colour.
    pub color_texture: Option<TextureSlot>,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// Its alpha multiplies the roughness.
    pub roughness_texture: Option<TextureSlot>,
}

/// `KHR_materials_transmission`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transmission {
    /// Share of the light that is not reflected which passes, 0 to 1.
    pub factor: f32,
    /// Its red channel multiplies the share.
    pub texture: Option<TextureSlot>,
}

/// `KHR_materials_diffuse_transmission`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// Share of the scattered light that passes, 0 to 1.
    pub factor: f32,
    /// Its alpha multiplies the share.
    pub texture: Option<TextureSlot>,
    /// Linear RGB of the light that passes, each from 0 to 1.
    pub color: [f32; 3],
    /// Multiplies the colour.
    pub color_texture: Option<TextureSlot>,
}

impl Default for DiffuseTransmission {
    fn default() -> Self {
        Self { factor: 0.0, texture: None, color: [1.0; 3], color_texture: None }
    }
}

/// `KHR_materials_volume`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Thickness beneath the surface in the units of the model's mesh, from 0; 0 is a thin surface.
    pub thickness: f32,
    /// Its green channel multiplies the thickness.
    pub texture: Option<TextureSlot>,
    /// Distance in world space after which white light has the attenuation colour; infinite where
    /// no light is attenuated.
    pub attenuation_distance: f32,
    /// Linear RGB, each from 0 to 1.
    pub attenuation_color: [f32; 3],
}

impl Default for Volume {
    fn default() -> Self {
        Self {
            thickness: 0.0,
            texture: None,
            attenuation_distance: f32::INFINITY,
            attenuation_color: [1.0; 3],
        }
    }
}

/// `KHR_materials_iridescence`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iridescence {
    /// Strength, 0 to 1.
    pub factor: f32,
    /// Its red channel multiplies the strength.
    pub texture: Option<TextureSlot>,
    /// Index of refraction of the film, from 1.
    pub ior: f32,
    /// Thickness of the film in nanometres, from 0, where the texture is 0 and where it is 1; without a
    /// texture it is the second.
    pub thickness: [f32; 2],
    /// Its green channel goes from one thickness to the other.
    pub thickness_texture: Option<TextureSlot>,
}

impl Default for Iridescence {
    fn default() -> Self {
        let (texture, thickness_texture) = (None, None);
        Self { factor: 0.0, texture, ior: 1.3, thickness: [100.0, 400.0], thickness_texture }
    }
}

/// `KHR_materials_anisotropy`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anisotropy {
    /// Strength, 0 to 1.
    pub strength: f32,
    /// Direction in tangent space in radians, counter-clockwise from the tangent.
    pub rotation: f32,
    /// Red and green: the direction in tangent space, before it is turned; blue multiplies the strength.
    pub texture: Option<TextureSlot>,
}

/// `KHR_materials_specular`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Strength of the reflection of dielectrics, 0 to 1.
    pub factor: f32,
    /// Its alpha multiplies the strength.
    pub texture: Option<TextureSlot>,
    /// Linear RGB of their reflection at normal incidence, from 0; may exceed 1.
    pub color: [f32; 3],
    /// Multiplies the colour.
    pub color_texture: Option<TextureSlot>,
}

impl Default for Specular {
    fn default() -> Self {
        Self { factor: 1.0, texture: None, color: [1.0; 3], color_texture: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects textures from being forgotten: each that an extension has is among them.
    #[test]
    fn all_textures_are_found() {
        let mut all = MaterialExtensions {
            clearcoat: Some(Clearcoat::default()),
            sheen: Some(Sheen::default()),
            transmission: Some(Transmission::default()),
            diffuse_transmission: Some(DiffuseTransmission::default()),
            volume: Some(Volume::default()),
            iridescence: Some(Iridescence::default()),
            anisotropy: Some(Anisotropy::default()),
            specular: Some(Specular::default()),
            ior: None,
            dispersion: None,
        };
        assert!(all.textures().count() == 0 && !all.show() && !all.is_empty());
        all.textures_mut().into_iter().for_each(|(slot, _)| *slot = Some(TextureSlot::default()));
        // The debug form names every field.
        let named = format!("{all:?}").matches("TextureSlot").count();
        assert_eq!(all.textures().count(), named);
        assert_eq!(all.textures().filter(|(_, is_color)| *is_color).count(), 3);
        assert!(all.show());
    }
}
