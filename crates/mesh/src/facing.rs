//! Normals that look away from their own faces, turned round.
//!
//! Where a face's vertex normals point to its back, it is lit from behind whichever side is seen:
//! black, and no normal map can tilt it by more than 90°. Coarse copies have such faces where thin
//! parts collapsed to their middle, so that the normals of both sides met in one vertex.
//!
//! A corner whose normal is 90° or more away from its face's takes the mean of the faces around its
//! position that look the same way as its own, weighted by their angles there; its vertex is split
//! for that. All other corners keep what they have, to the bit.
//!
//! Contract: the mesh has V normals. Positions and texture coordinates of corners stay, so no chart
//! is cut (`charts.rs`); triangles without area are left alone. Where anything is turned, vertices
//! that no triangle uses are dropped.

use crate::normals::corner_angle;
use crate::vertices::{drop_unused, push_copy};
use crate::weld::weld_by_position;
use parbake_model::Mesh;
use parbake_model::glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// Turns them; returns how many triangles had such corners.
pub fn face_outwards(mesh: &mut Mesh) -> usize {
    let faces: Vec<DVec3> = (0..mesh.triangles.len()).map(|i| unit_normal(mesh, i)).collect();
    let looks_back = |&(triangle, k): &(usize, usize)| {
        let normal = mesh.normals[mesh.triangles[triangle][k] as usize].as_dvec3();
        faces[triangle] != DVec3::ZERO && normal.dot(faces[triangle]) <= 0.0
    };
    let corners = |triangle| (0..3).map(move |k| (triangle, k));
    let back: Vec<(usize, usize)> = (0..faces.len()).flat_map(corners).filter(looks_back).collect();
    if back.is_empty() {
        return 0;
    }
    let welded = weld_by_position(&mesh.positions);
    let mut around: BTreeMap<u32, Vec<(usize, usize)>> = BTreeMap::new();
    for (triangle, k) in (0..faces.len()).flat_map(corners) {
        around.entry(welded[mesh.triangles[triangle][k] as usize]).or_default().push((triangle, k));
    }
    let mut split: BTreeMap<(u32, [u32; 3]), u32> = BTreeMap::new();
    for &(triangle, k) in &back {
        let vertex = mesh.triangles[triangle][k];
        let normal = around[&welded[vertex as usize]]
            .iter()
            .filter(|(other, _)| faces[*other].dot(faces[triangle]) > 0.0)
            .map(|&(other, corner)| faces[other] * corner_angle(mesh, other, corner))
            .sum::<DVec3>()
            .normalize_or(faces[triangle])
            .as_vec3();
        let key = (vertex, normal.to_array().map(f32::to_bits));
        let own = *split.entry(key).or_insert_with(|| {
            let copy = push_copy(mesh, vertex);
            mesh.normals[copy as usize] = normal;
            copy
        });
        mesh.triangles[triangle][k] = own;
    }
    drop_unused(mesh);
    back.chunk_by(|a, b| a.0 == b.0).count()
}

/// Share of a mesh's area, 0 to 1, on triangles whose mean vertex normal points to their back; 0 without area. The mesh
/// has V normals.
pub fn area_facing_back(mesh: &Mesh) -> f64 {
    let (mut all, mut back) = (0.0, 0.0);
    for (index, corners) in mesh.triangles.iter().enumerate() {
        let face = mesh.area_normal(index).as_dvec3();
        let sum: DVec3 = corners.iter().map(|&vertex| mesh.normals[vertex as usize].as_dvec3()).sum();
        all += face.length();
        back += if sum.dot(face) < 0.0 { face.length() } else { 0.0 };
    }
    if all > 0.0 { back / all } else { 0.0 }
}

fn unit_normal(mesh: &Mesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle).map(Vec3::as_dvec3);
    (b - a).cross(c - a).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{charts, smooth_normals};
    use parbake_model::glam::Vec2;

    /// A thin fin that collapsed: two sheets back to back over the same four corners, one of them
    /// larger, whose smooth normals therefore all look its way.
    fn fin() -> Mesh {
        let positions = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.5]];
        let positions: Vec<Vec3> = positions.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect();
        let triangles = vec![[0, 1, 2], [0, 2, 3], [1, 4, 2], [0, 2, 1], [0, 3, 2]];
        let mut mesh = Mesh {
            uvs: (0..5).map(|i| Vec2::new(i as f32, 0.5 * (i * i) as f32)).collect(),
            triangle_materials: vec![0; triangles.len()],
            normals: vec![Vec3::Z; positions.len()],
            positions,
            triangles,
            ..Mesh::default()
        };
        mesh.tangents.clear();
        mesh
    }

    /// Protects what shading needs: afterwards no corner looks away from its face, what was right
    /// stays as it was, and nothing moves.
    #[test]
    fn no_corner_looks_away_from_its_face() {
        let before = fin();
        let mut mesh = before.clone();
        assert_eq!(face_outwards(&mut mesh), 2, "the sheet that looks down");
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            for &vertex in triangle {
                assert!(mesh.normals[vertex as usize].as_dvec3().dot(unit_normal(&mesh, index)) > 0.9);
            }
            assert_eq!(mesh.corners(index), before.corners(index));
            assert_eq!(mesh.corner_uvs(index), before.corner_uvs(index));
        }
        assert_eq!(mesh.positions.len(), 9, "each of four corners is split once");
        let upper = |mesh: &Mesh| {
            mesh.triangles[..3].iter().flatten().map(|&v| mesh.normals[v as usize]).collect::<Vec<_>>()
        };
        assert_eq!(upper(&mesh), upper(&before));
        assert_eq!(charts(&mesh), charts(&before), "no chart is cut");
        assert_eq!(face_outwards(&mut mesh), 0, "once is enough");
    }

    /// Protects the share that users are told of: areas count, not triangles.
    #[test]
    fn what_faces_back_is_measured_by_its_area() {
        let mut mesh = fin();
        assert!((area_facing_back(&mesh) - 1.0 / 2.5).abs() < 1e-6, "{}", area_facing_back(&mesh));
        face_outwards(&mut mesh);
        assert_eq!(area_facing_back(&mesh), 0.0);
        assert_eq!(area_facing_back(&Mesh::default()), 0.0);
    }

    /// Protects good meshes: a closed box with smooth normals is left to the bit.
    #[test]
    fn a_sound_mesh_is_left_alone() {
        let mut mesh = crate::wall_low();
        mesh.normals = smooth_normals(&mesh);
        let before = mesh.clone();
        assert_eq!(face_outwards(&mut mesh), 0);
        assert!(mesh == before);
    }
}
