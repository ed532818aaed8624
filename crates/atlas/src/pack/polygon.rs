//! Plane geometry that packing needs: convex hulls, boxes and strips.

use glam::{DVec2, dvec2};

/// The convex hull, counter-clockwise, without collinear points (Andrew's monotone
/// chain). Fewer than three points for what has no area.
pub(super) fn convex_hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    let mut hull: Vec<DVec2> = Vec::with_capacity(sorted.len() + 1);
    for half in 0..2 {
        let start = hull.len();
        for i in 0..sorted.len() {
            let p = sorted[if half == 0 { i } else { sorted.len() - 1 - i }];
            while hull.len() >= start + 2 {
                let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
                if (b - a).perp_dot(p - a) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(p);
        }
        hull.pop();
    }
    hull
}

/// The direction (unit vector) of a side of the smallest box around a convex hull by
/// `measure(width, height)`; +X for what has no extent.
pub(super) fn best_box_direction(hull: &[DVec2], measure: impl Fn(f64, f64) -> f64) -> DVec2 {
    // A side of the smallest box lies on a side of the hull (Freeman and Shapira 1975);
    // of very round hulls some sides will do.
    let step = hull.len().div_ceil(256).max(1);
    let mut best = (f64::INFINITY, DVec2::X);
    for i in (0..hull.len()).step_by(step) {
        let Some(x) = (hull[(i + 1) % hull.len()] - hull[i]).try_normalize() else { continue };
        let (low, high) = bounds(hull.iter().map(|&p| dvec2(p.dot(x), p.dot(x.perp()))));
        let size = high - low;
        let value = measure(size.x, size.y);
        if value < best.0 * (1.0 - 1e-9) {
            best = (value, x);
        }
    }
    best.1
}

/// Lower and upper corner of the box around points.
pub(super) fn bounds(points: impl Iterator<Item = DVec2>) -> (DVec2, DVec2) {
    points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// The x range of the part of a convex polygon (also a segment or a point) that lies in
/// the strip `low <= y <= high`, or `None`.
pub(super) fn range_in_strip(polygon: &[DVec2], low: f64, high: f64) -> Option<(f64, f64)> {
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut include = |x: f64| {
        left = left.min(x);
        right = right.max(x);
    };
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        if (low..=high).contains(&a.y) {
            include(a.x);
        }
        for y in [low, high] {
            if (a.y < y) != (b.y < y) {
                include(a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)));
            }
        }
    }
    (left <= right).then_some((left, right))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the orientation search, on which all packing of boxes rests.
    #[test]
    fn a_turned_box_is_found() {
        let x = DVec2::from_angle(0.4);
        let points: Vec<DVec2> = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (0.0, 1.0), (1.5, 0.5), (1.0, 0.0)]
            .map(|(u, v)| x * u + x.perp() * v)
            .to_vec();
        let hull = convex_hull(&points);
        assert!((4..=5).contains(&hull.len()));
        let found = best_box_direction(&hull, |w, h| w * h);
        assert!(found.dot(x).abs().max(found.dot(x.perp()).abs()) > 1.0 - 1e-9);
        assert_eq!(convex_hull(&[DVec2::ONE; 3]).len(), 0);
        assert_eq!(best_box_direction(&[], |w, h| w * h), DVec2::X);
    }

    /// Protects the rows that are rasterised: too narrow a range would lose the gutter.
    #[test]
    fn strips_cut_polygons_where_they_should() {
        let triangle = [dvec2(0.0, 0.0), dvec2(4.0, 0.0), dvec2(0.0, 4.0)];
        assert_eq!(range_in_strip(&triangle, 1.0, 2.0), Some((0.0, 3.0)));
        assert_eq!(range_in_strip(&triangle, 4.5, 5.0), None);
        assert_eq!(range_in_strip(&[dvec2(1.0, 0.5)], 0.0, 1.0), Some((1.0, 1.0)));
    }
}
