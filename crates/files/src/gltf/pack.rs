//! A glTF document with all that it refers to in one GLB file, for viewers that can open no other files.
//!
//! Everything in the document stays as it is, what this crate does not understand too: animations, extensions,
//! levels of detail. Only places change: buffers are put one behind the other into the binary chunk, pictures become
//! views of it.
//!
//! Contract: a GLB file that names no other file comes back as it was, to the byte. A picture that is not there is
//! replaced by a white texel.

use super::buffers::{Buffers, pointer};
use super::uri::{Uri, parse as parse_uri};
use super::write::assemble;
use super::{MAGIC, container, parse};
use crate::context::Context;
use crate::{FileError, Place, encode_png};
use parbake_model::Image;
use serde_json::{Value, json};

/// Buffer views that name their bytes in an extension.
const COMPRESSED: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The bytes of one GLB file that names no other.
///
/// # Errors
/// When the document cannot be parsed or a buffer is not there.
pub(crate) fn pack(context: &Context<'_>, bytes: &[u8]) -> Result<Vec<u8>, FileError> {
    let (text, binary) = container::open(bytes, context)?;
    let document = parse(text, context)?;
    let uris =
        document.buffers.iter().map(|buffer| &buffer.uri).chain(document.images.iter().map(|i| &i.uri));
    let names_others = uris.flatten().next().is_some();
    if bytes.starts_with(MAGIC) && !names_others {
        return Ok(bytes.to_vec());
    }
    let buffers = Buffers::new(&document, binary, context);
    let mut json: Value = serde_json::from_slice(text)
        .map_err(|error| context.invalid(Place::File, format!("the document is not valid JSON: {error}")))?;

    let mut all = Vec::new();
    let mut starts = Vec::new();
    for (index, buffer) in document.buffers.iter().enumerate() {
        aligned(&mut all);
        starts.push(all.len());
        // What compressed views fall back to need not be there.
        if buffer.uri.is_some() || (index == 0 && binary.is_some()) {
            all.extend_from_slice(buffers.part(
                index,
                0,
                buffer.byte_length,
                &format!("/buffers/{index}"),
            )?);
        }
    }
    if let Some(views) = json.get_mut("bufferViews").and_then(Value::as_array_mut) {
        for view in views {
            moved(view, &starts);
            for name in COMPRESSED {
                if let Some(view) = view.pointer_mut(&format!("/extensions/{name}")) {
                    moved(view, &starts);
                }
            }
        }
    }
    for (index, image) in document.images.iter().enumerate() {
        let Some(uri) = &image.uri else { continue };
        let place = pointer(format!("/images/{index}/uri"));
        let picture = match parse_uri(uri) {
            Ok(Uri::Data(bytes)) => Some(bytes),
            Ok(Uri::Relative(path)) => buffers.external(&path, place)?.ok(),
            Err(_) => None,
        };
        let picture = match picture {
            Some(picture) => picture,
            None => {
                context.warn(format!("image {:?} is not there; it is shown as white", image_name(uri)));
                encode_png(&Image::solid("", 1, 1, [255; 4]))?
            }
        };
        aligned(&mut all);
        let view = json!({ "buffer": 0, "byteOffset": all.len(), "byteLength": picture.len() });
        let media = media_type(&picture);
        all.extend_from_slice(&picture);
        let views = &mut json["bufferViews"];
        if !views.is_array() {
            *views = json!([]);
        }
        let Some(views) = views.as_array_mut() else { continue };
        views.push(view);
        let view = views.len() - 1;
        if let Some(image) = json.pointer_mut(&format!("/images/{index}")).and_then(Value::as_object_mut) {
            image.remove("uri");
            image.insert("bufferView".into(), view.into());
            image.insert("mimeType".into(), media.into());
        }
    }
    json["buffers"] = json!([{ "byteLength": all.len() }]);
    assemble(context.path, &json.to_string(), all)
}

fn aligned(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(8), 0);
}

/// The view in the one buffer.
fn moved(view: &mut Value, starts: &[usize]) {
    let buffer = view["buffer"].as_u64().and_then(|b| usize::try_from(b).ok()).unwrap_or(0);
    let offset = view["byteOffset"].as_u64().unwrap_or(0);
    let start = starts.get(buffer).copied().unwrap_or(0) as u64;
    view["buffer"] = 0.into();
    view["byteOffset"] = offset.saturating_add(start).into();
}

fn image_name(uri: &str) -> &str {
    if uri.get(..5).is_some_and(|s| s.eq_ignore_ascii_case("data:")) { "data" } else { uri }
}

/// By the first bytes, since documents and extensions are wrong about it.
fn media_type(bytes: &[u8]) -> &'static str {
    match bytes {
        [0xFF, 0xD8, ..] => "image/jpeg",
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => "image/webp",
        [0xAB, b'K', b'T', b'X', ..] => "image/ktx2",
        _ => "image/png",
    }
}
