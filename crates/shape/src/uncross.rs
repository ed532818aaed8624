//! Thin walls whose sides cross already are pulled apart before vertices follow pictures: few triangles over a
//! bend of a chair's arm lie partly below those of its underside, which then shows as a dark patch.
//!
//! ```text
//! views ─ pixels at which a wall shows the wrong side (walls.rs) and the high-poly the right one ─┐
//!   └──────────── both sides move apart along their common normal, until none is left ────────────┘
//! ```
//!
//! Whether it is a fault is for the high-poly to say: foliage shows backs with fronts close behind them, and is meant to. All of its
//! triangles count as opaque.
//!
//! Contract: all is in the common frame. Points that no such pixel asks to move stay to the bit, and triangles stay sane
//! (`triangle_quality.rs`). Deterministic.

use crate::points::Points;
use crate::triangle_quality::TriangleQuality;
use crate::walls::{Crossing, THICKEST, crossings_from, is_back};
use glam::Vec3;
use parbake_model::Mesh;
use parbake_progress::Watcher;
use parbake_render::camera::{Camera, fibonacci_sphere};
use parbake_render::interpolate::{barycentrics, interpolate};
use parbake_render::on_screen::Raster;
use parbake_render::raster::{NOTHING, Visibility};
use parbake_render::scene::Scene;
use parbake_views::pool::Rig;
use rayon::prelude::*;

/// More triangles are too small to reach through a wall.
const MOST_TRIANGLES: usize = 20_000;
/// Views that are looked at, and pixels along a side of each.
const VIEWS: usize = 64;
const PIXELS: usize = 256;
/// Steps at most.
const STEPS: usize = 16;
/// How far the sides of a wall are to be apart, in the common frame: enough for the depth buffers of viewers.
const APART: f32 = 2e-3;
/// Cosine between the normals of a wall's sides at most.
const OPPOSITE: f32 = -0.5;
/// Part of the pixels with wrong sides that have to be gone for the points to move.
const WORTH_IT: f64 = 0.5;

/// The vertices of a mesh with the sides of its walls in order, as the scene of the high-poly shows them from the distance of
/// `rig`; none where they are in order, or cannot be brought into it, or where there are more than
/// 20,000 triangles. The mesh has a normal at each vertex. A watcher that says stop is heeded between steps.
pub fn with_sides_in_order(mesh: &Mesh, high: &Scene, rig: &Rig, watcher: &dyn Watcher) -> Option<Vec<Vec3>> {
    if mesh.triangles.len() > MOST_TRIANGLES || watcher.stopped() {
        return None;
    }
    let points = Points::new(&mesh.positions, &mesh.normals, &mesh.triangles);
    let apart = uncrossed(&points.rest, &points.triangles, high, rig, watcher)?;
    Some(points.vertices(&apart))
}

fn uncrossed(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    high: &Scene,
    rig: &Rig,
    watcher: &dyn Watcher,
) -> Option<Vec<Vec3>> {
    let camera = |direction| Camera::towards_origin(direction, rig.radius, rig.projection);
    let cameras: Vec<Camera> = fibonacci_sphere(VIEWS, 0.0).into_iter().map(camera).collect();
    let looks = |at: &[Vec3], cameras: &[Camera]| -> Vec<Vec<Crossing>> {
        cameras.par_iter().map(|camera| crossings_from(at, triangles, camera, PIXELS)).collect()
    };
    let seen = looks(points, &cameras);
    // Only views that may show a fault are looked at again, and need the high-poly's.
    let (cameras, seen): (Vec<Camera>, Vec<Vec<Crossing>>) =
        cameras.into_iter().zip(seen).filter(|(_, found)| !found.is_empty()).unzip();
    if seen.is_empty() {
        return None;
    }
    let fronts: Vec<Vec<Option<Vec3>>> = cameras.par_iter().map(|camera| fronts(high, camera)).collect();
    let faults = |at: &[Vec3], seen: Vec<Vec<Crossing>>| -> Vec<Crossing> {
        let is_fault = |own: &Crossing, fronts: &[Option<Vec3>]| {
            let [near, far] = own.triangles.map(|t| triangles[t as usize].map(|point| at[point as usize]));
            let far_at: Vec3 = interpolate(far, own.weights[1]);
            let is_shown = |front: &Vec3| front.distance(far_at) < THICKEST;
            normal(near).dot(normal(far)) < OPPOSITE
                && fronts.get(own.pixel).is_some_and(|front| front.as_ref().is_some_and(is_shown))
        };
        let each = seen.into_iter().zip(&fronts);
        each.flat_map(|(found, fronts)| found.into_iter().filter(|own| is_fault(own, fronts))).collect()
    };
    let mut wrong = faults(points, seen);
    let first = wrong.len();
    let quality = TriangleQuality::new(points, triangles);
    let mut at = points.to_vec();
    let mut best = (first, None);
    for _ in 0..STEPS {
        if wrong.is_empty() || watcher.stopped() {
            break;
        }
        let mut next = pulled_apart(&at, triangles, &wrong);
        quality.revert(&at, &mut next);
        at = next;
        wrong = faults(&at, looks(&at, &cameras));
        if wrong.len() < best.0 {
            best = (wrong.len(), Some(at.clone()));
        }
    }
    best.1.filter(|_| best.0 as f64 <= (1.0 - WORTH_IT) * first as f64)
}

/// What is seen of a scene's front at each pixel.
fn fronts(scene: &Scene, camera: &Camera) -> Vec<Option<Vec3>> {
    let mut seen = Visibility::default();
    let screen = scene.on_screen(camera, PIXELS);
    screen.rasterise(PIXELS, (0.0, 0.0), None, &mut seen);
    let front = |(pixel, &triangle): (usize, &u32)| {
        let corners = (triangle != NOTHING).then(|| scene.mesh().corners(triangle as usize))?;
        let at = ((pixel % PIXELS) as f64 + 0.5, (pixel / PIXELS) as f64 + 0.5);
        let weights = || barycentrics(&screen.triangle(triangle as usize), at.0, at.1).weights;
        (!is_back(corners, camera)).then(|| interpolate(corners, weights()))
    };
    seen.triangle.iter().enumerate().map(front).collect()
}

fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// The points after a step: the corners of both triangles of each pixel move apart by half of what is asked for, each by the mean of
/// what its pixels ask, weighted by their barycentric weights.
fn pulled_apart(at: &[Vec3], triangles: &[[u32; 3]], wrong: &[Crossing]) -> Vec<Vec3> {
    let mut sums = vec![(Vec3::ZERO, 0.0f32); at.len()];
    for own in wrong {
        let [near, far] = own.triangles.map(|triangle| triangles[triangle as usize]);
        let corners = |triangle: [u32; 3]| triangle.map(|point| at[point as usize]);
        // Out of the far triangle's front, into the near one's back.
        let axis = (normal(corners(far)) - normal(corners(near))).normalize_or_zero();
        let [near_at, far_at]: [Vec3; 2] =
            [interpolate(corners(near), own.weights[0]), interpolate(corners(far), own.weights[1])];
        let way = 0.5 * ((near_at - far_at).dot(axis).max(0.0) + APART) * axis;
        for (triangle, weights, way) in [(near, own.weights[0], -way), (far, own.weights[1], way)] {
            for (point, weight) in triangle.into_iter().zip(weights) {
                let (sum, weights) = &mut sums[point as usize];
                *sum += weight * way;
                *weights += weight;
            }
        }
    }
    let moved =
        |(at, (sum, weights)): (&Vec3, (Vec3, f32))| if weights > 0.0 { *at + sum / weights } else { *at };
    at.iter().zip(sums).map(moved).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parbake_model::Material;
    use parbake_render::camera::Projection;
    use parbake_render::interpretation::Interpretation;

    const RIG: Rig = Rig { radius: 3.5, projection: Projection::Perspective(0.4) };

    /// A board that is bent along its middle by this much, closed but for its rims; its sides, cut into `cells` across the
    /// bend, are this far apart.
    fn board(cells: [usize; 2], apart: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for (side, cells) in cells.into_iter().enumerate() {
            let first = points.len() as u32;
            for column in 0..=cells {
                let x = 1.8 * (column as f32 / cells as f32 - 0.5);
                let z = 0.05 * (1.0 - (x / 0.9).powi(2)) + if side == 0 { 0.5 * apart } else { -0.5 * apart };
                points.extend([Vec3::new(x, -0.4, z), Vec3::new(x, 0.4, z)]);
            }
            for column in 0..cells as u32 {
                let [a, b, c, d] = [0, 1, 2, 3].map(|k| first + 2 * column + k);
                triangles.extend(if side == 0 { [[a, c, b], [b, c, d]] } else { [[a, b, c], [b, d, c]] });
            }
        }
        (points, triangles)
    }

    fn scene((points, triangles): (Vec<Vec3>, Vec<[u32; 3]>)) -> Scene {
        let mesh = Mesh {
            normals: vec![Vec3::Z; points.len()],
            triangle_materials: vec![0; triangles.len()],
            positions: points,
            triangles,
            ..Mesh::default()
        };
        Scene::new(mesh, &[Material::default()], &[], Interpretation::default())
    }

    fn wrong_pixels((points, triangles): &(Vec<Vec3>, Vec<[u32; 3]>)) -> usize {
        let cameras = fibonacci_sphere(20, 0.7).into_iter();
        let camera = |direction| Camera::towards_origin(direction, RIG.radius, RIG.projection);
        cameras.map(|d| crossings_from(points, triangles, &camera(d), 128).len()).sum()
    }

    /// Protects clean seats and arms: a bend whose upper side has fewer triangles than its underside shows none of it
    /// any more, and the rims stay together.
    #[test]
    fn the_underside_of_a_bend_stays_below() {
        let high = scene(board([32, 32], 0.01));
        let low = board([2, 8], 0.01);
        let before = wrong_pixels(&low);
        assert!(before > 500, "{before}");
        let apart = uncrossed(&low.0, &low.1, &high, &RIG, &()).unwrap();
        let farthest = apart.iter().zip(&low.0).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(farthest < 0.03, "{farthest}");
        let after = wrong_pixels(&(apart, low.1));
        assert!(20 * after < before, "{before} {after}");
    }

    /// Protects what is right, and what is meant to show its back: leaves with fronts close behind.
    #[test]
    fn sound_walls_and_leaves_stay() {
        let sound = board([16, 16], 0.01);
        assert_eq!(uncrossed(&sound.0, &sound.1, &scene(sound.clone()), &RIG, &()), None);
        let inside_out = board([8, 8], -0.01);
        assert!(wrong_pixels(&inside_out) > 500);
        assert_eq!(uncrossed(&inside_out.0, &inside_out.1, &scene(inside_out.clone()), &RIG, &()), None);
    }
}
