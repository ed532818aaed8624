//! Classical baking: every texel of the low-poly asks the high-poly along a ray, several times over its area,
//! what it shows there and what its shape is like.
//!
//! ```text
//! low-poly ─ texels' samples ─ projector (views) ─┬ material maps
//!            (cast.rs)                            └ sample.rs ─┬ occlusion, bent normal   (ambient.rs)
//!                                                              ├ thickness, curvature     (rays)
//!                                                              └ position, height, object normal
//!                                                  encode.rs: numbers of 16 bits, and their range
//! ```
//!
//! One file a map, each with its definition. Rays of hemispheres are in `rays.rs`.
//!
//! Contract: maps are in the common frame until they are encoded; results do not depend on the number of
//! threads; every texel of the square has a value, those off the surface that of the nearest chart.

pub mod ambient;
pub mod cast;
pub mod curvature;
pub mod encode;
pub mod height;
pub mod map;
pub mod object_normal;
pub mod position;
pub mod rays;
pub mod sample;
pub mod thickness;

pub use cast::{CastMaps, CastOptions, cast_maps};
pub use encode::{Encoded, encode};
pub use map::GeometryMap;
