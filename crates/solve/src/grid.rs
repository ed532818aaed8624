//! A square grid of texels that repeats, cut into bands of rows so that many
//! threads can add to it with a result that does not depend on their number.
//!
//! A bilinear fetch touches two rows. Work is binned by the first of them, each band
//! adds into rows of its own plus one spare row, and the spare rows are added to the next
//! band afterwards, always in the same order.

use rayon::prelude::*;

/// Rows of a band.
pub const BAND: usize = 8;

/// Indices of a texel and its right, lower and lower right neighbours.
#[inline]
pub fn block(texel: usize, size: usize) -> [usize; 4] {
    let (x, row) = (texel % size, texel - texel % size);
    let right = if x + 1 == size { 0 } else { x + 1 };
    let below = if row + size == size * size { 0 } else { row + size };
    [texel, row + right, below + x, below + right]
}

/// Bilinear weights in the order of [`block`].
#[inline]
pub fn weights(fx: f32, fy: f32) -> [f32; 4] {
    let (gx, gy) = (1.0 - fx, 1.0 - fy);
    [gx * gy, fx * gy, gx * fy, fx * fy]
}

/// How many bands a square of this size has.
pub fn bands(size: usize) -> usize {
    size.div_ceil(BAND)
}

/// Fills `size²` texels: `accumulate(band, first_texel, local)` adds into `local`,
/// which holds the band's rows and one more; texel t of the grid is
/// `local[t − first_texel]`, and `+ size` stays inside it. Returns what each band
/// returned, in order.
pub fn gather<T, R>(
    size: usize,
    grid: &mut Vec<T>,
    accumulate: impl Fn(usize, usize, &mut [T]) -> R + Sync,
    add: impl Fn(&mut T, &T) + Sync,
) -> Vec<R>
where
    T: Copy + Default + Send + Sync,
    R: Send,
{
    grid.clear();
    grid.resize(size * size, T::default());
    let (spill, results): (Vec<Vec<T>>, Vec<R>) = grid
        .par_chunks_mut(BAND * size)
        .enumerate()
        .map(|(band, rows)| {
            let mut local = vec![T::default(); rows.len() + size];
            let result = accumulate(band, band * BAND * size, &mut local);
            rows.copy_from_slice(&local[..rows.len()]);
            (local.split_off(rows.len()), result)
        })
        .unzip();
    let last = spill.len() - 1;
    grid.par_chunks_mut(BAND * size).enumerate().for_each(|(band, rows)| {
        let above = &spill[if band == 0 { last } else { band - 1 }];
        for (to, from) in rows.iter_mut().zip(above) {
            add(to, from);
        }
    });
    results
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the seams between bands, and the wrap from the last row to the first.
    #[test]
    fn gather_adds_every_contribution_once() {
        let size = 20;
        let mut grid = Vec::new();
        gather(
            size,
            &mut grid,
            |band, first, local: &mut [u32]| {
                let rows = BAND.min(size - band * BAND);
                for t in first..first + rows * size {
                    local[t - first] += 1;
                    local[t - first + size] += 10;
                }
            },
            |a, b| *a += b,
        );
        assert!(grid.iter().all(|&v| v == 11));
    }

    /// Protects the wrap at the right and lower border.
    #[test]
    fn a_block_wraps() {
        assert_eq!(block(15, 4), [15, 12, 3, 0]);
        assert_eq!(block(5, 4), [5, 6, 9, 10]);
    }
}
