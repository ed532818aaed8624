//! glTF's material extensions that are kept as factors, by the names of their specifications.
//!
//! Contract: that of `json.rs`: nothing is checked but the types. Of textures only their presence
//! is looked at.

use super::ignored::Ignored;
use serde::Deserialize;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Clearcoat {
    pub clearcoat_factor: Option<f32>,
    pub clearcoat_roughness_factor: Option<f32>,
    pub clearcoat_texture: Option<Ignored>,
    pub clearcoat_roughness_texture: Option<Ignored>,
    pub clearcoat_normal_texture: Option<Ignored>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Sheen {
    pub sheen_color_factor: Option<[f32; 3]>,
    pub sheen_roughness_factor: Option<f32>,
    pub sheen_color_texture: Option<Ignored>,
    pub sheen_roughness_texture: Option<Ignored>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Transmission {
    pub transmission_factor: Option<f32>,
    pub transmission_texture: Option<Ignored>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct DiffuseTransmission {
    pub diffuse_transmission_factor: Option<f32>,
    pub diffuse_transmission_color_factor: Option<[f32; 3]>,
    pub diffuse_transmission_texture: Option<Ignored>,
    pub diffuse_transmission_color_texture: Option<Ignored>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Volume {
    pub thickness_factor: Option<f32>,
    pub thickness_texture: Option<Ignored>,
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
    pub iridescence_texture: Option<Ignored>,
    pub iridescence_thickness_texture: Option<Ignored>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Anisotropy {
    pub anisotropy_strength: Option<f32>,
    pub anisotropy_rotation: Option<f32>,
    pub anisotropy_texture: Option<Ignored>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Specular {
    pub specular_factor: Option<f32>,
    pub specular_color_factor: Option<[f32; 3]>,
    pub specular_texture: Option<Ignored>,
    pub specular_color_texture: Option<Ignored>,
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
