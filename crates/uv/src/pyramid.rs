//! A texture and its mip levels, each texel the mean of four of the level before, as
//! engines make them.
//!
//! Forward: [`levels`]. Adjoint: [`gather`], which carries what every level collected back
//! to the texture.

use glam::Vec4;
use rayon::prelude::*;

/// How many levels a texture of this size has: halved while its size is even and at
/// least 4, for engines agree no further.
pub fn level_count(size: usize) -> usize {
    let mut count = 1;
    while size >> (count - 1) >= 4 && (size >> (count - 1)).is_multiple_of(2) {
        count += 1;
    }
    count
}

/// The first `count` levels of a texture of size² texels; the first is a copy.
pub fn levels(texels: &[Vec4], size: usize, count: usize) -> Vec<Vec<Vec4>> {
    let mut levels = vec![texels.to_vec()];
    for level in 1..count {
        let half = size >> level;
        let mut to = vec![Vec4::ZERO; half * half];
        halve(&levels[level - 1], half, &mut to);
        levels.push(to);
    }
    levels
}

/// Overwrites the half² texels of `to` with the next level of `from`.
pub fn halve(from: &[Vec4], half: usize, to: &mut [Vec4]) {
    to.par_chunks_mut(half).enumerate().for_each(|(y, row)| {
        let upper = &from[2 * y * 2 * half..][..2 * half];
        let lower = &from[(2 * y + 1) * 2 * half..][..2 * half];
        for (x, texel) in row.iter_mut().enumerate() {
            *texel = 0.25 * (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
        }
    });
}

/// Adds to the first level what the others hold: a quarter of each texel to the four that
/// it is the mean of.
pub fn gather(levels: &mut [Vec<Vec4>], size: usize) {
    for level in (1..levels.len()).rev() {
        let half = size >> level;
        let (finer, coarser) = levels.split_at_mut(level);
        let from = &coarser[0];
        finer[level - 1].par_chunks_mut(2 * half).enumerate().for_each(|(y, row)| {
            let coarse = &from[y / 2 * half..][..half];
            for (x, texel) in row.iter_mut().enumerate() {
                *texel += 0.25 * coarse[x / 2];
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the adjoint: ⟨levels(x), y⟩ = ⟨x, gather(y)⟩.
    #[test]
    fn gather_is_the_adjoint_of_levels() {
        let number = |i: usize| Vec4::splat(((i * 2_654_435_761) % 1000) as f32 / 1000.0);
        let size = 8;
        let x: Vec<Vec4> = (0..64).map(number).collect();
        let count = level_count(size);
        assert_eq!(count, 3);
        let forward = levels(&x, size, count);
        let mut y: Vec<Vec<Vec4>> = forward
            .iter()
            .enumerate()
            .map(|(l, level)| (0..level.len()).map(|i| number(i + 100 * l + 7)).collect())
            .collect();
        let dot = |a: &[Vec4], b: &[Vec4]| -> f32 { a.iter().zip(b).map(|(a, b)| a.x * b.x).sum() };
        let left: f32 = forward.iter().zip(&y).map(|(a, b)| dot(a, b)).sum();
        gather(&mut y, size);
        assert!((left - dot(&x, &y[0])).abs() < 1e-3 * left);
    }

    /// Protects sizes that cannot be halved.
    #[test]
    fn odd_sizes_have_few_levels() {
        assert_eq!([2, 3, 4, 6, 100, 128].map(level_count), [1, 1, 2, 2, 3, 7]);
    }
}
