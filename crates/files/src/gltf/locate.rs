//! From a place in a JSON text to the JSON pointer (RFC 6901) of the value there,
//! for errors about documents that are JSON but not glTF.

/// Deeper levels are left out of the pointer: hostile documents nest without end.
const DEEPEST: usize = 32;

/// One level around a place.
enum Level<'a> {
    Array(usize),
    /// The current key, as written between its quotes.
    Object(&'a [u8]),
}

/// The pointer to the value that `error` stopped at or after.
pub(super) fn pointer(text: &[u8], error: &serde_json::Error) -> String {
    let line_start = match error.line() {
        0 | 1 => 0,
        line => text.iter().enumerate().filter(|(_, b)| **b == b'\n').nth(line - 2).map_or(0, |(i, _)| i + 1),
    };
    let end = line_start.saturating_add(error.column()).min(text.len());
    let mut out = String::new();
    for level in levels(&text[..end]) {
        out.push('/');
        match level {
            Level::Array(index) => out.push_str(&index.to_string()),
            Level::Object(key) => out.push_str(&name(key)),
        }
    }
    out
}

/// The levels that are open at the end of `text`, the beginning of a JSON text.
fn levels(text: &[u8]) -> Vec<Level<'_>> {
    let mut levels = Vec::new();
    let mut depth = 0usize;
    let mut at = 0;
    while let Some(&byte) = text.get(at) {
        at += 1;
        match byte {
            b'{' | b'[' => {
                depth += 1;
                if depth <= DEEPEST {
                    levels.push(if byte == b'{' { Level::Object(b"") } else { Level::Array(0) });
                }
            }
            b'}' | b']' => {
                depth = depth.saturating_sub(1);
                levels.truncate(depth);
            }
            b',' if depth <= DEEPEST => {
                if let Some(Level::Array(index)) = levels.last_mut() {
                    *index += 1;
                }
            }
            b'"' => {
                let length = string_length(&text[at..]);
                let is_key = text[at + length..].iter().skip(1).find(|b| !b.is_ascii_whitespace());
                if let (Some(b':'), Some(Level::Object(key)), true) =
                    (is_key, levels.last_mut(), depth <= DEEPEST)
                {
                    *key = &text[at..at + length];
                }
                at += length + 1;
            }
            _ => {}
        }
    }
    levels
}

/// Bytes up to the closing quote, or all where there is none.
fn string_length(text: &[u8]) -> usize {
    let mut at = 0;
    while let Some(&byte) = text.get(at) {
        match byte {
            b'"' => return at,
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    text.len()
}

/// A key in a pointer, where `~` and `/` stand for other things.
fn name(key: &[u8]) -> String {
    String::from_utf8_lossy(key).replace('~', "~0").replace('/', "~1")
}

/// What the parser says about a misfit, without its place and in JSON's own words.
pub(super) fn reason(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let text = text.split(" at line ").next().unwrap_or(&text);
    let text = match text.split_once("expected struct ") {
        Some((before, _)) => format!("{before}expected an object"),
        None => text.replace("expected a sequence", "expected an array"),
    };
    text.replace("invalid type: map", "invalid type: object")
        .replace("invalid type: sequence", "invalid type: array")
}

#[cfg(test)]
mod tests {
    use super::super::json::Document;
    use super::*;

    fn locate(text: &str) -> (String, String) {
        let error = serde_json::from_slice::<Document>(text.as_bytes()).unwrap_err();
        (pointer(text.as_bytes(), &error), reason(&error))
    }

    /// Protects the promise that errors point at their place.
    #[test]
    fn misfits_are_located() {
        for (text, place, expected) in [
            (
                r#"{"accessors":[{"componentType":1,"count":1,"type":"VEC3"},{"count":1}]}"#,
                "/accessors/1",
                "componentType",
            ),
            (r#"{"nodes":5}"#, "/nodes", "expected an array"),
            ("{\n \"nodes\": [\n  {},\n  { \"mesh\": -1 }\n ]\n}", "/nodes/1/mesh", "a whole number"),
            (
                r#"{"meshes":[{"primitives":[{},{"attributes":7}]}]}"#,
                "/meshes/0/primitives/1/attributes",
                "expected an object",
            ),
            (
                r#"{"extras":{"a,b":"}\"{","x":[[1,2],{}]},"materials":["m"]}"#,
                "/materials/0",
                "string \"m\", expected an object",
            ),
            (r#"{"meshes":[{"primitives":{}}]}"#, "/meshes/0/primitives", "type: object, expected an array"),
            (r#"{"asset":{}}"#, "/asset", "version"),
        ] {
            let (pointer, reason) = locate(text);
            assert!(pointer.starts_with(place), "{text}: {pointer}");
            assert!(reason.contains(expected) && !reason.contains("line"), "{text}: {reason}");
        }
    }

    /// Protects memory and pointers from endless nesting.
    #[test]
    fn nesting_is_bounded() {
        let deep = "[".repeat(100_000);
        assert_eq!(levels(deep.as_bytes()).len(), DEEPEST);
        let closed = format!("[0,{deep}{},", "]".repeat(100_000));
        assert!(matches!(levels(closed.as_bytes())[..], [Level::Array(2)]));
    }
}
