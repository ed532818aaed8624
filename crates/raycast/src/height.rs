//! Height: how far the high-poly lies from the low-poly along the texel's ray.
//!
//! h = (q − p) · d with p on the low-poly, q what it found on the high-poly, and d the unit direction of the
//! ray, outwards. Along rays that is their signed length; where the closest point was taken, its share along
//! the normal.
//!
//! Contract: in the common frame; positive where the high-poly lies outside of the low-poly.

use crate::sample::Sample;

/// The height at a sample.
pub fn height(sample: &Sample) -> f32 {
    (sample.point - sample.low).dot(sample.direction)
}
