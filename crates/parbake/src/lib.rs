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

mod algorithm_one;
mod bake;
mod bridge;
mod check;
mod compress;
mod convergence;
mod depth;
mod error;
mod evaluate;
mod geometry;
mod html;
mod low;
mod memory;
mod message;
mod models;
mod options;
mod pair;
mod picture;
mod plan;
mod report;
mod shape;
mod studio;
mod threads;
mod turntable;
mod unfold;
mod uv_animation;
mod variants;

pub use bake::{Baked, bake};
pub use check::{LayoutCheck, ModelCheck, check_model};
pub use compress::compress;
pub use convergence::Convergence;
pub use depth::DepthReport;
pub use error::BakeError;
pub use evaluate::options::EvaluateOptions;
pub use evaluate::{Evaluation, ViewFigures, evaluate, evaluate_before};
pub use html::{html_report, variants_html};
pub use memory::peak_memory;
pub use message::{Message, Stage, Watcher};
pub use models::{demo_pair, simplified, subdivided, wall_pair};
pub use options::{Backdrop, BakeOptions, Convention, Method, Parallax, Preset, ShapeMode, UvMode};
pub use parbake_atlas::UvCheck;
pub use parbake_files::{
    FileError, Limits, Loaded, encode_png, read_image, read_model, write_atomically as write_file, write_glb,
    write_obj,
};
pub use parbake_model::{Image as Picture, Model};
pub use picture::{BakedImage, ImageOptions, ImageReport, PictureUv, bake_image};
pub use plan::Plan;
pub use report::{BakeReport, LossStep, StageTime, Work};
pub use shape::ShapeReport;
pub use studio::{Shot, Studio, Subject};
pub use threads::{join, with_threads};
pub use turntable::{FilmFormat, TurntableOptions, turntable, write_turntable};
pub use unfold::{UnfoldReport, laid_out};
pub use uv_animation::{UvAnimationOptions, UvMoves, uv_animation};
pub use variants::{ComparedVariants, VariantFigures, VariantsOptions, VariantsReport, compare_variants};
