//! The largest step that keeps all limits: the earliest time of impact over all pairs
//! of boundary vertex and boundary edge, and over the border.
//!
//! Pairs that may meet are those whose boxes, swept along the step, overlap. Long ways
//! would sweep everything over everything, so a step is gone in stages, each from where
//! the one before ended, until something is hit. Stages grow while few boxes overlap
//! and shrink when many do; this count does not depend on threads.

use super::Contact;
use super::grid::{Bounds, Grid};
use super::pair::{KEPT, Relative};
use glam::DVec2;
use rayon::prelude::*;

/// Share of its way by which a point's swept box is grown. A pair that loses all but a
/// share κ of its gap goes ways of 1 − κ gaps together, so that boxes grown by
/// κ / (1 − κ) of them overlap before; a little more for rounding.
const GROWN: f64 = 1.01 * KEPT / (1.0 - KEPT);

/// Boundary vertices that one task looks at.
const BAND: usize = 128;

/// Edge lengths (with the gutter) that the fastest point covers in the first stage.
const FIRST_STAGE: f64 = 4.0;

/// Candidates for each boundary vertex below which the next stage is twice as long,
/// and above which it is half as long.
const FEW_AND_MANY: [usize; 2] = [24, 96];

impl Contact {
    /// The largest t in [0, `limit`] up to which all limits hold while each point moves
    /// from `points` to `points + t · direction`, and each pair keeps a tenth of its gap
    /// (on a way many edges long: of its gap where the last stage began).
    ///
    /// Conservative. Zero where a pair without a gap would approach, and where boundary
    /// points or directions are not finite. It costs less with a good `limit`: ask
    /// [`crate::inversion::max_step`] first.
    pub fn max_step(&self, points: &[DVec2], direction: &[DVec2], limit: f64) -> f64 {
        let ways = || self.boundary.vertices.iter().map(|&v| direction[v as usize]);
        // Squares of speeds must be finite too.
        let fastest = ways().map(DVec2::length).fold(0.0, f64::max);
        let finite = fastest.is_finite() && ways().all(DVec2::is_finite) && self.is_finite(points);
        if !finite || limit.is_nan() || limit <= 0.0 {
            return 0.0;
        }
        let mut limit = limit.min(f64::MAX);
        for (vertex, &v) in self.boundary.vertices.iter().enumerate() {
            limit = self.border.step(vertex, points[v as usize], direction[v as usize], limit);
        }
        if fastest == 0.0 || limit == 0.0 {
            return limit;
        }
        let mut stage = self.first_stage(points) / fastest;
        let mut begin = 0.0;
        loop {
            let end = limit.min(begin + stage);
            let at: Vec<DVec2> = points.iter().zip(direction).map(|(p, d)| p + begin * d).collect();
            let (step, candidates) = self.earliest_impact(&at, direction, end - begin);
            if step < end - begin || end <= begin {
                return limit.min(begin + step);
            }
            if end >= limit {
                return limit;
            }
            begin = end;
            let [few, many] = FEW_AND_MANY.map(|share| share * self.boundary.vertices.len());
            if candidates < few {
                stage *= 2.0;
            } else if candidates > many {
                stage *= 0.5;
            }
        }
    }

    /// How far the fastest point may go in the first stage.
    fn first_stage(&self, points: &[DVec2]) -> f64 {
        let edges = self.boundary.edges.len();
        let lengths = (0..edges).map(|e| self.boundary.ends(e, points)).map(|[a, b]| a.distance(b));
        FIRST_STAGE * (lengths.sum::<f64>() / edges.max(1) as f64 + self.limits.others.minimum)
    }

    /// The earliest time of impact of all pairs that may meet until `horizon`, or
    /// `horizon`; and how many candidates there were.
    fn earliest_impact(&self, points: &[DVec2], direction: &[DVec2], horizon: f64) -> (f64, usize) {
        let swept = |v: u32| {
            let (at, way) = (points[v as usize], horizon * direction[v as usize]);
            Bounds::of(at, at + way, GROWN * way.length())
        };
        let minimum = self.limits.others.minimum;
        let boxes: Vec<Bounds> =
            self.boundary.edges.par_iter().map(|&[a, b]| swept(a).union(swept(b)).grown(minimum)).collect();
        let grid = Grid::new(boxes);
        let bands: Vec<usize> = (0..self.boundary.vertices.len()).step_by(BAND).collect();
        let impact = |first: usize| {
            let last = (first + BAND).min(self.boundary.vertices.len());
            let (mut least, mut candidates) = (horizon, 0);
            for vertex in first..last {
                let query = swept(self.boundary.vertices[vertex]);
                grid.for_each(&query, |edge| {
                    candidates += 1;
                    least = least.min(self.impact(vertex, edge, points, direction, least));
                });
            }
            (least, candidates)
        };
        let earlier = |a: (f64, usize), b: (f64, usize)| (a.0.min(b.0), a.1 + b.1);
        bands.into_par_iter().map(impact).reduce(|| (horizon, 0), earlier)
    }

    /// The time of impact of one pair, at most `limit`.
    #[inline]
    fn impact(&self, vertex: usize, edge: usize, points: &[DVec2], direction: &[DVec2], limit: f64) -> f64 {
        let index = self.boundary.vertices[vertex];
        if self.boundary.edges[edge].contains(&index) {
            return limit;
        }
        let Some(limits) = self.limits.of(&self.boundary, vertex, edge) else { return limit };
        let relative = |of: &[DVec2]| Relative::new(of[index as usize], self.boundary.ends(edge, of));
        relative(points).time_of_impact(&relative(direction), limits.minimum, limit)
    }
}
