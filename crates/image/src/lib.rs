//! Images of floats, from 8 bits and back.
//!
//! ```text
//! 8-bit image ─ quantise ─ FloatImage ─ mip ─ Pyramid ─ fetch (pyramid), its adjoint (slopes)
//!      maps ─────┘ (which maps there are, domains, encodings)
//! written_maps: from maps to a material's factors and textures
//! window: a part of a map with another number of texels
//! display, display_table: transfer curves
//! ```

pub mod display;
pub mod display_table;
mod float_image;
pub mod maps;
pub mod material_maps;
pub mod mip;
pub mod pyramid;
pub mod quantise;
pub mod reduced;
pub mod slopes;
pub mod window;
pub mod written_maps;

pub use float_image::{FloatImage, Texel};
pub use maps::{Domain, Encoding, MapKind, MapSet, MapSpec, MapValues};
