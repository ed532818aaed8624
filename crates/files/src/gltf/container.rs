//! GLB: a glTF document and its first buffer in one file (glTF 2.0, section 4).

use super::MAGIC;
use crate::context::Context;
use crate::words::count;
use crate::{FileError, Place};

/// Bytes of a file's header.
const HEADER: usize = 12;

/// The document's text and the binary chunk, if there is one. Bytes that do not
/// begin with "glTF" are a document by themselves.
pub(super) fn open<'b>(
    bytes: &'b [u8],
    context: &Context<'_>,
) -> Result<(&'b [u8], Option<&'b [u8]>), FileError> {
    let bad = |reason: String| Err(context.invalid(Place::File, reason));
    if !bytes.starts_with(MAGIC) {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let named_glb = context.path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb"));
        // A document with the wrong extension is read; what is neither is told apart.
        if named_glb && !text.trim_ascii_start().starts_with(b"{") {
            return bad("the file is not GLB: it does not begin with \"glTF\"".into());
        }
        return Ok((text, None));
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return bad("the GLB header is cut off".into());
    };
    if version != 2 {
        return Err(context.unsupported(
            Place::File,
            format!("GLB version {version}"),
            "convert the model to glTF 2.0",
        ));
    }
    let length = length as usize;
    let there = bytes.len();
    if length > there {
        return bad(format!("the GLB file is cut off: {there} of {length} bytes are there"));
    }
    if length < HEADER {
        return bad(format!("the GLB header says that the file has {length} bytes; it has {there}"));
    }
    if length < there {
        context.warn(format!("passed over {} after the GLB file's end", count(there - length, "byte")));
    }
    let mut at = HEADER;
    let (mut json, mut binary) = (None, None);
    while at < length {
        let rest = &bytes[at..length];
        let (Some(size), Some(kind)) = (word(rest, 0), rest.get(4..8)) else {
            return bad(format!("the GLB chunk at byte {at} is cut off"));
        };
        let Some(data) = rest.get(8..).and_then(|r| r.get(..size as usize)) else {
            return bad(format!("the GLB chunk at byte {at} has {size} bytes and reaches beyond the file"));
        };
        match kind {
            b"JSON" if json.is_none() => json = Some(data),
            b"BIN\0" if binary.is_none() => binary = Some(data),
            b"JSON" | b"BIN\0" => return bad(format!("the GLB chunk at byte {at} comes twice")),
            _ => {}
        }
        at += 8 + data.len();
    }
    match json {
        Some(json) => Ok((json, binary)),
        None => bad("the GLB file has no JSON chunk".into()),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|b| u32::from_le_bytes(*b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Textures;
    use crate::{Limits, NoResources};
    use std::path::Path;

    fn glb(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        for (kind, data) in chunks {
            out.extend((data.len() as u32).to_le_bytes());
            out.extend(*kind);
            out.extend(*data);
        }
        let length = (out.len() as u32).to_le_bytes();
        out[8..12].copy_from_slice(&length);
        out
    }

    /// Both chunks, and how many warnings there were.
    type Opened = Result<(Vec<u8>, Option<Vec<u8>>, usize), String>;

    fn run(bytes: &[u8]) -> Opened {
        let limits = Limits::default();
        let context = Context::new(Path::new("a.glb"), &NoResources, &limits, Textures::Decode);
        let (json, binary) = open(bytes, &context).map_err(|e| e.to_string())?;
        Ok((json.to_vec(), binary.map(<[u8]>::to_vec), context.into_warnings().len()))
    }

    /// Protects the reading of chunks, also where others stand between them.
    #[test]
    fn chunks_are_found() {
        let mut bytes = glb(&[(b"JSON", b"{}  "), (b"XYZW", b"abcd"), (b"BIN\0", b"1234")]);
        assert_eq!(run(&bytes), Ok((b"{}  ".to_vec(), Some(b"1234".to_vec()), 0)));
        bytes.push(0);
        assert_eq!(run(&bytes).unwrap().2, 1);
        assert_eq!(run(b"\xef\xbb\xbf{}"), Ok((b"{}".to_vec(), None, 0)));
    }

    /// Protects against files that are cut off anywhere.
    #[test]
    fn cut_files_are_refused() {
        let bytes = glb(&[(b"JSON", b"{}"), (b"BIN\0", b"1234")]);
        for length in 4..bytes.len() {
            assert!(run(&bytes[..length]).unwrap_err().starts_with("a.glb"));
        }
        assert!(run(&glb(&[(b"JSON", b"{}"), (b"JSON", b"{}")])).unwrap_err().contains("twice"));
        assert!(run(&glb(&[])).unwrap_err().contains("no JSON"));
        let mut old = glb(&[(b"JSON", b"{}")]);
        old[4] = 1;
        assert!(run(&old).unwrap_err().contains("convert"));
    }
}
