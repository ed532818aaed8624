//! What a run is doing, stage by stage.

use serde::{Deserialize, Serialize};

/// What a run is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// Reading and decoding files.
    Read,
    /// Normals, tangents, charts, the search structure of the high-poly.
    Prepare,
    /// Choosing the triangles of a low-poly.
    Simplify,
    /// Moving vertices.
    Shape,
    /// Repairing, unwrapping and moving texture coordinates.
    Uv,
    /// Rendering the high-poly from the training views.
    Reference,
    /// Projecting the high-poly onto the low-poly's texture.
    Start,
    /// Finding where each pixel falls on the texture.
    Sampling,
    /// Fitting the cutout.
    Cutout,
    /// Fitting the parallax map.
    Parallax,
    /// Solving for the textures.
    Solve,
    /// Projecting the high-poly onto the delivered low-poly, to compare with.
    Baseline,
    /// Comparing pictures.
    Evaluate,
    /// Rendering and encoding frames of a film.
    Film,
    /// Encoding and writing files.
    Write,
}

impl Stage {
    /// What a person reads: "rendering the high-poly".
    pub fn label(self) -> &'static str {
        match self {
            Stage::Read => "reading files",
            Stage::Prepare => "preparing",
            Stage::Simplify => "choosing triangles",
            Stage::Shape => "moving vertices",
            Stage::Uv => "moving texture coordinates",
            Stage::Reference => "rendering the high-poly",
            Stage::Start => "projecting",
            Stage::Sampling => "finding samples",
            Stage::Cutout => "cutting silhouettes",
            Stage::Parallax => "fitting parallax",
            Stage::Solve => "solving for textures",
            Stage::Baseline => "ray-casting the delivered low-poly",
            Stage::Evaluate => "comparing pictures",
            Stage::Film => "filming",
            Stage::Write => "writing files",
        }
    }
}
