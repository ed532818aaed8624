//! Thickness: how deep the high-poly is behind its surface.
//!
//! T = (1/π) ∫ d(ω) (−n·ω)² dω over the hemisphere below the surface, where d is how far a ray along ω gets
//! before it meets the surface from within: the mean depth along −n that cosine-weighted rays reach. A slab
//! of thickness t has T = t, whatever the direction of rays; a ball of radius r has T = r.
//!
//! Contract: in the common frame. Rays that meet nothing (there is a hole, or no inside) are left out; where
//! all of them do, T is 0, as of a sheet.

use crate::sample::{LIFT, Sample};

/// The mean depth at a sample.
pub fn thickness(sample: &Sample) -> f32 {
    let origin = sample.point - LIFT * sample.facet;
    let (mut sum, mut count) = (0.0f32, 0.0f32);
    for direction in sample.rays.directions(-sample.smooth, -sample.facet) {
        if let Some(hit) = sample.surface.cast(origin, direction, f32::INFINITY) {
            sum += hit.distance * -sample.smooth.dot(direction).min(0.0);
            count += 1.0;
        }
    }
    if count > 0.0 { sum / count } else { 0.0 }
}
