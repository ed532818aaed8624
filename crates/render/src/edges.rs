//! Which triangles meet at each edge: what silhouettes are found with.
//!
//! A half-edge `3 t + k` is the edge of triangle t opposite to its corner k. All
//! half-edges between the same two points in space form one ring, so that seams of
//! texture coordinates or normals, borders (rings of one) and edges where more than
//! two triangles meet need no cases of their own.
//!
//! Contract: points are one where their coordinates are equal; triangles that use a
//! point twice have no edges.

use parbake_model::glam::Vec3;
use std::collections::HashMap;

/// The rings of half-edges of a mesh. Depends on which positions coincide, not on
/// where they are: it stays valid while coinciding vertices move together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EdgeAdjacency {
    /// 3 F entries: the next half-edge of the same ring; itself at a border.
    next: Vec<u32>,
}

impl EdgeAdjacency {
    /// Welds the positions and links the half-edges.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let mut points: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
        let point_of: Vec<u32> = (positions.iter())
            .map(|p| {
                let fresh = points.len() as u32;
                // Adding zero makes −0 equal to 0 in its bits, too.
                *points.entry(p.to_array().map(|x| (x + 0.0).to_bits())).or_insert(fresh)
            })
            .collect();
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
        for (t, corners) in triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|i| point_of[i as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            for (k, (p, q)) in [(b, c), (c, a), (a, b)].into_iter().enumerate() {
                sides.push(([p.min(q), p.max(q)], (3 * t + k) as u32));
            }
        }
        sides.sort_unstable();
        let mut next: Vec<u32> = (0..3 * triangles.len() as u32).collect();
        for ring in sides.chunk_by(|a, b| a.0 == b.0) {
            for (i, side) in ring.iter().enumerate() {
                next[side.1 as usize] = ring[(i + 1) % ring.len()].1;
            }
        }
        Self { next }
    }

    /// The other half-edges at the same place, each as (triangle, corner).
    #[inline]
    pub fn others(&self, triangle: usize, corner: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let start = (3 * triangle + corner) as u32;
        let mut at = start;
        std::iter::from_fn(move || {
            at = self.next[at as usize];
            (at != start).then_some((at as usize / 3, at as usize % 3))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects silhouettes against texture seams: split vertices are one point.
    #[test]
    fn seams_are_no_borders_and_fins_belong_to_the_ring() {
        let p = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, -0.0), (0.0, 1.0, 0.0)]
            .into_iter()
            .chain([(1.0, 1.0, 0.0), (0.5, 0.5, 1.0)])
            .map(|(x, y, z)| Vec3::new(x, y, z))
            .collect::<Vec<_>>();
        let edges = EdgeAdjacency::new(&p, &[[0, 1, 2], [3, 5, 4]]);
        assert_eq!(edges.others(0, 0).collect::<Vec<_>>(), [(1, 1)]);
        assert_eq!(edges.others(0, 1).count(), 0);
        let edges = EdgeAdjacency::new(&p, &[[0, 1, 2], [3, 5, 4], [1, 2, 6], [0, 0, 1]]);
        let mut ring: Vec<_> = edges.others(0, 0).collect();
        ring.sort_unstable();
        assert_eq!(ring, [(1, 1), (2, 2)]);
        assert_eq!(edges.others(3, 2).count(), 0);
    }
}
