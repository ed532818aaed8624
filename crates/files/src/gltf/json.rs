//! The parts of a glTF 2.0 document that Parbake reads, by the names of the
//! specification (section 5); all else in a document is passed over.
//!
//! `usize` fields go through [`integer`], as some exporters write `0.0` for `0`.

use serde::de::{self, Deserializer, Visitor};
use serde::{Deserialize, de::DeserializeOwned};
use std::fmt;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    pub asset: Option<Asset>,
    pub extensions_used: Vec<String>,
    pub extensions_required: Vec<String>,
    #[serde(deserialize_with = "optional_integer")]
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<BufferView>,
    pub buffers: Vec<Buffer>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub images: Vec<Image>,
    pub samplers: Vec<Sampler>,
    pub skins: Vec<Ignored>,
    pub animations: Vec<Ignored>,
}

/// Something that is only counted.
#[derive(Debug, Deserialize)]
pub(super) struct Ignored {}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Asset {
    pub version: String,
    pub min_version: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Scene {
    #[serde(deserialize_with = "integers")]
    pub nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    #[serde(deserialize_with = "integers")]
    pub children: Vec<usize>,
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    #[serde(deserialize_with = "optional_integer")]
    pub mesh: Option<usize>,
    #[serde(deserialize_with = "optional_integer")]
    pub skin: Option<usize>,
    pub extensions: Option<Box<NodeExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instancing>,
    #[serde(rename = "KHR_node_visibility")]
    pub visibility: Option<Visibility>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Instancing {
    pub attributes: InstancingAttributes,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct InstancingAttributes {
    #[serde(deserialize_with = "optional_integer")]
    pub translation: Option<usize>,
    #[serde(deserialize_with = "optional_integer")]
    pub rotation: Option<usize>,
    #[serde(deserialize_with = "optional_integer")]
    pub scale: Option<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Visibility {
    #[serde(default = "yes")]
    pub visible: bool,
}

fn yes() -> bool {
    true
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Mesh {
    pub primitives: Vec<Primitive>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub attributes: Attributes,
    #[serde(deserialize_with = "optional_integer")]
    pub indices: Option<usize>,
    #[serde(deserialize_with = "optional_integer")]
    pub material: Option<usize>,
    #[serde(deserialize_with = "optional_integer")]
    pub mode: Option<usize>,
    pub targets: Vec<Ignored>,
    pub extensions: Option<Box<PrimitiveExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub draco: Option<Ignored>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION", deserialize_with = "optional_integer")]
    pub position: Option<usize>,
    #[serde(rename = "NORMAL", deserialize_with = "optional_integer")]
    pub normal: Option<usize>,
    #[serde(rename = "TANGENT", deserialize_with = "optional_integer")]
    pub tangent: Option<usize>,
    #[serde(rename = "TEXCOORD_0", deserialize_with = "optional_integer")]
    pub texcoord_0: Option<usize>,
    #[serde(rename = "TEXCOORD_1", deserialize_with = "optional_integer")]
    pub texcoord_1: Option<usize>,
    #[serde(rename = "COLOR_0", deserialize_with = "optional_integer")]
    pub color_0: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    #[serde(default, deserialize_with = "optional_integer")]
    pub buffer_view: Option<usize>,
    #[serde(default, deserialize_with = "integer")]
    pub byte_offset: usize,
    #[serde(deserialize_with = "integer")]
    pub component_type: usize,
    #[serde(default)]
    pub normalized: bool,
    #[serde(deserialize_with = "integer")]
    pub count: usize,
    #[serde(rename = "type")]
    pub kind: String,
    pub sparse: Option<Box<Sparse>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    #[serde(deserialize_with = "integer")]
    pub count: usize,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    #[serde(deserialize_with = "integer")]
    pub buffer_view: usize,
    #[serde(default, deserialize_with = "integer")]
    pub byte_offset: usize,
    #[serde(deserialize_with = "integer")]
    pub component_type: usize,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    #[serde(deserialize_with = "integer")]
    pub buffer_view: usize,
    #[serde(default, deserialize_with = "integer")]
    pub byte_offset: usize,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    #[serde(deserialize_with = "integer")]
    pub buffer: usize,
    #[serde(default, deserialize_with = "integer")]
    pub byte_offset: usize,
    #[serde(deserialize_with = "integer")]
    pub byte_length: usize,
    #[serde(default, deserialize_with = "optional_integer")]
    pub byte_stride: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub uri: Option<String>,
    #[serde(deserialize_with = "integer")]
    pub byte_length: usize,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub name: String,
    pub pbr_metallic_roughness: Option<MetallicRoughness>,
    pub normal_texture: Option<TextureInfo>,
    pub alpha_mode: Option<String>,
    pub extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct MetallicRoughness {
    pub base_color_factor: Option<[f32; 4]>,
    pub base_color_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub specular_glossiness: Option<SpecularGlossiness>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct SpecularGlossiness {
    pub diffuse_factor: Option<[f32; 4]>,
    pub diffuse_texture: Option<TextureInfo>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    #[serde(deserialize_with = "integer")]
    pub index: usize,
    #[serde(default, deserialize_with = "integer")]
    pub tex_coord: usize,
    /// Of normal textures only.
    pub scale: Option<f32>,
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

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Texture {
    #[serde(deserialize_with = "optional_integer")]
    pub sampler: Option<usize>,
    #[serde(deserialize_with = "optional_integer")]
    pub source: Option<usize>,
    pub extensions: TextureExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureExtensions {
    #[serde(rename = "EXT_texture_webp")]
    pub webp: Option<TextureSource>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureSource {
    #[serde(deserialize_with = "optional_integer")]
    pub source: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Image {
    pub name: String,
    pub uri: Option<String>,
    #[serde(deserialize_with = "optional_integer")]
    pub buffer_view: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Sampler {
    #[serde(deserialize_with = "optional_integer")]
    pub wrap_s: Option<usize>,
    #[serde(deserialize_with = "optional_integer")]
    pub wrap_t: Option<usize>,
}

/// A whole number from 0, however it is written.
#[derive(Clone, Copy)]
struct Integer(usize);

impl<'de> Deserialize<'de> for Integer {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Digits;
        impl Visitor<'_> for Digits {
            type Value = Integer;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number from 0")
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Integer, E> {
                usize::try_from(value).map(Integer).map_err(E::custom)
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Integer, E> {
                Err(E::invalid_value(de::Unexpected::Signed(value), &self))
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Integer, E> {
                // Beyond 2⁵³ doubles are no longer exact, and no count is that large.
                if (0.0..9e15).contains(&value) && value.fract() == 0.0 {
                    return self.visit_u64(value as u64);
                }
                Err(E::invalid_value(de::Unexpected::Float(value), &self))
            }
        }
        deserializer.deserialize_any(Digits)
    }
}

fn integer<'de, D: Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
    Integer::deserialize(deserializer).map(|i| i.0)
}

fn optional_integer<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<usize>, D::Error> {
    Ok(Option::<Integer>::deserialize(deserializer)?.map(|i| i.0))
}

fn integers<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<usize>, D::Error> {
    Ok(Vec::<Integer>::deserialize(deserializer)?.into_iter().map(|i| i.0).collect())
}

/// Where in the document the first thing stands that does not fit, as a JSON
/// pointer to the object, and why. For documents that are JSON but not glTF.
pub(super) fn locate(bytes: &[u8]) -> Option<(String, String)> {
    let value: serde_json::Value = serde_json::from_slice(bytes).ok()?;
    fn misfit<T: DeserializeOwned>(root: &serde_json::Value, key: &str) -> Option<(String, String)> {
        let value = root.get(key)?;
        let Some(elements) = value.as_array() else {
            return Some((format!("/{key}"), "this should be an array".into()));
        };
        elements.iter().enumerate().find_map(|(i, element)| {
            T::deserialize(element).err().map(|e| (format!("/{key}/{i}"), e.to_string()))
        })
    }
    let root = value.as_object().map(|_| &value)?;
    misfit::<Accessor>(root, "accessors")
        .or_else(|| misfit::<BufferView>(root, "bufferViews"))
        .or_else(|| misfit::<Buffer>(root, "buffers"))
        .or_else(|| misfit::<Node>(root, "nodes"))
        .or_else(|| misfit::<Scene>(root, "scenes"))
        .or_else(|| misfit::<Mesh>(root, "meshes"))
        .or_else(|| misfit::<Material>(root, "materials"))
        .or_else(|| misfit::<Texture>(root, "textures"))
        .or_else(|| misfit::<Image>(root, "images"))
        .or_else(|| misfit::<Sampler>(root, "samplers"))
        .or_else(|| misfit::<Ignored>(root, "skins"))
        .or_else(|| misfit::<Ignored>(root, "animations"))
        .or_else(|| {
            Asset::deserialize(root.get("asset")?).err().map(|e| ("/asset".to_string(), e.to_string()))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects documents whose numbers have a point, and the defaults.
    #[test]
    fn integers_may_have_a_point() {
        let text = r#"{"accessors":[{"componentType":5126.0,"count":3.0,"type":"VEC3"}],"scene":0.0,"nodes":[{"children":[1.0]}]}"#;
        let document: Document = serde_json::from_str(text).unwrap();
        assert_eq!(document.accessors[0].count, 3);
        assert_eq!((document.scene, document.nodes[0].children[0]), (Some(0), 1));
        for bad in ["-1", "1.5", "1e300", "\"1\""] {
            assert!(serde_json::from_str::<Document>(&format!("{{\"scene\":{bad}}}")).is_err());
        }
    }

    /// Protects the promise that errors point at their place.
    #[test]
    fn misfits_are_located() {
        let text = br#"{"accessors":[{"componentType":1,"count":1,"type":"VEC3"},{"count":1}]}"#;
        let (pointer, reason) = locate(text).unwrap();
        assert_eq!(pointer, "/accessors/1");
        assert!(reason.contains("componentType"), "{reason}");
        assert_eq!(locate(br#"{"nodes":5}"#).unwrap().0, "/nodes");
    }
}
