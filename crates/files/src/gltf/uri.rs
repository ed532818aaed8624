//! URIs of buffers and images: data in the URI itself (RFC 2397, base64 of RFC
//! 4648) or a relative path (RFC 3986, percent-encoded).

/// What a URI is.
#[derive(Debug, PartialEq)]
pub(super) enum Uri {
    /// The bytes themselves.
    Data(Vec<u8>),
    /// A path relative to the document.
    Relative(String),
}

/// Understands a URI, or says why not.
pub(super) fn parse(uri: &str) -> Result<Uri, String> {
    if let Some(rest) = uri.get(..5).filter(|s| s.eq_ignore_ascii_case("data:")).map(|_| &uri[5..]) {
        let (kind, data) = rest.split_once(',').ok_or("the data URI has no comma")?;
        return if kind.ends_with(";base64") {
            base64(data.as_bytes()).map(Uri::Data)
        } else {
            Ok(Uri::Data(percent_decode(data)))
        };
    }
    let scheme = uri.find(':').map(|at| &uri[..at]);
    let is_scheme =
        |s: &str| s.len() > 1 && s.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b));
    if let Some(scheme) = scheme.filter(|s| is_scheme(s)) {
        return Err(format!(
            "{scheme}: addresses are not followed; put the file beside the model and write a relative path"
        ));
    }
    if uri.is_empty() {
        return Err("the URI is empty".into());
    }
    // Exporters on Windows forget to turn their slashes; files with a backslash in
    // their names are next to unheard of.
    Ok(Uri::Relative(String::from_utf8_lossy(&percent_decode(uri)).replace('\\', "/")))
}

fn percent_decode(text: &str) -> Vec<u8> {
    let mut out = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, tail @ ..] = rest {
        let hex = |b: u8| (b as char).to_digit(16);
        rest = match (first, tail) {
            (b'%', [a, b, after @ ..]) if hex(*a).is_some() && hex(*b).is_some() => {
                out.push((hex(*a).unwrap_or(0) * 16 + hex(*b).unwrap_or(0)) as u8);
                after
            }
            _ => {
                out.push(*first);
                tail
            }
        };
    }
    out
}

/// Decodes base64 of the common or the URL alphabet; padding may be missing.
fn base64(text: &[u8]) -> Result<Vec<u8>, String> {
    let digits = text.strip_suffix(b"==").or(text.strip_suffix(b"=")).unwrap_or(text);
    let mut out = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for group in digits.chunks(4) {
        let mut bits = 0u32;
        for &digit in group {
            let value = match digit {
                b'A'..=b'Z' => digit - b'A',
                b'a'..=b'z' => digit - b'a' + 26,
                b'0'..=b'9' => digit - b'0' + 52,
                b'+' | b'-' => 62,
                b'/' | b'_' => 63,
                _ => return Err(format!("byte {digit:#04x} in the data URI is not base64")),
            };
            bits = bits << 6 | u32::from(value);
        }
        bits <<= 6 * (4 - group.len());
        let [_, a, b, c] = bits.to_be_bytes();
        match group.len() {
            4 => out.extend([a, b, c]),
            3 => out.extend([a, b]),
            2 => out.push(a),
            _ => return Err("the data URI's base64 is cut off".into()),
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects embedded data: all lengths of the last group, and what is no base64.
    #[test]
    fn base64_of_all_lengths() {
        for (text, expected) in [("", ""), ("TQ==", "M"), ("TWE=", "Ma"), ("TWFu", "Man"), ("TWFuTQ", "ManM")]
        {
            let uri = format!("data:application/octet-stream;base64,{text}");
            assert_eq!(parse(&uri), Ok(Uri::Data(expected.into())));
        }
        assert_eq!(parse("data:;base64,-_+/"), Ok(Uri::Data(vec![0xfb, 0xff, 0xbf])));
        assert!(parse("data:;base64,TW!u").is_err());
        assert!(parse("data:;base64,TWFuT").is_err());
        assert!(parse("data:nothing").is_err());
        assert_eq!(parse("data:,a%20b"), Ok(Uri::Data(b"a b".to_vec())));
    }

    /// Protects names with blanks and colons, and refuses addresses.
    #[test]
    fn paths_and_addresses() {
        assert_eq!(parse("Box%20With%C3%A9.bin"), Ok(Uri::Relative("Box Withé.bin".into())));
        assert_eq!(parse("../a b.png"), Ok(Uri::Relative("../a b.png".into())));
        assert_eq!(parse("100%.png"), Ok(Uri::Relative("100%.png".into())));
        assert_eq!(parse("textures\\a.png"), Ok(Uri::Relative("textures/a.png".into())));
        assert!(parse("https://example.org/a.bin").unwrap_err().contains("https"));
        assert!(parse("file:///etc/passwd").is_err());
        assert!(parse("").is_err());
    }
}
