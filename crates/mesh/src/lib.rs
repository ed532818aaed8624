//! Parbake's geometry: what is done to meshes before, around and after rendering.
//!
//! ```text
//! normals → facing → tangents   what a surface needs before it can be shaded
//! charts, texel_map             which point of the surface a texel shows
//! projection                    where that point lies on the detailed model
//! simplify, subdivide, bisect   coarser and finer copies of a mesh
//! simplify_in_layout            a coarser copy that keeps its layout and attributes
//! corner_vertices               vertices as both tell them apart
//! own_normals                   a coarser copy's normals where its vertices lost them
//! deviation                     how far two surfaces are apart, for a choice between them
//! distance                      the same in full: Chamfer, Hausdorff, root mean square
//! topology                      pieces, holes, handles, and where a surface is none
//! visibility                    how much of a surface is seen from outside
//! material_uvs                  texture coordinates as materials read them
//! rig_parts, rig_transfer, rigs what moves by itself, and how a rig comes along
//! named_nodes, parts            nodes that a user names, parts that stay apart
//! weld, vertices, union_find    what these share
//! demo                          the built-in pairs of models
//! ```
//!
//! Contract, for every file: any mesh that keeps [`parbake_model::Mesh`]'s
//! contract is taken, however degenerate its triangles, non-manifold its edges or
//! many its charts; results do not depend on the number of threads.

pub mod bisect;
mod bvh;
pub mod charts;
mod corner_vertices;
pub mod creases;
pub mod demo;
pub mod deviation;
pub mod distance;
pub mod facing;
pub mod material_uvs;
pub mod named_nodes;
pub mod normals;
mod own_normals;
pub mod parts;
pub mod projection;
pub mod rig_parts;
pub mod rig_transfer;
pub mod rigs;
pub mod simplify;
pub mod simplify_in_layout;
pub mod subdivide;
pub mod tangents;
pub mod texel_map;
pub mod topology;
pub mod union_find;
pub mod vertices;
pub mod visibility;
pub mod weld;
mod wide_nodes;

pub use bisect::{Bisected, Piece};
pub use charts::{charts, texel_charts};
pub use demo::{demo_low, demo_model, wall_low, wall_model};
pub use distance::{DistanceOptions, SurfaceDistance, surface_distance};
pub use facing::{area_facing_back, face_outwards};
pub use material_uvs::material_uvs;
pub use normals::{ensure_normals, smooth_normals};
pub use projection::{HighSurface, SurfacePoint};
pub use rig_parts::rig_parts;
pub use rig_transfer::transfer_rig;
pub use simplify::{SimplifyOptions, simplify};
pub use simplify_in_layout::{Collapses, Seams, simplify_in_layout};
pub use subdivide::subdivide;
pub use tangents::compute_tangents;
pub use texel_map::{TexelMap, texel_map};
pub use topology::{Component, Topology, topology};
pub use visibility::visibilities;
pub use weld::weld_by_position;
