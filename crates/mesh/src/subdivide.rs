//! Midpoint subdivision: every triangle becomes four of a quarter of its area, the
//! shape unchanged. For measuring how time and memory grow with a model.

use crate::vertices::push_midpoint;
use parbake_model::Mesh;
use std::collections::HashMap;

/// The mesh with 4 F triangles: triangle i becomes 4 i … 4 i + 3 (its three
/// corners in order, then the middle). Old vertices keep their indices; new ones
/// follow in the order in which the triangles' edges first name them. Tangents are
/// dropped.
pub fn subdivide(mesh: &Mesh) -> Mesh {
    let mut fine = Mesh { tangents: Vec::new(), ..mesh.clone() };
    fine.triangles = Vec::with_capacity(4 * mesh.triangles.len());
    let mut midpoints = HashMap::with_capacity(3 * mesh.triangles.len() / 2);
    for &[a, b, c] in &mesh.triangles {
        let mut between = |p: u32, q: u32| {
            *midpoints.entry((p.min(q), p.max(q))).or_insert_with(|| push_midpoint(&mut fine, p, q))
        };
        let (ab, bc, ca) = (between(a, b), between(b, c), between(c, a));
        fine.triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    fine.triangle_materials = mesh.triangle_materials.iter().flat_map(|&m| [m; 4]).collect();
    fine
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::{Vec2, Vec3};
    use proptest::prelude::*;

    /// Protects shared edges (no cracks, no duplicates), materials and windings.
    #[test]
    fn a_square_becomes_eight_triangles_over_nine_vertices() {
        let m = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            normals: vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_materials: vec![0, 1],
            ..Mesh::default()
        };
        let fine = subdivide(&m);
        assert_eq!((fine.positions.len(), fine.triangles.len(), fine.normals.len()), (9, 8, 9));
        assert_eq!(fine.triangle_materials, [0, 0, 0, 0, 1, 1, 1, 1]);
        for (p, uv) in fine.positions.iter().zip(&fine.uvs) {
            assert_eq!(p.truncate(), *uv);
        }
        assert!((0..8).all(|t| fine.area_normal(t).z == 0.25));
        assert!(fine.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
    }

    proptest! {
        /// Protects measurements of growth: same surface, four times the triangles.
        #[test]
        fn area_is_preserved(
            points in prop::collection::vec((-1f32..1.0, -1f32..1.0, -1f32..1.0), 3..12),
            corners in prop::collection::vec((0usize..12, 0usize..12, 0usize..12), 1..20),
        ) {
            let n = points.len();
            let m = Mesh {
                positions: points.into_iter().map(Vec3::from).collect(),
                triangles: corners.iter().map(|c| [c.0 % n, c.1 % n, c.2 % n].map(|v| v as u32)).collect(),
                triangle_materials: vec![0; corners.len()],
                ..Mesh::default()
            };
            let fine = subdivide(&m);
            let area = |m: &Mesh| -> f32 { (0..m.triangles.len()).map(|t| m.area_normal(t).length()).sum() };
            prop_assert_eq!(fine.triangles.len(), 4 * m.triangles.len());
            prop_assert!((area(&fine) - area(&m)).abs() < 1e-4 * area(&m).max(1.0));
        }
    }
}
