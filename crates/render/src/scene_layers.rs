//! What a scene's materials have of glTF's extensions, as `material_layers.rs` shades it: factors and textures of
//! clearcoat, sheen, specular, index of refraction, transmission and volume.
//!
//! Contract: built only where the interpretation asks for extensions. Textures are filtered as those of the maps are.
//! Iridescence, anisotropy, dispersion and diffuse transmission are not read.

use crate::behind::Refraction;
use crate::material_layers::{CoatLayer, Dielectric, MaterialLayers, SheenLayer};
use crate::scene_pyramids::{Map, Pyramids, Use};
use parbake_image::MapKind;
use parbake_model::glam::Vec3;
use parbake_model::{Material, TextureSlot};

/// Channel of a texture of numbers.
#[derive(Clone, Copy)]
enum Channel {
    Red,
    Green,
    Alpha,
}

/// A colour's factor and the texture that multiplies it.
#[derive(Clone)]
struct Color {
    factor: Vec3,
    texture: Option<Map>,
}

/// A number's factor, and the texture and its channel that multiply it.
#[derive(Clone)]
struct Number {
    factor: f32,
    texture: Option<(Map, Channel)>,
}

impl Color {
    fn new(factor: [f32; 3], slot: Option<TextureSlot>, pyramids: &mut Pyramids) -> Self {
        Self { factor: Vec3::from(factor), texture: pyramids.map(MapKind::BaseColor, slot) }
    }

    fn at(&self, fetch: &impl Fn(&Map) -> Vec3) -> Vec3 {
        self.factor * self.texture.as_ref().map_or(Vec3::ONE, fetch)
    }
}

impl Number {
    fn new(factor: f32, slot: Option<TextureSlot>, channel: Channel, pyramids: &mut Pyramids) -> Self {
        let texture = match channel {
            Channel::Alpha => pyramids.pyramid(slot, Use::Opacity),
            Channel::Red | Channel::Green => pyramids.map(MapKind::MetallicRoughness, slot),
        };
        Self { factor, texture: texture.map(|map| (map, channel)) }
    }

    fn at(&self, fetch: &impl Fn(&Map) -> Vec3) -> f32 {
        let of = |(map, channel): &(Map, Channel)| match channel {
            Channel::Green => fetch(map).y,
            // Pyramids of alpha have it in all channels.
            Channel::Red | Channel::Alpha => fetch(map).x,
        };
        self.factor * self.texture.as_ref().map_or(1.0, of)
    }
}

#[derive(Clone)]
struct Coat {
    strength: Number,
    roughness: Number,
    normal: Option<(Map, f32)>,
}

/// The extensions of a material; what it lacks has no effect.
#[derive(Clone)]
pub(crate) struct SurfaceLayers {
    coat: Option<Coat>,
    sheen: Option<(Color, Number)>,
    strength: Number,
    tint: Color,
    /// Index of refraction, and what is reflected at normal incidence for it.
    index: f32,
    f0: f32,
    transmission: Number,
    thickness: Number,
    /// What is left of light after a length, by channel, and that length; none where all of it is.
    attenuation: Option<(Vec3, f32)>,
}

impl SurfaceLayers {
    /// None where no extension that is read has an effect.
    pub fn new(material: &Material, pyramids: &mut Pyramids) -> Option<Self> {
        let e = &material.extensions;
        let (coat, sheen) = (e.clearcoat.filter(|c| c.factor > 0.0), e.sheen.filter(|s| s.color != [0.0; 3]));
        let transmission = e.transmission.filter(|t| t.factor > 0.0).unwrap_or_default();
        let (specular, ior) = (e.specular.unwrap_or_default(), e.ior.unwrap_or(1.5));
        let is_plain = coat.is_none() && sheen.is_none() && transmission.factor == 0.0;
        if material.unlit || is_plain && e.specular.is_none_or(|s| s == Default::default()) && ior == 1.5 {
            return None;
        }
        let tint = Color::new(specular.color, specular.color_texture, pyramids);
        let strength = Number::new(specular.factor, specular.texture, Channel::Alpha, pyramids);
        let sheen = sheen.map(|s| {
            let color = Color::new(s.color, s.color_texture, pyramids);
            (color, Number::new(s.roughness, s.roughness_texture, Channel::Alpha, pyramids))
        });
        let volume = e.volume.filter(|v| v.thickness > 0.0).unwrap_or_default();
        let thickness = Number::new(volume.thickness, volume.texture, Channel::Green, pyramids);
        let passing = Number::new(transmission.factor, transmission.texture, Channel::Red, pyramids);
        let coat = coat.map(|c| Coat {
            strength: Number::new(c.factor, c.texture, Channel::Red, pyramids),
            roughness: Number::new(c.roughness, c.roughness_texture, Channel::Green, pyramids),
            normal: pyramids.map(MapKind::Normal, c.normal_texture).map(|map| (map, c.normal_scale)),
        });
        let f0 = if ior == 0.0 { 1.0 } else { ((ior - 1.0) / (ior + 1.0)).powi(2) };
        let distance = volume.attenuation_distance;
        let attenuation =
            distance.is_finite().then(|| (Vec3::from(volume.attenuation_color), distance.max(1e-12)));
        // An index of 0 stands for one without bound.
        let index = if ior == 0.0 { f32::INFINITY } else { ior };
        Some(Self { coat, sheen, strength, tint, index, f0, transmission: passing, thickness, attenuation })
    }

    /// Whether light passes it.
    pub fn transmits(&self) -> bool {
        self.transmission.factor > 0.0
    }

    /// The layers at a point, given what textures hold there. `frame` turns a mapped normal, or none, into a unit
    /// vector on the viewer's side; `unit` is the length of the model's unit in that of the mesh.
    pub fn at(
        &self,
        fetch: &impl Fn(&Map) -> Vec3,
        frame: &impl Fn(Option<Vec3>) -> Vec3,
        unit: f32,
    ) -> MaterialLayers {
        let strength = self.strength.at(fetch);
        let dielectric = Dielectric {
            f0: (self.f0 * self.tint.at(fetch)).min(Vec3::ONE) * strength,
            f90: strength,
            scatters: 1.0 - if self.transmits() { self.transmission.at(fetch) } else { 0.0 },
        };
        let thickness = if self.thickness.factor > 0.0 { self.thickness.at(fetch) } else { 0.0 };
        let left = |(color, distance): (Vec3, f32)| color.powf(thickness / distance);
        let attenuation = self.attenuation.map_or(Vec3::ONE, left);
        let refraction = Refraction { index: self.index, thickness: thickness * unit };
        let sheen = self
            .sheen
            .as_ref()
            .map(|(tint, roughness)| SheenLayer { color: tint.at(fetch), roughness: roughness.at(fetch) });
        let coat = self.coat.as_ref().map(|coat| CoatLayer {
            strength: coat.strength.at(fetch),
            roughness: coat.roughness.at(fetch),
            normal: frame(
                coat.normal.as_ref().map(|(map, scale)| fetch(map) * Vec3::new(*scale, *scale, 1.0)),
            ),
        });
        MaterialLayers { dielectric, attenuation, refraction, sheen, coat }
    }
}
