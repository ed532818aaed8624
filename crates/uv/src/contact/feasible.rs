//! Whether proposed points keep all limits, decided where they are and not on the way:
//! distances in f64, crossings of edges by exact predicates.

use super::Contact;
use super::boundary::Boundary;
use super::grid::{Bounds, Grid};
use super::limits::{OWN_MINIMUM, ROUNDING};
use super::pair::Relative;
use glam::DVec2;
use rayon::prelude::*;
use robust::{Coord, orient2d};

/// How two edges without a common end lie to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meeting {
    Apart,
    /// They have a point in common, but none is on both sides of the other.
    Touching,
    Crossing,
}

/// Pairs of edges that met at the start; the first index is the smaller one; sorted.
#[derive(Clone, Debug)]
pub(super) struct Crossings {
    pub crossing: Vec<(u32, u32)>,
    pub touching: Vec<(u32, u32)>,
}

impl Crossings {
    /// Looks for them.
    pub fn new(boundary: &Boundary, points: &[DVec2]) -> Self {
        let edges = 0..boundary.edges.len();
        let boxes: Vec<Bounds> =
            edges.map(|e| boundary.ends(e, points)).map(|[a, b]| Bounds::of(a, b, 0.0)).collect();
        let grid = Grid::new(boxes.clone());
        let rows: Vec<Vec<(u32, u32, Meeting)>> = (0..boxes.len())
            .into_par_iter()
            .map(|e| {
                let mut row = Vec::new();
                grid.for_each(&boxes[e], |other| {
                    let meeting =
                        if other > e { meeting(boundary, points, e, other) } else { Meeting::Apart };
                    if meeting != Meeting::Apart {
                        row.push((e as u32, other as u32, meeting));
                    }
                });
                row.sort_unstable_by_key(|&(_, other, _)| other);
                row
            })
            .collect();
        let of = |kind: Meeting| {
            rows.iter().flatten().filter(|(_, _, m)| *m == kind).map(|&(e, other, _)| (e, other)).collect()
        };
        Self { crossing: of(Meeting::Crossing), touching: of(Meeting::Touching) }
    }

    /// Whether a pair may meet as it does, because it did so at the start.
    fn allow(&self, pair: (u32, u32), meeting: Meeting) -> bool {
        match meeting {
            Meeting::Apart => true,
            Meeting::Touching => {
                self.touching.binary_search(&pair).is_ok() || self.crossing.binary_search(&pair).is_ok()
            }
            Meeting::Crossing => self.crossing.binary_search(&pair).is_ok(),
        }
    }
}

impl Contact {
    /// Whether all limits hold at `points`: coordinates are finite, the fixed ones are
    /// where they began, boundary vertices keep their distance from the border and from
    /// edges, and no two boundary edges meet that did not at the start.
    ///
    /// Says nothing about triangles: [`crate::inversion::all_upright`] does.
    pub fn is_feasible(&self, points: &[DVec2]) -> bool {
        self.is_feasible_with(points, 0.0)
    }

    /// The same with distances that are larger by `room`.
    fn is_feasible_with(&self, points: &[DVec2], room: f64) -> bool {
        if !self.is_finite(points) || !self.border_is_kept(points) {
            return false;
        }
        let grid = self.grid(points, self.limits.others.minimum.max(OWN_MINIMUM) + room);
        let vertices = 0..self.boundary.vertices.len();
        let edges = 0..self.boundary.edges.len();
        vertices.into_par_iter().with_min_len(64).all(|v| self.distances_are_kept(v, points, &grid, room))
            && edges.into_par_iter().with_min_len(64).all(|e| self.crosses_nothing(e, points, &grid))
    }

    /// The points rounded to what a file can hold (`f32`), if they are feasible then, with gaps
    /// that the next step can leave a tenth of without running into rounding; else the caller takes a
    /// shorter step.
    pub fn feasible_after_rounding(&self, points: &[DVec2]) -> Option<Vec<DVec2>> {
        let rounded: Vec<DVec2> = points.iter().map(|p| p.as_vec2().as_dvec2()).collect();
        self.is_feasible_with(&rounded, ROUNDING).then_some(rounded)
    }

    /// Fixed coordinates are where they began, and the others inside.
    fn border_is_kept(&self, points: &[DVec2]) -> bool {
        self.boundary.vertices.iter().enumerate().all(|(vertex, &v)| {
            let (at, start) = (points[v as usize], self.start[vertex]);
            let mask = self.constraints.masks[v as usize];
            (mask.x != 0.0 || at.x == start.x)
                && (mask.y != 0.0 || at.y == start.y)
                && self.border.keeps(vertex, at)
        })
    }

    /// A boundary vertex keeps its distance from all edges, and `room` besides.
    fn distances_are_kept(&self, vertex: usize, points: &[DVec2], grid: &Grid, room: f64) -> bool {
        let v = self.boundary.vertices[vertex];
        let at = points[v as usize];
        let mut kept = true;
        grid.for_each(&Bounds::of(at, at, 0.0), |edge| {
            if !kept || self.boundary.edges[edge].contains(&v) {
                return;
            }
            if let Some(limits) = self.limits.of(&self.boundary, vertex, edge) {
                let closest = Relative::new(at, self.boundary.ends(edge, points)).closest();
                kept = closest.distance > limits.minimum + room;
            }
        });
        kept
    }

    /// A boundary edge meets none of those after it that it did not meet at the start.
    fn crosses_nothing(&self, edge: usize, points: &[DVec2], grid: &Grid) -> bool {
        let [a, b] = self.boundary.ends(edge, points);
        let mut apart = true;
        grid.for_each(&Bounds::of(a, b, 0.0), |other| {
            if apart && other > edge {
                let meeting = meeting(&self.boundary, points, edge, other);
                apart = self.crossings.allow((edge as u32, other as u32), meeting);
            }
        });
        apart
    }
}

/// How two boundary edges lie to each other; edges with a common end count as apart,
/// for the distance of the other ends tells about them.
fn meeting(boundary: &Boundary, points: &[DVec2], first: usize, second: usize) -> Meeting {
    if boundary.edges[first].iter().any(|end| boundary.edges[second].contains(end)) {
        return Meeting::Apart;
    }
    let ([a, b], [c, d]) = (boundary.ends(first, points), boundary.ends(second, points));
    if a.max(b).cmplt(c.min(d)).any() || c.max(d).cmplt(a.min(b)).any() {
        return Meeting::Apart;
    }
    let [to_c, to_d] = [side(a, b, c), side(a, b, d)];
    if to_c * to_d > 0.0 {
        return Meeting::Apart;
    }
    let [to_a, to_b] = [side(c, d, a), side(c, d, b)];
    if to_a * to_b > 0.0 {
        Meeting::Apart
    } else if to_c * to_d < 0.0 && to_a * to_b < 0.0 {
        Meeting::Crossing
    } else {
        // An end lies on the other edge's line, and their boxes overlap.
        Meeting::Touching
    }
}

/// On which side of the line from a to b a point lies: 1 left, 0 on it, −1 right.
fn side(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let [a, b, p] = [a, b, p].map(|p| Coord { x: p.x, y: p.y });
    let doubled_area = orient2d(a, b, p);
    if doubled_area == 0.0 { 0.0 } else { doubled_area.signum() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    /// Protects the three ways of meeting, also of edges on one line.
    #[test]
    fn meetings_by_hand() {
        let points = [(0, 0), (2, 0), (1, -1), (1, 1), (1, 0), (3, 0), (4, 0), (1, 3), (5, 5), (6, 6)];
        let points = points.map(|(x, y)| dvec2(f64::from(x), f64::from(y)));
        let meets = |first: [u32; 2], second: [u32; 2]| {
            let boundary = Boundary {
                vertices: Vec::new(),
                vertex_groups: Vec::new(),
                edges: vec![first, second],
                edge_groups: vec![0; 2],
            };
            meeting(&boundary, &points, 0, 1)
        };
        assert_eq!(meets([0, 1], [2, 3]), Meeting::Crossing);
        assert_eq!(meets([0, 1], [4, 3]), Meeting::Touching);
        assert_eq!(meets([0, 1], [4, 5]), Meeting::Touching);
        assert_eq!(meets([0, 1], [5, 6]), Meeting::Apart);
        assert_eq!(meets([0, 1], [3, 7]), Meeting::Apart);
        assert_eq!(meets([0, 1], [8, 9]), Meeting::Apart);
        assert_eq!(meets([0, 1], [1, 5]), Meeting::Apart);
    }
}
