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

pub mod atlas;
pub mod canvas;
pub mod color;
pub mod conjugate_gradient;
pub mod cutout;
pub mod gutter;
pub mod membrane;
pub mod normal;
pub mod outliers;
pub mod parallax;
pub mod quantise;
pub mod reference;
pub mod samples;
pub mod schedule;
pub mod sighted;
pub mod start;
pub mod stencil;
pub mod territory;
pub mod thin_plate;
pub mod view_walk;
pub mod views;
pub mod watch;
