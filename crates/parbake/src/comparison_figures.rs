//! Figures of a bake and of the ray-cast bake of the same pair, as plain data; `comparison.rs` makes them.

use parbake_evaluate::channels::Channel;
use parbake_evaluate::conventions::Shading;
use parbake_evaluate::figures::ViewFigures;
use parbake_evaluate::options::EvaluateOptions;
use serde::{Deserialize, Serialize};

/// What lies behind the models, as `evaluate` knows it; the first is its default.
pub const BACKGROUNDS: [&str; 3] = ["black", "grey", "white"];

/// Figures of both models.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeforeAndAfter {
    /// Of [`Baked::ray_cast`](crate::Baked::ray_cast).
    pub ray_cast: ViewFigures,
    /// Of [`Baked::model`](crate::Baked::model).
    pub baked: ViewFigures,
}

/// Figures of both models on one background.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OnBackground {
    /// Its name, one of [`BACKGROUNDS`].
    pub background: String,
    /// Means over the views.
    pub mean: BeforeAndAfter,
    /// Each view's figures.
    pub views: Vec<BeforeAndAfter>,
}

/// Figures of both models in one channel of the material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OnChannel {
    /// Which.
    pub channel: Channel,
    /// Means over the views.
    pub mean: BeforeAndAfter,
}

/// Figures of a bake and of the ray-cast bake of the same pair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The options with which `evaluate` gives the same figures on the first background.
    pub options: EvaluateOptions,
    /// How all were shaded.
    #[serde(default)]
    pub shading: Shading,
    /// The channels of whole materials; none under [`Shading::Lambert`], or where they were left out.
    #[serde(default)]
    pub channels: Vec<OnChannel>,
    /// One for each of [`BACKGROUNDS`], in their order.
    pub backgrounds: Vec<OnBackground>,
}
