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

    /// Protects every step of clipping: a hexagon far from symmetry (worked out with
    /// fractions), wherever the corners begin, whichever triangle comes first, and away
    /// from the origin.
    #[test]
    fn a_known_hexagon_is_left() {
        let a = [dvec2(1.0, 1.0), dvec2(7.0, 1.0), dvec2(4.0, 7.0)];
        let b = [dvec2(3.0, -1.0), dvec2(8.0, 6.0), dvec2(1.0, 4.0)];
        let turned = |[a, b, c]: [DVec2; 3], by: usize| [[a, b, c], [b, c, a], [c, a, b]][by];
        let centre = dvec2(5_748_267_937.0 / 1_522_619_280.0, 63_123_413.0 / 21_751_704.0);
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            for by in [DVec2::ZERO, dvec2(-100.0, 30.0)] {
                let (a, b) = (moved(turned(a, i), by), moved(turned(b, j), by));
                for (area, centroid) in [intersection(a, b).unwrap(), intersection(b, a).unwrap()] {
                    assert!((area - 231_023.0 / 19_040.0).abs() < 1e-12, "{area}");
                    assert!(centroid.distance(centre + by) < 1e-12, "{centroid}");
                }
            }
        }
    }

    /// Protects digits: a corner on an edge is neither clipped nor doubled by a rounded
    /// copy of itself, so that what is left is, to the last bit, what is left where no
    /// edge is near.
    #[test]
    fn corners_on_edges_stay_as_they_are() {
        let around = [dvec2(0.0, 0.0), dvec2(4_096.0, 0.0), dvec2(0.0, 4_096.0)];
        let wider = [dvec2(0.0, 0.0), dvec2(4_096.0, -64.0), dvec2(-64.0, 8_192.0)];
        for i in 0..50 {
            // Numbers whose sums and differences round, and slivers, which feel it.
            let [x, y, z] = [0.1, 0.7, 1.3].map(|start| start + f64::from(i) / 7.0);
            let (on, far) = (dvec2(x, 0.0), dvec2(y + 1_000.0, 1.0));
            let inside = [on, on.midpoint(far) - dvec2(0.0, 1e-3), far];
            assert_eq!(intersection(inside, around), intersection(inside, wider), "{inside:?}");
            let (on, right, left) = (dvec2(0.0, x), dvec2(z, 500.0), dvec2(-y, 1_000.0 + y));
            let cut = right + (left - right) * (z / (z + y));
            let (whole, part) = ([right, left, on], [right, cut, on]);
            assert_eq!(intersection(whole, around), intersection(part, wider), "{whole:?}");
        }
    }

    /// Protects both triangles' part in the search for a line between two: each of the
    /// six edges may be the only one that separates.
    #[test]
    fn every_edge_may_separate() {
        let turned = |[a, b, c]: [DVec2; 3], by: usize| [[a, b, c], [b, c, a], [c, a, b]][by];
        let corner = [dvec2(0.5, 0.5), dvec2(2.0, 0.75), dvec2(0.75, 2.0)];
        let pushed = corner.map(|p| p - f64::EPSILON);
        for by in 0..3 {
            let unit = turned(UNIT, by);
            assert!(!positive_triangles_overlap(unit, corner) && !positive_triangles_overlap(corner, unit));
            assert!(positive_triangles_overlap(unit, pushed) && positive_triangles_overlap(pushed, unit));
        }
    }

    /// Protects touching segments: an end on the other segment, whichever end of which,
    /// on whichever side; a common end; an end before the other's; and what misses by
    /// the smallest step of an `f32`.
    #[test]
    fn segments_meet_at_any_of_their_ends() {
        let both_ways = |a: [DVec2; 2], b: [DVec2; 2]| {
            let turned = |[p, q]: [DVec2; 2]| [[p, q], [q, p]];
            let all = turned(a).into_iter().flat_map(|a| turned(b).map(|b| (a, b)));
            let answers: Vec<bool> =
                all.flat_map(|(a, b)| [segments_meet(a, b), segments_meet(b, a)]).collect();
            assert!(answers.iter().all(|&x| x == answers[0]), "{a:?} {b:?} {answers:?}");
            answers[0]
        };
        let base = [dvec2(-1.0, -1.0), dvec2(3.0, 1.0)];
        let on = dvec2(1.0, 0.0);
        let step = f64::from(f32::EPSILON);
        for (off, away) in [(dvec2(0.5, 2.0), dvec2(0.0, step)), (dvec2(1.5, -2.0), dvec2(0.0, -step))] {
            assert!(both_ways(base, [on, off]));
            assert!(!both_ways(base, [on + away, off]));
            assert!(both_ways(base, [base[0], off]));
            assert!(both_ways(base, [base[1], off]));
        }
        // On one line: end to end, within, and with a gap.
        let along = dvec2(4.0, 2.0);
        assert!(both_ways(base, [base[1], base[1] + along]));
        assert!(both_ways(base, [base[0] + 0.25 * along, base[0] + 0.75 * along]));
        assert!(!both_ways(base, [base[1] + step * along, base[1] + along]));
        // Boxes that meet, with the one or the other segment on one side.
        assert!(!both_ways(base, [dvec2(-0.5, 0.5), dvec2(1.0, 0.5)]));
        assert!(!both_ways([DVec2::ZERO, DVec2::ONE], [dvec2(0.625, 0.5), dvec2(4.0, 0.25)]));
        // A point on a segment, at its end, and beside it.
        assert!(both_ways(base, [on; 2]) && both_ways(base, [base[0]; 2]));
        assert!(!both_ways(base, [on + dvec2(0.0, step); 2]));
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
