//! Texture coordinates that move to where they show most, and stay sound on the way.
//!
//! ```text
//! signal                              what the surface shall show
//! footprint, pyramid                  where that falls, on which mip level
//! normal_matrix, normal_equations,
//! least_squares_texture, rounding     the best texture for given coordinates, and in bytes
//! residual, trilinear_error           what it leaves: as minimised, and as seen
//! distortion, metric                  energies of triangles; the signal's structure tensors
//! contact, inversion, region          what keeps a layout bijective
//! laplacian, curvature,
//! gauss_seidel, stiffness             how a step is scaled
//! lbfgs, descent                      feasible descent
//! variable_projection, optimise       the default method
//! paper                               the paper's method
//! surface, picture                    the UV stages of a bake: of models, and of pictures on planes
//! mode, moves, convergence            what is asked for, and what became of it
//! ```

pub mod contact;
pub mod convergence;
pub mod curvature;
pub mod descent;
pub mod distortion;
pub mod footprint;
pub mod gauss_seidel;
pub mod inversion;
pub mod laplacian;
pub mod lbfgs;
pub mod least_squares_texture;
pub mod metric;
pub mod mode;
pub mod moves;
pub(crate) mod normal_equations;
pub mod normal_matrix;
pub mod optimise;
pub mod paper;
pub mod parameterized;
pub mod picture;
pub mod pyramid;
pub mod region;
pub mod residual;
pub(crate) mod rounding;
pub mod signal;
pub mod stiffness;
pub mod surface;
pub mod triangle_batches;
pub mod trilinear_error;
pub mod variable_projection;
