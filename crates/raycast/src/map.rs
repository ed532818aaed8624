//! The maps of the high-poly's shape, beside those of its materials.

use serde::{Deserialize, Serialize};

/// A map of the high-poly's shape. Formulas are in the files of these names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum GeometryMap {
    /// Ambient occlusion: share of the cosine-weighted sky that is open; white is open
    Occlusion,
    /// Mean open direction in the low-poly's tangent space
    BentNormal,
    /// Mean curvature; white is convex, half grey is flat, black is concave
    Curvature,
    /// Place on the high-poly
    Position,
    /// Depth of the high-poly behind its surface
    Thickness,
    /// Distance of the high-poly from the low-poly along the ray; half grey is none
    Height,
    /// The high-poly's normal in the model's own axes
    ObjectNormal,
}

impl GeometryMap {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Occlusion,
        Self::BentNormal,
        Self::Curvature,
        Self::Position,
        Self::Thickness,
        Self::Height,
        Self::ObjectNormal,
    ];

    /// Its name in file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Occlusion => "occlusion",
            Self::BentNormal => "bent_normal",
            Self::Curvature => "curvature",
            Self::Position => "position",
            Self::Thickness => "thickness",
            Self::Height => "height",
            Self::ObjectNormal => "object_normal",
        }
    }

    /// Channels of its picture: 1 (grey) or 3.
    pub fn channels(self) -> usize {
        match self {
            Self::Occlusion | Self::Curvature | Self::Thickness | Self::Height => 1,
            Self::BentNormal | Self::Position | Self::ObjectNormal => 3,
        }
    }
}
