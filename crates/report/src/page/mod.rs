//! What reports are drawn with: one page that needs no other file and no network, in light and
//! in dark; text, tables' numbers, charts and pictures for it.
//!
//! Contract: whatever comes in, names are escaped, no "NaN" or "inf" stands on a page, and the
//! same input gives the same bytes.

mod axes;
mod base64;
pub mod charts;
mod document;
mod picture;
pub mod text;
mod uv_layout;

pub use axes::Axes;
pub use base64::encode as base64;
pub use document::{document, document_with_script, section};
pub use picture::{Embedded, amplified_difference, embed, embed_rgb};
pub use uv_layout::{UvLayout, uv_layout};
