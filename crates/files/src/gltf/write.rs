//! GLB out (glTF 2.0, sections 3 and 4): one mesh, and one for each part that stays apart (`pieces.rs`), or these for each
//! level of detail (`MSFT_lod`, `levels_out.rs`); pictures inside the file, as PNG if nothing else is asked for.
//!
//! The file passes the Khronos validator without errors, and the same model gives
//! the same bytes.

use super::binary::Binary;
use super::image_purpose::purpose_of;
use super::levels_out::{self, meshes, nodes, together};
use super::material_lists::Materials;
use super::meshopt_out;
use super::pieces::{Piece, pieces};
use super::write_material::{EMISSIVE_STRENGTH, UNLIT};
use super::write_rig;
use crate::contents::PictureFormat;
use crate::picture_files::{PictureFile, PictureFiles};
use crate::texture_out::{Encoded, Purpose, encode_texture};
use crate::write_options::{
    MeshCompression, TextureFormat, WriteOptions, Written, WrittenMesh, WrittenTexture,
};
use crate::{FileError, Place, encode_png, write_atomically};
use parbake_model::{Image, Model};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::Path;

const WEBP: &str = "EXT_texture_webp";
const KTX2: &str = "KHR_texture_basisu";
const QUANTIZATION: &str = "KHR_mesh_quantization";

/// Writes `model` as a GLB file, and returns its bytes' number.
///
/// # Errors
/// When the model breaks its contract, or the file cannot be written.
pub fn write_glb(path: &Path, model: &Model) -> Result<u64, FileError> {
    Ok(write_glb_with(path, model, &WriteOptions::default())?.bytes)
}

/// As [`write_glb`], with textures and mesh as the options say; returns what the file holds and what
/// that lost.
///
/// # Errors
/// As [`write_glb`].
pub fn write_glb_with(path: &Path, model: &Model, options: &WriteOptions) -> Result<Written, FileError> {
    write_glb_keeping(path, model, options, &PictureFiles::default())
}

/// As [`write_glb_with`]; where PNG is asked for, textures that are still those of `files` are written as these files
/// (JPEG or 16-bit PNG).
///
/// # Errors
/// As [`write_glb`].
pub fn write_glb_keeping(
    path: &Path,
    model: &Model,
    options: &WriteOptions,
    files: &PictureFiles,
) -> Result<Written, FileError> {
    let encode = |image: &Image, purpose: Purpose, options: &WriteOptions| {
        let kept = if options.texture_format == TextureFormat::Png { files.of(image) } else { None };
        match kept {
            Some(PictureFile { bytes, format }) => {
                let is_jpeg = *format == PictureFormat::Jpeg;
                let format = if is_jpeg { TextureFormat::Jpeg } else { TextureFormat::Png };
                let reason = is_jpeg.then(|| "copied unchanged".into());
                Ok(Encoded { bytes: bytes.clone(), format, psnr: None, reason })
            }
            None => encode_texture(image, purpose, options),
        }
    };
    let (bytes, written) = to_bytes(path, &[model], None, options, encode)?;
    write_atomically(path, &bytes)?;
    Ok(written)
}

/// Writes several levels of detail of one model as one GLB file, finest first, with `MSFT_lod` and
/// `MSFT_screencoverage`. `coverages` holds for each level the share of the screen's height that the model spans
/// where the next level takes its place; that of the last level is 0.
///
/// # Errors
/// As [`write_glb`]; also where there is no level, or not one coverage for each.
pub fn write_lod_glb(
    path: &Path,
    levels: &[&Model],
    coverages: &[f64],
    options: &WriteOptions,
) -> Result<Written, FileError> {
    if levels.is_empty() || levels.len() != coverages.len() {
        let reason =
            format!("{} levels of detail need as many coverages, not {}", levels.len(), coverages.len());
        return Err(FileError::Invalid { path: path.into(), place: Place::File, reason });
    }
    let (bytes, written) = to_bytes(path, levels, Some(coverages), options, encode_texture)?;
    write_atomically(path, &bytes)?;
    Ok(written)
}

/// The bytes of a GLB file of `model`. Errors name the model instead of a file.
///
/// # Errors
/// When the model breaks its contract.
pub fn glb_bytes(model: &Model) -> Result<Vec<u8>, FileError> {
    Ok(glb_bytes_with(model, &WriteOptions::default())?.0)
}

/// As [`glb_bytes`], with textures and mesh as the options say; also what the file holds.
///
/// # Errors
/// As [`glb_bytes`].
pub fn glb_bytes_with(model: &Model, options: &WriteOptions) -> Result<(Vec<u8>, Written), FileError> {
    to_bytes(Path::new(&model.name), &[model], None, options, encode_texture)
}

/// As [`glb_bytes`], for one look at it: textures are encoded fast instead of small.
///
/// # Errors
/// As [`glb_bytes`].
pub fn quick_glb_bytes(model: &Model) -> Result<Vec<u8>, FileError> {
    let encode = |image: &Image, _: Purpose, _: &WriteOptions| {
        let bytes = encode_png(image)?;
        Ok(Encoded { bytes, format: TextureFormat::Png, psnr: None, reason: None })
    };
    Ok(to_bytes(Path::new(&model.name), &[model], None, &WriteOptions::default(), encode)?.0)
}

fn to_bytes(
    path: &Path,
    levels: &[&Model],
    coverages: Option<&[f64]>,
    options: &WriteOptions,
    encode_texture: impl Fn(&Image, Purpose, &WriteOptions) -> Result<Encoded, FileError> + Sync,
) -> Result<(Vec<u8>, Written), FileError> {
    for model in levels {
        crate::model_out::check(path, model)?;
    }
    let mut binary = Binary::default();
    let pieces = pieces(levels, options.mesh_compression != MeshCompression::None);
    let skeleton = write_rig::shared_skeleton(path, levels)?;
    // Skinned meshes ignore their nodes: their joints bring positions back, and leave scales alone.
    let placed = skeleton.is_none_or(|skeleton| skeleton.joints.is_empty());
    let model = &together(levels);
    let mut materials = Materials::new(!model.mesh.tangents.is_empty());
    let mut meshes = meshes(&mut binary, &mut materials, levels, model, &pieces, placed);
    for (mesh, skeleton) in meshes.iter_mut().zip(skeleton.into_iter().cycle()) {
        write_rig::describe_targets(mesh, skeleton);
    }
    let fallback =
        (options.mesh_compression == MeshCompression::Meshopt).then(|| meshopt_out::compress(&mut binary));
    let mesh_bytes = binary.bytes.len() as u64;
    let encode = |&image: &usize| encode_texture(&model.images[image], purpose_of(model, image), options);
    let encoded: Vec<Encoded> = materials.images.par_iter().map(encode).collect::<Result<_, _>>()?;
    let (mut images, mut textures) = (Vec::new(), Vec::new());
    for (&image, Encoded { bytes, format, psnr, reason }) in materials.images.iter().zip(encoded) {
        let view = binary.view(&bytes, None);
        let name = model.images[image].name.clone();
        images.push(json!({ "name": name, "mimeType": format.media_type(), "bufferView": view }));
        textures.push(WrittenTexture { name, format, bytes: bytes.len() as u64, psnr, reason });
    }
    name_sources(&mut materials.textures, &textures);
    let uses = |extension| textures.iter().any(|texture| extension_of(texture.format) == Some(extension));
    let (uses_webp, uses_ktx2) = (uses(WEBP), uses(KTX2));
    let nodes = nodes(levels, coverages, &pieces, placed);
    let uses_meshopt = fallback.is_some();
    let mut document = json!({
        "asset": { "version": "2.0", "generator": concat!("Parbake ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials.json,
    });
    if let Some(skeleton) = skeleton {
        // All pieces of what is skinned share a grid.
        let grid = pieces.first().and_then(|piece| piece.grid.as_ref());
        write_rig::add_to_document(&mut document, &mut binary, skeleton, grid);
    }
    let mut buffers = vec![json!({ "byteLength": binary.bytes.len() })];
    buffers.extend(fallback);
    document["accessors"] = binary.accessors.into();
    document["bufferViews"] = binary.views.into();
    document["buffers"] = buffers.into();
    // glTF has no empty arrays.
    for (key, values) in
        [("textures", materials.textures), ("samplers", materials.samplers), ("images", images)]
    {
        if !values.is_empty() {
            document[key] = values.into();
        }
    }
    // Whether it is used, and whether a reader cannot do without it.
    let extensions = [
        (levels_out::NAME, coverages.is_some(), false),
        (EMISSIVE_STRENGTH, materials.uses_emissive_strength, false),
        (UNLIT, materials.uses_unlit, false),
        ("KHR_texture_transform", materials.uses_transforms, false),
        (super::parallax::NAME, materials.uses_parallax, false),
        (super::parallax::NAME_SH, materials.uses_harmonics, false),
        (WEBP, uses_webp, true),
        (KTX2, uses_ktx2, true),
        (QUANTIZATION, options.mesh_compression != MeshCompression::None, true),
        (meshopt_out::NAME, uses_meshopt, true),
    ];
    let materials = materials.extensions.into_iter().map(|name| (name, true, false));
    let extensions: Vec<_> = extensions.into_iter().chain(materials).collect();
    for (key, required) in [("extensionsUsed", false), ("extensionsRequired", true)] {
        let names: Vec<&str> = extensions.iter().filter(|e| e.1 && (e.2 || !required)).map(|e| e.0).collect();
        if !names.is_empty() {
            document[key] = names.into();
        }
    }
    let bytes = assemble(path, &document.to_string(), binary.bytes)?;
    let position_error = pieces.iter().map(Piece::error).fold(0.0, f64::max);
    let mesh = WrittenMesh { compression: options.mesh_compression, bytes: mesh_bytes, position_error };
    let written = Written { bytes: bytes.len() as u64, mesh, textures };
    Ok((bytes, written))
}

/// The extension by which textures name an image that core glTF does not know.
fn extension_of(format: TextureFormat) -> Option<&'static str> {
    match format {
        TextureFormat::Png | TextureFormat::Jpeg => None,
        TextureFormat::Webp | TextureFormat::WebpLossless => Some(WEBP),
        TextureFormat::Ktx2 | TextureFormat::Ktx2Etc1s => Some(KTX2),
    }
}

/// Textures name such images in their extension alone: there is no other picture to fall back to.
fn name_sources(textures: &mut [Value], images: &[WrittenTexture]) {
    for texture in textures {
        let Some(source) = texture["source"].as_u64() else { continue };
        if let Some(name) = extension_of(images[source as usize].format) {
            *texture = json!({ "sampler": texture["sampler"], "extensions": { name: { "source": source } } });
        }
    }
}

/// Header, JSON chunk, binary chunk; each padded to four bytes.
pub(super) fn assemble(path: &Path, document: &str, mut binary: Vec<u8>) -> Result<Vec<u8>, FileError> {
    let mut text = document.as_bytes().to_vec();
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let total = 12 + 8 + text.len() + 8 + binary.len();
    let length = u32::try_from(total).map_err(|_| FileError::OverLimit {
        path: path.into(),
        place: Place::File,
        what: "bytes in a GLB file",
        found: total as u64,
        limit: u32::MAX.into(),
    })?;
    let mut out = Vec::with_capacity(total);
    out.extend_from_slice(super::MAGIC);
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&length.to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &binary)] {
        out.extend_from_slice(&(chunk.len() as u32).to_le_bytes());
        out.extend_from_slice(kind);
        out.extend_from_slice(chunk);
    }
    Ok(out)
}
