//! Lines and words of OBJ and MTL files, straight from bytes: no string is made
//! for a line, and bytes that are no UTF-8 do no harm.

/// Goes through a text line by line; a line that ends in `\` goes on in the next.
pub(super) struct Lines<'a> {
    bytes: &'a [u8],
    newline: u8,
    position: usize,
    number: usize,
    joined: Vec<u8>,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        // Files of the first Macs end their lines with a carriage return alone.
        let newline = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
        Self { bytes, newline, position: 0, number: 0, joined: Vec::new() }
    }

    fn physical(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.position..).filter(|rest| !rest.is_empty())?;
        let end = rest.iter().position(|&b| b == self.newline).unwrap_or(rest.len());
        self.position += end + 1;
        self.number += 1;
        Some(rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]))
    }

    /// The next line, and its number from 1 (of its first line, where it was joined).
    pub fn next(&mut self) -> Option<(usize, &[u8])> {
        let first = self.physical()?;
        let number = self.number;
        // A comment may well end in a Windows path; it never goes on.
        if first.last() != Some(&b'\\') || first.trim_ascii_start().starts_with(b"#") {
            return Some((number, first));
        }
        self.joined.clear();
        self.joined.extend_from_slice(first);
        while self.joined.last() == Some(&b'\\') {
            self.joined.pop();
            self.joined.push(b' ');
            let Some(next) = self.physical() else { break };
            self.joined.extend_from_slice(next);
        }
        Some((number, &self.joined))
    }
}

/// The words of a line, up to a comment.
#[derive(Clone)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
}

impl<'a> Words<'a> {
    pub fn new(line: &'a [u8]) -> Self {
        Self { rest: line }
    }

    /// All that is left of the line, without the blanks around it: names may
    /// contain blanks and `#`.
    pub fn remainder(&self) -> &'a [u8] {
        self.rest.trim_ascii()
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let rest = &self.rest[start..];
        if rest[0] == b'#' {
            self.rest = &[];
            return None;
        }
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.rest = &rest[end..];
        Some(&rest[..end])
    }
}

/// A decimal number, correctly rounded; what is printed for NaN and infinity on
/// any system is a number here.
#[inline]
pub(super) fn number<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    let word = std::str::from_utf8(word).ok()?;
    word.parse().ok().or_else(|| odd_number(word)?.parse().ok())
}

/// `-nan(ind)`, `1.#QNAN`, `-1.#IND` or `1.#INF`, in the words of Rust.
fn odd_number(word: &str) -> Option<&'static str> {
    let plain = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
    match plain.strip_prefix("1.#").unwrap_or(&plain) {
        rest if rest.starts_with("inf") => Some("inf"),
        rest if rest.starts_with("nan(") => Some("nan"),
        rest if ["ind", "qnan", "snan"].iter().any(|nan| rest.starts_with(nan)) => Some("nan"),
        _ => None,
    }
}

/// Bytes as text. What is no UTF-8 is taken for Latin-1, as older exporters write
/// it; so names that differ stay different.
pub(super) fn text(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(bytes: &[u8]) -> Vec<(usize, String)> {
        let mut lines = Lines::new(bytes);
        let mut all = Vec::new();
        while let Some((number, line)) = lines.next() {
            all.push((number, text(line)));
        }
        all
    }

    /// Protects line numbers and joined lines under all line endings.
    #[test]
    fn lines_join_and_count() {
        let expected = [(1, "a".into()), (2, "b  c".into()), (4, "d".into())];
        assert_eq!(lines(b"a\nb \\\nc\nd"), expected);
        assert_eq!(lines(b"\xef\xbb\xbfa\r\nb \\\r\nc\r\nd\r\n"), expected);
        assert_eq!(lines(b"a\rb\r"), [(1, "a".into()), (2, "b".into())]);
        assert_eq!(lines(b"# C:\\\nv"), [(1, "# C:\\".into()), (2, "v".into())]);
        assert_eq!(lines(b"x\\"), [(1, "x ".into())]);
    }

    /// Protects words from blanks and comments, and names from being cut.
    #[test]
    fn words_and_remainders() {
        let mut words = Words::new(b"  map_Kd\ta b#c.png ");
        assert_eq!(words.next(), Some(b"map_Kd".as_slice()));
        assert_eq!(words.remainder(), b"a b#c.png");
        assert_eq!(Words::new(b"v 1 2 # 3").count(), 3);
        assert_eq!(number::<f64>(b".8e-001"), Some(0.08));
        assert_eq!(number::<f64>(b"1,5"), None);
    }

    /// Protects files with normals of no direction, as C libraries print them.
    #[test]
    fn numbers_that_are_none() {
        for word in ["nan", "-NaN", "nan(ind)", "-nan(ind)", "1.#QNAN0", "-1.#IND00"] {
            assert!(number::<f32>(word.as_bytes()).is_some_and(f32::is_nan), "{word}");
        }
        assert!(number::<f32>(b"-1.#INF").is_some_and(f32::is_infinite));
        assert_eq!(number::<f32>(b"name"), None);
    }
}
