//! The parts of a glTF 2.0 material that Parbake reads (section 5.19 and after it), with
//! extensions, by the names of the specification.
//!
//! Contract: that of `json.rs`: nothing is checked but the types.

use super::ignored::Ignored;
use super::integer::optional_integer;
use super::json_extensions::{
    Anisotropy, Clearcoat, DiffuseTransmission, Dispersion, Ior, Iridescence, Sheen, Specular, Transmission,
    Volume,
};
use super::json_texture::TextureInfo;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub name: String,
    pub pbr_metallic_roughness: Option<MetallicRoughness>,
    pub normal_texture: Option<TextureInfo>,
    pub occlusion_texture: Option<TextureInfo>,
    pub emissive_texture: Option<TextureInfo>,
    pub emissive_factor: Option<[f32; 3]>,
    pub alpha_mode: Option<String>,
    pub alpha_cutoff: Option<f32>,
    pub double_sided: bool,
    pub extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct MetallicRoughness {
    pub base_color_factor: Option<[f32; 4]>,
    pub base_color_texture: Option<TextureInfo>,
    pub metallic_factor: Option<f32>,
    pub roughness_factor: Option<f32>,
    pub metallic_roughness_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub emissive_strength: Option<EmissiveStrength>,
    #[serde(rename = "KHR_materials_unlit")]
    pub unlit: Option<Ignored>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub specular_glossiness: Option<SpecularGlossiness>,
    #[serde(rename = "PARBAKE_materials_parallax")]
    pub parallax: Option<Box<ParallaxTangent>>,
    #[serde(rename = "PARBAKE_materials_parallax_sh")]
    pub parallax_sh: Option<Box<ParallaxSh>>,
    #[serde(rename = "KHR_materials_clearcoat")]
    pub clearcoat: Option<Clearcoat>,
    #[serde(rename = "KHR_materials_sheen")]
    pub sheen: Option<Sheen>,
    #[serde(rename = "KHR_materials_transmission")]
    pub transmission: Option<Transmission>,
    #[serde(rename = "KHR_materials_diffuse_transmission")]
    pub diffuse_transmission: Option<DiffuseTransmission>,
    #[serde(rename = "KHR_materials_volume")]
    pub volume: Option<Volume>,
    #[serde(rename = "KHR_materials_iridescence")]
    pub iridescence: Option<Iridescence>,
    #[serde(rename = "KHR_materials_anisotropy")]
    pub anisotropy: Option<Anisotropy>,
    #[serde(rename = "KHR_materials_specular")]
    pub specular: Option<Specular>,
    #[serde(rename = "KHR_materials_ior")]
    pub ior: Option<Ior>,
    #[serde(rename = "KHR_materials_dispersion")]
    pub dispersion: Option<Dispersion>,
    /// All others, by name.
    #[serde(flatten)]
    pub others: BTreeMap<String, IgnoredAny>,
}

impl MaterialExtensions {
    /// Whether there is a parallax map of either kind.
    pub fn has_parallax(&self) -> bool {
        self.parallax.is_some() || self.parallax_sh.is_some()
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct EmissiveStrength {
    pub emissive_strength: Option<f32>,
}

/// Parbake's own, in the tangent frame: `docs/parallax_format.md`.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct ParallaxTangent {
    #[serde(deserialize_with = "optional_integer")]
    pub version: Option<usize>,
    pub texture: Option<TextureInfo>,
    pub scale: Vec<f32>,
    pub offset: Vec<f32>,
    pub limit: Option<f32>,
    pub fade_footprint: Option<f32>,
    pub cutout: Option<CutoutTangent>,
    pub base_color_texture: Option<TextureInfo>,
    pub normal_texture: Option<TextureInfo>,
}

/// The cutout in such a map.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct CutoutTangent {
    pub texture: Option<TextureInfo>,
    pub scale: Vec<f32>,
    pub offset: Vec<f32>,
}

/// Parbake's own, of spherical harmonics: `docs/parallax_sh_format.md`.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct ParallaxSh {
    #[serde(deserialize_with = "optional_integer")]
    pub order: Option<usize>,
    pub limit: Option<f32>,
    pub coefficient_textures: Vec<TextureInfo>,
    pub scale: Vec<f32>,
    pub offset: Vec<f32>,
    pub depth_texture: Option<TextureInfo>,
    pub depth_scale: Option<f32>,
    pub depth_offset: Option<f32>,
    pub cutout: Option<CutoutSh>,
    pub base_color_texture: Option<TextureInfo>,
    pub normal_texture: Option<TextureInfo>,
}

/// The cutout in a parallax map.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct CutoutSh {
    #[serde(deserialize_with = "optional_integer")]
    pub order: Option<usize>,
    pub coefficient_textures: Vec<TextureInfo>,
    pub scale: Vec<f32>,
    pub offset: Vec<f32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct SpecularGlossiness {
    pub diffuse_factor: Option<[f32; 4]>,
    pub diffuse_texture: Option<TextureInfo>,
    pub glossiness_factor: Option<f32>,
    pub specular_factor: Option<[f32; 3]>,
    pub specular_glossiness_texture: Option<TextureInfo>,
}
