//! Thin walls whose two sides crossed: where one looks at the back of a triangle, and what should have covered it
//! lies just behind.
//!
//! A provisional texture learns the colour of whatever it is seen as, so pictures do not tell that a wall was turned
//! inside out. The bake of a whole material does: no texel takes its maps from a surface that its own side never shows, so
//! the dirty underside of a clean seat would show through it.
//!
//! Contract: all is in the common frame. What is seen through the open side of a sheet is no crossing, for nothing of
//! the same wall lies behind it. Answers depend on the arguments alone, not on the number of threads.

use glam::Vec3;
use parbake_render::camera::Camera;
use parbake_render::interpolate::{barycentrics, interpolate};
use parbake_render::raster::{NOTHING, ScreenTriangles, Visibility, rasterise, rasterise_behind_some};
use rayon::prelude::*;

/// Sides of a wall are at most this far apart, in the common frame, in which a model is 2 long.
pub(crate) const THICKEST: f32 = 0.03;

/// What views see of crossings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Crossings {
    /// Pixels of all views at which the wrong side is seen.
    pub pixels: usize,
    /// Points of the triangles there, those in front and those behind; ascending.
    pub points: Vec<u32>,
}

/// Crossings of a mesh's points as `cameras` see them in pictures of `size`² pixels.
pub fn crossings(points: &[Vec3], triangles: &[[u32; 3]], cameras: &[Camera], size: usize) -> Crossings {
    let each: Vec<Crossings> =
        cameras.par_iter().map(|camera| seen_from(points, triangles, camera, size)).collect();
    let pixels = each.iter().map(|view| view.pixels).sum();
    let mut points: Vec<u32> = each.into_iter().flat_map(|view| view.points).collect();
    points.sort_unstable();
    points.dedup();
    Crossings { pixels, points }
}

fn seen_from(points: &[Vec3], triangles: &[[u32; 3]], camera: &Camera, size: usize) -> Crossings {
    let mut found = Crossings::default();
    for Crossing { triangles: [near, far], .. } in crossings_from(points, triangles, camera, size) {
        found.pixels += 1;
        found.points.extend([near, far].into_iter().flat_map(|triangle| triangles[triangle as usize]));
    }
    found
}

/// A pixel at which the wrong side of a wall is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Which pixel, row by row.
    pub pixel: usize,
    /// The triangle in front, whose back is seen, and the one behind it that should have covered it.
    pub triangles: [u32; 2],
    /// Barycentric weights of where the pixel's ray meets them.
    pub weights: [[f32; 3]; 2],
}

/// The pixels of a picture of `size`² pixels at which walls have crossed, row by row.
pub(crate) fn crossings_from(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    camera: &Camera,
    size: usize,
) -> Vec<Crossing> {
    let screen = ScreenTriangles::new(points, triangles, camera, size);
    let (mut front, mut behind) = (Visibility::default(), Visibility::default());
    rasterise(&screen, size, (0.0, 0.0), &mut front);
    let corners = |triangle: u32| triangles[triangle as usize].map(|point| points[point as usize]);
    let backs: Vec<bool> = (0..triangles.len() as u32).map(|t| is_back(corners(t), camera)).collect();
    let is_back = |triangle: u32| backs[triangle as usize];
    let shows_back: Vec<bool> = front.triangle.iter().map(|&t| t != NOTHING && is_back(t)).collect();
    if !shows_back.contains(&true) {
        return Vec::new();
    }
    rasterise_behind_some(&screen, size, &front, &shows_back, &mut behind);
    let crossing = |(pixel, (&near, &far)): (usize, (&u32, &u32))| {
        if !shows_back[pixel] || far == NOTHING || is_back(far) {
            return None;
        }
        let at = ((pixel % size) as f64 + 0.5, (pixel / size) as f64 + 0.5);
        let weights = [near, far]
            .map(|triangle| barycentrics(&screen.triangles[triangle as usize], at.0, at.1).weights);
        let [near_at, far_at]: [Vec3; 2] =
            [interpolate(corners(near), weights[0]), interpolate(corners(far), weights[1])];
        (near_at.distance(far_at) < THICKEST).then_some(Crossing { pixel, triangles: [near, far], weights })
    };
    front.triangle.iter().zip(&behind.triangle).enumerate().filter_map(crossing).collect()
}

/// Whether a camera looks at the back of a triangle.
pub(crate) fn is_back([a, b, c]: [Vec3; 3], camera: &Camera) -> bool {
    (b - a).cross(c - a).dot(camera.view_direction(a)) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_render::camera::Projection;

    /// A board of this thickness, closed but for its rims: the upper side looks up, the lower one down.
    fn board(thickness: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let corners = [(-0.8, -0.8), (0.8, -0.8), (0.8, 0.8), (-0.8, 0.8)];
        let side = |z: f32| corners.map(|(x, y)| Vec3::new(x, y, z));
        let points = [side(0.5 * thickness), side(-0.5 * thickness)].concat();
        (points, vec![[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]])
    }

    fn cameras() -> Vec<Camera> {
        [Vec3::new(0.2, 0.1, 1.0), Vec3::new(0.1, -0.3, -1.0)]
            .map(|from| Camera::towards_origin(from, 3.5, Projection::Perspective(0.4)))
            .to_vec()
    }

    /// Protects boards, sheets and boxes: only sides that have changed places are told, with their points.
    #[test]
    fn only_walls_inside_out_are_crossings() {
        let of = |thickness: f32| {
            let (points, triangles) = board(thickness);
            crossings(&points, &triangles, &cameras(), 64)
        };
        assert_eq!(of(0.01), Crossings::default());
        let crossed = of(-0.01);
        assert!(crossed.pixels > 1000 && crossed.points == (0..8).collect::<Vec<u32>>(), "{crossed:?}");
        // A room that is seen from outside, without a wall between.
        assert_eq!(of(-0.5).pixels, 0);
        let (points, triangles) = board(0.01);
        assert_eq!(crossings(&points, &triangles[..2], &cameras(), 64), Crossings::default());
    }
}
