//! How far points may move before a triangle turns over.
//!
//! With the two edges e₁, e₂ of a triangle and their velocities d₁, d₂, twice its
//! signed area after a step t is the quadratic
//!
//! `area(t) = A + B t + C t²`, `A = e₁×e₂`, `B = e₁×d₂ + d₁×e₂`, `C = d₁×d₂`,
//!
//! whose smallest positive root bounds the step (Smith and Schaefer 2015, "Bijective
//! Parameterization with Free Boundaries"). The root is taken in the form that does
//! not cancel, `2A / (−B + √(B² − 4AC))`.
//!
//! Contract: the triangles given are those that must stay upright, and are upright at
//! the start ([`upright`]); all others are left out by the caller. The bound is exact
//! up to rounding, so a caller takes a share of it (0.8 or 0.9) and lets
//! [`all_upright`], which is exact, judge where it arrives.

use glam::DVec2;
use parbake_atlas::Layout;
use rayon::prelude::*;
use robust::{Coord, orient2d};

/// Triangles that one task looks at.
const BAND: usize = 1024;

/// The triangles of a layout that have a positive signed area, decided exactly, in the
/// layout's order: those that must keep it.
pub fn upright(layout: &Layout) -> Vec<[u32; 3]> {
    layout.triangles.iter().filter(|t| doubled_area(**t, &layout.points) > 0.0).copied().collect()
}

/// Whether all triangles have a positive signed area at `points`, decided exactly;
/// false where a coordinate is not a number.
pub fn all_upright(triangles: &[[u32; 3]], points: &[DVec2]) -> bool {
    triangles.par_chunks(BAND).all(|band| band.iter().all(|&t| doubled_area(t, points) > 0.0))
}

/// The largest t in [0, `limit`] up to which no triangle's signed area reaches zero
/// while each point moves from `points` to `points + t · direction`.
///
/// Zero where a triangle is not upright at the start, and where a direction that
/// concerns a triangle is not finite.
pub fn max_step(triangles: &[[u32; 3]], points: &[DVec2], direction: &[DVec2], limit: f64) -> f64 {
    triangles
        .par_chunks(BAND)
        .map(|band| {
            band.iter().fold(limit, |least, &t| {
                if stays_upright(t, points, direction, least) {
                    least
                } else {
                    least.min(step_of(t, points, direction))
                }
            })
        })
        .reduce(|| limit, f64::min)
        .max(0.0)
}

/// Looks at the slowed directions at most so many times.
const SLOWINGS: usize = 4;

/// Slows points down whose triangles would turn over before the step `limit`, so that these few do
/// not bound the step of all: each point by the least share of `limit` that its triangles come to.
///
/// Points slowed differently may close another triangle, so it looks again, a few times; what is
/// left [`max_step`] bounds.
pub fn slow_down(triangles: &[[u32; 3]], points: &[DVec2], direction: &mut [DVec2], limit: f64) {
    let mut slowed = vec![true; points.len()];
    for _ in 0..SLOWINGS {
        let share = |t: [u32; 3]| step_of(t, points, direction) / limit;
        let tight: Vec<([u32; 3], f64)> = triangles
            .par_chunks(BAND)
            .flat_map_iter(|band| {
                band.iter()
                    .filter(|t| t.iter().any(|i| slowed[*i as usize]))
                    .filter(|t| !stays_upright(**t, points, direction, limit))
                    .map(|t| (*t, share(*t)))
                    .filter(|(_, share)| *share < 1.0)
            })
            .collect();
        if tight.is_empty() {
            return;
        }
        let mut shares = vec![1.0f64; points.len()];
        for (triangle, share) in tight {
            for i in triangle {
                shares[i as usize] = shares[i as usize].min(share);
            }
        }
        for ((direction, slowed), share) in direction.iter_mut().zip(&mut slowed).zip(shares) {
            *slowed = share < 1.0;
            *direction *= share;
        }
    }
}

/// Whether a triangle surely stays upright up to the step `limit`: its area outweighs all that its
/// change can come to, with room for rounding. False says nothing; it spares most triangles the root.
#[inline]
fn stays_upright(triangle: [u32; 3], points: &[DVec2], direction: &[DVec2], limit: f64) -> bool {
    const ROUNDING: f64 = 1e-9;
    let [a, b, c] = triangle.map(|i| points[i as usize]);
    let [da, db, dc] = triangle.map(|i| direction[i as usize]);
    let (e1, e2, d1, d2) = (b - a, c - a, db - da, dc - da);
    let area = e1.perp_dot(e2);
    let change = (e1.perp_dot(d2) + d1.perp_dot(e2)).min(0.0) + d1.perp_dot(d2).min(0.0) * limit;
    let size = (e1.x.abs() + e1.y.abs() + (d1.x.abs() + d1.y.abs()) * limit)
        * (e2.x.abs() + e2.y.abs() + (d2.x.abs() + d2.y.abs()) * limit);
    area + change * limit > ROUNDING * size
}

/// Twice the signed area with its exact sign.
fn doubled_area(triangle: [u32; 3], points: &[DVec2]) -> f64 {
    let [a, b, c] = triangle.map(|i| points[i as usize]).map(|p| Coord { x: p.x, y: p.y });
    orient2d(a, b, c)
}

/// The step at which one triangle's area reaches zero; infinite where it never does.
fn step_of(triangle: [u32; 3], points: &[DVec2], direction: &[DVec2]) -> f64 {
    let area = doubled_area(triangle, points);
    let [a, b, c] = triangle.map(|i| points[i as usize]);
    let [da, db, dc] = triangle.map(|i| direction[i as usize]);
    // Of unit size, so that no product of a huge direction overflows.
    let scale = [da, db, dc].iter().fold(0.0, |s: f64, d| s.max(d.x.abs()).max(d.y.abs()));
    if !(da + db + dc).is_finite() || area.is_nan() || area <= 0.0 {
        return 0.0;
    }
    if scale == 0.0 {
        return f64::INFINITY;
    }
    let (e1, e2) = (b - a, c - a);
    let (d1, d2) = (db / scale - da / scale, dc / scale - da / scale);
    let linear = e1.perp_dot(d2) + d1.perp_dot(e2);
    smallest_positive_root(area, linear, d1.perp_dot(d2)) / scale
}

/// The smallest positive root of `constant + linear · t + square · t²` where the
/// constant is positive; infinite without one.
fn smallest_positive_root(constant: f64, linear: f64, square: f64) -> f64 {
    let discriminant = linear * linear - 4.0 * constant * square;
    // A parabola that touches zero may miss it by rounding: better to stop there.
    if discriminant < -1e-12 * linear * linear {
        return f64::INFINITY;
    }
    let root = discriminant.max(0.0).sqrt();
    if linear < 0.0 {
        2.0 * constant / (root - linear)
    } else if square < 0.0 {
        // The same root; here it is this form that does not cancel.
        (linear + root) / (-2.0 * square)
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;
    use proptest::prelude::*;

    /// Protects slowing down: the tip that falls is held back, what is not near it keeps its way, and
    /// nothing then turns over before the limit.
    #[test]
    fn slows_down_only_what_is_tight() {
        let points = [(0, 0), (2, 0), (1, 1), (9, 0), (11, 0), (10, 1)];
        let points = points.map(|(x, y)| dvec2(f64::from(x), f64::from(y)));
        let triangles = [[0, 1, 2], [3, 4, 5]];
        let falling = dvec2(0.0, -4.0);
        let mut direction = [DVec2::ZERO, DVec2::ZERO, falling, DVec2::ZERO, DVec2::ZERO, dvec2(0.0, -0.5)];
        slow_down(&triangles, &points, &mut direction, 1.0);
        assert!(direction[2].y < -0.99 && max_step(&triangles, &points, &direction, 1.0) > 1.0 - 1e-9);
        assert_eq!(direction[5], dvec2(0.0, -0.5));
    }

    /// Protects the three kinds of root by triangles on which they can be counted.
    #[test]
    fn roots_by_hand() {
        let points = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(0.0, 1.0)];
        let step = |d: [DVec2; 3]| max_step(&[[0, 1, 2]], &points, &d, 10.0);
        // The tip falls through the base.
        assert_eq!(step([DVec2::ZERO, DVec2::ZERO, dvec2(0.0, -0.5)]), 2.0);
        // It shrinks to a point: a double root.
        assert!((step([DVec2::ZERO, dvec2(-1.0, 0.0), dvec2(0.0, -1.0)]) - 1.0).abs() < 1e-6);
        // It grows, moves or stands still.
        assert_eq!(step([DVec2::ZERO, dvec2(1.0, 0.0), dvec2(0.0, 1.0)]), 10.0);
        assert_eq!(step([dvec2(3.0, 4.0); 3]), 10.0);
        assert_eq!(step([DVec2::ZERO; 3]), 10.0);
        // Growing at first, then turned over: B = 0, C < 0.
        assert_eq!(step([DVec2::ZERO, dvec2(0.0, 0.5), dvec2(0.5, 0.0)]), 2.0);
        // Huge and broken directions.
        assert!(step([DVec2::ZERO, DVec2::ZERO, dvec2(0.0, -1e300)]) > 0.0);
        assert_eq!(step([DVec2::NAN; 3]), 0.0);
    }

    /// Protects the choice of the triangles that are watched.
    #[test]
    fn only_upright_triangles_are_watched() {
        let layout = Layout {
            points: vec![dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(0.0, 1.0), dvec2(2.0, 0.0)],
            triangles: vec![[0, 1, 2], [0, 2, 1], [0, 1, 3]],
            ..Layout::default()
        };
        assert_eq!(upright(&layout), [[0, 1, 2]]);
        assert!(all_upright(&[[0, 1, 2]], &layout.points));
        assert!(!all_upright(&layout.triangles, &layout.points));
        assert!(!all_upright(&[[0, 1, 2]], &[DVec2::NAN; 3]));
    }

    proptest! {
        /// Protects the short cut around the root: it clears no triangle that the root does not.
        #[test]
        fn the_short_cut_agrees_with_the_root(
            v in proptest::collection::vec(-1.0f64..1.0, 12),
            limit in 0.01f64..1.0,
        ) {
            let points = [dvec2(v[0], v[1]), dvec2(v[2], v[3]), dvec2(v[4], v[5])];
            let direction = [dvec2(v[6], v[7]), dvec2(v[8], v[9]), dvec2(v[10], v[11])];
            prop_assume!(doubled_area([0, 1, 2], &points) > 0.0);
            if stays_upright([0, 1, 2], &points, &direction, limit) {
                prop_assert!(step_of([0, 1, 2], &points, &direction) >= limit);
            }
        }

        /// Protects the bound against sampling: nothing turns over before it, and at it
        /// the area is zero.
        #[test]
        fn the_step_is_the_first_zero(v in proptest::collection::vec(-1.0f64..1.0, 12)) {
            let points = [dvec2(v[0], v[1]), dvec2(v[2], v[3]), dvec2(v[4], v[5])];
            let direction = [dvec2(v[6], v[7]), dvec2(v[8], v[9]), dvec2(v[10], v[11])];
            let area = |t: f64| {
                let [a, b, c] = [0, 1, 2].map(|k| points[k] + t * direction[k]);
                (b - a).perp_dot(c - a)
            };
            prop_assume!(area(0.0) > 1e-9);
            let limit = 4.0;
            let step = max_step(&[[0, 1, 2]], &points, &direction, limit);
            for k in 0..1000 {
                prop_assert!(area(step * f64::from(k) / 1000.0) > 0.0);
            }
            if step < limit {
                prop_assert!(area(step).abs() < 1e-9);
            }
        }
    }
}
