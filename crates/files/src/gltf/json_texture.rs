//! How a glTF 2.0 material names a texture (section 5.30), with KHR_texture_transform, by the names of
//! the specification.
//!
//! Contract: that of `json.rs`: nothing is checked but the types.

use super::integer::{integer, optional_integer};
use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    #[serde(deserialize_with = "integer")]
    pub index: usize,
    #[serde(default, deserialize_with = "integer")]
    pub tex_coord: usize,
    /// Of normal textures only.
    pub scale: Option<f32>,
    /// Of occlusion textures only.
    pub strength: Option<f32>,
    #[serde(default)]
    pub extensions: TextureInfoExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub transform: Option<TextureTransform>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct TextureTransform {
    pub offset: Option<[f32; 2]>,
    pub rotation: f32,
    pub scale: Option<[f32; 2]>,
    #[serde(deserialize_with = "optional_integer")]
    pub tex_coord: Option<usize>,
}
