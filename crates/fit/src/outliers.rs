//! Pixels that no texture can please: what one view shows and all others of the same texel do
//! not, because depth, an outline or another part of the model got in between.
//!
//! Least squares bend a texel halfway towards them, and surfaces look mottled. Cauchy's loss
//! `ρ(r²) = s² ln(1 + r² / s²)`, r the length of a pixel's three display differences, is the
//! square for small differences and grows slower and slower beyond the scale s. It is minimised
//! by least squares with weights `ρ' = 1 / (1 + r² / s²)` that follow the differences from step
//! to step (Holland and Welsch 1977).
//!
//! Contract: an infinite scale is plain least squares, to the bit.

use std::iter::Sum;
use std::ops::AddAssign;

/// Cauchy's loss with a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cauchy {
    inverse_square: f32,
}

impl Cauchy {
    /// Where a difference of `scale` counts half, as display values, more than 0; infinity for squares.
    pub fn new(scale: f32) -> Self {
        Self { inverse_square: 1.0 / (scale * scale) }
    }

    /// The weight of a pixel whose differences have this squared length.
    #[inline]
    pub fn weight(&self, square: f32) -> f32 {
        1.0 / (1.0 + square * self.inverse_square)
    }

    /// The loss of such a pixel.
    #[inline]
    pub fn loss(&self, square: f32) -> f32 {
        let ratio = square * self.inverse_square;
        if ratio > 0.0 { square * (ratio.ln_1p() / ratio) } else { square }
    }
}

/// What differences sum up to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loss {
    /// By Cauchy's loss, which is minimised.
    pub minimised: f64,
    /// Their squares, which are reported.
    pub square: f64,
}

impl AddAssign for Loss {
    fn add_assign(&mut self, other: Self) {
        self.minimised += other.minimised;
        self.square += other.square;
    }
}

impl Sum for Loss {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        let mut sum = Self::default();
        parts.for_each(|part| sum += part);
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the fit's convergence: a weight that is not its loss's derivative would walk
    /// somewhere else than where the best state is kept.
    #[test]
    fn weights_are_the_losss_derivative() {
        let cauchy = Cauchy::new(0.5);
        for square in [1e-4_f32, 0.01, 0.25, 1.0, 3.0] {
            let step = 1e-2 * square;
            let slope = (cauchy.loss(square + step) - cauchy.loss(square - step)) / (2.0 * step);
            assert!((slope - cauchy.weight(square)).abs() < 1e-3, "{square}: {slope}");
        }
    }

    /// Protects plain least squares where they are asked for.
    #[test]
    fn an_infinite_scale_is_the_square() {
        let plain = Cauchy::new(f32::INFINITY);
        for square in [0.0, 1e-6, 0.3, 3.0] {
            assert_eq!((plain.loss(square), plain.weight(square)), (square, 1.0));
        }
    }
}
