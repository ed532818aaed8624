//! Parts of a rigged surface that bend by themselves: triangles between whose joints no triangle mediates.
//!
//! A body with a skeleton is one part. The blades of a fan, its cage and its foot are three: they move against each
//! other, so nothing may be stretched between them.

use crate::union_find::UnionFind;
use parbake_model::{Influences, Mesh, Rig};

/// For each triangle its part, numbered from 0 in the order in which triangles name them; all 0 where nothing has
/// joints.
pub fn rig_parts(mesh: &Mesh, rig: &Rig) -> Vec<u32> {
    if rig.influences.is_empty() {
        return vec![0; mesh.triangles.len()];
    }
    let mut joints = UnionFind::new(rig.skeleton.joints.len());
    let of = |vertex: u32| rig.influences.get(vertex as usize).into_iter().flat_map(Influences::used);
    let first = |triangle: &[u32; 3]| of(triangle[0]).next().map_or(0, |(joint, _)| joint);
    for triangle in &mesh.triangles {
        for (joint, _) in triangle.iter().flat_map(|&vertex| of(vertex)) {
            joints.union(first(triangle), joint);
        }
    }
    let mut numbers = vec![u32::MAX; rig.skeleton.joints.len()];
    let mut count = 0;
    let part = |triangle: &[u32; 3]| {
        let number = &mut numbers[joints.find(first(triangle)) as usize];
        if *number == u32::MAX {
            *number = count;
            count += 1;
        }
        *number
    };
    mesh.triangles.iter().map(part).collect()
}
