//! Position: the point of the high-poly itself.
//!
//! Contract: in the common frame, so within −1 … 1 along the high-poly's longest side and within less along
//! the others: the centre of its box is the origin, and all axes have one scale.

use crate::sample::Sample;
use parbake_model::glam::Vec3;

/// The position at a sample.
pub fn position(sample: &Sample) -> Vec3 {
    sample.point
}
