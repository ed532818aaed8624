//! What conjugate gradients ask of a matrix on texels, and how they measure its vectors.
//!
//! Lanes of a texel that the matrix couples are one problem with one step length ([`Coupled`]). Lanes that share
//! a matrix but not a solution, as the channels of a texture do, are solved side by side, each with its own
//! step lengths ([`Lanes`]).

use glam::{DVec4, Vec4};

/// A symmetric, positive semi-definite matrix and a preconditioner.
pub trait Operator: Sync {
    /// How vectors are measured.
    type Inner: Inner;

    /// Texels in a row; vectors hold whole rows, and sums are made row by row.
    fn width(&self) -> usize;

    /// `q = A p`; returns `p · q`. May put another vector of the same length in the place of `q`.
    fn product(&mut self, p: &[Vec4], q: &mut Vec<Vec4>) -> Self::Inner;

    /// The residual `r` of texel i, preconditioned.
    fn precondition(&self, i: usize, r: Vec4) -> Vec4;
}

/// An inner product of vectors of texels.
pub trait Inner: Copy + Send + Sync {
    /// Of no texels.
    const ZERO: Self;

    /// Adds that of one texel of either vector.
    fn add(&mut self, a: Vec4, b: Vec4);

    /// The sum over rows, in their order and in double precision.
    fn total(rows: &[Self]) -> Self;

    /// The quotient as a factor of each lane.
    fn over(self, divisor: Self) -> Vec4;

    /// Whether no lane is above the bound.
    fn is_within(self, bound: Self) -> bool;

    /// Whether any lane is above 0.
    fn is_positive(self) -> bool;

    /// What a step of these lengths takes from the energy, self being the residual's norm.
    fn gain(self, step: Vec4) -> f64;
}

/// All lanes together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupled(pub f64);

impl Inner for Coupled {
    const ZERO: Self = Self(0.0);

    #[inline(always)]
    fn add(&mut self, a: Vec4, b: Vec4) {
        self.0 += f64::from(a.dot(b));
    }

    fn total(rows: &[Self]) -> Self {
        Self(rows.iter().map(|row| row.0).sum())
    }

    fn over(self, divisor: Self) -> Vec4 {
        Vec4::splat((self.0 / divisor.0) as f32)
    }

    fn is_within(self, bound: Self) -> bool {
        // Also where it is no number: a run that has left the numbers ends.
        self.0.is_nan() || self.0 <= bound.0
    }

    fn is_positive(self) -> bool {
        self.0 > 0.0
    }

    fn gain(self, step: Vec4) -> f64 {
        f64::from(step.x) * self.0
    }
}

/// Each lane by itself. A lane whose divisor is 0 has no way to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes(pub Vec4);

/// Divisors up to this count as 0.
const NOTHING: f32 = 1e-30;

impl Inner for Lanes {
    const ZERO: Self = Self(Vec4::ZERO);

    #[inline(always)]
    fn add(&mut self, a: Vec4, b: Vec4) {
        self.0 += a * b;
    }

    fn total(rows: &[Self]) -> Self {
        Self(rows.iter().map(|row| row.0.as_dvec4()).sum::<DVec4>().as_vec4())
    }

    fn over(self, divisor: Self) -> Vec4 {
        let least = Vec4::splat(NOTHING);
        Vec4::select(divisor.0.cmpgt(least), self.0 / divisor.0.max(least), Vec4::ZERO)
    }

    fn is_within(self, bound: Self) -> bool {
        !self.0.cmpgt(bound.0).any()
    }

    fn is_positive(self) -> bool {
        self.0.cmpgt(Vec4::ZERO).any()
    }

    fn gain(self, step: Vec4) -> f64 {
        f64::from((step * self.0).element_sum())
    }
}
