//! Curvature: the high-poly's mean curvature at the scale of a radius ρ.
//!
//! In each tangent direction t a ray looks, from above the point p, at the surface beside it. If it meets it at q,
//! x farther along t, the curvature in that direction is how fast the normal turns, κ = (n(q) − n(p)) · t / x,
//! with the interpolated normals n of the high-poly, so that facets of a smooth surface do not show. On a sphere
//! that is 1/r exactly. The mean over directions is the mean curvature H = (κ₁ + κ₂) / 2 (Euler). What the map
//! holds is ρ H, each κ within ± 1/ρ: a hard edge, whose curvature has no bound, is a line as wide as ρ on
//! either side.
//!
//! Rays ask at tangent distances of ρ/2 to ρ, so that such lines end softly. They begin as high as they look
//! far, or lower in a crevice, where something stands above.
//!
//! Contract: positive where the surface is convex, 0 where it is flat. A ray that finds nothing down to ρ
//! below the tangent plane passed an edge: 1.

use crate::sample::{LIFT, Sample, normals_at};
use std::f32::consts::TAU;

/// Directions a texel at most: curvature is smooth in the direction.
pub const MOST_RAYS: usize = 32;

/// ρ H at a sample; `radius` is ρ in the common frame.
pub fn curvature(sample: &Sample, radius: f32) -> f32 {
    let Sample { surface, point, facet, smooth, .. } = *sample;
    let start = point + LIFT * facet;
    // Half-way up to whatever is above.
    let free = surface.cast(start, smooth, 2.0 * radius).map_or(radius, |hit| 0.5 * hit.distance);
    let (tangent, bitangent) = smooth.any_orthonormal_pair();
    let (mut sum, mut count) = (0.0f32, 0.0f32);
    for [u, v] in sample.rays.at_most(MOST_RAYS).points() {
        let reach = radius * (0.5 + 0.5 * v);
        let high = free.min(reach).max(LIFT);
        let (sin, cos) = (TAU * u).sin_cos();
        let ray = (tangent * cos + bitangent * sin) * reach - smooth * high;
        let length = ray.length();
        let longest = length * (high + radius) / high;
        let found = surface.cast(start + smooth * high, ray, longest.min(4.0 * radius));
        sum += match found {
            None => 1.0,
            Some(hit) => {
                let along = (hit.distance / length * reach).max(LIFT);
                let (_, normal) = normals_at(sample.mesh, &hit, -ray);
                ((normal - smooth).dot(tangent * cos + bitangent * sin) * radius / along).clamp(-1.0, 1.0)
            }
        };
        count += 1.0;
    }
    sum / count.max(1.0)
}
