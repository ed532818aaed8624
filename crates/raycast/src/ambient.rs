//! Ambient occlusion and bent normals: how much of the sky a point sees, and where most of it is.
//!
//! Occlusion is A = (1/π) ∫ V(ω) (n·ω) dω over the hemisphere about the high-poly's smooth normal n (Zhukov,
//! Iones and Kronin 1998; Landis 2002), where V is 1 if a ray along ω leaves or goes farther than the
//! occlusion distance, else 0. The bent normal is the mean of the open directions, ∫ V ω (n·ω) dω, of unit
//! length. Both come of the same rays, so they agree.
//!
//! Contract: A is within 0 (closed) … 1 (open). Both sides of a triangle block. Opacity has no say: what is
//! cut out or blended blocks as well.

use crate::sample::Sample;
use parbake_model::glam::{Vec3, Vec4};
use parbake_views::projection::in_frame;

/// Weight of the normal itself in the sum of open directions, so that there is one where nothing is open.
const OWN: f32 = 1e-3;

/// In xyz the sum of open directions over all, in the low-poly's tangent frame; in w the open share. Rays end
/// after `distance` in the common frame.
pub fn ambient(sample: &Sample, distance: f32) -> Vec4 {
    let (mut open, mut count) = (0.0f32, 0.0f32);
    let mut sum = Vec3::ZERO;
    for direction in sample.rays.directions(sample.smooth, sample.facet) {
        count += 1.0;
        if !sample.surface.blocks(sample.origin, direction, distance) {
            open += 1.0;
            sum += direction;
        }
    }
    let bent = in_frame(&sample.frame, sum / count.max(1.0) + OWN * sample.smooth);
    bent.extend(open / count.max(1.0))
}
