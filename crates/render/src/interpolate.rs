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

/// Adjoint of [`barycentrics`] with its derivatives per pixel: the gradients of the
/// three planes. With `a = (g − (g·β) 1) / Σs` for each of the three vectors of
/// weights, and ∂ₓβ for the derivative to the right, the gradient of plane j is
/// `a_j c + a^x_j e_x − (g^x·∂ₓβ + Σ∂ₓs · a^x_j) c / Σs + …` (and so for y), c = (x, y, 1).
///
/// It is linear in `gradient`, and sums over samples of one triangle can be carried
/// on together by [`planes_adjoint`].
#[inline]
pub fn footprint_adjoint(
    triangle: &ScreenTriangle,
    x: f64,
    y: f64,
    at: &Barycentrics,
    gradient: &Barycentrics,
) -> [DVec3; 3] {
    let p = &triangle.planes;
    let total = p[0] + p[1] + p[2];
    let c = DVec3::new(x, y, 1.0);
    let inverse = 1.0 / total.dot(c);
    let weights = at.weights.map(f64::from);
    let dot = |g: [f32; 3], w: [f32; 3]| f64::from(g[0] * w[0] + g[1] * w[1] + g[2] * w[2]);
    let centred = |g: [f32; 3]| {
        let g = g.map(f64::from);
        let along = g[0] * weights[0] + g[1] * weights[1] + g[2] * weights[2];
        g.map(|g| (g - along) * inverse)
    };
    let (a, ax, ay) = (centred(gradient.weights), centred(gradient.per_x), centred(gradient.per_y));
    let back = (dot(gradient.per_x, at.per_x) + dot(gradient.per_y, at.per_y)) * inverse;
    let (fall_x, fall_y) = (total.x * inverse, total.y * inverse);
    std::array::from_fn(|j| {
        c * (a[j] - back - fall_x * ax[j] - fall_y * ay[j]) + DVec3::new(ax[j], ay[j], 0.0)
    })
}

/// Gradients of the three planes to those of the homogeneous vertices (X, Y, W):
/// `dM⁻¹ = −M⁻¹ dM M⁻¹`, so vertex k receives `−Σ_j (G_j · plane_k) plane_j`.
#[inline]
pub fn planes_adjoint(triangle: &ScreenTriangle, gradient: &[DVec3; 3]) -> [DVec3; 3] {
    let p = &triangle.planes;
    p.map(|k| -(p[0] * gradient[0].dot(k) + p[1] * gradient[1].dot(k) + p[2] * gradient[2].dot(k)))
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

    /// Protects the vertices' gradient through the choice of mip levels.
    #[test]
    fn footprint_adjoint_matches_central_differences() {
        for projection in [Projection::Perspective(0.4), Projection::Orthographic(1.3)] {
            let camera = Camera::towards_origin(Vec3::new(0.2, 0.5, 1.0), 3.5, projection);
            let p = [Vec3::new(-0.7, -0.4, 0.5), Vec3::new(0.8, -0.5, -0.3), Vec3::new(0.1, 0.9, 0.2)];
            let g = Barycentrics {
                weights: [0.3, -1.1, 0.8],
                per_x: [20.0, -35.0, 11.0],
                per_y: [-14.0, 9.0, 40.0],
            };
            let dot = |a: [f32; 3], b: [f32; 3]| -> f64 {
                a.into_iter().zip(b).map(|(a, b)| f64::from(a) * f64::from(b)).sum()
            };
            let value = |p: &[Vec3; 3]| {
                let b = barycentrics(&screen(p, &camera), 30.0, 28.0);
                dot(b.weights, g.weights) + dot(b.per_x, g.per_x) + dot(b.per_y, g.per_y)
            };
            let triangle = screen(&p, &camera);
            let at = barycentrics(&triangle, 30.0, 28.0);
            let planes = footprint_adjoint(&triangle, 30.0, 28.0, &at, &g);
            for (k, gradient) in planes_adjoint(&triangle, &planes).into_iter().enumerate() {
                let analytic = camera.project_adjoint(gradient, 64);
                for axis in 0..3 {
                    let (mut lo, mut hi) = (p, p);
                    lo[k][axis] -= 1e-2;
                    hi[k][axis] += 1e-2;
                    let numeric = (value(&hi) - value(&lo)) / 2e-2;
                    assert!(
                        (numeric - f64::from(analytic[axis])).abs() < 3e-3,
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
