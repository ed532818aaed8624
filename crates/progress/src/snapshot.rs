//! The state of a running stage as something to look at.
//!
//! A stage asks [`Watcher::wants_snapshot`](crate::Watcher::wants_snapshot) first, since what it hands over takes time
//! to make. It knows a part; whoever called it makes a whole model of that (`showing.rs`).
//!
//! Contract: maps have at most [`MOST_TEXELS`] texels along a side.

use parbake_image::{FloatImage, MapSet};
use parbake_model::glam::Vec4;
use parbake_model::{Image, Mesh, Model, ParallaxMap};

/// Texels along a side of a snapshot's maps, at most: a page does not show more of them.
pub const MOST_TEXELS: usize = 512;

/// The state of a stage.
#[derive(Clone, Debug, PartialEq)]
pub enum Snapshot {
    /// A surface that moves, in the common frame.
    Surface {
        /// Vertices and texture coordinates as they are now.
        mesh: Mesh,
        /// The base colour that moves along, linear; none where the stage has none.
        color: Option<FloatImage<Vec4>>,
    },
    /// Maps of a surface that stays.
    Maps {
        /// As they are now, some or all; reduced to at most [`MOST_TEXELS`].
        maps: MapSet,
        /// How fetches of them shift, where that moves along.
        parallax: Option<PackedParallax>,
    },
    /// The model as it would be written now.
    Model(Model),
}

/// A parallax map as a file holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct PackedParallax {
    /// The map; its images are those below.
    pub map: ParallaxMap,
    /// What it and its cutout are stored in.
    pub images: Vec<Image>,
}

impl PackedParallax {
    /// Of a map that `pack` adds the images of to a list.
    pub fn new(pack: impl FnOnce(&mut Vec<Image>) -> ParallaxMap) -> Self {
        let mut images = Vec::new();
        Self { map: pack(&mut images), images }
    }
}
