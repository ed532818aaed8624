//! The fit: which textures make the low-poly look like the high-poly.
//!
//! Geometry and texture coordinates stand still here, so a view's samples never
//! change: where each pixel falls on the texture and how the light meets it there
//! is worked out once, and every iteration only re-reads that list.
//!
//! ```text
//! views → reference ─┐
//!                    ├→ samples → color ⇄ normal → gutter → quantise
//! start (projection) ┘              │        │
//!                                   └ stencil, conjugate_gradient
//! ```
//!
//! With maps of depth, between views and samples: `view_walk` (a view's pixels) → `cutout` (what
//! is left out) → `sighted` (what is left) → `parallax` (where coordinates shift) → `territory`
//! (shifts stay in their chart).
//!
//! `schedule` walks that way; `watch` is how it reports and is stopped.

pub mod backend;
pub mod cutout;
pub mod membrane;
pub mod outliers;
pub mod parallax;
pub mod parallax_maps;
pub mod problem;
pub mod schedule;
pub mod step;
pub mod territory;
