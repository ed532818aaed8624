//! Charts: the connected pieces of a texture layout.
//!
//! Two triangles lie in one chart when they share an edge both in space and in
//! the texture. Corners are welded by (position, texture coordinate), so that
//! vertices which are split for their normals or tangents alone cut no chart.

use crate::texel_map::TexelMap;
use crate::union_find::UnionFind;
use crate::weld::{ordered_bits, weld_by};
use parbake_model::Mesh;
use rayon::prelude::*;

/// For each of the V vertices the first one at the same position and texture
/// coordinate.
pub fn weld_by_position_and_uv(mesh: &Mesh) -> Vec<u32> {
    weld_by(mesh.positions.len(), |v| {
        let [x, y, z] = mesh.positions[v].to_array().map(ordered_bits);
        let uv = mesh.uvs.get(v).copied().unwrap_or_default();
        [x, y, z, ordered_bits(uv.x), ordered_bits(uv.y)]
    })
}

/// For each of the F triangles the index of its chart; charts are numbered in the
/// order of their first triangles.
pub fn charts(mesh: &Mesh) -> Vec<u32> {
    let welded = weld_by_position_and_uv(mesh);
    let mut edges: Vec<([u32; 2], u32)> = mesh
        .triangles
        .par_iter()
        .enumerate()
        .flat_map_iter(|(index, triangle)| {
            let corners = triangle.map(|v| welded[v as usize]);
            (0..3).map(move |k| {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                ([a.min(b), a.max(b)], index as u32)
            })
        })
        // An edge of no length is a vertex, and vertices do not connect.
        .filter(|(edge, _)| edge[0] != edge[1])
        .collect();
    edges.par_sort_unstable();
    let mut sets = UnionFind::new(mesh.triangles.len());
    for pair in edges.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        sets.union(pair[0].1, pair[1].1);
    }
    let mut chart_of = vec![u32::MAX; mesh.triangles.len()];
    let mut count = 0;
    for index in 0..mesh.triangles.len() {
        // The leader is its set's first triangle: already numbered, or this one.
        let leader = sets.find(index as u32) as usize;
        if leader == index {
            chart_of[index] = count;
            count += 1;
        } else {
            chart_of[index] = chart_of[leader];
        }
    }
    chart_of
}

/// For each of the size² texels the chart of its triangle, `u32::MAX` where there
/// is none.
pub fn texel_charts(map: &TexelMap, charts: &[u32]) -> Vec<u32> {
    map.triangle.par_iter().map(|&t| charts.get(t as usize).copied().unwrap_or(u32::MAX)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::{Vec2, Vec3};

    /// A strip of `count` squares along x, each with four vertices of its own.
    fn strip(count: usize) -> Mesh {
        let mut m = Mesh::default();
        for i in 0..count {
            for (x, y) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
                m.positions.push(Vec3::new((i + x) as f32, y as f32, 0.0));
                m.uvs.push(Vec2::new((i + x) as f32, y as f32) * 0.1);
            }
            let v = 4 * i as u32;
            m.triangles.extend([[v, v + 1, v + 2], [v, v + 2, v + 3]]);
        }
        m.triangle_materials = vec![0; m.triangles.len()];
        m
    }

    /// Protects charts from splits of normals and tangents, which duplicate
    /// vertices without cutting the texture.
    #[test]
    fn split_vertices_do_not_cut_charts() {
        assert_eq!(charts(&strip(3)), [0; 6]);
    }

    /// Protects the two ways in which a chart may end: moved in the texture, or
    /// apart in space though adjacent in the texture.
    #[test]
    fn an_edge_must_be_shared_in_space_and_texture() {
        let mut moved = strip(3);
        for uv in &mut moved.uvs[4..8] {
            uv.y += 0.5;
        }
        assert_eq!(charts(&moved), [0, 0, 1, 1, 2, 2]);
        let mut apart = strip(3);
        for p in &mut apart.positions[8..12] {
            p.z += 1.0;
        }
        assert_eq!(charts(&apart), [0, 0, 0, 0, 1, 1]);
    }

    /// Protects thousands of charts, triangles of one point, and meshes without
    /// texture coordinates.
    #[test]
    fn many_charts_and_odd_meshes() {
        let mut m = strip(3000);
        for (i, p) in m.positions.iter_mut().enumerate() {
            p.y += (i / 4) as f32 * 3.0;
        }
        let chart_of = charts(&m);
        assert!(chart_of.iter().enumerate().all(|(t, &c)| c as usize == t / 2));
        m.uvs.clear();
        m.triangles[5] = [0, 0, 0];
        assert_eq!(charts(&m).len(), 6000);
        assert!(charts(&Mesh::default()).is_empty());
    }
}
