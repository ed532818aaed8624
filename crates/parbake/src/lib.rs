//! Parbake bakes the appearance of a high-poly model onto a low-poly one by differentiable rendering.
//!
//! It renders both models from hundreds of views and solves for the vertices, texture coordinates and
//! maps of the low-poly that make the pictures agree. This crate is options and order only; the
//! algorithms live in the crates that it calls (`ARCHITECTURE.md`).
//!
//! ```no_run
//! use parbake::{BakeError, BakeOptions, Limits, bake, read_model, write_glb};
//!
//! fn main() -> Result<(), BakeError> {
//!     let limits = Limits::default();
//!     let high = read_model("high.obj".as_ref(), &limits)?.model;
//!     let low = read_model("low.obj".as_ref(), &limits)?.model;
//!     let baked = bake(&high, &low, &BakeOptions::default(), &())?;
//!     write_glb("baked.glb".as_ref(), &baked.model)?;
//!     Ok(())
//! }
//! ```
//!
//! * **Options** are plain structs with a documented default for each field: [`BakeOptions`] for
//!   [`bake`] and [`compress`], [`RaycastOptions`] for [`raycast()`], [`ImageOptions`] for [`bake_image`], [`EvaluateOptions`] for
//!   [`evaluate()`]. They are the same for library, command line and options file.
//! * **Several low-polys** of one high-poly: [`prepare_high_poly`] once, then [`bake_prepared`] for each.
//! * **Warnings and progress** come as [`Message`]s to the [`Watcher`] that is the last argument, which
//!   may also stop the run; `&()` watches nothing. Warnings of readers are in [`Loaded`].
//! * **Errors** are [`BakeError`]s: one sentence with the file, the place or the option, and what to do.
//! * **Threads**: work runs on rayon's current pool ([`with_threads`] makes one); the result does not
//!   depend on their number.

mod bake;
mod bake_to_triangles;
mod baseline;
mod budget;
mod coarse_copy;
mod comparison;
mod comparison_figures;
mod compress;
mod copies;
mod error;
mod fallback;
mod geometry;
mod idle_options;
mod image;
mod image_options;
mod kept;
pub mod lod;
mod low_poly;
mod map_images;
mod memory;
mod models;
mod options;
mod order;
mod plan;
mod raycast;
mod raycast_options;
mod report;
mod shortlist;
mod snapshots;
mod stats;
mod texels;
mod textures;
mod threads;
mod used_values;
mod warnings;
mod work;

pub use bake::{Baked, bake, bake_prepared, prepare_high_poly};
pub use bake_to_triangles::bake_to_triangles;
pub use budget::check_budget;
pub use coarse_copy::{simplified, simplified_by_pictures};
pub use comparison::{
    BACKGROUNDS, BeforeAndAfter, Comparison, Detail, OnBackground, OnChannel, compare_bake, compared_as,
};
pub use compress::{compress, has_colour_alone};
pub use error::BakeError;
pub use fallback::FallbackReport;
pub use idle_options::{IDLE_IN_COMPRESS, QUALITY_OF_LOSSLESS, idle_options};
pub use image::{BakedImage, ImageOptions, ImageReport, PictureUv, bake_image};
pub use lod::options::LodOptions;
pub use lod::search::Verdict;
pub use lod::target::{TargetReport, Trial, TrialMap};
pub use lod::{Candidate, Level, LevelReport, Way, make_levels};
pub use low_poly::low_poly;
pub use memory::peak_memory;
pub use models::{demo_pair, laid_out, subdivided, wall_pair, with_tangents};
#[cfg(feature = "clap")]
pub use options::heading;
pub use options::{
    BakeOptions, Convention, Method, Parallax, Preset, Shading, ShapeMode, SilhouetteBackground, UvMode,
};
pub use parbake_atlas::{LayoutCheck, ModelCheck, UvCheck, check_mesh, check_model};
pub use parbake_evaluate::EvaluateError;
pub use parbake_evaluate::channels::{Channel, ChannelFigures};
pub use parbake_evaluate::evaluate::{Evaluation, evaluate, evaluate_on};
pub use parbake_evaluate::figures::{
    Metrics, ViewFigures, compare as compare_pictures, mean as mean_figures,
};
pub use parbake_evaluate::options::EvaluateOptions;
pub use parbake_evaluate::renderer::{PlacedModel, RenderedView, Renderer, tonemapped};
pub use parbake_evaluate::screen_size::AtSize;
pub use parbake_files::{
    Contents, DEFAULT_TEXTURE_QUALITY, FileError, Limits, Loaded, MeshCompression, NormalY, PictureFiles,
    PictureFormat, StoredPicture, TextureFormat, Warning, WarningKind, WriteOptions, Written, WrittenMesh,
    WrittenTexture, encode_png, named_files, read_image, read_model, read_model_with_pictures,
    read_painted_model, replaced_files, with_normal_y, write_atomically as write_file, write_glb,
    write_glb_keeping, write_glb_with, write_lod_glb, write_obj,
};
pub use parbake_fit::parallax_maps::ParallaxReport;
pub use parbake_mesh::distance::{OneWay, SurfaceDistance};
pub use parbake_mesh::named_nodes::NodeError;
pub use parbake_mesh::parts::{PartReport, PartsError};
pub use parbake_mesh::topology::{Component, Topology};
pub use parbake_metric::psnr_from_mse;
pub use parbake_model::{Image as Picture, Model};
pub use parbake_progress::{Estimate, Message, ProgressScope, Snapshot, Stage, StageTime, Watcher};
pub use parbake_raycast::{Encoded, GeometryMap};
pub use parbake_shape::stage::ShapeReport;
pub use parbake_simplify::{LayerReport, Start, StartReport};
pub use parbake_uv::convergence::Convergence;
pub use parbake_uv::moves::UvMoves;
pub use parbake_uv::surface::UvStageReport;
pub use parbake_views::PrepareError;
pub use parbake_views::high_poly::HighPoly;
pub use parbake_views::importance::{Importance, ImportanceError, importances};
pub use plan::Plan;
pub use raycast::{
    Match, RayNormals, Raycast, RaycastOptions, RaycastReport, RaycastUv, ShapeMapReport, ShapePicture,
    raycast,
};
pub use report::{BakeReport, LossStep};
pub use stats::{
    FileStats, LayoutStats, ModelStats, StatsOptions, TexelDensity, TextureStats, model_distance, model_stats,
};
pub use texels::parse_texels;
pub use threads::{MOST_THREADS, join, with_threads};
pub use used_values::UsedValues;
pub use work::Work;

/// The README's example, compiled as it is pasted.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
pub struct Readme;
