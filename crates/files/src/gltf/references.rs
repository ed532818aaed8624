//! Whether a document's parts name parts that are there (glTF 2.0, section 2.6).
//!
//! What a model is built from is checked where it is used, and what it is not
//! built from may be broken. But a document that gives no triangles at all is
//! best explained by the first reference in it that leads nowhere.

use super::buffers::Buffers;
use super::json::Primitive;
use super::json_material::Material;
use super::json_texture::TextureInfo;
use crate::FileError;

/// Refuses a document with a reference to what is not there.
pub(super) fn check(buffers: &Buffers<'_>) -> Result<(), FileError> {
    let document = buffers.document;
    let counts = [
        document.accessors.len(),
        document.buffer_views.len(),
        document.buffers.len(),
        document.images.len(),
        document.materials.len(),
        document.meshes.len(),
        document.nodes.len(),
        document.samplers.len(),
        document.scenes.len(),
        document.textures.len(),
    ];
    let mut result = Ok(());
    // Said for the first only; the others are not even put into words.
    let mut see = |part: Part, index: Option<usize>, from: &dyn Fn() -> String| {
        let count = counts[part as usize];
        if let (Ok(()), Some(index)) = (&result, index.filter(|&i| i >= count)) {
            result = Err(buffers.missing(&from(), NAMES[part as usize], index, count));
        }
    };
    see(Part::Scene, document.scene, &|| "/scene".into());
    for (i, scene) in document.scenes.iter().enumerate() {
        for (k, &node) in scene.nodes.iter().enumerate() {
            see(Part::Node, Some(node), &|| format!("/scenes/{i}/nodes/{k}"));
        }
    }
    for (i, node) in document.nodes.iter().enumerate() {
        see(Part::Mesh, node.mesh, &|| format!("/nodes/{i}/mesh"));
        for (k, &child) in node.children.iter().enumerate() {
            see(Part::Node, Some(child), &|| format!("/nodes/{i}/children/{k}"));
        }
    }
    for (i, mesh) in document.meshes.iter().enumerate() {
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let here = || format!("/meshes/{i}/primitives/{k}");
            see(Part::Material, primitive.material, &|| here() + "/material");
            let draco = primitive.extensions.as_ref().and_then(|e| e.draco.as_ref());
            see(Part::BufferView, draco.and_then(|d| d.buffer_view), &|| {
                here() + "/extensions/KHR_draco_mesh_compression/bufferView"
            });
            for (accessor, name) in accessors(primitive) {
                see(Part::Accessor, accessor, &|| format!("{}/{name}", here()));
            }
        }
    }
    for (i, accessor) in document.accessors.iter().enumerate() {
        let here = || format!("/accessors/{i}");
        see(Part::BufferView, accessor.buffer_view, &|| here() + "/bufferView");
        if let Some(sparse) = &accessor.sparse {
            let (indices, values) = (Some(sparse.indices.buffer_view), Some(sparse.values.buffer_view));
            see(Part::BufferView, indices, &|| here() + "/sparse/indices/bufferView");
            see(Part::BufferView, values, &|| here() + "/sparse/values/bufferView");
        }
    }
    for (i, view) in document.buffer_views.iter().enumerate() {
        see(Part::Buffer, Some(view.buffer), &|| format!("/bufferViews/{i}/buffer"));
        let extensions = view.extensions.as_deref();
        for (meshopt, name) in [
            (extensions.and_then(|e| e.ext_meshopt.as_ref()), "EXT_meshopt_compression"),
            (extensions.and_then(|e| e.khr_meshopt.as_ref()), "KHR_meshopt_compression"),
        ] {
            see(Part::Buffer, meshopt.map(|m| m.buffer), &|| {
                format!("/bufferViews/{i}/extensions/{name}/buffer")
            });
        }
    }
    for (i, image) in document.images.iter().enumerate() {
        see(Part::BufferView, image.buffer_view, &|| format!("/images/{i}/bufferView"));
    }
    for (i, texture) in document.textures.iter().enumerate() {
        see(Part::Sampler, texture.sampler, &|| format!("/textures/{i}/sampler"));
        see(Part::Image, texture.source, &|| format!("/textures/{i}/source"));
    }
    for (i, material) in document.materials.iter().enumerate() {
        for (texture, name) in textures(material) {
            see(Part::Texture, texture, &|| format!("/materials/{i}/{name}/index"));
        }
    }
    result
}

/// What can be named; the order is that of `counts` and `NAMES`.
#[derive(Clone, Copy)]
enum Part {
    Accessor,
    BufferView,
    Buffer,
    Image,
    Material,
    Mesh,
    Node,
    Sampler,
    Scene,
    Texture,
}

const NAMES: [&str; 10] =
    ["accessor", "buffer view", "buffer", "image", "material", "mesh", "node", "sampler", "scene", "texture"];

fn accessors(primitive: &Primitive) -> [(Option<usize>, &'static str); 7] {
    let attributes = &primitive.attributes;
    [
        (primitive.indices, "indices"),
        (attributes.position, "attributes/POSITION"),
        (attributes.normal, "attributes/NORMAL"),
        (attributes.tangent, "attributes/TANGENT"),
        (attributes.texcoord_0, "attributes/TEXCOORD_0"),
        (attributes.texcoord_1, "attributes/TEXCOORD_1"),
        (attributes.color_0, "attributes/COLOR_0"),
    ]
}

fn textures(material: &Material) -> [(Option<usize>, &'static str); 5] {
    let pbr = material.pbr_metallic_roughness.as_ref();
    let index = |info: Option<&TextureInfo>| info.map(|t| t.index);
    [
        (index(pbr.and_then(|p| p.base_color_texture.as_ref())), "pbrMetallicRoughness/baseColorTexture"),
        (index(material.normal_texture.as_ref()), "normalTexture"),
        (
            index(pbr.and_then(|p| p.metallic_roughness_texture.as_ref())),
            "pbrMetallicRoughness/metallicRoughnessTexture",
        ),
        (index(material.occlusion_texture.as_ref()), "occlusionTexture"),
        (index(material.emissive_texture.as_ref()), "emissiveTexture"),
    ]
}
