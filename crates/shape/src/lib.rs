//! Vertices that move until silhouettes and pictures agree, on a mesh that stays sane.
//!
//! ```text
//! points            vertices that share a position move as one; along the normal or freely
//! triangle_quality  what keeps triangles from turning over, shrinking to nothing or spiking
//! laplacian         the smoothness term of earlier work, for comparison
//! normals           vertex normals that turn with the faces around them
//! seen              what the high-poly looks like from the views that vertices follow, and from others
//! outline           how far outlines are apart there
//! views             what rendered views say: loss, gradients
//! moving_points     points that follow them by Adam, while triangles keep their quality
//! walls             thin walls whose sides crossed
//! uncross           pulls them apart before anything else moves
//! provisional       a texture that follows them, and is thrown away
//! joint             the fit: vertices and a provisional texture, against rendered views
//! stage             the stage of a bake: small textures and views, the fit, what moved
//! paper             the paper's optimiser: textures, parallax and displacement from nothing
//! paper_joint_fit   its stage of a bake
//! ```

pub mod joint;
pub mod laplacian;
pub mod moving_points;
pub mod normals;
pub mod outline;
pub mod paper;
pub mod paper_joint_fit;
pub mod points;
pub mod provisional;
pub mod seen;
pub mod stage;
pub mod triangle_quality;
pub mod uncross;
pub mod views;
pub mod walls;

pub use joint::{ShapeOptions, Shaped, fit_shape};
pub use points::Motion;
