//! Which maps make the low-poly look like the high-poly.
//!
//! Geometry and texture coordinates stand still here, so a view's samples never change: where each
//! pixel falls on the texture and how the light meets it there is worked out once
//! (`parbake_views`), and every iteration only reads that list again.
//!
//! ```text
//! samples ─ schedule ─ step ─ assemble ─ solve        the maps, in turns
//!              │        └ membrane, robust_loss       unseen texels, robust loss
//! material samples ─ separate_maps ┘                  maps that do not depend on each other
//!                         └ normal_spread             roughness for what normals do within a texel
//! layers ─ cutout                                     where the low-poly is left out
//! view samples ─ parallax ─ view_gradient ─ texels    how coordinates shift
//!              └ chart_ownership                      shifts stay within their chart
//! backend                                             the coarse operations, for a GPU to replace
//! ```
//!
//! `parallax_maps` is the stage of a bake that makes cutout and parallax map; `baked_materials` turns fitted maps into the
//! low-poly's materials.

pub(crate) mod assemble;
pub mod backend;
pub mod baked_materials;
pub mod chart_ownership;
pub mod cutout;
pub mod material_problem;
pub mod membrane;
pub(crate) mod normal_spread;
pub mod parallax;
pub mod parallax_maps;
pub mod problem;
pub mod robust_loss;
pub mod schedule;
pub mod separate_maps;
pub mod step;
pub mod texels;
pub mod view_gradient;
