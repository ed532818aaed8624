//! The paper's tables and figures, by name.

use serde::{Deserialize, Serialize};

/// A table or a figure of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "clap", value(rename_all = "lowercase"))]
pub enum Exhibit {
    /// What the models are like.
    Table5,
    /// Low-polys close to their high-polys.
    Table8,
    /// Low-polys at moderate distance.
    Table9,
    /// The coarsest low-polys.
    Table10,
    /// Kinds of parallax and displacement.
    Table11,
    /// The same model with a smaller texture.
    Table7,
    /// Pictures on a plane.
    Table6,
    /// The content-aware term in the paper's method.
    Table3,
    /// What it costs.
    Table2,
    /// Distances of low-polys from their high-polys.
    Figure4,
    /// What the models are like, all together.
    Figure5,
    /// Gains by level and texture size.
    Figure6,
    /// Levels side by side.
    Figure7,
    /// Texture sizes side by side.
    Figure8,
    /// Gains of smaller textures.
    Figure9,
    /// Texture coordinates over pictures.
    Figure10,
    /// The brick wall.
    Figure11,
    /// Measured depth.
    Figure12,
    /// Further maps under random lights.
    Figure14,
    /// Convergence of the paper's method.
    Figure15,
    /// One thing at a time.
    Figure16,
    /// Orders of spherical harmonics.
    Figure17,
    /// Starts of the texture coordinates.
    Figure18,
}

impl Exhibit {
    /// All, in the order in which they are made: what most others build on comes first, what takes
    /// longest last.
    pub const ALL: [Exhibit; 23] = [
        Exhibit::Table5,
        Exhibit::Figure4,
        Exhibit::Figure5,
        Exhibit::Table10,
        Exhibit::Table6,
        Exhibit::Table7,
        Exhibit::Table8,
        Exhibit::Table9,
        Exhibit::Table11,
        Exhibit::Figure6,
        Exhibit::Figure7,
        Exhibit::Figure8,
        Exhibit::Figure9,
        Exhibit::Figure10,
        Exhibit::Figure11,
        Exhibit::Figure12,
        Exhibit::Figure14,
        Exhibit::Figure16,
        Exhibit::Figure17,
        Exhibit::Figure18,
        Exhibit::Table3,
        Exhibit::Figure15,
        Exhibit::Table2,
    ];

    /// Those of a quick run.
    pub const QUICK: [Exhibit; 5] =
        [Exhibit::Table10, Exhibit::Table6, Exhibit::Table7, Exhibit::Figure6, Exhibit::Figure9];

    /// "Table 8".
    pub fn name(self) -> &'static str {
        match self {
            Exhibit::Table2 => "Table 2",
            Exhibit::Table3 => "Table 3",
            Exhibit::Table5 => "Table 5",
            Exhibit::Table6 => "Table 6",
            Exhibit::Table7 => "Table 7",
            Exhibit::Table8 => "Table 8",
            Exhibit::Table9 => "Table 9",
            Exhibit::Table10 => "Table 10",
            Exhibit::Table11 => "Table 11",
            Exhibit::Figure4 => "Figure 4",
            Exhibit::Figure5 => "Figure 5",
            Exhibit::Figure6 => "Figure 6",
            Exhibit::Figure7 => "Figure 7",
            Exhibit::Figure8 => "Figure 8",
            Exhibit::Figure9 => "Figure 9",
            Exhibit::Figure10 => "Figure 10",
            Exhibit::Figure11 => "Figure 11",
            Exhibit::Figure12 => "Figure 12",
            Exhibit::Figure14 => "Figure 14",
            Exhibit::Figure15 => "Figure 15",
            Exhibit::Figure16 => "Figure 16",
            Exhibit::Figure17 => "Figure 17",
            Exhibit::Figure18 => "Figure 18",
        }
    }
}
