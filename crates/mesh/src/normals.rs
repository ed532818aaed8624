//! Vertex normals from faces: each corner adds its face's unit normal times its
//! angle (Thürmer and Wüthrich, "Computing Vertex Normals from Polygonal Facets",
//! JGT 3, 1998), so that the way a face is cut into triangles does not matter.
//!
//! Vertices are welded by position first: a texture seam does not crease the
//! surface. Sums are in double precision, which no finite position overflows.
//!
//! Contract: the results are unit vectors; +Y where no face gives a direction.

use crate::weld::weld_by_position;
use parbake_model::Mesh;
use parbake_model::glam::{DVec3, Vec3};

/// V smooth unit normals, the same for all vertices at one position.
pub fn smooth_normals(mesh: &Mesh) -> Vec<Vec3> {
    group_normals(mesh, &weld_by_position(&mesh.positions))
}

/// V unit normals, the same for all vertices of a group; `groups` has for each vertex one that stands for its group.
pub(crate) fn group_normals(mesh: &Mesh, groups: &[u32]) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        let corners = mesh.corners(index).map(|p| p.as_dvec3());
        let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        for k in 0..3 {
            sums[groups[triangle[k] as usize] as usize] += face * corner_angle(mesh, index, k);
        }
    }
    groups.iter().map(|&v| sums[v as usize].normalize_or(DVec3::Y).as_vec3()).collect()
}

/// A triangle's angle at its corner `k`, in radians.
pub(crate) fn corner_angle(mesh: &Mesh, triangle: usize, k: usize) -> f64 {
    let corners = mesh.corners(triangle).map(Vec3::as_dvec3);
    let (to_next, to_last) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
    // Exact for small angles too, unlike the arc cosine.
    to_next.cross(to_last).length().atan2(to_next.dot(to_last))
}

/// Gives the mesh V unit normals: smooth ones where it has none at all, repaired
/// from its faces where a vertex's is zero or not finite, and its own, brought to
/// unit length, elsewhere. Returns how many came from the faces.
pub fn ensure_normals(mesh: &mut Mesh) -> usize {
    if mesh.normals.len() != mesh.positions.len() {
        mesh.normals = smooth_normals(mesh);
        return mesh.normals.len();
    }
    let unit = |n: Vec3| n.as_dvec3().try_normalize().map(|n| n.as_vec3());
    let broken = mesh.normals.iter().filter(|&&n| unit(n).is_none()).count();
    let repaired = if broken > 0 { smooth_normals(mesh) } else { Vec::new() };
    for (index, normal) in mesh.normals.iter_mut().enumerate() {
        *normal = unit(*normal).unwrap_or_else(|| repaired[index]);
    }
    broken
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit cube of 12 triangles over 8 vertices.
    fn cube() -> Mesh {
        let positions =
            (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32)).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> =
            quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Mesh { triangle_materials: vec![0; 12], positions, triangles, ..Mesh::default() }
    }

    /// Protects the weighting: a cube's corners point along its diagonals however
    /// its squares are cut into triangles.
    #[test]
    fn cube_corners_point_along_diagonals() {
        let m = cube();
        for (p, n) in m.positions.iter().zip(smooth_normals(&m)) {
            assert!(n.distance((*p - Vec3::splat(0.5)).normalize()) < 1e-6, "{p} {n}");
        }
    }

    /// Protects smoothness across texture seams.
    #[test]
    fn seams_stay_smooth() {
        let mut m = cube();
        let shared = smooth_normals(&m);
        m.positions = m.triangles.iter().flatten().map(|&v| m.positions[v as usize]).collect();
        let vertices: Vec<u32> = m.triangles.iter().flatten().copied().collect();
        m.triangles = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        for (n, v) in smooth_normals(&m).into_iter().zip(vertices) {
            assert_eq!(n, shared[v as usize]);
        }
    }

    /// Protects files with broken normals, and the count that the report shows.
    #[test]
    fn only_broken_normals_are_replaced() {
        let mut m = cube();
        assert_eq!(ensure_normals(&mut m), 8);
        let smooth = m.normals.clone();
        m.normals[0] = Vec3::ZERO;
        m.normals[1] = Vec3::new(f32::NAN, 0.0, 1.0);
        m.normals[2] = Vec3::new(0.0, 1e-30, 0.0);
        m.normals[3] = Vec3::new(3e38, 3e38, 0.0);
        assert_eq!(ensure_normals(&mut m), 2);
        assert_eq!(m.normals[..2], smooth[..2]);
        assert_eq!(m.normals[2], Vec3::Y);
        assert!(m.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
    }

    /// Protects against degenerate and enormous triangles and unused vertices.
    #[test]
    fn always_unit() {
        let mut m = cube();
        m.positions.push(Vec3::splat(9.0));
        m.positions.extend([Vec3::MAX, Vec3::MIN, Vec3::new(3e38, -3e38, 1.0)]);
        m.triangles = vec![[0, 0, 1], [1, 1, 1], [9, 10, 11]];
        assert!(smooth_normals(&m).iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
    }
}
