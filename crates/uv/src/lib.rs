//! Texture coordinates that move.

pub mod best_texture;
pub mod contact;
pub mod descent;
pub mod distortion;
pub mod footprint;
pub mod inversion;
pub mod laplacian;
pub mod metric;
pub mod normal_matrix;
pub mod optimise;
pub mod pyramid;
pub mod region;
pub mod residual;
pub mod runs;
pub mod shown;
pub mod signal;
pub mod texture;
pub mod variable_projection;
