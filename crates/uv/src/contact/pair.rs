//! A vertex against an edge: their distance, its gradient, and the time of impact.
//!
//! All of it is told by the vertex relative to the edge's two ends, `r_a = v − a` and
//! `r_b = v − b`: the distance is that of the origin to the segment from r_a to r_b.
//!
//! The time of impact is conservative advancement as in additive continuous collision
//! detection (Li, Kaufman, Jiang 2021, "Codimensional Incremental Potential Contact"),
//! with a sharper bound of the motion. There, a step is the gap divided by the largest
//! relative speed. Here n is the direction from the closest point of the edge to the
//! vertex; both ends have `n·r ≥ distance`, both change linearly, and the distance
//! never falls below the smaller one. A step goes to where the first of the two falls
//! to the distance to be kept, n also being tilted a little if this lets it go further.
//! A vertex that slides along an edge thus costs one step and not as many as gaps fit
//! into its way.

use glam::DVec2;

/// Share of the gap that a step keeps at the least.
pub(super) const KEPT: f64 = 0.1;

/// Most steps of an advancement; stopping early only makes the time shorter.
const MOST_STEPS: usize = 256;

/// A vertex relative to both ends of an edge, or the velocity of this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Relative {
    pub a: DVec2,
    pub b: DVec2,
}

/// Where the vertex is nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Closest {
    /// From the closest point of the edge to the vertex.
    pub offset: DVec2,
    /// Its length.
    pub distance: f64,
    /// Where on the edge: 0 at a, 1 at b.
    pub along: f64,
}

impl Relative {
    #[inline]
    pub fn new(vertex: DVec2, [a, b]: [DVec2; 2]) -> Self {
        Self { a: vertex - a, b: vertex - b }
    }

    #[inline]
    pub fn closest(&self) -> Closest {
        let edge = self.b - self.a;
        let square = edge.length_squared();
        let along = if square > 0.0 { (-self.a.dot(edge) / square).clamp(0.0, 1.0) } else { 0.0 };
        // From the nearer end, so that the far half of an edge is as exact as the near one.
        let offset = if along < 0.5 { self.a + along * edge } else { self.b - (1.0 - along) * edge };
        Closest { offset, distance: offset.length(), along }
    }

    /// The unit vector from the closest point of the edge to the vertex. Beside the edge it is the
    /// edge's perpendicular: a short offset's own direction is off by its rounding over its length, and
    /// that, times the way to a far end, can be more than the gap.
    #[inline]
    fn normal(&self, closest: &Closest) -> DVec2 {
        let across = (self.b - self.a).perp().normalize_or_zero();
        if closest.along > 0.0 && closest.along < 1.0 && across != DVec2::ZERO {
            across * across.dot(closest.offset).signum()
        } else {
            closest.offset / closest.distance
        }
    }

    /// The largest t in [0, `limit`] up to which the distance stays at or above
    /// `minimum` plus [`KEPT`] times the gap at the start. Zero where there is no gap
    /// and they do not part. Conservative: it may be shorter, never longer.
    ///
    /// Velocities must be finite, and their squares too.
    pub fn time_of_impact(&self, velocity: &Self, minimum: f64, limit: f64) -> f64 {
        let mut closest = self.closest();
        let gap = (closest.distance - minimum).max(0.0);
        let keep = minimum + KEPT * gap;
        let near_enough = minimum + 1.1 * KEPT * gap;
        let mut at = *self;
        let mut time = 0.0;
        for _ in 0..MOST_STEPS {
            if closest.distance == 0.0 {
                return time;
            }
            let normal = at.normal(&closest);
            let mut step = at.step_along(normal, velocity, keep);
            if time + step < limit {
                step = step.max(at.step_along_tilted(normal, velocity, keep));
            }
            if time + step >= limit {
                return limit;
            }
            time += step;
            at = Self { a: self.a + time * velocity.a, b: self.b + time * velocity.b };
            closest = at.closest();
            if step == 0.0 || closest.distance <= near_enough {
                return time;
            }
        }
        time
    }
}

impl Relative {
    /// How long both ends stay at or beyond `keep` along a unit vector.
    #[inline]
    fn step_along(&self, normal: DVec2, velocity: &Self, keep: f64) -> f64 {
        let mut step = f64::INFINITY;
        for (place, rate) in [(self.a, velocity.a), (self.b, velocity.b)] {
            let closing = -normal.dot(rate);
            if closing > 0.0 {
                step = step.min((normal.dot(place) - keep).max(0.0) / closing);
            }
        }
        step
    }

    /// The same along a normal that is tilted so that both ends last about equally long:
    /// without it, a long edge that turns about a near end is bounded by its far one.
    /// Zero where the tilted normal does not separate.
    fn step_along_tilted(&self, normal: DVec2, velocity: &Self, keep: f64) -> f64 {
        let tangent = normal.perp();
        let room = [self.a, self.b].map(|place| normal.dot(place) - keep);
        let aside = [self.a, self.b].map(|place| tangent.dot(place));
        let closing = [velocity.a, velocity.b].map(|rate| -normal.dot(rate));
        // An end that parts bounds nothing, but the tilt must leave it some room.
        let least = 1e-3 * closing[0].max(closing[1]);
        let [a, b] = closing.map(|c| c.max(least));
        let tilt = (room[1] * a - room[0] * b) / (aside[0] * b - aside[1] * a);
        let tilted = (normal + tilt * tangent).normalize_or_zero();
        let separates = |place: DVec2| tilted.dot(place) >= keep;
        if separates(self.a) && separates(self.b) && tilted != DVec2::ZERO {
            self.step_along(tilted, velocity, keep)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = DVec2> {
        (-size..size, -size..size).prop_map(|(x, y)| dvec2(x, y))
    }

    /// Protects the distance beside an edge, beyond its ends, and of an edge without length.
    #[test]
    fn distances_by_hand() {
        let distance = |v: DVec2, a: DVec2, b: DVec2| Relative::new(v, [a, b]).closest();
        let (a, b) = (dvec2(0.0, 0.0), dvec2(2.0, 0.0));
        assert_eq!(distance(dvec2(0.5, 3.0), a, b).distance, 3.0);
        assert_eq!(distance(dvec2(0.5, 3.0), a, b).along, 0.25);
        assert_eq!(distance(dvec2(5.0, 4.0), a, b).distance, 5.0);
        assert_eq!(distance(dvec2(-3.0, 4.0), a, b).along, 0.0);
        assert_eq!(distance(dvec2(3.0, 4.0), a, a).distance, 5.0);
    }

    /// Protects gaps that are far smaller than a long edge's rounding suggests: the vertex must not
    /// get through although one end of the edge parts from it.
    #[test]
    fn a_small_gap_to_a_long_edge_that_turns() {
        let place = Relative {
            a: dvec2(2.384185791015625e-7, 0.06250017881393433),
            b: dvec2(2.980232238769531e-7, -0.06249964237213135),
        };
        let velocity = Relative { a: dvec2(1.46050292, 11.62775822), b: dvec2(-3.33090313, 18.63217952) };
        let minimum = 2.682209014892578e-7;
        let time = place.time_of_impact(&velocity, minimum, 1e-3);
        let there = Relative { a: place.a + time * velocity.a, b: place.b + time * velocity.b };
        assert!(time > 0.0 && there.closest().distance > minimum, "{time:e} {:e}", there.closest().distance);
    }

    /// Protects the time of impact by ways on which it can be counted: it stops with a
    /// tenth of the gap left.
    #[test]
    fn impacts_by_hand() {
        let (edge, still) = ([dvec2(-1.0, 0.0), dvec2(1.0, 0.0)], [DVec2::ZERO; 2]);
        let time = |v: DVec2, velocity: DVec2, minimum: f64| {
            Relative::new(v, edge).time_of_impact(&Relative::new(velocity, still), minimum, 100.0)
        };
        assert!((time(dvec2(0.0, 1.0), dvec2(0.0, -1.0), 0.0) - 0.9).abs() < 1e-12);
        assert!((time(dvec2(0.0, 1.0), dvec2(0.0, -1.0), 0.5) - 0.45).abs() < 1e-12);
        // Alongside, away, and at the minimum already: towards it and away.
        assert_eq!(time(dvec2(0.0, 1.0), dvec2(1.0, 0.0), 0.9), 100.0);
        assert_eq!(time(dvec2(0.0, 1.0), dvec2(0.0, 1e9), 0.9), 100.0);
        assert_eq!(time(dvec2(0.0, 1.0), dvec2(0.0, -1.0), 1.0), 0.0);
        assert_eq!(time(dvec2(0.0, 1.0), dvec2(0.0, 1.0), 1.0), 100.0);
        // On the edge: nothing is known about sides.
        assert_eq!(time(DVec2::ZERO, dvec2(0.0, 1.0), 0.0), 0.0);
        // It rushes by the edge's end at a distance.
        assert_eq!(time(dvec2(4.0, 2.0), dvec2(-2.0, 0.0), 1.5), 100.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Protects what bijectivity rests on: sampled densely, the distance never falls
        /// below the minimum before the time of impact, whatever the speed; and the time
        /// is not needlessly short.
        #[test]
        fn no_impact_before_its_time(
            places in [vector(1.0), vector(1.0), vector(1.0)],
            ways in [vector(1.0), vector(1.0), vector(1.0)],
            share in 0.0f64..1.0,
            power in -2.0f64..8.0,
        ) {
            let start = Relative::new(places[0], [places[1], places[2]]);
            let velocity = Relative::new(ways[0], [ways[1], ways[2]]);
            let speed = 10f64.powf(power);
            let velocity = Relative { a: speed * velocity.a, b: speed * velocity.b };
            let distance = |t: f64| {
                Relative { a: start.a + t * velocity.a, b: start.b + t * velocity.b }.closest().distance
            };
            let minimum = share * distance(0.0);
            let gap = distance(0.0) - minimum;
            let time = start.time_of_impact(&velocity, minimum, 1.0);
            for k in 0..=500 {
                prop_assert!(distance(time * f64::from(k) / 500.0) >= minimum + 0.99 * KEPT * gap);
            }
            if time < 1.0 {
                prop_assert!(distance(time) <= minimum + 1.11 * KEPT * gap + 1e-12);
            }
        }
    }
}
