//! Names of materials in a sentence.

use std::collections::BTreeSet;

/// Names that a warning has room for; the others are counted.
const MOST: usize = 5;

/// The names in quotes, each once, in alphabetical order: `"case", "screen" and 3 more`.
pub fn named<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    // Primitives of one material may have a copy each.
    let all: BTreeSet<&str> = names.into_iter().collect();
    let first: Vec<String> = all.iter().take(MOST).map(|name| format!("{name:?}")).collect();
    match all.len() - first.len() {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects warnings about models of a hundred materials from being lists.
    #[test]
    fn many_names_are_counted() {
        assert_eq!(named(["b", "a", "b"]), "\"a\", \"b\"");
        assert!(named(["7", "6", "5", "4", "3", "2", "1"]).ends_with("\"5\" and 2 more"));
    }
}
