//! Polygons to triangles.
//!
//! A fan around the first corner covers every convex polygon, and most faces are
//! convex; so the fan is kept wherever all its triangles face the polygon's way.
//! Any other polygon (concave, or with corners in a row on one line) is cut by ear
//! clipping (Meisters 1975) in the plane of its Newell normal. Holes that are
//! joined to the outline by a doubled edge, as exporters write them, are cut well too.
//!
//! Contract: n corners give n − 2 triangles of the polygon's own orientation, and
//! the work is bounded by a budget that is shared by all polygons of a file.

use parbake_model::glam::{DVec2, DVec3};

/// Point tests for all polygons of one file: some seconds of work, and far more
/// than any real file needs.
pub(super) const BUDGET: u64 = 1 << 30;

/// A triangle of places in the polygon's list of corners.
pub(super) type Cut = [usize; 3];

/// How a polygon is best cut.
#[derive(Debug, PartialEq)]
pub(super) enum Plan {
    /// Around its first corner.
    Fan,
    /// So.
    Triangles(Vec<Cut>),
    /// The budget is used up; a fan has to do.
    TooCostly,
}

/// Plans the cutting of a polygon with these corners.
pub(super) fn plan(corners: &[DVec3], budget: &mut u64) -> Plan {
    let Some(points) = flatten(corners) else { return Plan::Fan };
    let from_first = |pair: &[DVec2]| area(points[0], pair[0], pair[1]) > 0.0;
    if points.get(1..).is_none_or(|rest| rest.windows(2).all(from_first)) {
        return Plan::Fan;
    }
    clip_ears(&points, budget).map_or(Plan::TooCostly, Plan::Triangles)
}

/// Twice the signed area of a triangle; positive when counter-clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// The corners in the coordinate plane that the polygon faces most, turned
/// counter-clockwise. `None` when it faces nowhere.
fn flatten(corners: &[DVec3]) -> Option<Vec<DVec2>> {
    let origin = *corners.first()?;
    // Relative to one corner: far from the origin products would lose their low bits.
    let corners: Vec<DVec3> = corners.iter().map(|&c| c - origin).collect();
    let next = corners.iter().cycle().skip(1);
    let normal: DVec3 = corners.iter().zip(next).map(|(a, b)| a.cross(*b)).sum();
    let size = normal.abs();
    let largest = size.max_element();
    if largest.is_nan() || largest <= 0.0 {
        return None;
    }
    let (along, flat): (f64, fn(&DVec3) -> DVec2) = match largest {
        l if l == size.x => (normal.x, |c| DVec2::new(c.y, c.z)),
        l if l == size.y => (normal.y, |c| DVec2::new(c.z, c.x)),
        _ => (normal.z, |c| DVec2::new(c.x, c.y)),
    };
    let turn = if along < 0.0 { DVec2::new(1.0, -1.0) } else { DVec2::ONE };
    Some(corners.iter().map(|c| flat(c) * turn).collect())
}

/// `None` when the budget ends first.
fn clip_ears(points: &[DVec2], budget: &mut u64) -> Option<Vec<Cut>> {
    let mut ring: Vec<usize> = (0..points.len()).collect();
    let mut cuts = Vec::with_capacity(points.len().saturating_sub(2));
    // The corner that is looked at, and how many in a row were no ears.
    let (mut at, mut misses) = (0, 0);
    while ring.len() > 3 {
        let size = ring.len();
        let cut = [ring[(at + size - 1) % size], ring[at], ring[(at + 1) % size]];
        let [a, b, c] = cut.map(|i| points[i]);
        let is_ear = match misses / size {
            0 => {
                *budget = budget.checked_sub(size as u64)?;
                area(a, b, c) > 0.0 && !ring.iter().any(|&i| blocks(points[i], [a, b, c]))
            }
            // Outlines that touch or cross themselves have no ears at times. What
            // has no area is cut off first, then what turns the right way, then anything.
            1 => area(a, b, c) == 0.0,
            2 => area(a, b, c) > 0.0,
            _ => true,
        };
        if is_ear {
            cuts.push(cut);
            ring.remove(at);
            // The next corner is left out for now: two ears in a row make slivers.
            at = if at < ring.len() { (at + 1) % ring.len() } else { 0 };
            misses = 0;
        } else {
            at = (at + 1) % size;
            misses += 1;
        }
    }
    cuts.push([ring[0], ring[1], ring[2]]);
    Some(cuts)
}

/// Whether a point lies in or on the triangle. The triangle's own corners, and
/// others at the same places, are not in the way.
fn blocks(p: DVec2, [a, b, c]: [DVec2; 3]) -> bool {
    p != a && p != b && p != c && area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[(f64, f64)]) -> Vec<DVec3> {
        // In a slanted plane, so that no coordinate is simply left out.
        points.iter().map(|&(x, y)| DVec3::new(x + 10.0, y, 0.3 * x - 0.2 * y)).collect()
    }

    /// The triangles' areas in the plane of x and y.
    fn areas(corners: &[DVec3], plan: &Plan) -> Vec<f64> {
        let Plan::Triangles(cuts) = plan else { panic!("{plan:?}") };
        assert_eq!(cuts.len(), corners.len() - 2);
        cuts.iter()
            .map(|cut| cut.map(|i| corners[i].truncate()))
            .map(|[a, b, c]| area(a, b, c) / 2.0)
            .collect()
    }

    /// Protects the usual case, and the order of triangles in files without concave faces.
    #[test]
    fn convex_polygons_are_fans() {
        let square = polygon(&[(0., 0.), (1., 0.), (1., 1.), (0., 1.)]);
        assert_eq!(plan(&square, &mut 0), Plan::Fan);
        assert_eq!(plan(&square[..3], &mut 0), Plan::Fan);
        assert_eq!(plan(&[], &mut 0), Plan::Fan);
        assert_eq!(plan(&[DVec3::ONE; 5], &mut 0), Plan::Fan, "without area");
    }

    /// Protects concave faces: the triangles cover the polygon and nothing else.
    #[test]
    fn concave_polygons_are_covered_exactly() {
        let arrow = [(0., 0.), (4., -3.), (1., 0.), (4., 3.)];
        let comb = [(0., 0.), (7., 0.), (7., 3.), (6., 1.), (5., 3.), (4., 1.), (3., 3.), (2., 1.), (0., 3.)];
        let in_a_row = [(0., 0.), (1., 0.), (2., 0.), (2., 2.), (0., 2.)];
        let hole = [
            (0., 0.),
            (4., 0.),
            (4., 4.),
            (0., 4.),
            (0., 0.),
            (1., 1.),
            (1., 3.),
            (3., 3.),
            (3., 1.),
            (1., 1.),
        ];
        for (points, whole) in [(&arrow[..], 3.0), (&comb, 14.0), (&in_a_row, 4.0), (&hole, 12.0)] {
            for turns in 0..points.len() {
                let mut points = points.to_vec();
                points.rotate_left(turns);
                let mut corners = polygon(&points);
                for side in [1.0, -1.0] {
                    if plan(&corners, &mut 1000) != Plan::Fan {
                        let areas = areas(&corners, &plan(&corners, &mut 1000));
                        assert!(areas.iter().all(|a| a * side >= 0.0), "{points:?}: {areas:?}");
                        let sum: f64 = areas.iter().sum();
                        assert!((sum * side - whole).abs() < 1e-9, "{points:?}: {areas:?}");
                    }
                    corners.reverse();
                }
            }
        }
    }

    /// Protects against outlines that cross themselves, and against endless work.
    #[test]
    fn crossing_outlines_end_and_work_is_bounded() {
        let bow = polygon(&[(0., 0.), (2., 2.), (2., 0.), (0., 3.), (1., 5.)]);
        areas(&bow, &plan(&bow, &mut 1000));
        let spikes: Vec<_> = (0..2000).map(|i| (f64::from(i), f64::from(i % 2 * (i + 1)))).collect();
        let mut budget = 100_000;
        assert_eq!(plan(&polygon(&spikes), &mut budget), Plan::TooCostly);
    }
}
