//! How near two things may come, and from where on they repel each other.
//!
//! A pair that starts well apart has the limits of its kind. One that starts nearer
//! than these allow has its own, so that every start is feasible, and one that touches
//! at the start has none: its points are held in place instead.

use super::boundary::Boundary;
use super::grid::{Bounds, Grid};
use super::pair::Relative;
use glam::DVec2;
use rayon::prelude::*;

/// Pairs nearer than this touch (in texture coordinates): four steps of `f32` near 1.
pub(super) const TOUCHING: f64 = 1.0 / (1 << 22) as f64;

/// What parts of one chart keep between each other: more than the two ways that
/// rounding to `f32` moves points in the square, √2 · 2⁻²⁴ together, so that no
/// rounding can carry a vertex across an edge.
pub(super) const OWN_MINIMUM: f64 = 1.0 / (1 << 23) as f64;

/// What rounding to `f64` may do to a distance, with room to spare: each coordinate in the square is
/// off by 1e-16 after a step. A gap that a step leaves a tenth of must be larger than that.
pub(super) const ROUNDING: f64 = 1e-13;

/// Share of its distance at the start that a pair nearer than the gutter keeps.
const KEPT_OF_START: f64 = 0.9;

/// The distance that a pair keeps and the width of the barrier above it, in texture
/// coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub minimum: f64,
    pub activation: f64,
}

impl Limits {
    /// For two charts, or a chart and the border, that keep `minimum` where the start
    /// does; `None` where they touch.
    pub fn apart(self, start: f64) -> Option<Self> {
        if start < TOUCHING {
            return None;
        }
        if start > self.minimum + ROUNDING {
            return Some(self);
        }
        let minimum = KEPT_OF_START * start;
        // Twice the gap: it repels softly from the first step on.
        Some(Self { minimum, activation: self.activation.min(2.0 * (start - minimum)) })
    }

    /// For two parts of one chart, which start free of any force; `None` where they touch.
    pub fn own(self, start: f64) -> Option<Self> {
        let activation = self.activation.min(0.5 * (start - self.minimum));
        (start >= TOUCHING).then_some(Self { activation, ..self })
    }
}

/// Limits for pairs of the same group, of different ones, and of single pairs.
#[derive(Clone, Debug)]
pub(super) struct PairLimits {
    pub own: Limits,
    pub others: Limits,
    /// Where each boundary vertex's exceptions begin.
    starts: Vec<usize>,
    /// Edge and limits, by vertex, then by edge.
    exceptions: Vec<(u32, Option<Limits>)>,
}

impl PairLimits {
    /// Looks for the pairs that start too near for the limits of their kind.
    pub fn new(boundary: &Boundary, points: &[DVec2], own: Limits, others: Limits) -> Self {
        let reach = others.minimum.max(own.minimum + 2.0 * own.activation).max(TOUCHING);
        let boxes = (0..boundary.edges.len())
            .map(|e| boundary.ends(e, points))
            .map(|[a, b]| Bounds::of(a, b, reach))
            .collect();
        let grid = Grid::new(boxes);
        let rows: Vec<Vec<(u32, Option<Limits>)>> = boundary
            .vertices
            .par_iter()
            .zip(&boundary.vertex_groups)
            .map(|(&v, &group)| {
                let at = points[v as usize];
                let mut row = Vec::new();
                grid.for_each(&Bounds::of(at, at, 0.0), |e| {
                    if boundary.edges[e].contains(&v) {
                        return;
                    }
                    let start = Relative::new(at, boundary.ends(e, points)).closest().distance;
                    let (usual, limits) = if group == boundary.edge_groups[e] {
                        (own, own.own(start))
                    } else {
                        (others, others.apart(start))
                    };
                    if limits != Some(usual) {
                        row.push((e as u32, limits));
                    }
                });
                row.sort_unstable_by_key(|&(e, _)| e);
                row
            })
            .collect();
        let mut starts = vec![0];
        let mut exceptions = Vec::new();
        for row in rows {
            exceptions.extend(row);
            starts.push(exceptions.len());
        }
        Self { own, others, starts, exceptions }
    }

    /// The limits of a boundary vertex (its place in the list) and an edge that does not
    /// end in it; `None` where they touched at the start.
    #[inline]
    pub fn of(&self, boundary: &Boundary, vertex: usize, edge: usize) -> Option<Limits> {
        let row = &self.exceptions[self.starts[vertex]..self.starts[vertex + 1]];
        if !row.is_empty()
            && let Ok(at) = row.binary_search_by_key(&(edge as u32), |&(e, _)| e)
        {
            return row[at].1;
        }
        let same = boundary.vertex_groups[vertex] == boundary.edge_groups[edge];
        Some(if same { self.own } else { self.others })
    }

    /// Pairs of boundary vertex (its place in the list) and edge that touch at the start.
    pub fn touching(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.starts.windows(2).enumerate().flat_map(|(vertex, row)| {
            self.exceptions[row[0]..row[1]]
                .iter()
                .filter(|(_, limits)| limits.is_none())
                .map(move |&(edge, _)| (vertex, edge as usize))
        })
    }
}
