//! Interpolation: from a sample on a triangle to perspective-correct barycentrics,
//! and from barycentrics to whatever the vertices carry.
//!
//! Forward: `s = M⁻¹ (x, y, 1)ᵀ` (see `raster.rs`), `β = s / Σs`.
//! Adjoint: with `g = dL/dβ`, `dL/ds = (g − (g·β) 1) / Σs`, and since
//! `ds = −M⁻¹ dM s`, the gradient of homogeneous vertex k is
//! `−s_k Σ_j (dL/ds)_j · plane_j`.
//!
//! Contract: the sample lies on the triangle (or near it: the formulas extend
//! linearly); barycentrics sum to 1.

use crate::raster::ScreenTriangle;
use glam::DVec3;
use std::ops::{Add, Mul};

/// Perspective-correct barycentrics and their change per pixel step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Barycentrics {
    /// Weights of the three corners.
    pub weights: [f32; 3],
    /// Their derivative for one pixel to the right.
    pub per_x: [f32; 3],
    /// Their derivative for one pixel down.
    pub per_y: [f32; 3],
}

/// Barycentrics of the point of a triangle that is seen at `(x, y)`.
#[inline]
pub fn barycentrics(triangle: &ScreenTriangle, x: f64, y: f64) -> Barycentrics {
    let s = triangle.at(x, y);
    let inverse = 1.0 / (s[0] + s[1] + s[2]);
    let p = &triangle.planes;
    let (sum_x, sum_y) = (p[0].x + p[1].x + p[2].x, p[0].y + p[1].y + p[2].y);
    let mut out = Barycentrics::default();
    for k in 0..3 {
        let weight = s[k] * inverse;
        out.weights[k] = weight as f32;
        out.per_x[k] = ((p[k].x - weight * sum_x) * inverse) as f32;
        out.per_y[k] = ((p[k].y - weight * sum_y) * inverse) as f32;
    }
    out
}

/// Adjoint of [`barycentrics`]' weights: gradients of the three homogeneous
/// vertices (X, Y, W).
#[inline]
pub fn barycentrics_adjoint(triangle: &ScreenTriangle, x: f64, y: f64, gradient: [f32; 3]) -> [DVec3; 3] {
    let s = triangle.at(x, y);
    let inverse = 1.0 / (s[0] + s[1] + s[2]);
    let g = gradient.map(f64::from);
    let along = (g[0] * s[0] + g[1] * s[1] + g[2] * s[2]) * inverse;
    let p = &triangle.planes;
    let pull: DVec3 = (0..3).map(|j| p[j] * ((g[j] - along) * inverse)).sum();
    s.map(|s| -s * pull)
}

/// The weighted sum of three corners' attributes.
#[inline]
pub fn interpolate<T>(corners: [T; 3], weights: [f32; 3]) -> T
where
    T: Copy + Mul<f32, Output = T> + Add<Output = T>,
{
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Projection};
    use crate::raster::ScreenTriangles;
    use glam::Vec3;

    fn screen(p: &[Vec3; 3], camera: &Camera) -> ScreenTriangle {
        ScreenTriangles::new(p, &[[0, 1, 2]], camera, 64).triangles[0]
    }

    /// Protects every gradient that reaches vertices through the interior.
    #[test]
    fn barycentrics_adjoint_matches_central_differences() {
        for projection in [Projection::Perspective(0.4), Projection::Orthographic(1.3)] {
            let camera = Camera::towards_origin(Vec3::new(0.2, 0.5, 1.0), 3.5, projection);
            let p = [Vec3::new(-0.7, -0.4, 0.5), Vec3::new(0.8, -0.5, -0.3), Vec3::new(0.1, 0.9, 0.2)];
            let g = [0.3, -1.1, 0.8];
            let value = |p: &[Vec3; 3]| {
                let b = barycentrics(&screen(p, &camera), 30.0, 28.0).weights;
                f64::from(b[0] * g[0] + b[1] * g[1] + b[2] * g[2])
            };
            let gradient = barycentrics_adjoint(&screen(&p, &camera), 30.0, 28.0, g);
            for k in 0..3 {
                let analytic = camera.project_adjoint(gradient[k], 64);
                for axis in 0..3 {
                    let (mut lo, mut hi) = (p, p);
                    lo[k][axis] -= 1e-2;
                    hi[k][axis] += 1e-2;
                    let numeric = (value(&hi) - value(&lo)) / 2e-2;
                    assert!(
                        (numeric - f64::from(analytic[axis])).abs() < 2e-3,
                        "{k} {axis} {numeric} {analytic}"
                    );
                }
            }
        }
    }

    /// Protects the texture footprints, which choose the mip level.
    #[test]
    fn derivatives_match_central_differences() {
        let camera = Camera::towards_origin(Vec3::new(0.2, 0.5, 1.0), 3.5, Projection::Perspective(0.4));
        let t = screen(
            &[Vec3::new(-0.7, -0.4, 0.5), Vec3::new(0.8, -0.5, -0.3), Vec3::new(0.1, 0.9, 0.2)],
            &camera,
        );
        let at = |x: f64, y: f64| barycentrics(&t, x, y).weights;
        let here = barycentrics(&t, 30.0, 28.0);
        for k in 0..3 {
            let dx = (at(30.5, 28.0)[k] - at(29.5, 28.0)[k]) - here.per_x[k];
            let dy = (at(30.0, 28.5)[k] - at(30.0, 27.5)[k]) - here.per_y[k];
            assert!(dx.abs() < 1e-4 && dy.abs() < 1e-4);
        }
    }
}
