//! Parbake makes a small 3D model look like a big one.
//!
//! It takes a detailed textured model (the high-poly) and a coarse one (the low-poly), renders
//! both, and moves the coarse one's vertices, texture coordinates and textures until the
//! pictures agree.
//!
//! ```no_run
//! use parbake::{BakeOptions, Limits, bake, read_model, write_glb};
//! # fn main() -> Result<(), parbake::BakeError> {
//! let limits = Limits::default();
//! let high = read_model("high.obj".as_ref(), &limits)?.model;
//! let low = read_model("low.obj".as_ref(), &limits)?.model;
//! let baked = bake(&high, &low, &BakeOptions::default(), &())?;
//! write_glb("baked.glb".as_ref(), &baked.model)?;
//! # Ok(())
//! # }
//! ```

mod bake;
mod budget;
mod comparison;
mod compress;
mod error;
pub mod evaluate;
mod geometry;
mod image;
mod image_options;
mod memory;
mod models;
mod normal_y;
mod options;
mod plan;
mod report;
pub mod studio;
mod threads;

pub use bake::{Baked, bake, bake_prepared, prepare_high_poly};
pub use comparison::{
    BACKGROUNDS, BeforeAndAfter, COMPARED_VIEWS, Comparison, OnBackground, compare_bake, compared_as,
};
pub use compress::compress;
pub use error::BakeError;
pub use evaluate::options::EvaluateOptions;
pub use evaluate::{Evaluation, ViewFigures, evaluate, evaluate_before};
pub use image::{BakedImage, ImageOptions, ImageReport, PictureUv, bake_image};
pub use memory::peak_memory;
pub use models::{demo_pair, laid_out, simplified, subdivided, wall_pair};
pub use normal_y::{NormalY, with_normal_y};
pub use options::{Backdrop, BakeOptions, Convention, Method, Parallax, Preset, ShapeMode, UvMode};
#[cfg(feature = "clap")]
pub use options::{heading, parse_texels};
pub use parbake_atlas::{LayoutCheck, ModelCheck, UvCheck, check_mesh, check_model};
pub use parbake_files::{
    FileError, Limits, Loaded, encode_png, read_image, read_model, write_atomically as write_file, write_glb,
    write_obj,
};
pub use parbake_fit::parallax_maps::ParallaxReport;
pub use parbake_model::{Image as Picture, Model};
pub use parbake_progress::{Estimate, Message, ProgressScope, Stage, StageTime, Watcher};
pub use parbake_shape::stage::ShapeReport;
pub use parbake_uv::convergence::Convergence;
pub use parbake_uv::moves::UvMoves;
pub use parbake_uv::surface::UvStageReport;
pub use parbake_views::PrepareError;
pub use parbake_views::high_poly::HighPoly;
pub use plan::Plan;
pub use report::{BakeReport, LossStep, Work};
pub use studio::{Shot, Studio, Subject};
pub use threads::{MOST_THREADS, join, with_threads};
