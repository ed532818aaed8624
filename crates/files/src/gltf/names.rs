//! What a glTF document names, without reading it as a model.

use super::MAGIC;
use super::uri::{Uri, parse};
use std::collections::BTreeSet;

/// Bytes before a GLB file's first chunk, which is the document, and its header.
const HEADERS: [usize; 2] = [12, 8];

/// Files that buffers and images name; nothing of what is no document.
pub(crate) fn named_files(bytes: &[u8]) -> BTreeSet<String> {
    let text = if bytes.starts_with(MAGIC) {
        let size = bytes
            .get(HEADERS[0]..HEADERS[0] + 4)
            .and_then(|b| b.try_into().ok())
            .map_or(0, u32::from_le_bytes);
        bytes.get(HEADERS[0] + HEADERS[1]..).and_then(|rest| rest.get(..size as usize)).unwrap_or_default()
    } else {
        bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
    };
    let document: serde_json::Value = serde_json::from_slice(text).unwrap_or_default();
    let lists = ["buffers", "images"].into_iter().filter_map(|list| document[list].as_array());
    let uris = lists.flatten().filter_map(|item| item["uri"].as_str());
    let is_data = |uri: &str| uri.get(..5).is_some_and(|start| start.eq_ignore_ascii_case("data:"));
    uris.filter(|uri| !is_data(uri))
        .filter_map(|uri| match parse(uri) {
            Ok(Uri::Relative(path)) => Some(path),
            _ => None,
        })
        .collect()
}
