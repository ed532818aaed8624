//! Object-space normals: the high-poly's normals, with its normal map, in the model's own axes.
//!
//! Contract: unit vectors, +Y up as in glTF, on the side that the low-poly shows. They do not depend on the
//! low-poly's tangents, so no tangent basis has to be agreed on; they are wrong once the model deforms.

use crate::sample::Sample;
use parbake_model::glam::Vec3;

/// The normal at a sample.
pub fn object_normal(sample: &Sample) -> Vec3 {
    sample.mapped
}
