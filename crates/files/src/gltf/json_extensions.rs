//! glTF's material extensions beyond the metallic-roughness material, by the names of their
//! specifications.
//!
//! Contract: that of `json.rs`: nothing is checked but the types.

use super::json_texture::TextureInfo;
use serde::Deserialize;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Clearcoat {
    pub clearcoat_factor: Option<f32>,
    pub clearcoat_roughness_factor: Option<f32>,
    pub clearcoat_texture: Option<TextureInfo>,
    pub clearcoat_roughness_texture: Option<TextureInfo>,
    pub clearcoat_normal_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Sheen {
    pub sheen_color_factor: Option<[f32; 3]>,
    pub sheen_roughness_factor: Option<f32>,
    pub sheen_color_texture: Option<TextureInfo>,
    pub sheen_roughness_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Transmission {
    pub transmission_factor: Option<f32>,
    pub transmission_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct DiffuseTransmission {
    pub diffuse_transmission_factor: Option<f32>,
    pub diffuse_transmission_color_factor: Option<[f32; 3]>,
    pub diffuse_transmission_texture: Option<TextureInfo>,
    pub diffuse_transmission_color_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Volume {
    pub thickness_factor: Option<f32>,
    pub thickness_texture: Option<TextureInfo>,
    pub attenuation_distance: Option<f32>,
    pub attenuation_color: Option<[f32; 3]>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Iridescence {
    pub iridescence_factor: Option<f32>,
    pub iridescence_ior: Option<f32>,
    pub iridescence_thickness_minimum: Option<f32>,
    pub iridescence_thickness_maximum: Option<f32>,
    pub iridescence_texture: Option<TextureInfo>,
    pub iridescence_thickness_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Anisotropy {
    pub anisotropy_strength: Option<f32>,
    pub anisotropy_rotation: Option<f32>,
    pub anisotropy_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Specular {
    pub specular_factor: Option<f32>,
    pub specular_color_factor: Option<[f32; 3]>,
    pub specular_texture: Option<TextureInfo>,
    pub specular_color_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Ior {
    pub ior: Option<f32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Dispersion {
    pub dispersion: Option<f32>,
}
