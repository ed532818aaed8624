//! The energy that repels what comes too near.
//!
//! The barrier of incremental potential contact (Li et al. 2020, "Incremental Potential
//! Contact") on the gap above the distance to be kept, in texels. With r = gap / d₀,
//!
//! `b = d₀ · f(r)`, `f(r) = −(r − 1)² ln r` for r < 1 and 0 beyond,
//!
//! which is twice continuously differentiable where it sets in and infinite where
//! there is no gap. The paper's form is d₀ times this one; divided so, pairs of
//! different activation press with the same force when half of their room is gone, and
//! weight 1 means about one unit of energy for each texel that a vertex is pressed in.
//!
//! The second derivative, which Newton's method needs (`curvature.rs`), is given pair by pair.

use super::Contact;
use super::grid::{Bounds, Grid};
use super::limits::{Limits, PairLimits};
use super::pair::Relative;
use glam::DVec2;
use rayon::prelude::*;

/// Boundary vertices that one task looks at; sums are made by task, so it is a
/// constant.
const BAND: usize = 256;

/// What a task adds to the energy and to the gradients of which points.
#[derive(Default)]
struct Part {
    energy: f64,
    forces: Vec<(u32, DVec2)>,
}

/// A boundary vertex with an edge, or with a side of the square, that are near each other.
pub struct Active {
    distance: f64,
    limits: Limits,
    /// The distance's gradient for the vertex; without direction where the distance is zero.
    pub normal: DVec2,
    /// The vertex, the edge's ends, and how much of that gradient each has…
    shares: [(u32, f64); 3],
    /// …or the vertex alone: so many of them count.
    count: usize,
}

impl Active {
    /// Points, and how much of the distance's gradient each has.
    pub fn parts(&self) -> &[(u32, f64)] {
        &self.shares[..self.count]
    }
}

impl Contact {
    /// The barrier's energy, in texels, over all pairs of a boundary vertex and a
    /// boundary edge and over the border; its gradient (P, by texture coordinate) is
    /// added to `gradient`.
    ///
    /// Infinite where a pair has no gap left or a coordinate is not finite; such pairs
    /// add nothing to the gradient.
    pub fn energy_and_gradient(&self, points: &[DVec2], gradient: &mut [DVec2]) -> f64 {
        if !self.is_finite(points) {
            return f64::INFINITY;
        }
        let grid = self.grid(points, self.reach());
        let bands: Vec<usize> = (0..self.boundary.vertices.len()).step_by(BAND).collect();
        let parts: Vec<Part> = bands.par_iter().map(|&first| self.part(points, &grid, first)).collect();
        let mut energy = 0.0;
        for part in parts {
            energy += part.energy;
            for (point, force) in part.forces {
                gradient[point as usize] += force;
            }
        }
        energy
    }

    /// One task's share, from the boundary vertex `first` on.
    fn part(&self, points: &[DVec2], grid: &Grid, first: usize) -> Part {
        let mut part = Part::default();
        let last = (first + BAND).min(self.boundary.vertices.len());
        for vertex in first..last {
            self.for_each_active(points, grid, vertex, |active| {
                let (energy, slope) = self.barrier(active.distance, active.limits);
                part.energy += energy;
                if slope != 0.0 {
                    let force = slope * active.normal;
                    part.forces.extend(active.parts().iter().map(|(point, share)| (*point, *share * force)));
                }
            });
        }
        part
    }

    /// The pairs that the barrier repels, each with the energy's second derivative by the distance, above 0, in texels over
    /// squared texture coordinates.
    pub fn curvatures(&self, points: &[DVec2]) -> Vec<(f64, Active)> {
        let grid = self.grid(points, self.reach());
        let of_vertex = |vertex: usize| {
            let mut pairs = Vec::new();
            self.for_each_active(points, &grid, vertex, |active| {
                let curvature = self.curvature(active.distance, active.limits);
                if curvature > 0.0 {
                    pairs.push((curvature, active));
                }
            });
            pairs
        };
        (0..self.boundary.vertices.len())
            .into_par_iter()
            .with_min_len(BAND)
            .flat_map_iter(of_vertex)
            .collect()
    }

    /// The distance from which on any pair is free.
    fn reach(&self) -> f64 {
        let PairLimits { own, others, .. } = &self.limits;
        (others.minimum + others.activation).max(own.minimum + own.activation)
    }

    /// Pairs of this boundary vertex that are near enough to be repelled, with edges and with
    /// the border.
    fn for_each_active(&self, points: &[DVec2], grid: &Grid, vertex: usize, mut visit: impl FnMut(Active)) {
        let index = self.boundary.vertices[vertex];
        let at = points[index as usize];
        grid.for_each(&Bounds::of(at, at, 0.0), |edge| {
            let ends = self.boundary.edges[edge];
            if ends.contains(&index) {
                return;
            }
            let closest = Relative::new(at, ends.map(|i| points[i as usize])).closest();
            // Most pairs end here; the exceptions are all nearer than the rest.
            if closest.distance >= reach_of(self, vertex, edge) {
                return;
            }
            let Some(limits) = self.limits.of(&self.boundary, vertex, edge) else { return };
            let normal = closest.offset / closest.distance;
            let shares = [(index, 1.0), (ends[0], closest.along - 1.0), (ends[1], -closest.along)];
            visit(Active { distance: closest.distance, limits, normal, shares, count: 3 });
        });
        for (side, limits) in self.border.sides[vertex].iter().enumerate() {
            let Some(limits) = *limits else { continue };
            let (normal, distance) = super::border::inwards(at, side);
            let shares = [(index, 1.0); 3];
            visit(Active { distance, limits, normal, shares, count: 1 });
        }
    }

    /// Energy in texels and its derivative by the distance in texture coordinates.
    #[inline]
    fn barrier(&self, distance: f64, limits: Limits) -> (f64, f64) {
        let gap = distance - limits.minimum;
        if gap >= limits.activation {
            return (0.0, 0.0);
        }
        if gap <= 0.0 {
            return (f64::INFINITY, 0.0);
        }
        let ratio = gap / limits.activation;
        let (rest, log) = (ratio - 1.0, ratio.ln());
        let width = limits.activation * self.texture_size;
        (-width * rest * rest * log, -self.texture_size * rest * (2.0 * log + rest / ratio))
    }

    /// The energy's second derivative by the distance; 0 where it has none, or no gap.
    fn curvature(&self, distance: f64, limits: Limits) -> f64 {
        let gap = distance - limits.minimum;
        if gap >= limits.activation || gap <= 0.0 {
            return 0.0;
        }
        let ratio = gap / limits.activation;
        let rest = (ratio - 1.0) / ratio;
        -self.texture_size / limits.activation * (2.0 * ratio.ln() + rest + rest * (2.0 + 1.0 / ratio))
    }
}

/// The distance from which on a pair of this kind is free, whatever its exception.
#[inline]
fn reach_of(contact: &Contact, vertex: usize, edge: usize) -> f64 {
    let same = contact.boundary.vertex_groups[vertex] == contact.boundary.edge_groups[edge];
    let limits = if same { contact.limits.own } else { contact.limits.others };
    limits.minimum + limits.activation
}
