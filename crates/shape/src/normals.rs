//! Vertex normals that turn with the faces around them.
//!
//! A vertex's faces have a mean normal, weighted by their angles at the vertex, at rest and
//! after the move; `n' = n + (mean after − mean before)`, made unit. A vertex whose faces
//! stayed keeps its normal to the bit, hard edges stay hard, and what an artist set by hand
//! turns along.
//!
//! Contract: vertices are those of the file, so a split for a hard edge has its own faces.
//! Vertices at one position with one normal share their faces: seams of texture coordinates
//! do not crease.

use glam::Vec3;
use std::collections::BTreeMap;

/// Angle-weighted sums of the faces' normals, made unit, for each group of vertices.
fn means(positions: &[Vec3], triangles: &[[u32; 3]], groups: &[usize]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; groups.len()];
    for triangle in triangles {
        let corners = triangle.map(|i| positions[i as usize]);
        let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        for k in 0..3 {
            let (to_next, to_last) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
            let angle = to_next.cross(to_last).length().atan2(to_next.dot(to_last));
            sums[groups[triangle[k] as usize]] += face * angle;
        }
    }
    groups.iter().map(|&group| sums[group].normalize_or_zero()).collect()
}

/// For each vertex the first one with its position and its normal.
fn groups(rest: &[Vec3], normals: &[Vec3]) -> Vec<usize> {
    let mut first = BTreeMap::new();
    let bits = |v: Vec3| v.to_array().map(|x| (x + 0.0).to_bits());
    (rest.iter().zip(normals).enumerate())
        .map(|(vertex, (&p, &n))| *first.entry((bits(p), bits(n))).or_insert(vertex))
        .collect()
}

/// V normals of a mesh whose vertices moved from `rest` to `now`.
pub fn turned_normals(rest: &[Vec3], now: &[Vec3], normals: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let groups = groups(rest, normals);
    let (before, after) = (means(rest, triangles, &groups), means(now, triangles, &groups));
    (normals.iter().zip(before.iter().zip(&after)))
        .map(
            |(&normal, (&before, &after))| {
                if before == after { normal } else { (normal + (after - before)).normalize_or(normal) }
            },
        )
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects shading: normals follow a turn, and stay where nothing moved.
    #[test]
    fn normals_turn_with_their_faces() {
        let rest = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let normals = [Vec3::Z; 3];
        assert_eq!(turned_normals(&rest, &rest, &normals, &[[0, 1, 2]]), normals);
        let tilted = rest.map(|p| Vec3::new(p.x, p.y, 0.3 * p.x));
        let want = Vec3::new(-0.3, 0.0, 1.0).normalize();
        for n in turned_normals(&rest, &tilted, &normals, &[[0, 1, 2]]) {
            assert!(n.distance(want) < 1e-6);
        }
    }
}
