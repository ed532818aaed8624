//! The ways in which levels are made, and what is known of one that was tried.

use serde::{Deserialize, Serialize};

/// How a level was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// Triangles were chosen by their pictures, the layout is new, maps were fitted.
    #[default]
    New,
    /// Edges of the model collapsed, its layout was repaired, maps were fitted.
    Delivered,
    /// Edges of the model collapsed; it has its own layout and its own maps, with fewer texels.
    Scaled,
}

/// A way that was tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// How.
    pub way: Way,
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side of its largest texture.
    pub texture_size: usize,
    /// PSNR in dB against the original in pictures as viewers make them, the mean of the level's size and, up to 300
    /// pixels, twice that; before anything was compressed.
    pub psnr: f64,
}
