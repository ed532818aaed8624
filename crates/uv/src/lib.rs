//! Texture coordinates that move.

pub mod adam;
pub mod best_texture;
pub mod contact;
pub mod descent;
pub mod distortion;
pub mod footprint;
pub mod inversion;
pub mod laplacian;
pub mod lbfgs;
pub mod metric;
pub mod normal_matrix;
pub mod optimise;
pub mod paper;
pub mod pyramid;
pub mod region;
pub mod residual;
pub mod runs;
pub mod shown;
pub mod signal;
pub mod variable_projection;
