//! Vertices that move until silhouettes and pictures agree, on a mesh that stays sane.
//!
//! ```text
//! points        vertices that share a position move as one; along the normal or freely
//! guard         what keeps triangles from turning over, shrinking to nothing or spiking
//! normals       vertex normals that turn with the faces around them
//! joint         the fit: vertices and a provisional texture, against rendered views
//! ```

pub mod guard;
pub mod joint;
pub mod normals;
pub mod points;

pub use joint::{ShapeOptions, Shaped, fit_shape};
pub use points::Motion;
