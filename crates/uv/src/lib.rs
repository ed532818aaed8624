//! Texture coordinates that move.

pub mod contact;
pub mod descent;
pub mod distortion;
pub mod inversion;
pub mod laplacian;
pub mod runs;
pub mod signal;
pub mod texture;
pub mod variable_projection;
