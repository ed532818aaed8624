//! What conjugate gradients ask of a matrix, and how they measure its vectors.
//!
//! A vector's elements are small vectors themselves: a texel's four lanes in single precision, or a point of the
//! plane in double precision. Lanes that the matrix couples are one problem with one step length ([`Coupled`]).
//! Lanes that share a matrix but not a solution, as the channels of a texture do ([`Lanes`]) and the coordinates
//! of points ([`DoubleLanes`]), are solved side by side, each with its own step lengths.

use crate::free_lanes::FreeLanes;
use glam::{DVec2, DVec4, Vec4};
use std::ops::{Add, AddAssign, Mul, SubAssign};

/// An element of a vector; arithmetic is lane by lane.
pub trait Element:
    Copy + Send + Sync + Add<Output = Self> + AddAssign + SubAssign + Mul<Output = Self>
{
    /// 0 in all lanes.
    const ZERO: Self;

    /// 1 in all lanes.
    const ONE: Self;

    /// 1 in lanes that are free, else 0.
    fn mask(free: FreeLanes) -> Self;
}

impl Element for Vec4 {
    const ZERO: Self = Self::ZERO;
    const ONE: Self = Self::ONE;

    #[inline(always)]
    fn mask(free: FreeLanes) -> Self {
        free.mask()
    }
}

impl Element for DVec2 {
    const ZERO: Self = Self::ZERO;
    const ONE: Self = Self::ONE;

    #[inline(always)]
    fn mask(free: FreeLanes) -> Self {
        let mask = free.mask().as_dvec4();
        Self::new(mask.x, mask.y)
    }
}

/// The elements of an operator's vectors.
pub type ElementOf<O> = <<O as Operator>::Inner as Inner>::Element;

/// A symmetric, positive semi-definite matrix and a preconditioner.
pub trait Operator: Sync {
    /// How vectors are measured.
    type Inner: Inner;

    /// Elements in a row, at least 1; sums are made row by row, and a row is one task. The last row may be shorter.
    fn width(&self) -> usize;

    /// `q = A p`; returns `p · q`. May put another vector of the same length in the place of `q`.
    fn product(&mut self, p: &[ElementOf<Self>], q: &mut Vec<ElementOf<Self>>) -> Self::Inner;

    /// The residual `r` of element i, preconditioned.
    fn precondition(&self, i: usize, r: ElementOf<Self>) -> ElementOf<Self>;
}

/// An inner product of vectors.
pub trait Inner: Copy + Send + Sync {
    /// What the vectors are made of.
    type Element: Element;

    /// Of no elements.
    const ZERO: Self;

    /// Adds that of one element of either vector.
    fn add(&mut self, a: Self::Element, b: Self::Element);

    /// The sum over rows, in their order and in double precision.
    fn total(rows: &[Self]) -> Self;

    /// The quotient as a factor of each lane.
    fn over(self, divisor: Self) -> Self::Element;

    /// Whether no lane is above the bound.
    fn is_within(self, bound: Self) -> bool;

    /// Whether any lane is above 0.
    fn is_positive(self) -> bool;

    /// What a step of these lengths takes from the energy, self being the residual's norm.
    fn gain(self, step: Self::Element) -> f64;
}

/// All lanes together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupled(pub f64);

impl Inner for Coupled {
    type Element = Vec4;

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
    type Element = Vec4;

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

/// Each coordinate by itself, in double precision. One whose divisor is 0 has no way to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleLanes(pub DVec2);

impl Inner for DoubleLanes {
    type Element = DVec2;

    const ZERO: Self = Self(DVec2::ZERO);

    #[inline(always)]
    fn add(&mut self, a: DVec2, b: DVec2) {
        self.0 += a * b;
    }

    fn total(rows: &[Self]) -> Self {
        Self(rows.iter().map(|row| row.0).sum())
    }

    fn over(self, divisor: Self) -> DVec2 {
        DVec2::select(divisor.0.cmpgt(DVec2::ZERO), self.0 / divisor.0, DVec2::ZERO)
    }

    fn is_within(self, bound: Self) -> bool {
        !self.0.cmpgt(bound.0).any()
    }

    fn is_positive(self) -> bool {
        self.0.cmpgt(DVec2::ZERO).any()
    }

    fn gain(self, step: DVec2) -> f64 {
        step.dot(self.0)
    }
}
