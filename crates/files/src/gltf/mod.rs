//! glTF 2.0 and GLB, in and out.
//!
//! Understood are triangles, also compressed by Draco and meshoptimizer, the metallic-roughness
//! material with all its textures, specular-glossiness, the factors of other material extensions,
//! and parallax maps.
//! Skins, morph targets and animations become the model's one rig (`bind.rs`, `morphs.rs`, `animations.rs`).

mod accessor;
mod animations;
mod binary;
mod bind;
mod buffers;
mod component;
mod container;
mod draco;
mod extensions;
mod factors;
mod hierarchy;
mod ignored;
mod image_purpose;
mod integer;
mod json;
mod json_extensions;
mod json_material;
mod json_motion;
mod json_texture;
mod levels_out;
mod locate;
mod material_extensions;
mod material_lists;
mod materials;
mod merge;
mod meshopt;
mod meshopt_filter;
mod meshopt_out;
mod morphs;
mod motion;
mod names;
mod pack;
mod painted;
mod parallax;
mod pieces;
mod quantise;
mod references;
mod runs;
mod scene;
mod sources;
mod specular_glossiness;
mod textures;
mod topology;
mod uri;
mod uv_sets;
mod weight_tracks;
mod write;
mod write_extensions;
mod write_material;
mod write_mesh;
mod write_nodes;
mod write_parallax;
mod write_rig;

pub(crate) use names::named_files;
pub(crate) use pack::pack;
pub use write::{
    glb_bytes, glb_bytes_with, quick_glb_bytes, write_glb, write_glb_keeping, write_glb_with, write_lod_glb,
};

use crate::context::{Context, Textures};
use crate::finish::finish;
use crate::{FileError, Limits, Loaded, Place, Resources};
use parbake_model::Model;
use std::path::Path;

/// The first bytes of a GLB file.
pub(crate) const MAGIC: &[u8] = b"glTF";

/// Reads a glTF document (GLB or JSON) from memory; what it refers to comes from
/// `resources`. `path` is only for messages and the model's name.
///
/// # Errors
/// As [`read_model`](crate::read_model); they give a JSON pointer where there is one.
pub fn read_gltf_bytes(
    path: &Path,
    bytes: &[u8],
    resources: &dyn Resources,
    limits: &Limits,
) -> Result<Loaded, FileError> {
    read(Context::new(path, resources, limits, Textures::Decode), bytes)
}

pub(crate) fn read(context: Context<'_>, bytes: &[u8]) -> Result<Loaded, FileError> {
    context.count_own(bytes);
    let (text, binary) = container::open(bytes, &context)?;
    let document = parse(text, &context)?;
    extensions::check(&document, &context)?;
    mention_variants(&document, &context);
    let buffers = buffers::Buffers::new(&document, binary, &context);
    let mut merge = merge::Merge::new(&buffers);
    merge.add_all()?;
    let rig = merge.rig()?;
    let nodes = hierarchy::hierarchy(&buffers, std::mem::take(&mut merge.triangle_nodes))?;
    let painted = std::mem::take(&mut merge.painted).values(&buffers)?;
    let (mut mesh, used) = (std::mem::take(&mut merge.mesh), std::mem::take(&mut merge.materials));
    let turned = std::mem::take(&mut merge.turned);
    let scales = std::mem::take(&mut merge.scales);
    if mesh.triangles.is_empty() {
        references::check(&buffers)?;
    }
    let empty = emptiness(&document);
    let (materials, images) = materials::build(&buffers, &used, &scales, &turned)?;
    drop(merge);
    drop(buffers);
    parallax::leave_out_offsets(&mut mesh, &materials);
    for (material, index) in materials.iter().zip(&used) {
        let json = index.and_then(|index| document.materials.get(index));
        let sets = json.map(uv_sets::UvSets::of).unwrap_or_default();
        for slot in material.all_texture_slots() {
            let uvs = if slot.uv_set == 0 { &mesh.uvs } else { &mesh.uvs1 };
            if uvs.is_empty() {
                let (name, set) = (&material.name, sets.document_set(slot.uv_set.into()));
                context
                    .warn(format!("material {name:?} uses texture coordinate set {set}, which no mesh has"));
            }
        }
    }
    let name = context.path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    finish(Model { name, mesh, materials, images, rig, nodes, painted, parts: None }, context, empty)
}

fn parse(text: &[u8], context: &Context<'_>) -> Result<json::Document, FileError> {
    let objects = text.iter().filter(|&&b| b == b'{').count() as u64;
    context.within(Place::File, "JSON objects", objects, context.limits.max_json_objects as u64)?;
    let document: json::Document = serde_json::from_slice(text).map_err(|error| match error.classify() {
        serde_json::error::Category::Data => {
            let place = match locate::pointer(text, &error) {
                root if root.is_empty() => Place::File,
                pointer => Place::Pointer(pointer),
            };
            context.invalid(place, locate::reason(&error))
        }
        _ => context.invalid(Place::File, format!("the document is not valid JSON: {error}")),
    })?;
    let Some(asset) = &document.asset else {
        return Err(
            context.invalid(Place::Pointer("/asset".into()), "a glTF document has an asset with a version")
        );
    };
    let version = asset.min_version.as_ref().unwrap_or(&asset.version);
    let place = || Place::Pointer("/asset/version".into());
    match version.split_once('.').map(|(major, minor)| (major.parse::<u32>(), minor.parse::<u32>())) {
        Some((Ok(2), Ok(_))) => Ok(document),
        Some((Ok(_), Ok(_))) => {
            Err(context.unsupported(place(), format!("glTF {version}"), "convert the model to glTF 2.0"))
        }
        _ => Err(context.invalid(place(), format!("{version:?} is no version"))),
    }
}

/// What a document without triangles has instead.
fn emptiness(document: &json::Document) -> &'static str {
    let mut primitives = document.meshes.iter().flat_map(|m| &m.primitives).peekable();
    if document.meshes.is_empty() {
        "; the document has no meshes"
    } else if primitives.peek().is_none() {
        "; its meshes are empty"
    } else if !primitives.clone().any(topology::has_triangles) {
        "; it has only points and lines"
    } else if primitives.all(|p| p.attributes.position.is_none()) {
        "; its meshes have no positions"
    } else {
        "; no mesh with triangles is in its scene"
    }
}

fn mention_variants(document: &json::Document, context: &Context<'_>) {
    if let Some(variants) = document.extensions.variants.as_ref().filter(|v| !v.variants.is_empty()) {
        let names: Vec<String> = variants.variants.iter().map(|v| format!("{:?}", v.name)).collect();
        context.warn(format!(
            "the model has variants ({}); its materials are taken as they are by default",
            names.join(", ")
        ));
    }
}

#[cfg(test)]
mod tests;
