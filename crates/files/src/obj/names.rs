//! What an OBJ file and its libraries name, without reading either as a model.

use super::lex::{Lines, text};
use std::collections::BTreeSet;

/// Statements of a library that name a picture begin so.
const PICTURES: [&str; 6] = ["map_", "bump", "norm", "disp", "decal", "refl"];

/// What `mtllib` lines name: each as one name, since names may hold blanks, and as several.
pub(crate) fn named_libraries(bytes: &[u8]) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let mut lines = Lines::new(bytes);
    while let Some((_, line)) = lines.next() {
        let Some(rest) = line.trim_ascii_start().strip_prefix(b"mtllib") else { continue };
        let whole = text(rest.trim_ascii()).replace("\\ ", " ").replace('\\', "/");
        names.extend(whole.split_ascii_whitespace().map(String::from));
        names.insert(whole);
    }
    names
}

/// All that may be a picture's name in a library: every end of a line that names one.
pub(crate) fn named_pictures(bytes: &[u8]) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let mut lines = Lines::new(bytes);
    while let Some((_, line)) = lines.next() {
        let line = text(line.trim_ascii());
        let lower = line.to_ascii_lowercase();
        if !PICTURES.iter().any(|start| lower.starts_with(start)) {
            continue;
        }
        let line = line.replace("\\ ", " ").replace('\\', "/");
        let line = line.split(" #").next().unwrap_or_default();
        let mut rest = line.trim();
        while let Some((_, end)) = rest.split_once([' ', '\t']) {
            rest = end.trim_start();
            names.insert(rest.to_string());
        }
    }
    names
}
