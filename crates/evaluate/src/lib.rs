//! Compares models by pictures, as people see them.
//!
//! ```text
//! options, conventions ─ renderer ─┬─ figures ── what is seen: PSNR, MS-SSIM, FLIP ─┬─ evaluate
//!                                  ├─ few_views ─ one figure, to choose between models
//!                                  ├─ channels ─ the same for each map ─────────────┘
//!                                  └─ screen_size ─┬ up to which size two models look the same
//!                                                  └ differences ── where on its surface a copy looks different
//! ```
//!
//! Contract: figures depend on the models and the options only, not on how a model was made.

pub mod channels;
pub mod conventions;
pub mod differences;
mod error;
pub mod evaluate;
pub mod few_views;
pub mod figures;
pub mod options;
pub mod renderer;
pub mod screen_size;

pub use error::EvaluateError;
