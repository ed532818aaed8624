//! Hard edges: vertices are split along them, and normals are smooth between them alone.
//!
//! Around a vertex, triangles that meet at edges that are not hard belong together. Each such group has a vertex of its own,
//! whose normal is the mean of the group's faces, weighted by their angles (`normals.rs`). A hard edge that ends
//! at a vertex splits nothing there, since its two sides meet around the vertex.
//!
//! Contract: for meshes without attributes other than positions, triangles and materials; triangles and their order stay, and
//! where no edge is hard so do the vertices.

use crate::normals::group_normals;
use crate::union_find::UnionFind;
use crate::weld::weld_by_position;
use parbake_model::Mesh;
use std::collections::BTreeMap;

/// The mesh with unit normals, its vertices split where `is_hard` says so of an edge's two triangles and its two vertices.
pub fn split_at_hard_edges(mesh: &Mesh, is_hard: impl Fn([usize; 2], [u32; 2]) -> bool) -> Mesh {
    let mut edges: BTreeMap<[u32; 2], Vec<[usize; 2]>> = BTreeMap::new();
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        for k in 0..3 {
            let [a, b] = [triangle[k], triangle[(k + 1) % 3]];
            edges.entry([a.min(b), a.max(b)]).or_default().push([index, k]);
        }
    }
    let mut corners = UnionFind::new(3 * mesh.triangles.len());
    let mut has_hard_edge = vec![false; mesh.positions.len()];
    let corner_of = |triangle: usize, vertex: u32| {
        (3 * triangle + mesh.triangles[triangle].iter().position(|&v| v == vertex).unwrap_or(0)) as u32
    };
    for (edge, users) in &edges {
        if let [[one, _], [other, _]] = users[..]
            && is_hard([one, other], *edge)
        {
            edge.iter().for_each(|&v| has_hard_edge[v as usize] = true);
            continue;
        }
        for pair in users.windows(2) {
            for &vertex in edge {
                corners.union(corner_of(pair[0][0], vertex), corner_of(pair[1][0], vertex));
            }
        }
    }
    let mut out = mesh.clone();
    // Elsewhere vertices at one position have one normal.
    let welded = weld_by_position(&mesh.positions);
    let stands_for =
        |(v, &first): (usize, &u32)| if has_hard_edge[first as usize] { v as u32 } else { first };
    let mut groups: Vec<u32> = welded.iter().enumerate().map(stands_for).collect();
    // The first group of a vertex keeps it.
    let mut owners: Vec<Option<u32>> = vec![None; mesh.positions.len()];
    let mut others: BTreeMap<u32, u32> = BTreeMap::new();
    for (index, triangle) in out.triangles.iter_mut().enumerate() {
        for (k, own) in triangle.iter_mut().enumerate() {
            let vertex = *own as usize;
            if !has_hard_edge[vertex] {
                continue;
            }
            groups[vertex] = *own;
            let group = corners.find((3 * index + k) as u32);
            if *owners[vertex].get_or_insert(group) != group {
                *own = *others.entry(group).or_insert_with(|| {
                    out.positions.push(mesh.positions[vertex]);
                    groups.push(groups.len() as u32);
                    groups.len() as u32 - 1
                });
            }
        }
    }
    out.normals = group_normals(&out, &groups);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smooth_normals;
    use parbake_model::glam::Vec3;

    /// Two squares that meet at a right angle: x from 0 to 1 at z = 0, and z from 0 to 1 at x = 0.
    fn bent() -> Mesh {
        let positions = [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0), (0, 0, 1), (0, 1, 1)];
        Mesh {
            positions: positions.map(|(x, y, z)| Vec3::new(x as f32, y as f32, z as f32)).to_vec(),
            triangles: vec![[0, 2, 3], [0, 3, 1], [0, 1, 5], [0, 5, 4]],
            triangle_materials: vec![0; 4],
            ..Mesh::default()
        }
    }

    /// Protects flat sides: each side of a hard edge has the normals of its own faces, and nothing else changes.
    #[test]
    fn sides_of_a_hard_edge_are_flat() {
        let mesh = bent();
        let smooth = split_at_hard_edges(&mesh, |_, _| false);
        assert_eq!((smooth.positions.len(), &smooth.triangles), (6, &mesh.triangles));
        assert_eq!(smooth.normals, smooth_normals(&mesh));
        let hard = split_at_hard_edges(&mesh, |_, edge| edge == [0, 1]);
        assert_eq!(hard.positions.len(), 8);
        for (index, triangle) in hard.triangles.iter().enumerate() {
            assert_eq!(hard.corners(index), mesh.corners(index));
            let face = mesh.area_normal(index).normalize();
            assert!(triangle.iter().all(|&v| (hard.normals[v as usize] - face).length() < 1e-6), "{index}");
        }
    }
}
