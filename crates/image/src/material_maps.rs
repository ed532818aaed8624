//! Where a material keeps each kind of map: its texture and its factor.

use crate::maps::{MapKind, MapValues};
use glam::{Vec3, Vec4};
use parbake_model::{AlphaMode, Material, TextureSlot};

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

/// Whether light passes a material (`KHR_materials_transmission`) so that it shows.
pub fn transmits(material: &Material) -> bool {
    let is_metal = material.metallic >= 1.0 && material.metallic_roughness_texture.is_none();
    let passing = material.extensions.transmission.is_some_and(|t| t.factor > LEAST_TRANSMISSION);
    passing && !is_metal && !material.unlit
}

/// How the alpha of a material is shown by fits, and by pictures without extensions, and what
/// multiplies its opacity. Light that passes a dielectric (`KHR_materials_transmission` without a texture)
/// is approximated by blending, of which some is left for what the surface reflects.
pub fn fitted_alpha(material: &Material) -> (AlphaMode, f32) {
    let transmission = material.extensions.transmission;
    let passing = transmission.filter(|t| t.texture.is_none() && t.factor > LEAST_TRANSMISSION);
    match (material.alpha_mode, passing) {
        (AlphaMode::Mask, _) | (_, None) => (material.alpha_mode, 1.0),
        (_, Some(transmission)) => {
            // Where a texture says what is metal, the factor that multiplies it says little.
            let metallic = material.metallic_roughness_texture.map_or(material.metallic, |_| 0.0);
            (AlphaMode::Blend, opacity(transmission.factor * (1.0 - metallic)))
        }
    }
}

/// Opacity that stands in for a surface which this share of the light passes: some is left for what it reflects.
pub fn opacity(passes: f32) -> f32 {
    1.0 - (1.0 - REFLECTED) * passes.clamp(0.0, 1.0)
}

/// Less light that passes than this is not worth a layer.
const LEAST_TRANSMISSION: f32 = 0.05;

/// Opacity of a surface that all light passes which is not reflected: about what smooth glass reflects,
/// averaged over the half-sphere.
const REFLECTED: f32 = 0.09;

/// What the gloss of cloth (`KHR_materials_sheen`) of a linear colour and of an albedo adds to the base
/// colour, averaged over the directions from which a matte surface is seen, and what multiplies the base
/// colour below it; linear.
pub fn sheen_as_color(color: Vec3, albedo: f32) -> (Vec3, f32) {
    (color * albedo, 1.0 - albedo * color.max_element())
}

/// Albedo of a white sheen of this roughness, averaged over the half-sphere by the cosine.
pub fn sheen_albedo(roughness: f32) -> f32 {
    const STEPS: usize = 32;
    let at = |step: usize| {
        let cosine = (step as f32 + 0.5) / STEPS as f32;
        2.0 * cosine * sheen_albedo_at(cosine, roughness)
    };
    (0..STEPS).map(at).sum::<f32>() / STEPS as f32
}

/// Albedo of a white sheen of this roughness, seen at this cosine to the normal: the fit by exponentials that three.js uses
/// (r187) for the Charlie distribution (Estevez and Kulla 2017).
pub fn sheen_albedo_at(cosine: f32, roughness: f32) -> f32 {
    let (r, square, inverse) = (roughness, roughness * roughness, 1.0 / (roughness + 0.1));
    let slope = -1.9362 + 1.0678 * r + 0.4573 * square - 0.8469 * inverse;
    let start = -0.6014 + 0.5538 * r - 0.4670 * square - 0.1255 * inverse;
    (slope * cosine + start).exp()
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

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::{MaterialExtensions, Transmission};

    /// Protects cloth whose colour is all sheen: it is not black, and no brighter than white.
    #[test]
    fn sheen_is_a_colour() {
        for roughness in [0.0, 0.2, 0.5, 1.0] {
            let (added, below) = sheen_as_color(Vec3::new(1.0, 0.2, 0.0), sheen_albedo(roughness));
            assert!(added.x > 0.0 && added.x + below < 1.01, "{added} {below}");
            assert_eq!(added.z, 0.0);
        }
        assert!((sheen_albedo(1.0) - 0.253).abs() < 0.005);
    }

    /// Protects glass: what all light passes is blended, metal and cut-outs are not.
    #[test]
    fn transmission_is_blended() {
        let passing = |factor, is_textured: bool| MaterialExtensions {
            transmission: Some(Transmission { factor, texture: is_textured.then(TextureSlot::default) }),
            ..MaterialExtensions::default()
        };
        let glass = Material { extensions: passing(1.0, false), ..Material::default() };
        let (mode, opacity) = fitted_alpha(&glass);
        assert!(mode == AlphaMode::Blend && (opacity - REFLECTED).abs() < 1e-6, "{opacity}");
        let mask = Material { alpha_mode: AlphaMode::Mask, ..glass.clone() };
        assert_eq!(fitted_alpha(&mask), (AlphaMode::Mask, 1.0));
        let textured = Material { extensions: passing(1.0, true), ..glass.clone() };
        assert_eq!(fitted_alpha(&textured), (AlphaMode::Opaque, 1.0));
        assert!(transmits(&glass) && transmits(&textured));
        let metal = Material { metallic: 1.0, ..glass };
        assert!(fitted_alpha(&metal).1 == 1.0 && !transmits(&metal));
        let mapped = Material { metallic_roughness_texture: Some(TextureSlot::default()), ..metal };
        assert!(fitted_alpha(&mapped).1 < 0.1 && transmits(&mapped));
    }
}
