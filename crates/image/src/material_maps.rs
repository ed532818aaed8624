//! Where a material keeps each kind of map: its texture and its factor.

use crate::maps::{MapKind, MapValues};
use glam::{Vec3, Vec4};
use parbake_model::{Material, TextureSlot};

/// The texture of a map, as viewers see it that know no parallax maps.
pub fn texture_slot(material: &Material, kind: MapKind) -> Option<TextureSlot> {
    match kind {
        MapKind::BaseColor => material.base_color_texture,
        MapKind::Normal => material.normal_texture,
        MapKind::MetallicRoughness => material.metallic_roughness_texture,
        MapKind::Emissive => material.emissive_texture,
        MapKind::Occlusion => material.occlusion_texture,
    }
}

/// The same behind the material's parallax map, which may bring textures of its own.
pub fn shifted_texture_slot(material: &Material, kind: MapKind) -> Option<TextureSlot> {
    let own = material.parallax.as_ref().and_then(|map| match kind {
        MapKind::BaseColor => map.base_color_texture,
        MapKind::Normal => map.normal_texture,
        _ => None,
    });
    own.or(texture_slot(material, kind))
}

/// What multiplies the texture, or stands for it where there is none; colours are linear. Of the
/// occlusion it is the strength.
pub fn factors(material: &Material) -> MapValues {
    let mut factors = MapValues::NEUTRAL;
    factors[MapKind::BaseColor] = Vec4::from(material.base_color);
    // The strength is the material's normal texture's; others have none of their own.
    let strength = material.normal_texture.map_or(1.0, |_| material.normal_scale);
    factors[MapKind::Normal] = Vec4::new(strength, strength, 1.0, 0.0);
    factors[MapKind::Emissive] = Vec3::from(material.emissive).extend(0.0) * material.emissive_strength;
    factors[MapKind::MetallicRoughness] = Vec4::new(0.0, material.roughness, material.metallic, 0.0);
    // Its strength: the map's value is 1 + strength · (texture − 1).
    let strength = material.occlusion_texture.map_or(1.0, |_| material.occlusion_strength);
    factors[MapKind::Occlusion] = Vec4::splat(strength);
    factors
}

/// Gives a material a map; its factor becomes 1.
pub fn set_texture(material: &mut Material, kind: MapKind, slot: TextureSlot) {
    match kind {
        MapKind::BaseColor => material.base_color_texture = Some(slot),
        MapKind::Normal => material.normal_texture = Some(slot),
        MapKind::MetallicRoughness => {
            (material.roughness, material.metallic) = (1.0, 1.0);
            material.metallic_roughness_texture = Some(slot);
        }
        MapKind::Emissive => {
            (material.emissive, material.emissive_strength) = ([1.0; 3], 1.0);
            material.emissive_texture = Some(slot);
        }
        MapKind::Occlusion => material.occlusion_texture = Some(slot),
    }
}
