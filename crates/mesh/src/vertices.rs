//! Vertices as wholes: copying, blending and dropping all attributes of one at a
//! time, so that no other file has to know the list of attributes.
//!
//! Contract: attributes that the mesh lacks (empty vectors) stay empty.

use parbake_model::Mesh;
use parbake_model::glam::Vec3;

/// Appends a copy of a vertex and returns its index.
pub fn push_copy(mesh: &mut Mesh, vertex: u32) -> u32 {
    fn push<T: Copy>(values: &mut Vec<T>, vertex: usize) {
        if let Some(&value) = values.get(vertex) {
            values.push(value);
        }
    }
    let copy = mesh.positions.len() as u32;
    let vertex = vertex as usize;
    push(&mut mesh.positions, vertex);
    push(&mut mesh.normals, vertex);
    push(&mut mesh.tangents, vertex);
    push(&mut mesh.uvs, vertex);
    push(&mut mesh.uvs1, vertex);
    push(&mut mesh.colors, vertex);
    push(&mut mesh.parallax_offsets, vertex);
    copy
}

/// Appends the vertex halfway between two others and returns its index: the mean
/// of each attribute, normals brought back to unit length. Tangents are not
/// blended, since their handedness may differ: the mesh must have none.
pub fn push_midpoint(mesh: &mut Mesh, a: u32, b: u32) -> u32 {
    macro_rules! push_mean {
        ($values:expr) => {
            if let (Some(&x), Some(&y)) = ($values.get(a as usize), $values.get(b as usize)) {
                // Halved before the sum, which could overflow.
                $values.push(x * 0.5 + y * 0.5);
            }
        };
    }
    debug_assert!(mesh.tangents.is_empty());
    let midpoint = mesh.positions.len() as u32;
    push_mean!(mesh.positions);
    push_mean!(mesh.uvs);
    push_mean!(mesh.uvs1);
    push_mean!(mesh.colors);
    push_mean!(mesh.parallax_offsets);
    if let (Some(&x), Some(&y)) = (mesh.normals.get(a as usize), mesh.normals.get(b as usize)) {
        mesh.normals.push((x + y).try_normalize().unwrap_or(x));
    }
    midpoint
}

/// Drops the vertices that no triangle uses; the others keep their order.
pub fn drop_unused(mesh: &mut Mesh) {
    fn keep<T>(values: &mut Vec<T>, used: &[bool]) {
        let mut index = 0;
        values.retain(|_| {
            index += 1;
            used[index - 1]
        });
    }
    let mut used = vec![false; mesh.positions.len()];
    for &vertex in mesh.triangles.iter().flatten() {
        used[vertex as usize] = true;
    }
    let mut next = 0;
    let renumbered: Vec<u32> = used
        .iter()
        .map(|&u| {
            next += u32::from(u);
            next.wrapping_sub(1)
        })
        .collect();
    keep(&mut mesh.positions, &used);
    keep(&mut mesh.normals, &used);
    keep(&mut mesh.tangents, &used);
    keep(&mut mesh.uvs, &used);
    keep(&mut mesh.uvs1, &used);
    keep(&mut mesh.colors, &used);
    keep(&mut mesh.parallax_offsets, &used);
    for triangle in &mut mesh.triangles {
        *triangle = triangle.map(|v| renumbered[v as usize]);
    }
}

/// Any unit vector orthogonal to `normal`: the coordinate axis that is farthest
/// from it, projected. +X where the normal is zero or not finite.
pub fn any_orthogonal(normal: Vec3) -> Vec3 {
    let n = normal.abs();
    let axis = if n.x <= n.y && n.x <= n.z {
        Vec3::X
    } else if n.y <= n.z {
        Vec3::Y
    } else {
        Vec3::Z
    };
    match normal.try_normalize() {
        Some(n) => (axis - n * n.dot(axis)).normalize_or(Vec3::X),
        None => Vec3::X,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::{Vec2, Vec4};

    fn mesh() -> Mesh {
        Mesh {
            positions: (0..5).map(|i| Vec3::splat(i as f32)).collect(),
            normals: vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::X, Vec3::NEG_X],
            uvs: (0..5).map(|i| Vec2::splat(i as f32 * 0.1)).collect(),
            colors: (0..5).map(|i| Vec4::splat(i as f32)).collect(),
            triangles: vec![[4, 1, 3]],
            triangle_materials: vec![0],
            ..Mesh::default()
        }
    }

    /// Protects the pairing of attributes when vertices disappear.
    #[test]
    fn unused_vertices_go_and_the_rest_keep_their_attributes() {
        let mut m = mesh();
        drop_unused(&mut m);
        assert_eq!(m.triangles, [[2, 0, 1]]);
        assert_eq!(m.positions, [Vec3::splat(1.0), Vec3::splat(3.0), Vec3::splat(4.0)]);
        assert_eq!((m.normals.len(), m.uvs.len(), m.colors.len(), m.uvs1.len()), (3, 3, 3, 0));
        assert_eq!(m.colors[2], Vec4::splat(4.0));
    }

    /// Protects the midpoint's normal where the two ends' normals cancel out.
    #[test]
    fn midpoints_blend_everything_and_keep_unit_normals() {
        let mut m = mesh();
        let v = push_midpoint(&mut m, 0, 1) as usize;
        assert_eq!((m.positions[v], m.uvs[v]), (Vec3::splat(0.5), Vec2::splat(0.05)));
        assert!((m.normals[v].length() - 1.0).abs() < 1e-6);
        let opposed = push_midpoint(&mut m, 0, 4) as usize;
        assert_eq!(m.normals[opposed], Vec3::X);
    }

    /// Protects the fallback tangents.
    #[test]
    fn orthogonal_is_orthogonal_and_unit() {
        for n in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(1.0, -2.0, 0.5), Vec3::ONE, Vec3::ZERO, Vec3::MAX] {
            let t = any_orthogonal(n);
            assert!((t.length() - 1.0).abs() < 1e-6 && t.dot(n.normalize_or_zero()).abs() < 1e-6, "{n}");
        }
    }
}
