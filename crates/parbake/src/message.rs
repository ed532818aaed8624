//! Messages of a run, for whoever draws them.

use serde::{Deserialize, Serialize};

/// What a run is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// Reading and decoding files.
    Read,
    /// Normals, tangents, charts, the search structure of the high-poly.
    Prepare,
    /// Moving vertices.
    Shape,
    /// Mending, unwrapping and moving texture coordinates.
    Unfold,
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
            Stage::Shape => "moving vertices",
            Stage::Unfold => "moving texture coordinates",
            Stage::Reference => "rendering the high-poly",
            Stage::Start => "projecting",
            Stage::Sampling => "finding samples",
            Stage::Cutout => "cutting silhouettes",
            Stage::Parallax => "fitting parallax",
            Stage::Solve => "solving for textures",
            Stage::Evaluate => "comparing pictures",
            Stage::Film => "filming",
            Stage::Write => "writing files",
        }
    }
}

/// One message.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// `done` of `total` steps of a stage are finished.
    Progress {
        /// Which stage.
        stage: Stage,
        /// Steps finished.
        done: usize,
        /// Steps in all.
        total: usize,
    },
    /// Something that the user should know and that stops nothing.
    Warning(String),
}

/// Receives messages and may stop a run; called from several threads at once.
pub trait Watcher: Sync {
    /// Takes a message.
    fn message(&self, message: Message) {
        let _ = message;
    }

    /// True once the run shall end with the best state so far.
    fn stopped(&self) -> bool {
        false
    }

    /// Seconds until [`Watcher::stopped`] will be true, where that is known: long
    /// stages then leave time to those after them.
    fn seconds_left(&self) -> Option<f64> {
        None
    }
}

/// Nobody watches.
impl Watcher for () {}
