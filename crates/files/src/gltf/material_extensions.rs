//! Material extensions beyond the metallic-roughness material: their factors and textures.
//!
//! Numbers out of an extension's range are clamped; those that are not finite become its default.

use super::json_material;
use super::json_texture::TextureInfo;
use super::textures::TextureReader;
use crate::FileError;
use parbake_model::{
    Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, MaterialExtensions, Sheen, Specular,
    TextureSlot, Transmission, Volume,
};

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

/// The extensions of the material at the pointer `here`. `scale` is the length of the mesh's own unit, in
/// which thickness is given, in the model.
pub(super) fn read(
    textures: &mut TextureReader<'_, '_>,
    json: &json_material::MaterialExtensions,
    here: &str,
    scale: f32,
) -> Result<MaterialExtensions, FileError> {
    let mut slot = |info: &Option<TextureInfo>, name: &str| -> Result<Option<TextureSlot>, FileError> {
        match info {
            Some(info) => textures.slot(info, &format!("{here}/extensions/{name}")),
            None => Ok(None),
        }
    };
    let mut out = MaterialExtensions::default();
    if let Some(c) = &json.clearcoat {
        out.clearcoat = Some(Clearcoat {
            factor: share(c.clearcoat_factor, 0.0),
            texture: slot(&c.clearcoat_texture, "KHR_materials_clearcoat/clearcoatTexture")?,
            roughness: share(c.clearcoat_roughness_factor, 0.0),
            roughness_texture: slot(
                &c.clearcoat_roughness_texture,
                "KHR_materials_clearcoat/clearcoatRoughnessTexture",
            )?,
            normal_texture: slot(
                &c.clearcoat_normal_texture,
                "KHR_materials_clearcoat/clearcoatNormalTexture",
            )?,
            normal_scale: c.clearcoat_normal_texture.as_ref().and_then(|t| t.scale).unwrap_or(1.0),
        });
    }
    if let Some(s) = &json.sheen {
        out.sheen = Some(Sheen {
            color: color(s.sheen_color_factor, 0.0, 1.0),
            color_texture: slot(&s.sheen_color_texture, "KHR_materials_sheen/sheenColorTexture")?,
            roughness: share(s.sheen_roughness_factor, 0.0),
            roughness_texture: slot(&s.sheen_roughness_texture, "KHR_materials_sheen/sheenRoughnessTexture")?,
        });
    }
    if let Some(t) = &json.transmission {
        out.transmission = Some(Transmission {
            factor: share(t.transmission_factor, 0.0),
            texture: slot(&t.transmission_texture, "KHR_materials_transmission/transmissionTexture")?,
        });
    }
    if let Some(d) = &json.diffuse_transmission {
        const NAME: &str = "KHR_materials_diffuse_transmission";
        out.diffuse_transmission = Some(DiffuseTransmission {
            factor: share(d.diffuse_transmission_factor, 0.0),
            texture: slot(&d.diffuse_transmission_texture, &format!("{NAME}/diffuseTransmissionTexture"))?,
            color: color(d.diffuse_transmission_color_factor, 1.0, 1.0),
            color_texture: slot(
                &d.diffuse_transmission_color_texture,
                &format!("{NAME}/diffuseTransmissionColorTexture"),
            )?,
        });
    }
    if let Some(v) = &json.volume {
        out.volume = Some(Volume {
            thickness: number(v.thickness_factor.map(|x| x * scale), 0.0, 0.0, f32::MAX),
            texture: slot(&v.thickness_texture, "KHR_materials_volume/thicknessTexture")?,
            attenuation_distance: v.attenuation_distance.filter(|&d| d > 0.0).unwrap_or(f32::INFINITY),
            attenuation_color: color(v.attenuation_color, 1.0, 1.0),
        });
    }
    if let Some(i) = &json.iridescence {
        const NAME: &str = "KHR_materials_iridescence";
        out.iridescence = Some(Iridescence {
            factor: share(i.iridescence_factor, 0.0),
            texture: slot(&i.iridescence_texture, &format!("{NAME}/iridescenceTexture"))?,
            ior: number(i.iridescence_ior, 1.3, 1.0, f32::MAX),
            thickness: [
                number(i.iridescence_thickness_minimum, 100.0, 0.0, f32::MAX),
                number(i.iridescence_thickness_maximum, 400.0, 0.0, f32::MAX),
            ],
            thickness_texture: slot(
                &i.iridescence_thickness_texture,
                &format!("{NAME}/iridescenceThicknessTexture"),
            )?,
        });
    }
    if let Some(a) = &json.anisotropy {
        out.anisotropy = Some(Anisotropy {
            strength: share(a.anisotropy_strength, 0.0),
            rotation: a.anisotropy_rotation.filter(|r| r.is_finite()).unwrap_or(0.0),
            texture: slot(&a.anisotropy_texture, "KHR_materials_anisotropy/anisotropyTexture")?,
        });
    }
    if let Some(s) = &json.specular {
        out.specular = Some(Specular {
            factor: share(s.specular_factor, 1.0),
            texture: slot(&s.specular_texture, "KHR_materials_specular/specularTexture")?,
            color: color(s.specular_color_factor, 1.0, f32::MAX),
            color_texture: slot(&s.specular_color_texture, "KHR_materials_specular/specularColorTexture")?,
        });
    }
    // 0 stands for an infinite index, the next that there is is 1.
    out.ior = json.ior.as_ref().map(|i| match i.ior {
        Some(0.0) => 0.0,
        other => number(other, 1.5, 1.0, f32::MAX),
    });
    out.dispersion = json.dispersion.as_ref().map(|d| number(d.dispersion, 0.0, 0.0, f32::MAX));
    Ok(out)
}
