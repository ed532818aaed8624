//! What a surface is like, whatever its shape: pieces, holes, handles, and where it is no surface.
//!
//! Vertices are welded by position first: files split them along seams of the texture and at sharp edges, where
//! the surface goes on. Then
//!
//! - an *edge* is a boundary where one triangle has it, manifold where two have it, non-manifold where more have;
//! - a *component* is what edges connect;
//! - a *fan* is what edges connect of the triangles around a vertex. A vertex with several fans is non-manifold:
//!   the surface touches itself there. Each fan counts as a vertex of its own in what follows, as if such points
//!   were cut apart;
//! - a *boundary loop* (hole) is what fans connect of the boundary edges;
//! - a component without non-manifold edges whose triangles can all be wound alike is an oriented surface. With
//!   V vertices, E edges, F triangles and b boundary loops it has the genus `(2 − (V − E + F) − b) / 2`.
//!
//! Contract: linear in the mesh but for sorting; the result depends on the mesh alone.

use crate::charts::weld_by_position_and_uv;
use crate::union_find::UnionFind;
use crate::weld::weld_by_position;
use parbake_model::Mesh;
use rayon::prelude::*;
use serde::Serialize;

/// Components that a [`Topology`] lists at most.
pub const LISTED: usize = 10;

/// The topology of a mesh, welded by position, and its measures.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Topology {
    /// Different positions of triangles' corners.
    pub vertices: usize,
    /// Different pairs of positions that triangles have as sides.
    pub edges: usize,
    /// Triangles with three different corners: those that all other figures are of.
    pub triangles: usize,
    /// Triangles without area: two corners at one place, or all on one line.
    pub degenerate_triangles: usize,
    /// Triangles whose three corners another one before them has, in whatever order.
    pub duplicate_triangles: usize,
    /// Connected pieces.
    pub components: usize,
    /// Pieces without a boundary.
    pub closed_components: usize,
    /// Edges with one triangle.
    pub boundary_edges: usize,
    /// Closed rows of boundary edges: holes, and borders of open sheets.
    pub boundary_loops: usize,
    /// Edges with more than two triangles.
    pub non_manifold_edges: usize,
    /// Vertices around which triangles form more than one fan.
    pub non_manifold_vertices: usize,
    /// Edges of two triangles that run along them in the same direction: one faces in where the other faces out.
    pub inconsistent_edges: usize,
    /// Pieces that cannot be wound alike, as a Möbius strip.
    pub non_orientable_components: usize,
    /// No non-manifold edges and vertices.
    pub manifold: bool,
    /// Vertices − edges + triangles.
    pub euler_characteristic: i64,
    /// Handles of all pieces that are oriented surfaces; none where no piece is one.
    pub genus: Option<u64>,
    /// Pieces that have no genus, having non-manifold edges or no orientation.
    pub components_without_genus: usize,
    /// Surface area, in the model's unit squared.
    pub area: f64,
    /// Volume of the closed pieces that are wound alike, in the model's unit cubed; negative where pieces are
    /// turned inside out; none where no piece is closed.
    pub volume: Option<f64>,
    /// Vertices if welded by position and texture coordinate: as an OBJ file's faces name them without normals.
    pub split_vertices: usize,
    /// Pieces that share such vertices: what the paper counts as components.
    pub split_components: usize,
    /// The first [`LISTED`] components by number of triangles, the largest first.
    pub largest: Vec<Component>,
}

/// A connected piece.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Component {
    /// Its triangles.
    pub triangles: usize,
    /// Its fans − edges + triangles.
    pub euler_characteristic: i64,
    /// Its boundary loops; 0 of a closed one.
    pub boundary_loops: usize,
    /// Its handles; none where it is no oriented surface.
    pub genus: Option<u64>,
    /// Whether all triangles are wound alike.
    pub wound_alike: bool,
    /// Its area.
    pub area: f64,
    /// Its volume; none where it is open or not wound alike.
    pub volume: Option<f64>,
}

/// A triangle's side between welded positions: ends in order of index, the triangle, the corner where it begins, and
/// whether it runs from the lower index to the higher.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    ends: [u32; 2],
    triangle: u32,
    corner: u8,
    up: bool,
}

impl Side {
    /// The triangle's corner at the end with the lower or the higher index, as an index of all corners.
    fn corner_at(&self, high: bool) -> u32 {
        let at = if high == self.up { (self.corner + 1) % 3 } else { self.corner };
        3 * self.triangle + u32::from(at)
    }
}

/// What is gathered of each component, under the index of its leading triangle.
#[derive(Clone, Copy, Default)]
struct Sums {
    component: Component,
    fans: i64,
    edges: i64,
    is_cut: bool,
    is_turned: bool,
    is_one_sided: bool,
    volume: f64,
}

/// Finds all of this.
pub fn topology(mesh: &Mesh) -> Topology {
    let welded = weld_by_position(&mesh.positions);
    let corners: Vec<[u32; 3]> =
        mesh.triangles.par_iter().map(|triangle| triangle.map(|v| welded[v as usize])).collect();
    let is_solid = |t: usize| matches!(corners[t], [a, b, c] if a != b && b != c && c != a);
    let sides = sorted_sides(&corners, is_solid);
    let count = corners.len() as u32;
    let mut pieces = UnionFind::new(count as usize);
    // Each triangle as it is wound, and turned over: where both are in one set, there is no orientation.
    let mut windings = UnionFind::new(2 * count as usize);
    let mut fans = UnionFind::new(3 * count as usize);
    let mut found = Topology::default();
    for run in sides.chunk_by(|a, b| a.ends == b.ends) {
        found.edges += 1;
        found.boundary_edges += usize::from(run.len() == 1);
        found.non_manifold_edges += usize::from(run.len() > 2);
        for other in &run[1..] {
            pieces.union(run[0].triangle, other.triangle);
            fans.union(run[0].corner_at(false), other.corner_at(false));
            fans.union(run[0].corner_at(true), other.corner_at(true));
        }
        if let [a, b] = run {
            let is_turned = a.up == b.up;
            found.inconsistent_edges += usize::from(is_turned);
            windings.union(a.triangle, b.triangle + if is_turned { count } else { 0 });
            windings.union(a.triangle + count, b.triangle + if is_turned { 0 } else { count });
        }
    }
    let mut sums = vec![Sums::default(); corners.len()];
    let loops = boundary_loops(&sides, &mut fans);
    for (corner, is_leader) in loops {
        if is_leader {
            sums[pieces.find(corner / 3) as usize].component.boundary_loops += 1;
        }
    }
    for run in sides.chunk_by(|a, b| a.ends == b.ends) {
        let sum = &mut sums[pieces.find(run[0].triangle) as usize];
        sum.edges += 1;
        sum.is_cut |= run.len() > 2;
        sum.is_turned |= matches!(run, [a, b] if a.up == b.up);
    }
    let mut fans_of_vertex = vec![0u32; mesh.positions.len()];
    for t in 0..corners.len() {
        let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a);
        found.area += 0.5 * normal.length();
        found.degenerate_triangles += usize::from(normal.length_squared() == 0.0);
        if !is_solid(t) {
            continue;
        }
        let piece = pieces.find(t as u32) as usize;
        let sum = &mut sums[piece];
        sum.component.triangles += 1;
        sum.component.area += 0.5 * normal.length();
        // From a corner of the piece, which keeps numbers small where it stands far from the origin.
        let from = mesh.positions[corners[piece][0] as usize].as_dvec3();
        sum.volume += (a - from).dot((b - from).cross(c - from)) / 6.0;
        sum.is_one_sided |= windings.find(t as u32) == windings.find(t as u32 + count);
        for k in 0..3 {
            let corner = 3 * t as u32 + k as u32;
            if fans.find(corner) == corner {
                sum.fans += 1;
                fans_of_vertex[corners[t][k] as usize] += 1;
            }
        }
    }
    found.vertices = fans_of_vertex.iter().filter(|&&n| n > 0).count();
    found.non_manifold_vertices = fans_of_vertex.iter().filter(|&&n| n > 1).count();
    let mut components: Vec<Component> =
        sums.iter().filter(|sum| sum.component.triangles > 0).map(Sums::component).collect();
    found.triangles = components.iter().map(|c| c.triangles).sum();
    found.euler_characteristic = found.vertices as i64 - found.edges as i64 + found.triangles as i64;
    found.manifold = found.non_manifold_edges == 0 && found.non_manifold_vertices == 0;
    found.components = components.len();
    found.boundary_loops = components.iter().map(|c| c.boundary_loops).sum();
    found.closed_components = components.iter().filter(|c| c.boundary_loops == 0).count();
    found.non_orientable_components = sums.iter().filter(|sum| sum.is_one_sided).count();
    found.components_without_genus = components.iter().filter(|c| c.genus.is_none()).count();
    found.genus = components.iter().filter_map(|c| c.genus).reduce(|a, b| a + b);
    found.volume = components.iter().filter_map(|c| c.volume).reduce(|a, b| a + b);
    found.duplicate_triangles = duplicates(&corners, is_solid);
    (found.split_vertices, found.split_components) = split(mesh);
    // Stable: pieces of one size stay in the mesh's order.
    components.sort_by_key(|c| std::cmp::Reverse(c.triangles));
    components.truncate(LISTED);
    found.largest = components;
    found
}

impl Sums {
    fn component(&self) -> Component {
        let euler_characteristic = self.fans - self.edges + self.component.triangles as i64;
        let loops = self.component.boundary_loops;
        let is_surface = !self.is_cut && !self.is_one_sided;
        let wound_alike = is_surface && !self.is_turned;
        let handles = (2 - euler_characteristic - loops as i64) / 2;
        Component {
            euler_characteristic,
            genus: is_surface.then_some(handles.max(0) as u64),
            wound_alike,
            volume: (wound_alike && loops == 0).then_some(self.volume),
            ..self.component
        }
    }
}

/// The sides of all triangles that have three, those between the same positions beside each other.
fn sorted_sides(corners: &[[u32; 3]], is_solid: impl Fn(usize) -> bool + Sync) -> Vec<Side> {
    let of = |triangle: usize| {
        (0..3u8).map(move |corner| {
            let (a, b) = (corners[triangle][corner as usize], corners[triangle][(corner as usize + 1) % 3]);
            Side { ends: [a.min(b), a.max(b)], triangle: triangle as u32, corner, up: a < b }
        })
    };
    let mut sides: Vec<Side> =
        (0..corners.len()).into_par_iter().filter(|&t| is_solid(t)).flat_map_iter(of).collect();
    sides.par_sort_unstable();
    sides
}

/// For each fan on a boundary its leading corner, and whether it leads its loop.
fn boundary_loops(sides: &[Side], fans: &mut UnionFind) -> Vec<(u32, bool)> {
    let mut ends: Vec<[u32; 2]> = sides
        .chunk_by(|a, b| a.ends == b.ends)
        .filter(|run| run.len() == 1)
        .map(|run| [false, true].map(|high| fans.find(run[0].corner_at(high))))
        .collect();
    let mut on_boundary: Vec<u32> = ends.iter().flatten().copied().collect();
    on_boundary.sort_unstable();
    on_boundary.dedup();
    let place = |fan: u32| on_boundary.partition_point(|&other| other < fan) as u32;
    let mut loops = UnionFind::new(on_boundary.len());
    for [a, b] in ends.drain(..) {
        loops.union(place(a), place(b));
    }
    let leads = |i: usize| loops.find(i as u32) as usize == i;
    let leading: Vec<bool> = (0..on_boundary.len()).map(leads).collect();
    on_boundary.into_iter().zip(leading).collect()
}

/// Triangles on the same three positions as one before them.
fn duplicates(corners: &[[u32; 3]], is_solid: impl Fn(usize) -> bool + Sync) -> usize {
    let sorted = |t: usize| {
        let mut triangle = corners[t];
        triangle.sort_unstable();
        triangle
    };
    let mut all: Vec<[u32; 3]> =
        (0..corners.len()).into_par_iter().filter(|&t| is_solid(t)).map(sorted).collect();
    all.par_sort_unstable();
    all.windows(2).filter(|pair| pair[0] == pair[1]).count()
}

/// Vertices welded by position and texture coordinate, and pieces that share one.
fn split(mesh: &Mesh) -> (usize, usize) {
    let welded = weld_by_position_and_uv(mesh);
    let mut sets = UnionFind::new(welded.len());
    let mut used = vec![false; welded.len()];
    for triangle in &mesh.triangles {
        let corners = triangle.map(|v| welded[v as usize]);
        corners.iter().for_each(|&v| used[v as usize] = true);
        sets.union(corners[0], corners[1]);
        sets.union(corners[0], corners[2]);
    }
    let leading = (0..used.len()).filter(|&v| used[v] && sets.find(v as u32) as usize == v).count();
    (used.iter().filter(|&&used| used).count(), leading)
}

#[cfg(test)]
#[path = "topology_tests.rs"]
mod tests;
