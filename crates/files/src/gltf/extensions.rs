//! Which extensions a document may require (glTF 2.0, 3.12).

use super::buffers::pointer;
use super::json::Document;
use crate::FileError;
use crate::context::Context;

/// Read, or without effect on the shape and the material.
const KNOWN: [&str; 10] = [
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "EXT_lights_image_based",
];

/// Refuses a document that requires what is not supported.
pub(super) fn check(document: &Document, context: &Context<'_>) -> Result<(), FileError> {
    for (i, name) in document.extensions_required.iter().enumerate() {
        // Material extensions add to the look; what is read of a material stays as it is without them.
        if !KNOWN.contains(&name.as_str()) && !name.starts_with("KHR_materials_") {
            return Err(unsupported(context, &format!("/extensionsRequired/{i}"), name));
        }
    }
    Ok(())
}

/// The error about extension `name`, with a way out.
pub(super) fn unsupported(context: &Context<'_>, here: &str, name: &str) -> FileError {
    let advice = match name {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "decompress the model first, for example with `gltf-transform copy in.glb out.glb`"
        }
        "KHR_texture_basisu" => {
            "convert its textures to PNG first, for example with `gltf-transform ktxdecompress in.glb out.glb`"
        }
        _ => "export the model without this extension",
    };
    context.unsupported(pointer(here.into()), name, advice)
}
