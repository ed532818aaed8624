//! How unevenly a layout shares its texels among the surface.
//!
//! With σ₁ ≥ σ₂ the singular values of a triangle's map from space to texture:
//! - texture stretch (Sander, Snyder, Gortler and Hoppe, "Texture Mapping Progressive
//!   Meshes", 2001, section 3): the map from texture to space has the singular values
//!   1/σ₂ and 1/σ₁, so L²(T)² = (1/σ₁² + 1/σ₂²) / 2 and L^∞(T) = 1/σ₂. A mesh's L² is
//!   the root of the mean of L²(T)² by surface area, its L^∞ the largest. Both are
//!   multiplied by √(texture area / surface area), so that 1 is best.
//! - area scale: σ₁σ₂, relative to texture area / surface area.
//! - anisotropy: σ₁/σ₂.

use super::{Distortion, Quantiles};
use crate::{Layout, predicates};
use glam::{DMat2, DVec2};

/// One triangle's part.
struct Scale {
    surface: f64,
    singular: [f64; 2],
}

/// Stretch, area scale and anisotropy; `None` where the texture or the surface has no
/// area. Mirrored triangles count like others; triangles without finite coordinates
/// or without area in space do not count.
pub(super) fn distortion(layout: &Layout, texture_size: usize) -> Option<Distortion> {
    let scales: Vec<Scale> = (0..layout.triangles.len()).filter_map(|t| scale(layout, t)).collect();
    let surface: f64 = scales.iter().map(|s| s.surface).sum();
    let texture: f64 = scales.iter().map(|s| s.surface * s.singular[0] * s.singular[1]).sum();
    let mean = texture / surface;
    if !(mean > 0.0 && mean.is_finite()) {
        return None;
    }
    let mut areas = Vec::with_capacity(scales.len());
    let mut ratios = Vec::with_capacity(scales.len());
    let (mut squares, mut stretched, mut largest) = (0.0, 0.0, 0.0f64);
    for Scale { surface, singular: [large, small] } in scales {
        areas.push((large * small / mean, surface));
        if small > 0.0 {
            ratios.push((large / small, surface));
            squares += 0.5 * surface * (large.powi(-2) + small.powi(-2));
            stretched += surface;
            largest = largest.max(1.0 / small);
        }
    }
    Some(Distortion {
        stretch_l2: (squares / stretched * mean).sqrt(),
        stretch_max: largest * mean.sqrt(),
        texels_per_unit: mean.sqrt() * texture_size as f64,
        area_scale: weighted_quantiles(areas)?,
        anisotropy: weighted_quantiles(ratios)?,
    })
}

fn scale(layout: &Layout, triangle: usize) -> Option<Scale> {
    let [a, b, c] = layout.corners(triangle);
    let rest = layout.rest[triangle];
    let surface = layout.rest_area(triangle);
    if !(surface > 0.0 && surface.is_finite() && a.is_finite() && b.is_finite() && c.is_finite()) {
        return None;
    }
    let map = DMat2::from_cols(b - a, c - a) * rest.inverse();
    // Not the determinant of the map, which a sliver's rounding would spoil.
    let determinant = predicates::orientation(a, b, c) / (2.0 * surface);
    let singular = singular_values(map, determinant);
    singular.iter().all(|s| s.is_finite()).then_some(Scale { surface, singular })
}

/// The singular values of a 2 × 2 matrix, the larger one first, from the matrix and
/// its determinant (Blinn, "Consider the Lowly 2×2 Matrix", 1996). The smaller one is
/// not the usual difference, which cancels.
pub fn singular_values(matrix: DMat2, determinant: f64) -> [f64; 2] {
    let [a, b, c, d] = matrix.to_cols_array();
    let sum = DVec2::new(a + d, b - c).length();
    let difference = DVec2::new(a - d, b + c).length();
    let large = 0.5 * (sum + difference);
    if large > 0.0 { [large, (determinant.abs() / large).min(large)] } else { [0.0; 2] }
}

/// Quantiles of (value, weight): the smallest values up to which 1 %, 5 %, 50 %, 95 %
/// and 99 % of the weight lies. `None` of nothing.
pub fn weighted_quantiles(mut values: Vec<(f64, f64)>) -> Option<Quantiles> {
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let total: f64 = values.iter().map(|v| v.1).sum();
    let &(last, _) = values.last()?;
    let (mut below, mut next) = (0.0, 0);
    let [q1, q5, q50, q95, q99] = [0.01, 0.05, 0.5, 0.95, 0.99].map(|share| {
        while next < values.len() && below + values[next].1 < share * total {
            below += values[next].1;
            next += 1;
        }
        values.get(next).map_or(last, |v| v.0)
    });
    Some(Quantiles { q1, q5, q50, q95, q99 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the closed form, for rotations, mirrors and singular matrices too.
    #[test]
    fn singular_values_of_known_matrices() {
        let check = |m: DMat2, want: [f64; 2]| {
            let [large, small] = singular_values(m, m.determinant());
            assert!((large - want[0]).abs() < 1e-12 && (small - want[1]).abs() < 1e-12, "{m} {want:?}");
        };
        let turn = DMat2::from_angle(0.7);
        let stretch = DMat2::from_diagonal(DVec2::new(3.0, 0.5));
        check(turn, [1.0, 1.0]);
        check(turn * stretch * DMat2::from_angle(-0.2), [3.0, 0.5]);
        check(DMat2::from_diagonal(DVec2::new(-3.0, 0.5)) * turn, [3.0, 0.5]);
        check(DMat2::from_cols(DVec2::ONE, DVec2::ONE), [2.0, 0.0]);
        check(DMat2::ZERO, [0.0, 0.0]);
    }

    /// Protects quantiles of weighted values.
    #[test]
    fn quantiles_go_by_weight() {
        let q = weighted_quantiles((0..100).rev().map(|i| (f64::from(i), 1.0)).collect()).unwrap();
        assert_eq!([q.q1, q.q5, q.q50, q.q95, q.q99], [0.0, 4.0, 49.0, 94.0, 98.0]);
        let q = weighted_quantiles(vec![(1.0, 99.5), (7.0, 0.5)]).unwrap();
        assert_eq!([q.q1, q.q99], [1.0, 1.0]);
        assert!(weighted_quantiles(Vec::new()).is_none());
        assert_eq!(weighted_quantiles(vec![(2.0, 0.0)]).unwrap().q50, 2.0);
    }
}
