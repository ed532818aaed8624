//! Surfaces to begin with: coarse, but with several times the wanted triangles (meshoptimizer, A. Kapoulkine).
//!
//! Contract: positions only; welded, without texture coordinates, so that no seam is in the way. The layout is made
//! anew for the result.

use crate::surface::Surface;
use meshopt::SimplifyOptions as Flags;
use parbake_model::Mesh;
use parbake_model::glam::Vec3;
use serde::{Deserialize, Serialize};

/// How a surface to begin with is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Edges of the model collapse, positions follow the quadrics (Garland and Heckbert 1997).
    Quadrics,
    /// The level before.
    Level,
}

/// Edge collapses down to about `target` triangles, in halvings: one shot at a large reduction is worse. `parts` has the
/// part of each material, as in [`Surface::in_parts`].
pub fn quadrics(mesh: &Mesh, parts: &[u32], target: usize) -> Mesh {
    let surface = Surface::in_parts(mesh, parts).to_mesh();
    let (mut positions, mut indices, materials) = by_material(&surface);
    let mut count = indices.len() / 3;
    while count > target {
        let next = (count / 2).max(target);
        let wanted = 3 * next;
        let kept = meshopt::simplify_with_update(
            &mut indices,
            &mut positions,
            &mut [],
            &[],
            0,
            None,
            wanted,
            f32::MAX,
            Flags::Prune | Flags::RegularizeLight,
            None,
        );
        indices.truncate(kept);
        if kept / 3 >= count {
            break;
        }
        count = kept / 3;
    }
    assembled(&positions, &indices, |triangle| materials[triangle[0] as usize])
}

/// How many triangles edge collapses need to stay within a distance, in the mesh's unit.
pub fn triangles_within(mesh: &Mesh, distance: f32) -> usize {
    let surface = Surface::new(mesh).to_mesh();
    let positions: Vec<[f32; 3]> = surface.positions.iter().map(|p| p.to_array()).collect();
    let indices: Vec<u32> = surface.triangles.iter().flatten().copied().collect();
    let flags = Flags::Prune | Flags::ErrorAbsolute;
    meshopt::simplify_decoder(&indices, &positions, 0, distance, flags, None).len() / 3
}

/// Vertices with their materials: one at the border of two materials is its first one's, so that the surface stays
/// whole there.
fn by_material(mesh: &Mesh) -> (Vec<[f32; 3]>, Vec<u32>, Vec<u32>) {
    let mut materials = vec![u32::MAX; mesh.positions.len()];
    for (triangle, &material) in mesh.triangles.iter().zip(&mesh.triangle_materials) {
        for &vertex in triangle {
            let own = &mut materials[vertex as usize];
            *own = (*own).min(material);
        }
    }
    let positions = mesh.positions.iter().map(|p| p.to_array()).collect();
    (positions, mesh.triangles.iter().flatten().copied().collect(), materials)
}

fn assembled(positions: &[[f32; 3]], indices: &[u32], material: impl Fn(&[u32; 3]) -> u32) -> Mesh {
    let triangles: Vec<[u32; 3]> = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    let triangle_materials = triangles.iter().map(material).collect();
    let positions = positions.iter().map(|&p| Vec3::from(p)).collect();
    Mesh { positions, triangles, triangle_materials, ..Mesh::default() }
}
