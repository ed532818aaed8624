//! Parbake's differentiable renderer, on the CPU.
//!
//! A pixel's way, one stage a file, each with its adjoint beside it:
//!
//! ```text
//! camera → raster → interpolate → frame ─┐
//!                        └→ uv → texture ┴→ shade → antialias → background → display → loss
//!                          parallax ↑ mip              ↑ edges
//! ```
//!
//! `pipeline.rs` goes the whole way and back; `patch.rs` is its inner loop, from a
//! triangle's samples to light. `slopes.rs` and `scatter.rs` are the two halves of the
//! texture's adjoint: towards the coordinates and towards the texels. `surface.rs` is
//! what goes in. `shade.rs` is what a BRDF is, and Lambert's; `metallic_roughness.rs` is glTF's, under the
//! light of `lighting.rs`, with the table of `split_sum.rs` and the derivatives of `real.rs`; `material_layers.rs` adds what extensions show. `scene.rs`
//! renders whole models, forward only (`scene_material.rs` with all of their materials, drawn by `scene_stage.rs`), with the textures of
//! `scene_textures.rs` and the extensions of `scene_layers.rs`, unpacked by `scene_pyramids.rs`, read as `interpretation.rs` says; meshes of many small
//! triangles by `raster_clusters.rs`. `turning_normals.rs` widens highlights as three.js does; `behind.rs` bends and blurs what shows through glass. `cutout.rs` is where a surface is not there, seen from the wrong side.
//! `parallax_variants` puts other ways to shift coordinates behind one interface.
//! `parallax_images.rs` and `cutout_images.rs` take maps to 8-bit images and back, by
//! `channels.rs`.
//!
//! Stages are pure functions over plain data: no hidden state, so that a GPU
//! backend can put a kernel in the place of each.

pub mod antialias;
pub mod background;
pub mod behind;
mod boxes_on_screen;
pub mod camera;
mod channels;
pub mod cutout;
mod cutout_images;
pub mod directions;
pub mod edges;
pub mod frame;
pub mod gradient_pixels;
pub mod interpolate;
pub mod interpretation;
pub mod lighting;
pub mod loss;
pub mod material_layers;
pub mod metallic_roughness;
pub mod on_screen;
pub mod parallax;
mod parallax_images;
pub mod parallax_variants;
pub mod patch;
mod picture;
pub mod pipeline;
pub mod raster;
pub mod raster_clusters;
mod real;
pub mod scatter;
pub mod scene;
mod scene_layers;
pub mod scene_material;
mod scene_pyramids;
mod scene_stage;
mod scene_textures;
pub mod shade;
pub mod spherical_harmonics;
mod split_sum;
pub mod surface;
mod turning_normals;
