//! Texture layouts: what one is, whether it is sound, and how to make one.
//!
//! ```text
//! layout      triangles as they lie in the texture
//! ```

pub mod layout;

pub use layout::{BoundaryEdge, Layout};
