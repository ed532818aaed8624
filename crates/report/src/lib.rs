//! What people look at: reports as HTML pages, and films of models and UV layouts.
//!
//! ```text
//! page           what pages are drawn with: charts, pictures, text
//! html           the report of a bake
//! evaluation     the report of a comparison of two models
//! turntable      a film of two models that turn beside each other
//! uv_animation   a film of a texture layout on its way
//! ```

mod evaluation;
mod html;
mod lod;
pub mod page;
mod turntable;
mod uv_animation;

pub use evaluation::evaluation_report;
pub use html::{flags, html_report};
pub use lod::lod_report;
pub use turntable::{FilmFormat, TurntableOptions, turntable, write_turntable};
pub use uv_animation::{UvAnimationOptions, uv_animation};
