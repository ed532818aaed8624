//! The parts of a glTF 2.0 document that Parbake reads, by the names of the
//! specification (section 5); all else in a document is passed over. Materials are in
//! `json_material.rs`, skins and animations in `json_motion.rs`.
//!
//! Contract: nothing is checked here but the types; what is missing has the
//! specification's default, and numbers are whole from 0 where it asks for that.

use super::integer::{integer, integers, optional_integer};
use super::json_material::Material;
use super::json_motion::{Animation, Skin, Target, TargetNames};
use serde::Deserialize;
use std::collections::BTreeMap;

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
    pub skins: Vec<Skin>,
    pub animations: Vec<Animation>,
    pub extensions: DocumentExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct DocumentExtensions {
    #[serde(rename = "KHR_materials_variants")]
    pub variants: Option<Variants>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Variants {
    pub variants: Vec<Variant>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Variant {
    pub name: String,
}

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
    pub name: String,
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
    pub weights: Vec<f32>,
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
    pub name: String,
    pub primitives: Vec<Primitive>,
    /// Of morph targets, where a node does not have its own.
    pub weights: Vec<f32>,
    #[serde(rename = "extras")]
    pub target_names: TargetNames,
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
    pub targets: Vec<Target>,
    pub extensions: Option<Box<PrimitiveExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub draco: Option<Draco>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Draco {
    #[serde(deserialize_with = "optional_integer")]
    pub buffer_view: Option<usize>,
    /// Not accessors but the stream's own numbers of its attributes.
    pub attributes: Attributes,
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
    #[serde(rename = "TEXCOORD_2", deserialize_with = "optional_integer")]
    pub texcoord_2: Option<usize>,
    #[serde(rename = "TEXCOORD_3", deserialize_with = "optional_integer")]
    pub texcoord_3: Option<usize>,
    #[serde(rename = "TEXCOORD_4", deserialize_with = "optional_integer")]
    pub texcoord_4: Option<usize>,
    #[serde(rename = "TEXCOORD_5", deserialize_with = "optional_integer")]
    pub texcoord_5: Option<usize>,
    #[serde(rename = "TEXCOORD_6", deserialize_with = "optional_integer")]
    pub texcoord_6: Option<usize>,
    #[serde(rename = "TEXCOORD_7", deserialize_with = "optional_integer")]
    pub texcoord_7: Option<usize>,
    #[serde(rename = "COLOR_0", deserialize_with = "optional_integer")]
    pub color_0: Option<usize>,
    #[serde(rename = "JOINTS_0", deserialize_with = "optional_integer")]
    pub joints_0: Option<usize>,
    #[serde(rename = "JOINTS_1", deserialize_with = "optional_integer")]
    pub joints_1: Option<usize>,
    #[serde(rename = "WEIGHTS_0", deserialize_with = "optional_integer")]
    pub weights_0: Option<usize>,
    #[serde(rename = "WEIGHTS_1", deserialize_with = "optional_integer")]
    pub weights_1: Option<usize>,
    /// All others, such as COLOR_1 and those of an application, whose names begin with an underscore.
    #[serde(flatten)]
    pub others: BTreeMap<String, serde_json::Value>,
}

impl Attributes {
    /// The attribute of a name, which is not one that has coordinates or joints.
    pub fn named(&self, name: &str) -> Option<usize> {
        match name {
            "COLOR_0" => self.color_0,
            _ => self.others.get(name)?.as_u64()?.try_into().ok(),
        }
    }

    /// Names of attributes that may be painted.
    pub fn painted(&self) -> impl Iterator<Item = &str> {
        let first = self.color_0.map(|_| "COLOR_0");
        let names = self.others.keys().map(String::as_str);
        first.into_iter().chain(names.filter(|name| name.starts_with('_') || name.starts_with("COLOR_")))
    }

    /// The texture coordinates of a set; none beyond the eighth.
    pub fn texcoord(&self, set: usize) -> Option<usize> {
        let sets = [
            self.texcoord_0,
            self.texcoord_1,
            self.texcoord_2,
            self.texcoord_3,
            self.texcoord_4,
            self.texcoord_5,
            self.texcoord_6,
            self.texcoord_7,
        ];
        sets.get(set).copied().flatten()
    }
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
    pub extensions: Option<Box<BufferViewExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct BufferViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    pub ext_meshopt: Option<Meshopt>,
    #[serde(rename = "KHR_meshopt_compression")]
    pub khr_meshopt: Option<Meshopt>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Meshopt {
    #[serde(deserialize_with = "integer")]
    pub buffer: usize,
    #[serde(default, deserialize_with = "integer")]
    pub byte_offset: usize,
    #[serde(deserialize_with = "integer")]
    pub byte_length: usize,
    #[serde(deserialize_with = "integer")]
    pub byte_stride: usize,
    #[serde(deserialize_with = "integer")]
    pub count: usize,
    pub mode: String,
    pub filter: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub uri: Option<String>,
    #[serde(deserialize_with = "integer")]
    pub byte_length: usize,
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
    #[serde(rename = "KHR_texture_basisu")]
    pub basisu: Option<TextureSource>,
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
