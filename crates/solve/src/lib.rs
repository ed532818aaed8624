//! The numerical solvers of the fits, on plain slices.
//!
//! ```text
//! grid                 a square of texels, summed by bands of rows in a fixed order
//! stencil              the nine-point normal matrix of a bilinear texture
//! free_lanes           which of a texel's four numbers may move
//! operator             what conjugate gradients ask of a matrix, and of the elements of its vectors
//! conjugate_gradient   the solver of all of them, boxed: solutions within [0, 1]
//! thin_plate           resistance to bending, by its gradient
//! adam                 first-order descent
//! random               numbers from counters
//! ```

pub mod adam;
pub mod boxed;
pub mod conjugate_gradient;
pub mod free_lanes;
pub mod grid;
pub mod operator;
pub mod random;
pub mod stencil;
pub mod thin_plate;
