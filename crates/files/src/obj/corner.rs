//! A face's corners: `position`, `position/texture`, `position//normal` or
//! `position/texture/normal`, counted from 1, or backwards from −1 for the last
//! one defined so far.

/// Stands for an index that a face does not give.
pub(super) const NONE: u32 = u32::MAX;

/// Indices of position, texture coordinate and normal.
pub(super) type Corner = [u32; 3];

/// The names of what a corner's indices count.
pub(super) const KINDS: [&str; 3] = ["v", "vt", "vn"];

/// For each kind the highest number used before its definition, and its line.
pub(super) type Forward = [(u32, usize); 3];

/// Reads a corner. `counts` says how many of each kind are defined so far.
#[inline]
pub(super) fn corner(
    word: &[u8],
    counts: [usize; 3],
    forward: &mut Forward,
    line: usize,
) -> Result<Corner, String> {
    let no_corner = || format!("{:?} is not a face corner", super::lex::text(word));
    let mut corner = [NONE; 3];
    let mut rest = word;
    for kind in 0..3 {
        let (value, after) = index(rest).ok_or_else(no_corner)?;
        if let Some(value) = value {
            corner[kind] = resolve(value, counts[kind], KINDS[kind])?;
            // Most files define first; only what is used before its definition
            // has to wait for the end of the file.
            if corner[kind] as usize >= counts[kind] {
                forward[kind] = forward[kind].max((corner[kind] + 1, line));
            }
        } else if kind == 0 {
            return Err(format!("{:?} gives no position", super::lex::text(word)));
        }
        match after {
            [] => return Ok(corner),
            [b'/', tail @ ..] if kind < 2 => rest = tail,
            _ => break,
        }
    }
    Err(no_corner())
}

/// A signed integer at the beginning, or nothing before a slash or the end; and
/// what follows it.
#[inline]
fn index(word: &[u8]) -> Option<(Option<i64>, &[u8])> {
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        [] | [b'/', ..] => return Some((None, word)),
        _ => (false, word),
    };
    let end = digits.iter().position(|b| !b.is_ascii_digit()).unwrap_or(digits.len());
    // Eighteen digits cannot overflow; what is longer is out of range anyway.
    if end == 0 || end > 18 {
        return None;
    }
    let value = digits[..end].iter().fold(0, |n, &d| n * 10 + i64::from(d - b'0'));
    Some((Some(if negative { -value } else { value }), &digits[end..]))
}

/// From OBJ's counting to indices from 0.
#[inline]
fn resolve(value: i64, count: usize, kind: &str) -> Result<u32, String> {
    let index = match value {
        0 => return Err(format!("the face uses {kind} number 0, but OBJ counts from 1")),
        v if v < 0 => v + count as i64,
        v => v - 1,
    };
    // One below NONE, so that forward uses can be kept as index + 1.
    u32::try_from(index).ok().filter(|&i| i < NONE - 1).ok_or_else(|| {
        format!("the face uses {kind} number {value}, but up to here the file defines only {count}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects all forms of corners, both ways of counting, and what is none.
    #[test]
    fn corners_in_all_forms() {
        let n = NONE;
        let read = |word: &str| corner(word.as_bytes(), [9, 5, 3], &mut Forward::default(), 1);
        for (word, expected) in [
            ("1", [0, n, n]),
            ("+3//", [2, n, n]),
            ("2/1", [1, 0, n]),
            ("2/1/", [1, 0, n]),
            ("-9//-1", [0, n, 2]),
            ("-1/-1/-1", [8, 4, 2]),
        ] {
            assert_eq!(read(word), Ok(expected), "{word}");
        }
        for word in ["/1", "//", "1/1/1/1", "1.5", "--1", "-", "1\\2", "99999999999999999999"] {
            assert!(read(word).is_err(), "{word}");
        }
    }

    /// Protects uses before the definition: they are remembered with their line.
    #[test]
    fn forward_uses_are_remembered() {
        let mut forward = Forward::default();
        corner(b"7/2", [6, 0, 0], &mut forward, 3).unwrap();
        corner(b"6/1", [6, 0, 0], &mut forward, 4).unwrap();
        assert_eq!(forward, [(7, 3), (2, 3), (0, 0)]);
    }
}
