//! Texture layouts: what one is, whether it is sound, and how to make one.
//!
//! ```text
//! layout      triangles as they lie in the texture
//! predicates  orientation and overlap, exactly
//! check       the proof that a layout is sound, and how good it is
//! model_check the same for all textures of a model
//! pack        charts into the square
//! unwrap      a new layout for any mesh
//! repair      a sound layout from a delivered one
//! mend        its faults mended where they are
//! sharing     texels that several parts share, in words
//! own_squares parts that show one value each, moved to a few texels of their own
//! blocks      several textures in one, by rectangles that are moved
//! tiles       charts of repeated textures brought into one tile
//! tutte       an embedding of each piece in a circle or square
//! ```

pub mod blocks;
pub mod check;
mod conflicts;
pub mod error;
pub mod layout;
pub mod model_check;
pub mod own_squares;
pub mod pack;
pub mod predicates;
pub mod repair;
pub mod sharing;
pub mod tiles;
pub mod tutte;
pub mod unwrap;

pub use check::{UvCheck, check};
pub use error::AtlasError;
pub use layout::{BoundaryEdge, Layout};
pub use model_check::{LayoutCheck, ModelCheck, check_mesh, check_model};
pub use own_squares::with_own_squares;
pub use pack::{ChartScale, PackOptions, pack};
pub use repair::{RepairOptions, repair};
pub use sharing::{Sharing, sharing};
pub use tiles::in_one_tile;
pub use tutte::{TutteBoundary, TutteOptions, TutteWeights, tutte};
pub use unwrap::{UnwrapOptions, UnwrappedMesh, unwrap};
