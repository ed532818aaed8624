//! Words for people: counts with their nouns, and texts of hostile length cut to
//! what fits a terminal.

/// More characters than this are cut off.
const LONGEST: usize = 300;

/// "1 triangle", "2 triangles".
pub(crate) fn count(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

/// One line of bounded length: a file's own words may have any.
pub(crate) fn shown(text: &str) -> String {
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    let mut characters = text.chars();
    let mut out: String = characters.by_ref().take(LONGEST).map(plain).collect();
    if characters.next().is_some() {
        out.push('…');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the terminal from files whose words are megabytes long or move the cursor.
    #[test]
    fn texts_are_cut_and_counts_agree() {
        assert_eq!(shown("a\u{1b}[2J\nb"), "a [2J b");
        assert_eq!(shown(&"é".repeat(LONGEST)), "é".repeat(LONGEST));
        assert_eq!(shown(&"é".repeat(LONGEST + 1)).chars().count(), LONGEST + 1);
        assert_eq!((count(1, "face"), count(0, "face")), ("1 face".into(), "0 faces".into()));
    }
}
