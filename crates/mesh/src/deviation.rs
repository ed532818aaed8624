//! How far two surfaces are apart: root mean square of the distance from points of one to the
//! other, the greater of both ways (what Cignoni, Rocchini and Scopigno, "Metro", 1998, call the
//! symmetric mean square error).
//!
//! One way finds what sticks out, the other what is missing.
//!
//! Contract: points are placed by the mesh alone, so that the figure is the same whenever it is
//! asked for.

use crate::projection::HighSurface;
use parbake_model::Mesh;
use parbake_model::glam::Vec3;
use rayon::prelude::*;

/// Points on a mesh, about; no triangle has less than one.
const POINTS: usize = 20_000;

/// The deviation of two meshes in their unit; infinite where either has no area.
pub fn deviation(a: (&Mesh, &HighSurface), b: (&Mesh, &HighSurface)) -> f64 {
    one_way(a.0, b.1).max(one_way(b.0, a.1))
}

fn one_way(from: &Mesh, to: &HighSurface) -> f64 {
    let count = from.triangles.len();
    // Of a mesh that has more triangles than there are points, one in so many stands for its
    // neighbours.
    let stride = count.div_ceil(POINTS).max(1);
    let each = (POINTS / count.max(1)).clamp(1, 64);
    let sums: Vec<[f64; 2]> = (0..count)
        .into_par_iter()
        .step_by(stride)
        .map(|triangle| {
            let corners = from.corners(triangle);
            let area = f64::from((corners[1] - corners[0]).cross(corners[2] - corners[0]).length());
            let squares = (0..each).map(|k| {
                let distance = to.closest(spread(corners, k), f32::INFINITY).map_or(f32::NAN, |p| p.distance);
                f64::from(distance).powi(2)
            });
            [squares.sum::<f64>() * area / each as f64, area]
        })
        .collect();
    let [square, area] = sums.iter().fold([0.0; 2], |[s, a], [square, area]| [s + square, a + area]);
    let mean = square / area;
    if mean.is_finite() { mean.sqrt() } else { f64::INFINITY }
}

/// The k-th of evenly spread points of a triangle (the sequence R2 of Roberts, 2018, folded).
pub(crate) fn spread([a, b, c]: [Vec3; 3], k: usize) -> Vec3 {
    let [x, y] = [0.754_877_7, 0.569_840_3].map(|step: f32| (0.5 + step * k as f32).fract());
    let (x, y) = if x + y > 1.0 { (1.0 - x, 1.0 - y) } else { (x, y) };
    a + (b - a) * x + (c - a) * y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wall_low;

    /// Protects the choice of coarse copies: the figure is a distance, and what is missing counts as
    /// much as what sticks out.
    #[test]
    fn it_sees_what_moved_and_what_is_missing() {
        let cube = wall_low();
        let surface = HighSurface::new(&cube);
        assert!(deviation((&cube, &surface), (&cube, &surface)) < 1e-6);

        let mut larger = cube.clone();
        larger.positions.iter_mut().for_each(|p| *p *= 1.1);
        let own = HighSurface::new(&larger);
        let side = cube.positions.iter().map(|p| p.x).fold(f32::MIN, f32::max);
        let off = deviation((&cube, &surface), (&larger, &own)) / f64::from(0.1 * side);
        assert!((0.9..1.6).contains(&off), "between a face's and a corner's way: {off}");

        let mut open = cube.clone();
        open.triangles.truncate(open.triangles.len() - 2);
        open.triangle_materials.truncate(open.triangles.len());
        let own = HighSurface::new(&open);
        assert!(deviation((&cube, &surface), (&open, &own)) > f64::from(0.1 * side), "a side is missing");
        let nothing = Mesh::default();
        assert_eq!(deviation((&cube, &surface), (&nothing, &HighSurface::new(&nothing))), f64::INFINITY);
    }
}
