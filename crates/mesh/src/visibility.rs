//! How much of a surface is seen from outside, when cameras are spread all around: the share of
//! cosine-weighted rays from it that leave the model (the "ambient" term of Zhukov, Iones and Kronin
//! 1998), which is the share of its own pixels that are not hidden behind other parts.
//!
//! Points and directions follow the R4 sequence (Roberts 2018), cosine weights come of adding a point
//! on the unit sphere to the normal.
//!
//! Contract: answers do not depend on threads. Both sides of a triangle are seen, as where back faces
//! are drawn: an open sheet is seen twice.

use crate::projection::HighSurface;
use parbake_model::Mesh;
use parbake_model::glam::{Vec3, vec3};
use rayon::prelude::*;

/// Rays in all, about: a quarter of a second on two cores, more where triangles are so many that each
/// has its least.
const RAYS: usize = 1 << 19;
/// Rays of a triangle at least and at most, from each side.
const RAYS_EACH: [usize; 2] = [4, 1024];
/// Where rays begin above their triangle, as a share of the mesh's extent.
const LIFT: f32 = 1e-4;

/// The share of each triangle's views that show it: 0 for what is hidden, 1 for the outside of a convex
/// body, 2 for a sheet that is seen from both sides. `surface` is the same mesh. Triangles without area
/// have 0.
pub fn visibilities(mesh: &Mesh, surface: &HighSurface) -> Vec<f32> {
    let doubled_area = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length()
    };
    let count = mesh.triangles.len();
    let total: f64 = (0..count).map(|t| f64::from(doubled_area(t))).sum();
    let (low, high) =
        (mesh.positions.iter()).fold((Vec3::MAX, Vec3::MIN), |(l, h), p| (l.min(*p), h.max(*p)));
    let lift = LIFT * (high - low).max_element();
    let even = (RAYS / 4 / count.max(1)).max(RAYS_EACH[0]);
    (0..count)
        .into_par_iter()
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { return 0.0 };
            let share = f64::from(doubled_area(t)) / total.max(f64::MIN_POSITIVE);
            let rays = (even + (share * (RAYS / 4) as f64) as usize).clamp(RAYS_EACH[0], RAYS_EACH[1]);
            let open = |side: f32, i: usize| {
                let [x, y, z, w] = spread(t, i);
                let [u, v] = if x + y <= 1.0 { [x, y] } else { [1.0 - x, 1.0 - y] };
                let up = normal * side;
                let direction = up + on_sphere(z, w);
                let origin = a + (b - a) * u + (c - a) * v + up * lift;
                surface.cast(origin, direction, f32::INFINITY).is_none()
            };
            let left = [1.0, -1.0].map(|side| (0..rays).filter(|i| open(side, *i)).count());
            (left[0] + left[1]) as f32 / rays as f32
        })
        .collect()
}

/// The i-th of a triangle's points in the unit cube of four dimensions.
fn spread(triangle: usize, i: usize) -> [f32; 4] {
    const STEPS: [f64; 4] =
        [0.856_674_883_854_5, 0.733_891_856_627_1, 0.628_706_721_042_9, 0.538_597_257_223_6];
    STEPS.map(|step| ((i as f64 + 1.0) * step + triangle as f64 * 0.618_033_988_749).fract() as f32)
}

fn on_sphere(turn: f32, height: f32) -> Vec3 {
    let z = 2.0 * height - 1.0;
    let (sin, cos) = (std::f32::consts::TAU * turn).sin_cos();
    let radius = (1.0 - z * z).max(0.0).sqrt();
    vec3(radius * cos, radius * sin, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box's six sides, two triangles each, facing outwards.
    fn cube(half: f32) -> Mesh {
        let mut mesh = Mesh::default();
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let place = |u: f32, v: f32| {
                    let (u, v) = if side > 0.0 { (u, v) } else { (v, u) };
                    let mut p = [0.0; 3];
                    p[axis] = side * half;
                    p[(axis + 1) % 3] = u * half;
                    p[(axis + 2) % 3] = v * half;
                    Vec3::from(p)
                };
                let first = mesh.positions.len() as u32;
                mesh.positions.extend([
                    place(-1.0, -1.0),
                    place(1.0, -1.0),
                    place(1.0, 1.0),
                    place(-1.0, 1.0),
                ]);
                mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            }
        }
        mesh
    }

    fn visible_shares(mesh: &Mesh) -> Vec<f32> {
        visibilities(mesh, &HighSurface::new(mesh))
    }

    /// Protects texels of what is seen: all of a convex body is, nothing of what it holds.
    #[test]
    fn a_box_in_a_box_is_hidden() {
        let mut mesh = cube(1.0);
        let inner = cube(0.5);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(&inner.positions);
        mesh.triangles.extend(inner.triangles.iter().map(|t| t.map(|i| i + first)));
        let found = visible_shares(&mesh);
        assert!(found[..12].iter().all(|e| *e == 1.0), "{found:?}");
        assert!(found[12..].iter().all(|e| *e == 0.0), "{found:?}");
    }

    /// Protects sheets, which views see from both sides, and their floor: a square on the floor of an
    /// open box as deep as it is wide is seen through its opening, by the form factor of two facing
    /// squares, 0.19982 (Howell, configuration C-11).
    #[test]
    fn a_sheet_is_seen_twice_and_a_pit_through_its_opening() {
        let corners = vec![vec3(0.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0)];
        let sheet = Mesh { positions: corners, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        assert_eq!(visible_shares(&sheet), [2.0]);
        let mut pit = cube(1.0);
        pit.triangles.truncate(10);
        // The side at −z, seen from within.
        let found = visible_shares(&pit);
        let floor = 0.5 * (found[8] + found[9]) - 1.0;
        assert!((floor - 0.199_82).abs() < 0.02, "{floor}");
    }

    /// Protects runs on bad meshes.
    #[test]
    fn triangles_without_area_have_none() {
        let mesh = Mesh { positions: vec![Vec3::ZERO; 3], triangles: vec![[0, 1, 2]], ..Mesh::default() };
        assert_eq!(visible_shares(&mesh), [0.0]);
        assert!(visible_shares(&Mesh::default()).is_empty());
    }
}
