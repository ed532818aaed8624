//! Vertices that move until silhouettes and pictures agree, on a mesh that stays sane.
//!
//! ```text
//! points        vertices that share a position move as one; along the normal or freely
//! guard         what keeps triangles from turning over, shrinking to nothing or spiking
//! laplacian     the smoothness term of earlier work, for comparison
//! normals       vertex normals that turn with the faces around them
//! views         what rendered views say: loss, gradients
//! joint         the fit: vertices and a provisional texture, against rendered views
//! paper         the paper's optimiser: textures, parallax and displacement from nothing
//! ```

pub mod guard;
pub mod joint;
pub mod laplacian;
pub mod normals;
pub mod paper;
pub mod points;
pub mod views;

pub use joint::{ShapeOptions, Shaped, fit_shape};
pub use points::Motion;
