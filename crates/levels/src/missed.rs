//! Vertices that a coarser copy of a mesh lacks where its pictures are wrong.
//!
//! As in greedy insertion (Garland and Heckbert, "Fast Polygonal Approximation of Terrains and Height Fields", 1995), where the error of
//! a triangle is largest the finer surface has a vertex that would mend most of it. Here the error is one of pictures, so that
//! outlines, highlights and textures count as they are seen.
//!
//! Contract: deterministic; each triangle of the copy asks for one vertex at most, the one with the largest error first.

use parbake_model::Mesh;
use parbake_model::glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// The error of pictures where a triangle of a copy and one of the finer mesh are seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lost {
    /// Triangle of the copy.
    pub of_copy: u32,
    /// Triangle of the finer mesh.
    pub of_finer: u32,
    /// The sum of squared differences, in any unit.
    pub error: f64,
}

/// The bits of a position.
type Place = [u32; 3];

/// A triangle of a copy.
#[derive(Default)]
struct OfCopy {
    error: f64,
    /// For each place on the finer mesh a vertex there, and the error around it.
    around: BTreeMap<Place, (u32, f64)>,
}

/// Vertices of `finer` in whose place `copy` has none, and that are not among `known`, in falling order of the errors of the triangles
/// that lack them. One that has moved counts as lacking: favoured, it goes back.
pub(crate) fn missed(finer: &Mesh, copy: &Mesh, lost: &[Lost], known: &[u32]) -> Vec<u32> {
    // Zero has two signs.
    let place = |position: &Vec3| position.to_array().map(|x| (x + 0.0).to_bits());
    let place_of = |vertex: u32| place(&finer.positions[vertex as usize]);
    let mut taken: BTreeSet<Place> = copy.positions.iter().map(place).collect();
    taken.extend(known.iter().map(|&vertex| place_of(vertex)));
    let mut triangles: BTreeMap<u32, OfCopy> = BTreeMap::new();
    for &Lost { of_copy, of_finer, error } in lost {
        let triangle = triangles.entry(of_copy).or_default();
        triangle.error += error;
        for vertex in finer.triangles[of_finer as usize] {
            triangle.around.entry(place_of(vertex)).or_insert((vertex, 0.0)).1 += error;
        }
    }
    let mut triangles: Vec<OfCopy> = triangles.into_values().collect();
    triangles.sort_by(|a, b| b.error.total_cmp(&a.error));
    let mut missed = Vec::new();
    for triangle in triangles {
        let free = triangle.around.into_iter().filter(|(place, _)| !taken.contains(place));
        if let Some((place, (vertex, _))) =
            free.max_by(|(_, a), (_, b)| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))
        {
            taken.insert(place);
            missed.push(vertex);
        }
    }
    missed
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::glam::vec3;

    /// Protects what is asked for: the vertex with most of the error around it, of the worst triangle first, and none that the copy
    /// has or that is known.
    #[test]
    fn the_worst_triangles_ask_for_their_worst_vertices() {
        // A fan of four triangles around vertex 4, and a second one that shares an edge with the first.
        let positions = vec![
            vec3(0.0, 0.0, 0.0),
            vec3(2.0, 0.0, 0.0),
            vec3(2.0, 2.0, 0.0),
            vec3(0.0, 2.0, 0.0),
            vec3(1.0, 1.0, 1.0),
            vec3(3.0, 1.0, 1.0),
        ];
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 5, 2]];
        let finer = Mesh { positions: positions.clone(), triangles, ..Mesh::default() };
        let copy = Mesh {
            positions: positions[..4].to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3], [1, 2, 2]],
            ..Mesh::default()
        };
        let lost = |of_copy, of_finer, error| Lost { of_copy, of_finer, error };
        let all = [lost(0, 0, 1.0), lost(0, 1, 2.0), lost(1, 3, 2.0), lost(2, 4, 5.0)];
        assert_eq!(missed(&finer, &copy, &all, &[]), [5, 4]);
        assert_eq!(missed(&finer, &copy, &all, &[5]), [4]);
        assert!(missed(&finer, &finer, &all, &[]).is_empty());
    }
}
