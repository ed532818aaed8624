//! A layout while it is made: each triangle's corners by themselves, so that charts can
//! be cut without looking after vertices.

use crate::Layout;
use glam::{DVec2, Vec2, dvec2};
use parbake_mesh::vertices::{drop_unused, push_copy};
use parbake_mesh::weld_by_position;
use parbake_model::Mesh;

/// The chart of a triangle that has no area in space: it is given a place at the end.
pub(crate) const NONE: u32 = u32::MAX;

/// Texture coordinates by triangle corner, in the order and with the signs of
/// [`Layout`]: an unmirrored triangle has a positive area.
#[derive(Clone)]
pub(crate) struct Corners {
    /// F × three corners.
    pub uv: Vec<[DVec2; 3]>,
    /// F labels: triangles with one label are one chart as far as they share edges.
    pub chart: Vec<u32>,
    /// The next label that is free.
    pub next: u32,
}

/// The corner of a mesh's triangle that is corner `k` of the layout's.
pub(crate) const MESH_CORNER: [usize; 3] = [0, 2, 1];

/// What stays the same while corners move.
pub(crate) struct Surface<'a> {
    pub mesh: &'a Mesh,
    /// The layout as delivered: its rest shapes are needed.
    pub delivered: Layout,
    /// For each vertex the first at its position.
    pub position: Vec<u32>,
}

impl<'a> Surface<'a> {
    pub fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, delivered: Layout::new(mesh), position: weld_by_position(&mesh.positions) }
    }

    /// Whether a triangle has an area in space.
    pub fn is_live(&self, t: usize) -> bool {
        self.delivered.rest_area(t) > 0.0
    }

    /// The welded positions of a triangle's corners, in the layout's order.
    pub fn positions(&self, t: usize) -> [u32; 3] {
        MESH_CORNER.map(|k| self.position[self.mesh.triangles[t][k] as usize])
    }

    /// A place for a triangle by itself: its true shape, unless that is too thin for
    /// 32-bit numbers; then a thin triangle of the same length. Scaled by `scale`.
    pub fn alone(&self, t: usize, scale: f64) -> [DVec2; 3] {
        let rest = self.delivered.rest[t] * scale;
        let (b, c) = (rest.x_axis, rest.y_axis);
        let longest = b.length().max(c.length()).max(b.distance(c));
        if b.perp_dot(c) > 0.02 * longest * longest {
            [DVec2::ZERO, b, c]
        } else {
            [DVec2::ZERO, dvec2(longest, 0.0), dvec2(0.5, 0.05) * longest]
        }
    }

    /// The layout of the triangles that have a chart, with their indices. No two charts
    /// share a point; `point_of_vertex` is empty.
    pub fn layout(&self, corners: &Corners) -> (Layout, Vec<u32>) {
        let live: Vec<u32> =
            (0..corners.chart.len() as u32).filter(|&t| corners.chart[t as usize] != NONE).collect();
        let (mut triangles, charts) = self.connected(corners, &live);
        // Charts that touch in a point get one each.
        let (split, firsts) = numbered(live.len(), |i, k| (charts[i], triangles[i][k]));
        triangles = split;
        let points = firsts.into_iter().map(|(i, k)| corners.uv[live[i] as usize][k]).collect();
        let rest = live.iter().map(|&t| self.delivered.rest[t as usize]).collect();
        (Layout { points, triangles, rest, charts, point_of_vertex: Vec::new() }, live)
    }

    /// Some triangles over numbered points, and for each its piece: those that share edges
    /// in space and texture and have one label.
    pub fn connected(&self, corners: &Corners, triangles: &[u32]) -> (Vec<[u32; 3]>, Vec<u32>) {
        let (numbered, _) = numbered(triangles.len(), |i, k| {
            let t = triangles[i] as usize;
            // Adding zero makes both zeros one.
            let uv = corners.uv[t][k] + DVec2::ZERO;
            (self.positions(t)[k], uv.x.to_bits(), uv.y.to_bits(), corners.chart[t])
        });
        let pieces = connected(&numbered);
        (numbered, pieces)
    }

    /// The mesh with these texture coordinates: vertices split where seams run, all
    /// attributes carried along but tangents, which belonged to the layout before.
    /// Also for each new vertex the one that it was.
    pub fn mesh_with(&self, corners: &Corners) -> (Mesh, Vec<u32>) {
        let mut mesh = self.mesh.clone();
        mesh.tangents.clear();
        mesh.uvs.resize(mesh.positions.len(), Vec2::ZERO);
        let uv = |i: usize, k: usize| {
            // Adding zero makes both zeros one.
            corners.uv[i][k].as_vec2() + Vec2::ZERO
        };
        let vertex = |i: usize, k: usize| self.mesh.triangles[i][MESH_CORNER[k]];
        let (ids, firsts) =
            numbered(corners.uv.len(), |i, k| (vertex(i, k), uv(i, k).x.to_bits(), uv(i, k).y.to_bits()));
        let mut source: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        let mut taken = vec![false; mesh.positions.len()];
        let mut new_index = Vec::with_capacity(firsts.len());
        for (i, k) in firsts {
            let original = vertex(i, k);
            let index = if std::mem::replace(&mut taken[original as usize], true) {
                source.push(original);
                push_copy(&mut mesh, original)
            } else {
                original
            };
            mesh.uvs[index as usize] = uv(i, k);
            new_index.push(index);
        }
        for (triangle, ids) in mesh.triangles.iter_mut().zip(&ids) {
            for k in 0..3 {
                triangle[MESH_CORNER[k]] = new_index[ids[k] as usize];
            }
        }
        let mut used = vec![false; source.len()];
        mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
        drop_unused(&mut mesh);
        source = source.into_iter().zip(used).filter_map(|(v, used)| used.then_some(v)).collect();
        (mesh, source)
    }
}

/// Numbers equal corners alike: for each triangle its three numbers, and for each number
/// the first corner that has it. Numbers follow the order of first corners.
pub(crate) fn numbered<K: Ord + Copy>(
    count: usize,
    key: impl Fn(usize, usize) -> K,
) -> (Vec<[u32; 3]>, Vec<(usize, usize)>) {
    let mut order: Vec<(K, u32)> = (0..3 * count).map(|c| (key(c / 3, c % 3), c as u32)).collect();
    order.sort_unstable();
    let mut first = vec![0u32; 3 * count];
    for run in order.chunk_by(|a, b| a.0 == b.0) {
        run.iter().for_each(|&(_, corner)| first[corner as usize] = run[0].1);
    }
    let mut ids = vec![[0u32; 3]; count];
    let mut firsts = Vec::new();
    for corner in 0..3 * count {
        let leader = first[corner] as usize;
        ids[corner / 3][corner % 3] = if leader == corner {
            firsts.push((corner / 3, corner % 3));
            firsts.len() as u32 - 1
        } else {
            ids[leader / 3][leader % 3]
        };
    }
    (ids, firsts)
}

/// Components of triangles that share edges, numbered by their first triangles.
pub(crate) fn connected(triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
    for (t, corners) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            if a != b {
                edges.push(([a.min(b), a.max(b)], t as u32));
            }
        }
    }
    edges.sort_unstable();
    let mut leader: Vec<u32> = (0..triangles.len() as u32).collect();
    fn find(leader: &mut [u32], mut t: u32) -> u32 {
        while leader[t as usize] != t {
            leader[t as usize] = leader[leader[t as usize] as usize];
            t = leader[t as usize];
        }
        t
    }
    for pair in edges.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let (a, b) = (find(&mut leader, pair[0].1), find(&mut leader, pair[1].1));
        leader[a.max(b) as usize] = a.min(b);
    }
    let mut count = 0;
    let mut number = vec![0; triangles.len()];
    for t in 0..triangles.len() {
        let first = find(&mut leader, t as u32) as usize;
        number[t] = if first == t {
            count += 1;
            count - 1
        } else {
            number[first]
        };
    }
    number
}
