//! Questions about points, edges and triangles of the plane, answered exactly.
//!
//! All answers are decided by the sign of one determinant, the orientation of three
//! points, evaluated with Shewchuk's adaptive arithmetic ("Adaptive Precision
//! Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997; crate
//! `robust`). The sign is that of the real number, whatever the rounding, for all
//! coordinates that `f32` can hold and for all `f64` whose products neither overflow
//! nor underflow. Areas and places are rounded in the ordinary way.

use glam::DVec2;
use robust::{Coord, orient2d};

/// Twice the signed area of a triangle: positive where `a`, `b`, `c` run
/// counter-clockwise (x right, y up), exactly 0 where they lie on one line. The sign
/// is exact; the value is rounded, with a small relative error even for slivers.
#[inline]
pub fn orientation(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Whether the interiors of two triangles meet. Triangles that share an edge or a
/// corner, or touch, do not overlap; a triangle without area has no interior. The
/// corners may run either way around.
pub fn triangles_overlap(a: [DVec2; 3], b: [DVec2; 3]) -> bool {
    match (counter_clockwise(a), counter_clockwise(b)) {
        (Some(a), Some(b)) => positive_triangles_overlap(a, b),
        _ => false,
    }
}

/// As [`triangles_overlap`], for triangles that are known to have positive areas.
///
/// The interiors of two convex polygons are disjoint exactly if the line through an
/// edge of one of them has the other one on its right or on it: the edges of their
/// Minkowski difference are parallel to theirs.
#[inline]
pub fn positive_triangles_overlap(a: [DVec2; 3], b: [DVec2; 3]) -> bool {
    let separates = |one: &[DVec2; 3], other: &[DVec2; 3]| {
        (0..3).any(|k| other.iter().all(|&p| orientation(one[k], one[(k + 1) % 3], p) <= 0.0))
    };
    !separates(&a, &b) && !separates(&b, &a)
}

/// The triangle with its corners counter-clockwise; `None` where it has no area.
#[inline]
pub fn counter_clockwise([a, b, c]: [DVec2; 3]) -> Option<[DVec2; 3]> {
    let doubled_area = orientation(a, b, c);
    if doubled_area > 0.0 {
        Some([a, b, c])
    } else if doubled_area < 0.0 {
        Some([a, c, b])
    } else {
        None
    }
}

/// Whether two closed segments have a point in common. Either may be a single point.
pub fn segments_meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let boxes_meet = a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all();
    // On one side, both off the line; not a product, which could underflow.
    let one_side = |p: f64, q: f64| (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
    boxes_meet
        && !one_side(orientation(a, b, c), orientation(a, b, d))
        && !one_side(orientation(c, d, a), orientation(c, d, b))
}

/// Area and centroid of what two counter-clockwise triangles have in common, rounded;
/// `None` where nothing is left after rounding. Sutherland and Hodgman's clipping.
pub fn intersection(a: [DVec2; 3], b: [DVec2; 3]) -> Option<(f64, DVec2)> {
    // Relative to a corner, so that small triangles far from the origin keep digits.
    let origin = b[0];
    let mut polygon: Vec<DVec2> = Vec::with_capacity(8);
    polygon.extend(a.map(|p| p - origin));
    let mut clipped = Vec::with_capacity(8);
    for k in 0..3 {
        let (from, to) = (b[k] - origin, b[(k + 1) % 3] - origin);
        let side = |p: DVec2| (to - from).perp_dot(p - from);
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let (at_p, at_q) = (side(p), side(q));
            if at_p >= 0.0 {
                clipped.push(p);
            }
            if (at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0) {
                clipped.push(p + (q - p) * (at_p / (at_p - at_q)));
            }
        }
        std::mem::swap(&mut polygon, &mut clipped);
        clipped.clear();
    }
    let &first = polygon.first()?;
    let (mut doubled_area, mut moment) = (0.0, DVec2::ZERO);
    for pair in polygon.windows(2) {
        let doubled = (pair[0] - first).perp_dot(pair[1] - first);
        doubled_area += doubled;
        moment += doubled * (pair[0] - first + pair[1] - first) / 3.0;
    }
    (doubled_area > 0.0).then(|| (0.5 * doubled_area, origin + first + moment / doubled_area))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    const UNIT: [DVec2; 3] = [DVec2::ZERO, DVec2::X, DVec2::Y];

    fn moved(triangle: [DVec2; 3], by: DVec2) -> [DVec2; 3] {
        triangle.map(|p| p + by)
    }

    /// Protects the sign convention and exactness where rounding gives the wrong
    /// sign or none.
    #[test]
    fn orientations_are_exact() {
        assert_eq!(orientation(UNIT[0], UNIT[1], UNIT[2]), 1.0);
        let (a, b) = (dvec2(12.0, 12.0), dvec2(24.0, 24.0));
        let off = dvec2(0.5, f64::from_bits(0.5f64.to_bits() + 1));
        assert!(orientation(a, b, off) > 0.0);
        assert!(orientation(b, a, off) < 0.0);
        let tiny = f64::from(f32::from_bits(1));
        assert_eq!(orientation(DVec2::ZERO, dvec2(tiny, 0.0), dvec2(0.0, tiny)), tiny * tiny);
    }

    /// Protects "touching is no overlap", either winding, and triangles inside others.
    #[test]
    fn overlaps_are_of_interiors() {
        let mirrored = [UNIT[0], UNIT[2], UNIT[1]];
        let flat = [dvec2(0.1, 0.1), dvec2(0.2, 0.2), dvec2(0.3, 0.3)];
        let inside = [dvec2(0.1, 0.1), dvec2(0.3, 0.1), dvec2(0.1, 0.3)];
        assert!(triangles_overlap(UNIT, UNIT));
        assert!(triangles_overlap(UNIT, mirrored));
        assert!(triangles_overlap(UNIT, inside) && triangles_overlap(inside, mirrored));
        assert!(!triangles_overlap(UNIT, flat) && !triangles_overlap(flat, UNIT));
        // A common edge, a common corner, an edge against a corner, and apart.
        assert!(!triangles_overlap(UNIT, [DVec2::X, DVec2::ONE, DVec2::Y]));
        assert!(!triangles_overlap(UNIT, moved(UNIT, DVec2::X)));
        assert!(!triangles_overlap(UNIT, [dvec2(0.5, 0.5), DVec2::ONE, dvec2(0.5, 1.0)]));
        assert!(!triangles_overlap(UNIT, moved(UNIT, DVec2::splat(2.0))));
        // The same by the smallest step of an f32.
        let step = f64::from(f32::EPSILON);
        assert!(triangles_overlap(UNIT, moved(UNIT, dvec2(1.0 - step, 0.0))));
    }

    /// Protects area and centroid of a known intersection.
    #[test]
    fn intersections_have_known_areas() {
        let (area, centroid) = intersection(UNIT, moved(UNIT, dvec2(0.5, 0.0))).unwrap();
        assert!((area - 0.125).abs() < 1e-15);
        assert!(centroid.distance(dvec2(2.0 / 3.0, 0.5 / 3.0)) < 1e-15);
        assert_eq!(intersection(UNIT, moved(UNIT, DVec2::X)), None);
        let (area, centroid) = intersection(UNIT, UNIT).unwrap();
        assert!((area - 0.5).abs() < 1e-15);
        assert!(centroid.distance(DVec2::splat(1.0 / 3.0)) < 1e-15);
    }

    /// Protects crossing, touching, collinear and one-point segments.
    #[test]
    fn segments_meet_where_they_touch() {
        let across = [dvec2(0.0, 1.0), dvec2(1.0, 0.0)];
        assert!(segments_meet([DVec2::ZERO, DVec2::ONE], across));
        assert!(segments_meet([DVec2::ZERO, dvec2(0.5, 0.5)], across));
        assert!(!segments_meet([DVec2::ZERO, dvec2(0.4, 0.5)], across));
        assert!(segments_meet([DVec2::ZERO, DVec2::X], [dvec2(0.9, 0.0), dvec2(2.0, 0.0)]));
        assert!(!segments_meet([DVec2::ZERO, DVec2::X], [dvec2(1.1, 0.0), dvec2(2.0, 0.0)]));
        assert!(segments_meet([dvec2(0.5, 0.5); 2], across));
        assert!(!segments_meet([dvec2(0.5, 0.6); 2], across));
        assert!(segments_meet([DVec2::ONE; 2], [DVec2::ONE; 2]));
    }
}
