//! Material extensions that Parbake does not fit: their factors are kept in the model, and a
//! warning says what is lost, in which materials.
//!
//! Numbers out of an extension's range are clamped; those that are not finite become its default.

use super::json_material;
use crate::context::Context;
use parbake_model::{
    Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Material, MaterialExtensions, Sheen, Specular,
    Transmission, Volume,
};

/// Materials that a warning names; the others are counted.
const MOST_NAMES: usize = 5;

/// From `low` on; `otherwise` where there is no number.
fn number(value: Option<f32>, otherwise: f32, low: f32, high: f32) -> f32 {
    value.filter(|x| x.is_finite()).map_or(otherwise, |x| x.clamp(low, high))
}

fn share(value: Option<f32>, otherwise: f32) -> f32 {
    number(value, otherwise, 0.0, 1.0)
}

fn color(value: Option<[f32; 3]>, otherwise: f32, high: f32) -> [f32; 3] {
    value.map_or([otherwise; 3], |rgb| rgb.map(|x| number(Some(x), otherwise, 0.0, high)))
}

/// The extensions of a material.
pub(super) fn read(json: &json_material::MaterialExtensions) -> MaterialExtensions {
    let clearcoat = json.clearcoat.as_ref().map(|c| Clearcoat {
        factor: share(c.clearcoat_factor, 0.0),
        roughness: share(c.clearcoat_roughness_factor, 0.0),
        textured: [&c.clearcoat_texture, &c.clearcoat_roughness_texture, &c.clearcoat_normal_texture]
            .iter()
            .any(|t| t.is_some()),
    });
    let sheen = json.sheen.as_ref().map(|s| Sheen {
        color: color(s.sheen_color_factor, 0.0, 1.0),
        roughness: share(s.sheen_roughness_factor, 0.0),
        textured: s.sheen_color_texture.is_some() || s.sheen_roughness_texture.is_some(),
    });
    let transmission = json.transmission.as_ref().map(|t| Transmission {
        factor: share(t.transmission_factor, 0.0),
        textured: t.transmission_texture.is_some(),
    });
    let diffuse_transmission = json.diffuse_transmission.as_ref().map(|d| DiffuseTransmission {
        factor: share(d.diffuse_transmission_factor, 0.0),
        color: color(d.diffuse_transmission_color_factor, 1.0, 1.0),
        textured: d.diffuse_transmission_texture.is_some() || d.diffuse_transmission_color_texture.is_some(),
    });
    let volume = json.volume.as_ref().map(|v| Volume {
        thickness: number(v.thickness_factor, 0.0, 0.0, f32::MAX),
        attenuation_distance: v.attenuation_distance.filter(|&d| d > 0.0).unwrap_or(f32::INFINITY),
        attenuation_color: color(v.attenuation_color, 1.0, 1.0),
        textured: v.thickness_texture.is_some(),
    });
    let iridescence = json.iridescence.as_ref().map(|i| Iridescence {
        factor: share(i.iridescence_factor, 0.0),
        ior: number(i.iridescence_ior, 1.3, 1.0, f32::MAX),
        thickness: [
            number(i.iridescence_thickness_minimum, 100.0, 0.0, f32::MAX),
            number(i.iridescence_thickness_maximum, 400.0, 0.0, f32::MAX),
        ],
        textured: i.iridescence_texture.is_some() || i.iridescence_thickness_texture.is_some(),
    });
    let anisotropy = json.anisotropy.as_ref().map(|a| Anisotropy {
        strength: share(a.anisotropy_strength, 0.0),
        rotation: a.anisotropy_rotation.filter(|r| r.is_finite()).unwrap_or(0.0),
        textured: a.anisotropy_texture.is_some(),
    });
    let specular = json.specular.as_ref().map(|s| Specular {
        factor: share(s.specular_factor, 1.0),
        color: color(s.specular_color_factor, 1.0, f32::MAX),
        textured: s.specular_texture.is_some() || s.specular_color_texture.is_some(),
    });
    // 0 stands for an infinite index, the next that there is is 1.
    let ior = json.ior.as_ref().map(|i| match i.ior {
        Some(0.0) => 0.0,
        other => number(other, 1.5, 1.0, f32::MAX),
    });
    MaterialExtensions {
        clearcoat,
        sheen,
        transmission,
        diffuse_transmission,
        volume,
        iridescence,
        anisotropy,
        specular,
        ior,
        dispersion: json.dispersion.as_ref().map(|d| number(d.dispersion, 0.0, 0.0, f32::MAX)),
    }
}

/// An extension, what is lost without it, and whether a material has it with an effect, which is
/// `Some(true)` where textures vary it.
type Loss = (&'static str, &'static str, fn(&MaterialExtensions) -> Option<bool>);

const LOSSES: [Loss; 10] = [
    ("KHR_materials_clearcoat", "the gloss of the clear layer on top", |e| {
        e.clearcoat.filter(|c| c.factor > 0.0).map(|c| c.textured)
    }),
    ("KHR_materials_sheen", "the soft light of cloth at grazing angles", |e| {
        e.sheen.filter(|s| s.color != [0.0; 3] || s.textured).map(|s| s.textured)
    }),
    ("KHR_materials_transmission", "refraction, blur and tint of what is seen through the surface", |e| {
        e.transmission.filter(|t| t.factor > 0.0).map(|t| t.textured)
    }),
    ("KHR_materials_diffuse_transmission", "the light that shines through from behind", |e| {
        e.diffuse_transmission.filter(|d| d.factor > 0.0).map(|d| d.textured)
    }),
    ("KHR_materials_volume", "refraction and the colour that thickness gives", |e| {
        e.volume.filter(|v| v.thickness > 0.0).map(|v| v.textured)
    }),
    ("KHR_materials_iridescence", "the colours of the thin film", |e| {
        e.iridescence.filter(|i| i.factor > 0.0).map(|i| i.textured)
    }),
    ("KHR_materials_anisotropy", "the stretch of highlights", |e| {
        e.anisotropy.filter(|a| a.strength > 0.0).map(|a| a.textured)
    }),
    ("KHR_materials_specular", "the strength and the colour of reflections", |e| {
        let plain = Specular::default();
        e.specular.filter(|s| *s != plain).map(|s| s.textured)
    }),
    ("KHR_materials_ior", "reflections that are stronger or weaker than those of an index of 1.5", |e| {
        e.ior.filter(|&ior| ior != 1.5).map(|_| false)
    }),
    ("KHR_materials_dispersion", "the rainbow that refraction makes", |e| {
        e.dispersion.filter(|&d| d > 0.0).map(|_| false)
    }),
];

/// Says what is not fitted, an extension at a time: models have many materials.
pub(super) fn warn(materials: &[Material], context: &Context<'_>) {
    for (name, lost, effect) in LOSSES {
        let having: Vec<(&Material, bool)> =
            materials.iter().filter_map(|m| effect(&m.extensions).map(|textured| (m, textured))).collect();
        if having.is_empty() {
            continue;
        }
        let names: Vec<String> =
            having.iter().take(MOST_NAMES).map(|(m, _)| format!("{:?}", m.name)).collect();
        let more = match having.len() - names.len() {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        let noun = if having.len() == 1 { "material" } else { "materials" };
        let textures = if having.iter().any(|(_, textured)| *textured) { ", with its textures" } else { "" };
        context.warn(format!(
            "{name} is not fitted{textures}: {lost} is lost in {noun} {}{more}",
            names.join(", ")
        ));
    }
}
