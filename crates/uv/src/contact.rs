//! Contact: what keeps charts apart from each other, from themselves, and inside the
//! square while points move.
//!
//! Triangles that stay upright ([`crate::inversion`]) and a boundary that never meets
//! itself make a layout bijective. In the plane two edges cannot cross before a vertex
//! of one of them lies on the other, so all is said by pairs of a boundary vertex and a
//! boundary edge. Each pair keeps a minimal distance; a barrier repels it before
//! ([`Contact::energy_and_gradient`]), the time of impact bounds each step
//! ([`Contact::max_step`]), and an exact check judges where a step arrives, since
//! rounding to `f32` moves points once more ([`Contact::is_feasible`]).
//!
//! What is guaranteed, if every step is at most `max_step` long, directions are
//! multiplied with [`Contact::constraints`], and iterates are feasible after rounding:
//!
//! - A start without crossing edges keeps this, and stays inside the square.
//! - Pairs of different charts keep the gutter; those that start nearer keep 0.9 of
//!   their distance at the start.
//! - Pairs of the same chart keep 2⁻²³: more than rounding can move them.
//! - Pairs nearer than 2⁻²² at the start (T-junctions, charts that touch, slivers) have
//!   their three points fixed: they never come loose, and nothing crosses there.
//! - Edges that cross at the start ([`Contact::crossings`]) are a fault that this module
//!   cannot repair: these pairs of edges may do as they like, all others are kept.
//! - Boundary vertices on the border or outside of the square keep that coordinate.
//!
//! Charts that share a point count as one chart here, for no gutter fits between them.
//! Bounds on rounding hold for points in the square.
//!
//! ```text
//! boundary     which vertices, which edges, of which charts
//! limits       how near pairs may come, from where on they repel
//! border       the same for the sides of the square
//! constraints  coordinates that are fixed
//! grid         pairs that are near each other
//! pair         distance and time of impact of one pair
//! barrier      energy and gradient
//! step         the largest step
//! feasible     the exact check
//! ```

mod barrier;
mod border;
mod boundary;
mod constraints;
mod feasible;
mod grid;
mod limits;
mod pair;
mod step;

pub use constraints::Constraints;

use border::BorderLimits;
use boundary::Boundary;
use feasible::Crossings;
use glam::DVec2;
use grid::{Bounds, Grid};
use limits::{Limits, OWN_MINIMUM, PairLimits};
use parbake_atlas::Layout;

/// What boundary vertices do at the border of the square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Border {
    /// They keep at least so many texels from it; those that start nearer keep 0.9 of
    /// their distance at the start.
    Margin {
        /// Texels, 0 or more.
        margin_texels: f64,
    },
    /// Those that start on it slide along their side, corners stay, and the others stay
    /// inside.
    Slide,
}

/// Distances of contact, in texels of a square texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOptions {
    /// Texels on each side; 0 is taken as 1.
    pub texture_size: u32,
    /// The distance between different charts that is never gone below, 0 or more.
    /// Charts that are packed at exactly this distance cannot approach by a hair: who
    /// packs leaves a little more.
    pub gutter_texels: f64,
    /// Width of the barrier above the gutter and the margin, 0 (no barrier) or more. The
    /// paper has 5.
    pub activation_texels: f64,
    /// Width of the barrier between parts of the same chart; for each pair at most half
    /// of its distance at the start.
    pub own_activation_texels: f64,
    /// What happens at the border.
    pub border: Border,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self {
            texture_size: 1024,
            gutter_texels: 2.0,
            activation_texels: 2.0,
            own_activation_texels: 0.25,
            border: Border::Margin { margin_texels: 1.0 },
        }
    }
}

/// A layout's boundary with the limits that its start sets. It does not change; points
/// are given to each question.
#[derive(Clone, Debug)]
pub struct Contact {
    texture_size: f64,
    boundary: Boundary,
    limits: PairLimits,
    border: BorderLimits,
    constraints: Constraints,
    crossings: Crossings,
    /// Where the boundary vertices begin.
    start: Vec<DVec2>,
}

impl Contact {
    /// Contact for a layout that starts where it is.
    pub fn new(layout: &Layout, options: &ContactOptions) -> Self {
        let points = &layout.points;
        let texture_size = f64::from(options.texture_size.max(1));
        // `max` also turns what is not a number into the least value.
        let texels = |distance: f64| distance.max(0.0) / texture_size;
        let others = Limits {
            minimum: texels(options.gutter_texels).max(OWN_MINIMUM),
            activation: texels(options.activation_texels),
        };
        let own = Limits { minimum: OWN_MINIMUM, activation: texels(options.own_activation_texels) };
        let boundary = Boundary::new(layout);
        let limits = PairLimits::new(&boundary, points, own, others);
        let mut constraints = Constraints::free(points.len());
        let border = match options.border {
            Border::Margin { margin_texels } => {
                Limits { minimum: texels(margin_texels), activation: others.activation }
            }
            Border::Slide => Limits { minimum: 0.0, activation: own.activation },
        };
        let border = BorderLimits::new(&boundary, points, border, &mut constraints);
        for (vertex, edge) in limits.touching() {
            constraints.hold(boundary.vertices[vertex]);
            boundary.edges[edge].iter().for_each(|&end| constraints.hold(end));
        }
        Self {
            texture_size,
            crossings: Crossings::new(&boundary, points),
            start: boundary.vertices.iter().map(|&v| points[v as usize]).collect(),
            boundary,
            limits,
            border,
            constraints,
        }
    }

    /// Coordinates that the optimiser must not change.
    pub fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    /// Indices of the points on the boundary, ascending.
    pub fn boundary_vertices(&self) -> &[u32] {
        &self.boundary.vertices
    }

    /// The points of each boundary edge; the chart lies to the left.
    pub fn boundary_edges(&self) -> &[[u32; 2]] {
        &self.boundary.edges
    }

    /// How many pairs of boundary edges cross at the start: 0 for a bijective one.
    pub fn crossings(&self) -> usize {
        self.crossings.crossing.len()
    }

    /// How many pairs of boundary vertex and boundary edge touch at the start, and are
    /// fixed for that.
    pub fn touching(&self) -> usize {
        self.limits.touching().count()
    }

    /// The edges' boxes, grown by `reach`.
    fn grid(&self, points: &[DVec2], reach: f64) -> Grid {
        let edges = 0..self.boundary.edges.len();
        Grid::new(
            edges.map(|e| self.boundary.ends(e, points)).map(|[a, b]| Bounds::of(a, b, reach)).collect(),
        )
    }

    /// Whether all boundary vertices are somewhere.
    fn is_finite(&self, points: &[DVec2]) -> bool {
        self.boundary.vertices.iter().all(|&v| points[v as usize].is_finite())
    }
}
