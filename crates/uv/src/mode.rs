//! What a user may ask of texture coordinates.

use crate::paper::Guide;
use serde::{Deserialize, Serialize};

/// What becomes of texture coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum UvMode {
    /// They stay as they are.
    Keep,
    /// What overlaps, is mirrored or lies outside is mended; sound ones stay.
    Repair,
    /// They are made anew.
    Unwrap,
    /// They are made anew as Tutte's embedding in the middle of the square, a poor start that
    /// optimisers can be tried on.
    Tutte,
    /// They are mended and then moved to where they show most.
    #[default]
    Optimize,
}

/// How texture coordinates are moved where they are optimised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// A start specialised to the signal, then variable projection: what the best texture
    /// leaves is reduced itself.
    #[default]
    Fit,
    /// The paper's alternation: steps of Adam on the texture, one step of L-BFGS on the
    /// coordinates.
    Paper,
}

impl Method {
    /// What moves coordinates in the paper's method, with and without its content-aware term
    /// (Table 3).
    pub fn guide(no_content_aware: bool) -> Guide {
        if no_content_aware { Guide::ImageLoss } else { Guide::ContentAware }
    }
}
