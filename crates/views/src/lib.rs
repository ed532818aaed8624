//! The two models of a bake made ready, and what the high-poly shows from all around.
//!
//! ```text
//! high-poly ─ frame ─ high_poly ─┬─ projection ─────────── projected maps
//!                                └─ pool ─ reference ─┐
//! low-poly ─ low_poly ─ chart_labels                  ├─ view_walk ─ sighted ─ samples
//!               └─────────────────────────────────────┘
//! ```
//!
//! Everything here is made once and read by the fits of vertices, texture coordinates and maps.

pub mod alpha_in_effect;
pub mod alpha_layers;
pub mod backs;
pub mod chart_labels;
mod coat_normals;
mod contradicting_normals;
mod error;
pub mod extension_maps;
pub mod extension_values;
pub mod frame;
pub mod gutter;
pub mod hidden;
pub mod high_poly;
pub mod importance;
pub mod joint_extensions;
mod layer_factors;
pub mod lost;
pub mod low_poly;
pub mod material_sample;
pub mod material_sampler;
pub mod named;
mod packing;
pub mod pool;
pub mod projection;
pub mod reference;
pub mod samples;
pub mod sides;
pub mod unlit;
pub mod view_sample;
pub mod view_sampler;

pub use error::PrepareError;
