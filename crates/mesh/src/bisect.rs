//! More triangles where they are wanted: longest-edge bisection (Rivara 1984).
//!
//! The triangle that weighs most is halved at its longest edge, and with it every other triangle at
//! that edge; where one of those has a longer edge, that one goes first, so that no slivers come of
//! it. Halves weigh half each.
//!
//! Contract: the surface stays, and no crack opens: an edge is halved on all its sides, whether they
//! share their vertices or not, and its midpoint is the same number on each.

use crate::vertices::push_midpoint;
use crate::weld::weld_by_position;
use parbake_model::Mesh;
use parbake_model::glam::Vec2;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// A mesh's triangles and vertices after bisection.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bisected {
    /// F′ triangles, in the order of those that they are pieces of. The mesh's V vertices come first, then
    /// one for each midpoint.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices that each new one lies halfway between, which come before it.
    pub midpoints: Vec<[u32; 2]>,
    /// F′ entries: where each triangle lies.
    pub pieces: Vec<Piece>,
}

/// Where a triangle lies that is a piece of one of a coarser mesh's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The coarser mesh's triangle.
    pub triangle: u32,
    /// Barycentric weights of the piece's corners in it.
    pub corners: [[f32; 3]; 3],
}

impl Piece {
    /// A triangle as a piece of itself.
    pub fn whole(triangle: u32) -> Self {
        Self { triangle, corners: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }

    /// The piece between this one's first two corners' midpoint and its first and third corner, and the
    /// rest of it.
    fn halves(&self) -> [Self; 2] {
        let [a, b, c] = self.corners;
        let ab = [0, 1, 2].map(|k| 0.5 * a[k] + 0.5 * b[k]);
        [[a, ab, c], [ab, b, c]].map(|corners| Self { corners, ..*self })
    }
}

impl Bisected {
    /// Adds at most `more` triangles to a mesh with these weights (F, ≥ 0), halving edges for as long as
    /// they are longer than `least` in texture coordinates.
    pub fn new(mesh: &Mesh, weights: &[f64], more: usize, least: f32) -> Self {
        let mut work = Work::new(mesh, weights);
        let most = mesh.triangles.len() + more;
        let mut heaviest: BinaryHeap<_> = (0..mesh.triangles.len()).map(|t| work.rank(t)).collect();
        while work.corners.len() < most
            && let Some((weight, Reverse(t))) = heaviest.pop()
        {
            if weight == 0 || work.rank(t).0 != weight {
                continue;
            }
            let (length, edge) = work.longest(t);
            if length <= least {
                continue;
            }
            let edge = work.terminal(edge);
            // An edge of many triangles may take more than there is left.
            if work.corners.len() + work.around[&edge].len() > most {
                continue;
            }
            let halved = work.halve(edge);
            heaviest.extend(halved.iter().map(|&t| work.rank(t)));
            if !halved.contains(&t) {
                heaviest.push(work.rank(t));
            }
        }
        work.done()
    }

    /// A mesh with the same triangles and as many vertices as the one that was bisected. Tangents are dropped.
    pub fn of(&self, mesh: &Mesh) -> Mesh {
        let mut fine = Mesh { tangents: Vec::new(), triangles: self.triangles.clone(), ..mesh.clone() };
        for &[a, b] in &self.midpoints {
            push_midpoint(&mut fine, a, b);
        }
        let material = |piece: &Piece| mesh.triangle_materials[piece.triangle as usize];
        fine.triangle_materials = self.pieces.iter().map(material).collect();
        fine
    }
}

/// Two points, the lesser one first.
type Edge = [u32; 2];

fn sorted(a: u32, b: u32) -> Edge {
    [a.min(b), a.max(b)]
}

/// Triangles while they are bisected.
struct Work {
    corners: Vec<[u32; 3]>,
    pieces: Vec<Piece>,
    weights: Vec<f64>,
    /// The texture coordinates of each vertex.
    uvs: Vec<Vec2>,
    /// The point in space of each vertex.
    points: Vec<u32>,
    /// The triangles at each edge.
    around: HashMap<Edge, Vec<u32>>,
    midpoints: Vec<[u32; 2]>,
}

impl Work {
    fn new(mesh: &Mesh, weights: &[f64]) -> Self {
        let points = weld_by_position(&mesh.positions);
        let (mut around, mut weights) = (HashMap::<Edge, Vec<u32>>::new(), weights.to_vec());
        for (t, corners) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| points[v as usize]);
            if a == b || b == c || c == a {
                // Nothing shows on it, and none of its edges is one that others have to follow.
                weights[t] = 0.0;
                continue;
            }
            for edge in [sorted(a, b), sorted(b, c), sorted(c, a)] {
                around.entry(edge).or_default().push(t as u32);
            }
        }
        Self {
            corners: mesh.triangles.clone(),
            pieces: (0..mesh.triangles.len() as u32).map(Piece::whole).collect(),
            weights,
            uvs: mesh.uvs.clone(),
            points,
            around,
            midpoints: Vec::new(),
        }
    }

    /// What the heap sorts by: numbers ≥ 0 have the order of their bits.
    fn rank(&self, t: usize) -> (u64, Reverse<usize>) {
        (self.weights[t].to_bits(), Reverse(t))
    }

    /// The edges of a triangle with the vertices on its side, each from a corner to the next.
    fn edges(&self, t: usize) -> [(Edge, [u32; 2]); 3] {
        let [a, b, c] = self.corners[t];
        [[a, b], [b, c], [c, a]]
            .map(|[p, q]| (sorted(self.points[p as usize], self.points[q as usize]), [p, q]))
    }

    /// Length of an edge in texture coordinates, on the side where it is longest.
    fn length(&self, edge: Edge) -> f32 {
        let sides = self.around[&edge].iter().flat_map(|&t| self.edges(t as usize));
        let own = sides.filter(|(key, _)| *key == edge);
        own.map(|(_, [a, b])| self.uvs[a as usize].distance(self.uvs[b as usize])).fold(0.0, f32::max)
    }

    /// The longest edge of a triangle; of edges as long as each other the same for all triangles.
    fn longest(&self, t: usize) -> (f32, Edge) {
        let edges = self.edges(t).map(|(edge, _)| (self.length(edge), edge));
        edges.into_iter().fold((0.0, edges[0].1), |a, b| if (b.0, b.1) > (a.0, a.1) { b } else { a })
    }

    /// The end of the longest-edge propagation path: an edge that is the longest of all triangles at it.
    fn terminal(&self, mut edge: Edge) -> Edge {
        loop {
            let longest = self.around[&edge].iter().map(|&t| self.longest(t as usize));
            let (_, longer) = longest.fold((self.length(edge), edge), |a, b| if b > a { b } else { a });
            if longer == edge {
                return edge;
            }
            edge = longer;
        }
    }

    /// Halves all triangles at an edge; the halves.
    fn halve(&mut self, edge: Edge) -> Vec<usize> {
        let mut halves = Vec::new();
        let mut new: Vec<([u32; 2], u32)> = Vec::new();
        for t in self.around.remove(&edge).unwrap_or_default() {
            let Some(k) = self.edges(t as usize).iter().position(|(own, _)| *own == edge) else { continue };
            let (mut corners, mut piece) = (self.corners[t as usize], self.pieces[t as usize]);
            corners.rotate_left(k);
            piece.corners.rotate_left(k);
            let [a, b, c] = corners;
            let known = new.iter().find(|(ends, _)| *ends == sorted(a, b)).map(|(_, middle)| *middle);
            let middle = known.unwrap_or_else(|| {
                let middle = self.points.len() as u32;
                // All midpoints of an edge are one point: its first.
                self.points.push(new.first().map_or(middle, |(_, first)| *first));
                self.uvs.push(0.5 * self.uvs[a as usize] + 0.5 * self.uvs[b as usize]);
                self.midpoints.push([a, b]);
                new.push((sorted(a, b), middle));
                middle
            });
            halves.extend(self.replace(t, [a, b, c], middle, piece));
        }
        halves
    }

    /// Puts the halves of the triangle a, b, c in its place, whose first edge has this middle.
    fn replace(&mut self, t: u32, [a, b, c]: [u32; 3], middle: u32, piece: Piece) -> [usize; 2] {
        let new = self.corners.len() as u32;
        let [first, second] = piece.halves();
        let half = 0.5 * self.weights[t as usize];
        (self.corners[t as usize], self.pieces[t as usize], self.weights[t as usize]) =
            ([a, middle, c], first, half);
        self.corners.push([middle, b, c]);
        self.pieces.push(second);
        self.weights.push(half);
        let [pa, pb, pc, pm] = [a, b, c, middle].map(|v| self.points[v as usize]);
        for (edge, triangle) in [([pa, pm], t), ([pm, pb], new), ([pm, pc], t), ([pm, pc], new)] {
            self.around.entry(sorted(edge[0], edge[1])).or_default().push(triangle);
        }
        if let Some(at) = self.around.get_mut(&sorted(pb, pc)) {
            at.iter_mut().filter(|other| **other == t).for_each(|other| *other = new);
        }
        [t as usize, new as usize]
    }

    fn done(self) -> Bisected {
        let mut order: Vec<usize> = (0..self.corners.len()).collect();
        order.sort_by_key(|&t| self.pieces[t].triangle);
        Bisected {
            triangles: order.iter().map(|&t| self.corners[t]).collect(),
            midpoints: self.midpoints,
            pieces: order.iter().map(|&t| self.pieces[t]).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::{Vec3, vec2};
    use proptest::prelude::*;

    fn mesh(points: &[(f32, f32)], triangles: Vec<[u32; 3]>) -> Mesh {
        Mesh {
            positions: points.iter().map(|&(x, y)| Vec3::new(x, y, x * y)).collect(),
            uvs: points.iter().map(|&(x, y)| vec2(x, y)).collect(),
            triangle_materials: (0..triangles.len() as u32).collect(),
            triangles,
            ..Mesh::default()
        }
    }

    /// How many triangles there are at each edge in space.
    fn sides(mesh: &Mesh) -> HashMap<Edge, usize> {
        let points = weld_by_position(&mesh.positions);
        let mut sides = HashMap::new();
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|v| points[v as usize]);
            for edge in [sorted(a, b), sorted(b, c), sorted(c, a)] {
                *sides.entry(edge).or_insert(0) += 1;
            }
        }
        sides
    }

    /// Protects the choice: the triangle that weighs most is halved at its longest edge, with its
    /// neighbour there though the two share no vertices; what is far stays.
    #[test]
    fn halves_what_weighs_most_on_both_sides_of_a_seam() {
        let points = [
            (0.0, 0.0),
            (1.0, 0.0),
            (0.0, 1.0),
            (1.0, 0.0),
            (1.0, 1.0),
            (0.0, 1.0),
            (5.0, 0.0),
            (6.0, 0.0),
            (5.0, 1.0),
        ];
        let mut m = mesh(&points, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
        m.uvs[3..6].iter_mut().for_each(|uv| uv.x += 10.0);
        let bisected = Bisected::new(&m, &[1.0, 0.1, 0.9], 2, 0.0);
        let fine = bisected.of(&m);
        assert_eq!(fine.triangles, [[1, 9, 0], [9, 2, 0], [5, 10, 4], [10, 3, 4], [6, 7, 8]]);
        assert_eq!((fine.positions[9], fine.uvs[9]), (fine.positions[10], vec2(0.5, 0.5)));
        assert_eq!(fine.uvs[10], vec2(10.5, 0.5));
        assert_eq!(fine.triangle_materials, [0, 0, 1, 1, 2]);
        assert_eq!(bisected.pieces[0].corners, [[0.0, 1.0, 0.0], [0.0, 0.5, 0.5], [1.0, 0.0, 0.0]]);
    }

    /// Protects from slivers: where the neighbour has a longer edge, that one is halved first.
    #[test]
    fn longer_edges_go_first() {
        let points = [(0.0, 0.0), (1.0, 0.0), (0.4, 1.2), (4.0, 0.8)];
        let m = mesh(&points, vec![[0, 1, 2], [1, 3, 2]]);
        let bisected = Bisected::new(&m, &[1.0, 0.0], 1, 0.0);
        assert_eq!(bisected.midpoints, [[3, 2]]);
        assert_eq!(bisected.triangles.len(), 3);
    }

    /// Protects budgets and texels: nothing is halved beyond them, nor without weight.
    #[test]
    fn ends_where_it_is_told_to() {
        let m = mesh(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], vec![[0, 1, 2]]);
        let count =
            |weight: f64, more: usize, least: f32| Bisected::new(&m, &[weight], more, least).triangles.len();
        assert_eq!([count(1.0, 0, 0.0), count(1.0, 7, 0.0), count(0.0, 7, 0.0)], [1, 8, 1]);
        let coarse = Bisected::new(&m, &[1.0], 1000, 0.3).of(&m);
        let longest = coarse
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| coarse.uvs[a as usize].distance(coarse.uvs[b as usize]));
        assert!(longest.fold(0.0, f32::max) <= 0.3);
    }

    proptest! {
        /// Protects all kinds of meshes (folded, with edges of many triangles): the same area, no
        /// crack, pieces where they say they are.
        #[test]
        fn area_and_edges_are_preserved(
            points in prop::collection::vec((-1f32..1.0, -1f32..1.0), 3..12),
            corners in prop::collection::vec((0usize..12, 0usize..12, 0usize..12), 1..20),
            more in 0usize..60,
        ) {
            let n = points.len();
            let triangles: Vec<_> = corners.iter().map(|c| [c.0 % n, c.1 % n, c.2 % n].map(|v| v as u32)).collect();
            let m = mesh(&points, triangles);
            let weights: Vec<f64> = (0..m.triangles.len()).map(|t| f64::from(m.area_normal(t).length())).collect();
            let bisected = Bisected::new(&m, &weights, more, 0.0);
            let fine = bisected.of(&m);
            prop_assert!(fine.triangles.len() <= m.triangles.len() + more);
            let area = |m: &Mesh| -> f32 { (0..m.triangles.len()).map(|t| m.area_normal(t).length()).sum() };
            prop_assert!((area(&fine) - area(&m)).abs() < 1e-4 * area(&m).max(1.0));
            for (t, piece) in bisected.pieces.iter().enumerate() {
                let whole = m.triangles[piece.triangle as usize].map(|v| m.positions[v as usize]);
                for (corner, weights) in fine.triangles[t].into_iter().zip(piece.corners) {
                    let place: Vec3 = whole.iter().zip(weights).map(|(p, w)| *p * w).sum();
                    prop_assert!(place.distance(fine.positions[corner as usize]) < 1e-5);
                }
            }
            // Of a crack's two sides one has edges that the other has not: what is at an edge with an
            // even number of triangles stays so, in halves.
            let is_folded = |m: &Mesh| m.triangles.iter().any(|&[a, b, c]| a == b || b == c || c == a);
            if !is_folded(&m) {
                let odd = |m: &Mesh| sides(m).values().filter(|count| **count % 2 == 1).count();
                prop_assert!(odd(&m) > 0 || odd(&fine) == 0);
            }
        }
    }
}
