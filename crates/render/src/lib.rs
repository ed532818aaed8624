//! Parbake's differentiable renderer, on the CPU.
//!
//! A pixel's way, one stage a file, each with its adjoint beside it:
//!
//! ```text
//! camera → raster → interpolate → frame ─┐
//!                        └→ uv → texture ┴→ shade → antialias → background → display → loss
//!                                  ↑ mip
//! ```
//!
//! Stages are pure functions over plain data: no hidden state, so that a GPU
//! backend can put a kernel in the place of each.

pub mod camera;
pub mod display;
pub mod frame;
pub mod interpolate;
pub mod mip;
pub mod raster;
pub mod scene;
pub mod shade;
pub mod texture;
