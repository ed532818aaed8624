//! Distortion of triangles between their rest shapes and the texture.
//!
//! `E = Σₜ Aₜ (αₜ ‖J‖² + tr(J⁻ᵀ Mₜ J⁻¹))`, J the map from triangle t's rest shape to the
//! texture, A its area at rest. Three energies of this field are of this form:
//!
//! - the symmetric Dirichlet energy (Smith and Schaefer 2015): α = 1, M = I;
//! - with a scale s between rest shape and texture, and a weight w that follows the
//!   picture's error (the paper's content-aware term, section 4.1): α = w s², M = w I / s²;
//! - signal-specialised stretch (Sander, Gortler, Snyder and Hoppe 2002): M = Σ ∇y ∇yᵀ of
//!   the signal y, a small α against growth.
//!
//! All grow without bound as a triangle's area falls to zero: they hold triangles open.
//! Forward and adjoint are [`Distortion::add`].

use glam::{DMat2, DVec2};
use rayon::prelude::*;

/// One triangle's coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Inverse of the rest shape's matrix.
    pub rest_inverse: DMat2,
    /// Area at rest.
    pub area: f64,
    /// α: weight of growth.
    pub growth: f64,
    /// M, symmetric: weight of shrinking, by direction at rest.
    pub shrinking: DMat2,
}

/// The energy of a mesh. Triangles without area at rest have a zero `area` and no say.
#[derive(Clone, Debug, Default)]
pub struct Distortion {
    /// F elements.
    pub elements: Vec<Element>,
}

impl Element {
    /// Energy of a triangle with these edges, and its derivatives for the two edges.
    #[inline]
    pub fn evaluate(&self, edges: DMat2) -> (f64, DMat2) {
        let j = edges * self.rest_inverse;
        let determinant = j.determinant();
        let adjugate =
            DMat2::from_cols(DVec2::new(j.y_axis.y, -j.x_axis.y), DVec2::new(-j.y_axis.x, j.x_axis.x));
        let product = self.shrinking * adjugate;
        let stretch = dot(product, adjugate);
        let squared = 1.0 / (determinant * determinant);
        let value = self.area * (self.growth * dot(j, j) + stretch * squared);
        // ∂ stretch / ∂J, entry by entry of the adjugate.
        let slope = DMat2::from_cols(
            DVec2::new(product.y_axis.y, -product.x_axis.y),
            DVec2::new(-product.y_axis.x, product.x_axis.x),
        ) * 2.0;
        let cofactor =
            DMat2::from_cols(DVec2::new(j.y_axis.y, -j.y_axis.x), DVec2::new(-j.x_axis.y, j.x_axis.x));
        let by_j =
            j * (2.0 * self.growth) + slope * squared - cofactor * (2.0 * stretch * squared / determinant);
        (value, by_j * self.rest_inverse.transpose() * self.area)
    }

    /// The energy's Hessian for the two edges, by pairs of them, made positive definite
    /// (`curvature.rs`); zero where the triangle has no say or no area left.
    pub fn curvature(&self, edges: DMat2) -> [[DMat2; 2]; 2] {
        if self.area == 0.0 || edges.determinant() <= 0.0 {
            return [[DMat2::ZERO; 2]; 2];
        }
        let (inverse, rest) = (edges.inverse(), self.rest_inverse);
        let by_rest = (edges * rest).inverse();
        let shrinking = by_rest.transpose() * self.shrinking * by_rest * (6.0 * self.area);
        let growing = 2.0 * self.area * self.growth;
        let (now, start) = (inverse * inverse.transpose(), rest * rest.transpose());
        [0, 1].map(|i| {
            [0, 1].map(|j| {
                shrinking * now.col(j)[i] + DMat2::from_diagonal(DVec2::splat(growing * start.col(j)[i]))
            })
        })
    }
}

/// Sum of the products of entries.
fn dot(a: DMat2, b: DMat2) -> f64 {
    a.x_axis.dot(b.x_axis) + a.y_axis.dot(b.y_axis)
}

impl Distortion {
    /// Symmetric Dirichlet energy, weighted: `weight[t] (s² ‖J‖² + ‖J⁻¹‖² / s²)`. Areas are
    /// taken relative to their sum.
    pub fn symmetric_dirichlet(rest: &[DMat2], scale: f64, weight: impl Fn(usize) -> f64) -> Self {
        let total = total_area(rest);
        let elements = rest
            .iter()
            .enumerate()
            .map(|(t, rest)| {
                let w = weight(t);
                Element::new(*rest, total, w * scale * scale, DMat2::IDENTITY * (w / (scale * scale)))
            })
            .collect();
        Self { elements }
    }

    /// The energy of a layout; adds its derivative, times `weight`, to `gradient`.
    /// Infinite where a triangle with area at rest is flipped or flat.
    pub fn add(&self, points: &[DVec2], triangles: &[[u32; 3]], weight: f64, gradient: &mut [DVec2]) -> f64 {
        let parts: Vec<(f64, DMat2)> = self
            .elements
            .par_iter()
            .zip(triangles)
            .map(|(element, corners)| {
                if element.area == 0.0 {
                    return (0.0, DMat2::ZERO);
                }
                let [a, b, c] = corners.map(|i| points[i as usize]);
                let edges = DMat2::from_cols(b - a, c - a);
                if edges.determinant() <= 0.0 {
                    return (f64::INFINITY, DMat2::ZERO);
                }
                element.evaluate(edges)
            })
            .collect();
        let mut energy = 0.0;
        for ((value, slope), [a, b, c]) in parts.into_iter().zip(triangles) {
            energy += value;
            gradient[*a as usize] -= (slope.x_axis + slope.y_axis) * weight;
            gradient[*b as usize] += slope.x_axis * weight;
            gradient[*c as usize] += slope.y_axis * weight;
        }
        energy * weight
    }
}

impl Element {
    /// Coefficients for a rest shape whose area counts relative to `total`.
    pub fn new(rest: DMat2, total: f64, growth: f64, shrinking: DMat2) -> Self {
        let area = 0.5 * rest.determinant() / total;
        if !has_area(&rest, total) {
            return Self { rest_inverse: DMat2::IDENTITY, area: 0.0, growth: 0.0, shrinking: DMat2::ZERO };
        }
        Self { rest_inverse: rest.inverse(), area, growth, shrinking }
    }
}

/// Whether a rest shape is more than a sliver of rounding errors.
pub fn has_area(rest: &DMat2, total: f64) -> bool {
    let determinant = rest.determinant();
    let longest = rest.x_axis.length_squared().max(rest.y_axis.length_squared());
    determinant > 1e-6 * longest && determinant > 1e-12 * total
}

/// Sum of the rest areas.
pub fn total_area(rest: &[DMat2]) -> f64 {
    rest.iter().map(|r| 0.5 * r.determinant()).sum::<f64>().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    /// Protects the gradient, for an anisotropic M and a sheared rest shape.
    #[test]
    fn central_differences() {
        let rest = DMat2::from_cols(dvec2(1.3, 0.0), dvec2(0.4, 0.9));
        let m = DMat2::from_cols(dvec2(2.0, 0.6), dvec2(0.6, 0.5));
        let distortion = Distortion { elements: vec![Element::new(rest, 1.0, 0.7, m)] };
        let points = vec![dvec2(0.1, 0.2), dvec2(0.8, 0.3), dvec2(0.3, 0.9)];
        let triangles = [[0, 1, 2]];
        let energy = |p: &[DVec2]| distortion.add(p, &triangles, 1.0, &mut [DVec2::ZERO; 3]);
        let mut gradient = [DVec2::ZERO; 3];
        distortion.add(&points, &triangles, 1.0, &mut gradient);
        for i in 0..3 {
            for axis in 0..2 {
                let h = 1e-6;
                let (mut up, mut down) = (points.clone(), points.clone());
                up[i][axis] += h;
                down[i][axis] -= h;
                let slope = (energy(&up) - energy(&down)) / (2.0 * h);
                assert!((slope - gradient[i][axis]).abs() < 1e-6 * slope.abs().max(1.0), "{i} {axis}");
            }
        }
    }

    /// Protects the minimum: an isometric map costs 4 a unit of area, more and less cost more.
    #[test]
    fn isometry_is_the_minimum() {
        let rest = [DMat2::IDENTITY];
        let distortion = Distortion::symmetric_dirichlet(&rest, 1.0, |_| 1.0);
        let at = |s: f64| {
            distortion.add(
                &[DVec2::ZERO, dvec2(s, 0.0), dvec2(0.0, s)],
                &[[0, 1, 2]],
                1.0,
                &mut [DVec2::ZERO; 3],
            )
        };
        assert!((at(1.0) - 4.0).abs() < 1e-12);
        assert!(at(0.9) > 4.0 && at(1.1) > 4.0);
        let mirrored = [DVec2::ZERO, dvec2(-1.0, 0.0), dvec2(0.0, 1.0)];
        assert!(distortion.add(&mirrored, &[[0, 1, 2]], 1.0, &mut [DVec2::ZERO; 3]).is_infinite());
    }
}
