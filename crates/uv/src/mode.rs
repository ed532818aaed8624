//! Options of texture coordinates.

use crate::paper::Guide;
use serde::{Deserialize, Serialize};

/// How texture coordinates are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum UvMode {
    /// Keep UVs as they are.
    Keep,
    /// Repair what overlaps, is mirrored or lies outside the square; keep sound UVs.
    Repair,
    /// Replace UVs by a new unwrap.
    Unwrap,
    /// Research only: Tutte's embedding in the middle of the square, a poor start for optimisers.
    #[cfg_attr(feature = "clap", value(hide = true))]
    Tutte,
    /// Repair, then redistribute texels to minimise the rendered error.
    #[default]
    Optimize,
}

/// UV optimiser.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Parbake's: triangles with more detail get more texels (signal-specialised parameterisation), then texture and UVs
    /// are fitted together (variable projection).
    #[default]
    Fit,
    /// The paper's alternation of Adam on the texture and L-BFGS on the UVs.
    Paper,
}

impl Method {
    /// What moves coordinates in the paper's method, with and without its content-aware term
    /// (Table 3).
    pub fn guide(no_content_aware: bool) -> Guide {
        if no_content_aware { Guide::ImageLoss } else { Guide::ContentAware }
    }
}
