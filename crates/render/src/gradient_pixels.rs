//! Which pixels an adjoint reads: all, or a quarter of them, so that a step of a stochastic descent costs less; and which
//! ones the forward pass shades for it.
//!
//! Each pixel of a square of four is read in one of four patterns, and counts four times there. Where patterns are drawn at
//! random, the expected gradient is that of all pixels (Robbins and Monro 1951).
//!
//! Contract: a pattern alone decides. Gradients of blended edges' vertices are never left out (`antialias.rs`), so pixels
//! that blends read or write are shaded in every pattern.

use crate::antialias::Blends;

/// Pixels that are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GradientPixels {
    /// All of them.
    #[default]
    All,
    /// One of each square of four: the number's last bit tells its column, the one before its row.
    Quarter(u64),
}

impl GradientPixels {
    /// How often the gradient of a pixel of this row counts; none where no pixel of the row is read.
    #[inline]
    pub fn weight_in_row(self, row: usize) -> Option<f32> {
        match self {
            Self::All => Some(1.0),
            Self::Quarter(which) => (row as u64 % 2 == which >> 1 & 1).then_some(4.0),
        }
    }

    /// Whether a pixel of this column is read, in a row that has such.
    #[inline]
    pub fn reads_column(self, column: usize) -> bool {
        match self {
            Self::All => true,
            Self::Quarter(which) => column as u64 % 2 == which & 1,
        }
    }
}

/// Pixels of one picture that are shaded and compared.
#[derive(Clone, Debug)]
pub struct ShadedPixels {
    pattern: GradientPixels,
    size: usize,
    /// By pixel; none where all are shaded.
    some: Option<Vec<bool>>,
}

impl ShadedPixels {
    /// All of a picture of size² pixels.
    pub fn all(size: usize) -> Self {
        Self { pattern: GradientPixels::All, size, some: None }
    }

    /// Those that the adjoint of this pattern needs in a picture of size² pixels with these blends.
    pub fn new(pattern: GradientPixels, blends: &Blends, size: usize) -> Self {
        if pattern == GradientPixels::All {
            return Self::all(size);
        }
        let mut some = vec![false; size * size];
        for (row, pixels) in some.chunks_mut(size.max(1)).enumerate() {
            if pattern.weight_in_row(row).is_some() {
                pixels
                    .iter_mut()
                    .enumerate()
                    .for_each(|(column, pixel)| *pixel = pattern.reads_column(column));
            }
        }
        for blend in blends.along_rows.iter().chain(&blends.along_columns) {
            [blend.source, blend.target].into_iter().for_each(|pixel| some[pixel as usize] = true);
        }
        Self { pattern, size, some: Some(some) }
    }

    /// Whether a pixel is shaded.
    #[inline]
    pub fn contains(&self, column: usize, row: usize) -> bool {
        self.some.as_ref().is_none_or(|some| some[row * self.size + column])
    }

    /// How often a pixel's loss counts, so that the sum stands for all pixels.
    #[inline]
    pub fn loss_weight(&self, column: usize, row: usize) -> f32 {
        let weight = self.pattern.weight_in_row(row);
        weight.filter(|_| self.pattern.reads_column(column)).unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the gradient's expectation: all patterns together read each pixel once, and count it as often as there are
    /// patterns.
    #[test]
    fn every_pixel_counts_once_in_the_mean() {
        let all = [vec![GradientPixels::All], (0..4).map(GradientPixels::Quarter).collect::<Vec<_>>()];
        for patterns in all {
            for (column, row) in [(0, 0), (1, 0), (0, 1), (1, 1), (6, 3)] {
                let reading = patterns.iter().filter(|pattern| pattern.reads_column(column));
                let weights: Vec<f32> = reading.filter_map(|pattern| pattern.weight_in_row(row)).collect();
                assert_eq!(weights, [patterns.len() as f32]);
            }
        }
    }
}
