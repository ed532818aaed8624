//! Which side of the high-poly a pixel of the low-poly shows: its own, or another one, as where a coarse wall
//! reaches over a fine one's rim and the inside looks out behind it, or where a wire in front of a wall has no triangle in
//! the low-poly.
//!
//! Contract: all is in the common frame. Answers depend on the arguments alone.

use crate::high_poly::HighPoly;
use parbake_model::glam::Vec3;

/// Least distance that counts as far, in the common frame: less may be rounding, even if the reach is 0.
const LEAST_FAR: f32 = 1e-4;

/// Whether a point of the low-poly (its position, and the normal of its triangle, of any length) stands for
/// another side than that of the high-poly's triangle `seen` in its place, `behind` it (along the line of sight, in the
/// frame's unit, negative in front; none where a parallax map fetches what lies there). That is so where the two face away
/// from each other, or where what is seen lies farther behind or in front than a projection looks, and the high-poly has,
/// within that reach, a surface that faces as the low-poly does; else what is seen is all there is.
pub fn is_of_another_side(
    high: &HighPoly,
    [position, face_normal]: [Vec3; 2],
    seen: usize,
    behind: Option<f32>,
) -> bool {
    let reach = high.conventions.max_distance;
    let is_opposite = high.scene.mesh().area_normal(seen).dot(face_normal) < 0.0;
    (is_opposite || behind.is_some_and(|behind| behind.abs() > reach.max(LEAST_FAR)))
        && high.surface.closest_facing(position, face_normal, reach).is_some()
}
