//! Triangles of a coarse mesh, chosen by how its pictures would differ from the detailed model's.
//!
//! `choose.rs` is the order; `target.rs` has the error, `pictures.rs` what a change would do to it.

mod at_once;
pub mod change;
pub mod choose;
pub mod collapse;
mod creases;
mod growth;
pub mod operations;
pub mod pictures;
pub mod polish;
pub mod raster;
mod shares;
pub mod start;
pub mod surface;
pub mod target;
pub mod triangle;
mod view;

pub use choose::{ChooseOptions, Chosen, LayerReport, StartReport, choose_triangles, least_triangles};
pub use start::{CoarseSurfaces, Start};
