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
//! - symmetric Dirichlet energy (Smith and Schaefer, "Bijective Parameterization with Free Boundaries", 2015):
//!   σ₁² + σ₂² + 1/σ₁² + 1/σ₂², the mean by surface area, of maps that are scaled as above, so that 4 is best.

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
    let (mut squares, mut stretched, mut largest, mut dirichlet) = (0.0, 0.0, 0.0f64, 0.0);
    for Scale { surface, singular: [large, small] } in scales {
        areas.push((large * small / mean, surface));
        if small > 0.0 {
            ratios.push((large / small, surface));
            squares += 0.5 * surface * (large.powi(-2) + small.powi(-2));
            stretched += surface;
            let grown = (large.powi(2) + small.powi(2)) / mean;
            dirichlet += surface * (grown + mean * (large.powi(-2) + small.powi(-2)));
            largest = largest.max(1.0 / small);
        }
    }
    Some(Distortion {
        stretch_l2: (squares / stretched * mean).sqrt(),
        stretch_max: largest * mean.sqrt(),
        symmetric_dirichlet: dirichlet / stretched,
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
    let mut below = 0.0;
    let mut rest = values.iter().peekable();
    let [q1, q5, q50, q95, q99] = [0.01, 0.05, 0.5, 0.95, 0.99].map(|share| {
        while let Some((_, weight)) = rest.next_if(|v| below + v.1 < share * total) {
            below += weight;
        }
        rest.peek().map_or(last, |v| v.0)
    });
    Some(Quantiles { q1, q5, q50, q95, q99 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2Swizzles as _, dvec2};

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

    /// One triangle of each given pair of corners and rest shape.
    fn layout(triangles: &[([DVec2; 3], DMat2)]) -> Layout {
        Layout {
            points: triangles.iter().flat_map(|t| t.0).collect(),
            triangles: (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            rest: triangles.iter().map(|t| t.1).collect(),
            ..Layout::default()
        }
    }

    const UNIT: [DVec2; 3] = [DVec2::ZERO, DVec2::X, DVec2::Y];

    /// Protects the figures from triangles that do not count: one coordinate that is
    /// not finite, no area in space, or one beyond all numbers, in any order.
    #[test]
    fn what_has_no_figures_does_not_count() {
        let good = ([0.5 * DVec2::ONE, DVec2::ONE, dvec2(0.25, 1.0)], DMat2::IDENTITY);
        let alone = distortion(&layout(&[good]), 64).unwrap();
        assert!((alone.stretch_l2 - alone.stretch_l2.max(1.0)).abs() < 1e-15);
        let mut odd = vec![(UNIT, DMat2::ZERO), (UNIT, DMat2::from_diagonal(DVec2::splat(1e200)))];
        for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for corner in 0..3 {
                let mut corners = UNIT;
                corners[corner].y = broken;
                odd.push((corners, DMat2::IDENTITY));
            }
        }
        // Negative: no contract allows it, and no figure should follow from it.
        odd.push((UNIT, DMat2::from_diagonal(dvec2(-1.0, 1.0))));
        for triangle in odd {
            assert!(distortion(&layout(&[triangle]), 64).is_none(), "{triangle:?}");
            assert_eq!(distortion(&layout(&[good, triangle]), 64).as_ref(), Some(&alone), "{triangle:?}");
            assert_eq!(distortion(&layout(&[triangle, good]), 64).as_ref(), Some(&alone), "{triangle:?}");
        }
        // Scales without a sum: half of the least area that a number can hold.
        let least = dvec2(2.3e-162, 0.0);
        assert!(distortion(&layout(&[([DVec2::ZERO, least, least.yx()], DMat2::IDENTITY)]), 64).is_none());
        // A sum beyond all numbers.
        let far = [DVec2::ZERO, dvec2(1e38, 0.0), DVec2::Y];
        assert!(distortion(&layout(&[(far, DMat2::from_diagonal(dvec2(1e-100, 1e300)))]), 64).is_none());
    }

    /// Protects the figures of a mesh of which one part has no area in the texture:
    /// it lowers the mean and the area scale, and has no stretch and no anisotropy.
    #[test]
    fn triangles_without_texels_have_no_stretch() {
        let flat = [DVec2::ZERO, DVec2::X, 2.0 * DVec2::X];
        let one = (UNIT, DMat2::from_diagonal(dvec2(0.5, 0.25)));
        let none = (flat, DMat2::from_diagonal(dvec2(0.5, 0.75)));
        // Scales 2 and 4 on a surface of 1/16; nothing on 3/16; a mean of 1/2 to 1/4.
        let d = distortion(&layout(&[one, none]), 64).unwrap();
        let close = |value: f64, want: f64| assert!((value - want).abs() < 1e-12, "{value}, not {want}");
        close(d.texels_per_unit, 64.0 * 2f64.sqrt());
        close(d.stretch_max, 0.5 * 2f64.sqrt());
        close(d.stretch_l2, (0.5 * (0.25 + 0.0625) * 2.0f64).sqrt());
        close(d.symmetric_dirichlet, (4.0 + 16.0) / 2.0 + 2.0 * (0.25 + 0.0625));
        assert_eq!((d.area_scale.q1, d.area_scale.q50), (0.0, 0.0));
        close(d.area_scale.q95, 4.0);
        assert_eq!((d.anisotropy.q1, d.anisotropy.q99), (2.0, 2.0));
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
