//! How models are shaded where pictures of them are compared, and what of their materials is shown.

use crate::error::EvaluateError;
use parbake_image::display::{Curve, Display};
use parbake_render::interpretation::Interpretation;
use serde::{Deserialize, Serialize};

/// Linear light of a grey background, the independent evaluator's too.
pub const GREY: f32 = 0.5;

/// Shading convention of compared pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Convention {
    /// As glTF viewers show models: base colour decoded from sRGB, a light of strength 1.
    #[default]
    Gltf,
    /// As in the paper's pictures: base colour as stored, a light of strength 1.59.
    Paper,
}

impl Convention {
    /// Whether base colour is decoded from sRGB before shading.
    pub fn decodes_srgb(self) -> bool {
        self == Convention::Gltf
    }

    /// How textures are read.
    pub fn interpretation(self) -> Interpretation {
        Interpretation {
            decode_srgb: self.decodes_srgb(),
            trilinear: true,
            parallax: true,
            extensions: false,
        }
    }

    /// Light strength and display curve.
    pub fn display(self) -> Display {
        let gain = if self == Convention::Paper { 1.59 } else { 1.0 };
        Display { gain, curve: Curve::Srgb }
    }
}

/// What of the high-poly's materials is fitted, and shown in comparisons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Shading {
    /// `pbr` where a material of the high-poly has more than colour, normals and emission; else `lambert`, but
    /// under glTF's convention with normals that are right under any light.
    #[default]
    Auto,
    /// Colours, normals and emission, as a headlight shows them on a matte surface (the paper's shading).
    Lambert,
    /// The whole metallic-roughness material.
    Pbr,
}

/// Checks that whole materials are asked for only where colours are decoded.
///
/// # Errors
/// [`EvaluateError::Option`] where they are not.
pub fn check_shading(shading: Shading, convention: Convention) -> Result<(), EvaluateError> {
    if shading == Shading::Pbr && convention == Convention::Paper {
        let range = "auto or lambert with --convention paper".into();
        return Err(EvaluateError::Option { option: "shading", value: "pbr".into(), range });
    }
    Ok(())
}
