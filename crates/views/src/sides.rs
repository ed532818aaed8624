//! Which side of the high-poly a pixel of the low-poly shows: its own, or another one, as where a coarse wall
//! reaches over a fine one's rim and the inside looks out behind it.
//!
//! Contract: all is in the common frame. Answers depend on the arguments alone.

use crate::high_poly::HighPoly;
use parbake_model::Mesh;
use parbake_model::glam::Vec3;

/// The high-poly has a wall where both of its sides lie within this part of the projection's reach.
const THIN: f32 = 0.5;
/// Farther than any two points of the common frame's box are apart.
const OUTSIDE: f32 = 4.0;

/// Whether a point of the low-poly (its position, and the normal of its triangle, of any length) stands for
/// another side than that of the high-poly's triangle which is seen in its place, `behind` it (in the
/// frame's unit). That is so where the two face away from each other, or where what is seen lies far behind,
/// and the high-poly has, within reach, a surface that faces as the low-poly does; else what is seen is all
/// there is.
pub fn is_of_another_side(
    high: &HighPoly,
    [position, face_normal]: [Vec3; 2],
    seen: usize,
    behind: Option<f32>,
) -> bool {
    let reach = high.conventions.max_distance;
    let is_opposite = high.scene.mesh().area_normal(seen).dot(face_normal) < 0.0;
    (is_opposite || behind.is_some_and(|behind| behind > reach))
        && high.surface.closest_facing(position, face_normal, reach).is_some()
}

/// A low-poly's triangles that stand for thin walls of the high-poly, whose sides are told apart by rays.
#[derive(Clone)]
pub struct Walls<'a> {
    high: &'a HighPoly,
    /// F flags.
    is_wall: Vec<bool>,
}

impl<'a> Walls<'a> {
    /// Looks at some points of each of the low-poly's triangles. None where the high-poly has no thin wall,
    /// or the surface is a single sheet: that has but one side.
    pub fn new(high: &'a HighPoly, low: &Mesh) -> Option<Self> {
        let reach = THIN * high.conventions.max_distance;
        let is_wall: Vec<bool> = (0..low.triangles.len())
            .map(|t| {
                let (corners, normal) = (low.corners(t), low.area_normal(t));
                let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
                let near = |p: Vec3, direction| high.surface.closest_facing(p, direction, reach).is_some();
                let mut points = corners.iter().map(|c| c.lerp(middle, 0.2)).chain([middle]);
                points.any(|p| near(p, normal) && near(p, -normal))
            })
            .collect();
        is_wall.contains(&true).then_some(Self { high, is_wall })
    }

    /// Whether the pixel that shows this point of this triangle, seen along `to_viewer`, shows another side of
    /// the high-poly.
    pub fn shows_another_side(&self, triangle: usize, point: [Vec3; 2], to_viewer: Vec3) -> bool {
        let from = point[0] + to_viewer * OUTSIDE;
        self.is_wall[triangle]
            && (self.high.surface.cast(from, -to_viewer, 2.0 * OUTSIDE)).is_some_and(|hit| {
                is_of_another_side(self.high, point, hit.triangle as usize, Some(hit.distance - OUTSIDE))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::high_poly::{Conventions, ViewSet};
    use crate::low_poly::LowPoly;
    use crate::material_samples::tests::{conventions, tube};
    use crate::reference::Sampling;
    use crate::view_sampler::{UncoveredPixels, ViewSampler};
    use parbake_model::Model;

    /// Protects thin walls whose materials have colour alone: no pixel of the black inside asks for light,
    /// none of the white outside for black, though the coarse wall reaches over the fine one's rim.
    #[test]
    fn pixels_that_show_another_side_are_left_out() {
        let plain = Conventions { whole_material: Some(false), ..conventions() };
        let high = HighPoly::new(&tube(96), plain).expect("it has an extent");
        let low = LowPoly::new(&tube(12), &high.frame, 32).expect("it has coordinates");
        let sampling = Sampling { size: 48, filter: 0.0, samples: 1 };
        let set = ViewSet { count: 24, seed: 1, jitter: true, sampling };
        let references = high.references(&set, &());
        let display = high.conventions.display;
        let sampler = ViewSampler::new(&low.placed, 48, &display, UncoveredPixels::Ignore);
        let wrong = |sampler: &ViewSampler| {
            let (mut wrong, mut all) = (0, 0);
            for reference in references.iter() {
                sampler.fragments(reference, |f| {
                    all += 1;
                    wrong += usize::from((f.target[0] < 100) == (f.uv.x < 0.5));
                });
            }
            (wrong, all)
        };
        let (before, _) = wrong(&sampler);
        let (after, all) = wrong(&sampler.with_walls(Walls::new(&high, &low.placed)));
        assert!(before > 20 && after == 0 && all > 4000, "{before}, {after} of {all}");
    }

    /// Protects the time of all other models: a single sheet, and what is thick, need no rays.
    #[test]
    fn what_has_no_thin_wall_is_not_looked_at() {
        let mut sheet: Model = tube(24);
        sheet.mesh.triangles.truncate(48);
        sheet.mesh.triangle_materials.truncate(48);
        let high = HighPoly::new(&sheet, conventions()).expect("it has an extent");
        let low = LowPoly::new(&sheet, &high.frame, 32).expect("it has coordinates");
        assert!(Walls::new(&high, &low.placed).is_none());
    }
}
