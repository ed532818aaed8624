//! Welding: which vertices are one and the same point.
//!
//! By sorting, so that it costs O(n log n) whatever the coordinates and uses all
//! cores; equality is of values, without any tolerance.

use parbake_model::glam::Vec3;
use rayon::prelude::*;

/// For each vertex the index of the first vertex at the very same position
/// (−0 = +0). V entries; first vertices refer to themselves.
pub fn weld_by_position(positions: &[Vec3]) -> Vec<u32> {
    weld_by(positions.len(), |i| positions[i].to_array().map(ordered_bits))
}

/// For each of `count` elements the index of the first with the same key.
pub(crate) fn weld_by<K: Ord + Copy + Send + Sync>(
    count: usize,
    key: impl Fn(usize) -> K + Sync,
) -> Vec<u32> {
    let mut order: Vec<(K, u32)> = (0..count).into_par_iter().map(|i| (key(i), i as u32)).collect();
    order.par_sort_unstable();
    let mut first = vec![0; count];
    for run in order.chunk_by(|a, b| a.0 == b.0) {
        for &(_, element) in run {
            first[element as usize] = run[0].1;
        }
    }
    first
}

/// A key that is equal for equal finite numbers.
#[inline]
pub(crate) fn ordered_bits(value: f32) -> u32 {
    // −0 + 0 = +0.
    (value + 0.0).to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects smoothing and charts across the two zeros, and the promise that
    /// no tolerance is used.
    #[test]
    fn welds_equal_positions_only() {
        let p = [
            Vec3::new(1.0, 0.0, 2.0),
            Vec3::new(1.0, f32::EPSILON, 2.0),
            Vec3::new(1.0, -0.0, 2.0),
            Vec3::new(1.0, 0.0, 2.0),
        ];
        assert_eq!(weld_by_position(&p), [0, 1, 0, 0]);
        assert!(weld_by_position(&[]).is_empty());
    }
}
