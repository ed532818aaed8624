//! Which extensions a document may require (glTF 2.0, 3.12).

use super::buffers::pointer;
use super::json::Document;
use crate::FileError;
use crate::context::Context;

/// Read, or without effect on the shape and the material.
const KNOWN: [&str; 14] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
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
            let place = pointer(format!("/extensionsRequired/{i}"));
            return Err(context.unsupported(place, name, "export the model without this extension"));
        }
    }
    Ok(())
}
