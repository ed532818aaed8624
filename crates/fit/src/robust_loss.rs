//! The robust loss, for pixels that no texture can match: what one view shows and all others of the same texel do
//! not, because depth, an outline or another part of the model got in between.
//!
//! Least squares bend a texel halfway towards them, and surfaces look mottled. Cauchy's loss
//! `ρ(r²) = s² ln(1 + r² / s²)` is the square for small differences and grows slower and slower
//! beyond the scale s. It is minimised by least squares with weights `ρ' = 1 / (1 + r² / s²)` that
//! follow the differences from step to step (Holland and Welsch 1977).
//!
//! Of a pixel's three display differences those that are too bright make up one r, those that are
//! too dark another, whose scale is twice as large: one dark speck on a bright surface disturbs
//! more than a bright one, so a texel goes dark for a majority only.
//!
//! Contract: an infinite scale is plain least squares, to the bit.

use parbake_model::glam::Vec4;
use std::iter::Sum;
use std::ops::AddAssign;

/// Cauchy's loss with a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cauchy {
    inverse_square: f32,
}

impl Cauchy {
    /// Where a difference of `scale` too much counts half, as display values, more than 0; infinity
    /// for squares.
    pub fn new(scale: f32) -> Self {
        Self { inverse_square: 1.0 / (scale * scale) }
    }

    /// The loss of a pixel whose display values are this much higher than wanted, three channels in
    /// -1 … 1 and a zero, and each channel's weight, 0 … 1.
    #[inline]
    pub fn weigh(&self, residual: Vec4) -> (f32, Vec4) {
        let bright = residual.max(Vec4::ZERO).length_squared();
        let dark = residual.min(Vec4::ZERO).length_squared();
        let weights = [bright, DARK * dark].map(|square| Vec4::splat(self.weight(square)));
        let loss = self.loss(bright) + self.loss(DARK * dark) * (1.0 / DARK);
        (loss, Vec4::select(residual.cmpgt(Vec4::ZERO), weights[0], weights[1]))
    }

    fn weight(&self, square: f32) -> f32 {
        1.0 / (1.0 + square * self.inverse_square)
    }

    fn loss(&self, square: f32) -> f32 {
        let ratio = square * self.inverse_square;
        if ratio > 0.0 { square * (ratio.ln_1p() / ratio) } else { square }
    }
}

/// 1 / 2²: what is too dark has twice the scale.
const DARK: f32 = 0.25;

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
        let residual = Vec4::new(0.4, -0.7, 0.2, 0.0);
        let (_, weights) = cauchy.weigh(residual);
        for lane in 0..3 {
            let at = |step: f32| {
                let mut moved = residual;
                moved[lane] += step;
                cauchy.weigh(moved).0
            };
            let slope = (at(1e-2) - at(-1e-2)) / 2e-2;
            let wanted = 2.0 * weights[lane] * residual[lane];
            assert!((slope - wanted).abs() < 1e-3, "{lane}: {slope} {wanted}");
        }
    }

    /// Protects from dark specks: what is too dark keeps its weight for longer.
    #[test]
    fn too_dark_counts_more_than_too_bright() {
        let weight = |x: f32| Cauchy::new(0.5).weigh(Vec4::new(x, 0.0, 0.0, 0.0)).1.x;
        assert!((weight(0.5) - 0.5).abs() < 1e-6 && (weight(-1.0) - 0.5).abs() < 1e-6);
    }

    /// Protects plain least squares where they are asked for.
    #[test]
    fn an_infinite_scale_is_the_square() {
        let plain = Cauchy::new(f32::INFINITY);
        for x in [0.0, 1e-3, -0.5, 1.0] {
            let (loss, weights) = plain.weigh(Vec4::new(x, 0.0, 0.0, 0.0));
            assert_eq!((loss, weights), (x * x, Vec4::ONE));
        }
    }
}
