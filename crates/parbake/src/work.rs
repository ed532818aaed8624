//! What kind of work a bake is: its command, and what its stages do differently for it.

use serde::{Deserialize, Serialize};

/// What a report is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Work {
    /// A high-poly's look on a low-poly.
    #[default]
    Bake,
    /// A high-poly's look on a low-poly that was made for it.
    Level,
    /// A model with a smaller texture.
    Compress,
}

impl Work {
    /// The command, as one types it, and what it takes.
    pub fn command(self) -> &'static str {
        match self {
            Self::Bake => "bake HIGH LOW",
            Self::Level => "lod MODEL",
            Self::Compress => "compress MODEL",
        }
    }
}
