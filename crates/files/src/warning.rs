//! What is odd about a file, yet no reason to refuse it.
//!
//! Contract: programs decide by the kind, people read the text.

use std::fmt;

/// What a warning is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum WarningKind {
    /// A picture that a material names is missing or cannot be used; the material goes without it.
    MissingTexture,
    /// A material or material library is missing; what it should cover is white.
    MissingMaterial,
    /// Anything else: parts that were left out, values that were replaced.
    #[default]
    Other,
}

/// One sentence to show to people, and what it is about.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Warning {
    /// For programs.
    pub kind: WarningKind,
    /// For people; where a file was read, it begins with the file's name.
    pub text: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl PartialEq<&str> for Warning {
    fn eq(&self, text: &&str) -> bool {
        self.text == *text
    }
}
