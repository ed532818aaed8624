//! Numbers that carry their derivatives along: forward-mode differentiation with dual numbers
//! (Clifford 1873; Griewank and Walther, Evaluating Derivatives, 2008, chapter 3).
//!
//! A [`Dual`] is a value and its slopes by up to four variables; `f(a)` has the slopes `f'(a) · a'`. A formula that
//! is written over [`Real`] gives values for `f32`, and values with derivatives for `Dual`, so there is no second
//! copy of it that could differ.
//!
//! Contract: where a function has a kink (`at_least`, `at_most`) the slope is that of the branch taken.

use glam::Vec4;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What a shading formula is written over.
pub(crate) trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f32, Output = Self>
    + Add<f32, Output = Self>
{
    /// A number that depends on nothing.
    fn constant(value: f32) -> Self;

    /// Without its slopes.
    fn value(self) -> f32;

    /// A function of this number, given the function's value and derivative here.
    fn chain(self, value: f32, derivative: f32) -> Self;

    /// Its square root; of a positive number.
    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.chain(root, 0.5 / root)
    }

    /// e to this.
    fn exp(self) -> Self {
        let power = self.value().exp();
        self.chain(power, power)
    }

    /// The greater of this and a bound.
    fn at_least(self, bound: f32) -> Self {
        if self.value() < bound { Self::constant(bound) } else { self }
    }

    /// The lesser of this and a bound.
    fn at_most(self, bound: f32) -> Self {
        if self.value() > bound { Self::constant(bound) } else { self }
    }

    /// From this to another, by a share of 0 to 1.
    fn mix(self, other: Self, share: Self) -> Self {
        self + (other - self) * share
    }
}

impl Real for f32 {
    #[inline(always)]
    fn constant(value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn value(self) -> f32 {
        self
    }

    #[inline(always)]
    fn chain(self, value: f32, _: f32) -> Self {
        value
    }
}

/// A value and its slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dual {
    pub value: f32,
    pub slopes: Vec4,
}

impl Dual {
    /// The variable with this number, 0 to 3.
    pub fn variable(value: f32, number: usize) -> Self {
        Self { value, slopes: Vec4::AXES[number] }
    }
}

impl Real for Dual {
    fn constant(value: f32) -> Self {
        Self { value, slopes: Vec4::ZERO }
    }

    fn value(self) -> f32 {
        self.value
    }

    fn chain(self, value: f32, derivative: f32) -> Self {
        Self { value, slopes: self.slopes * derivative }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slopes: self.slopes + other.slopes }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slopes: self.slopes - other.slopes }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let slopes = self.slopes * other.value + other.slopes * self.value;
        Self { value: self.value * other.value, slopes }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slopes: (self.slopes - other.slopes * value) / other.value }
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slopes: -self.slopes }
    }
}

impl Mul<f32> for Dual {
    type Output = Self;
    fn mul(self, by: f32) -> Self {
        Self { value: self.value * by, slopes: self.slopes * by }
    }
}

impl Add<f32> for Dual {
    type Output = Self;
    fn add(self, by: f32) -> Self {
        Self { value: self.value + by, ..self }
    }
}

/// Three numbers: a direction or a colour.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triple<T>(pub [T; 3]);

impl<T: Real> Triple<T> {
    /// One that depends on nothing.
    pub fn constant(v: glam::Vec3) -> Self {
        Self(v.to_array().map(T::constant))
    }

    /// Each number by itself.
    pub fn map(self, f: impl Fn(T) -> T) -> Self {
        Self(self.0.map(f))
    }

    /// Both, number by number.
    pub fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        Self(std::array::from_fn(|k| f(self.0[k], other.0[k])))
    }

    /// The scalar product.
    pub fn dot(self, other: Self) -> T {
        let [x, y, z] = self.zip(other, |a, b| a * b).0;
        x + y + z
    }

    /// The vector product.
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// Each number times `by`.
    pub fn scale(self, by: T) -> Self {
        self.map(|a| a * by)
    }

    /// The sum of both.
    pub fn plus(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    /// From this to another, by a share of each number.
    pub fn mix(self, other: Self, share: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].mix(other.0[k], share.0[k])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects every derivative of the metallic-roughness BRDF: each operation's slope is that of its value.
    #[test]
    fn slopes_match_central_differences() {
        fn formula<T: Real>(x: T, y: T) -> T {
            let product = (x * y + 0.3).sqrt() / (y - x * 2.0) - (-x).exp();
            product.mix(y.at_least(0.1), x) + x.at_most(0.2) * y.at_least(9.0)
        }
        let (x, y, h) = (0.4f32, 1.7f32, 1e-2);
        let both = formula(Dual::variable(x, 0), Dual::variable(y, 1));
        let by_x = (formula(x + h, y) - formula(x - h, y)) / (2.0 * h);
        let by_y = (formula(x, y + h) - formula(x, y - h)) / (2.0 * h);
        assert!((both.value - formula(x, y)).abs() < 1e-6);
        assert!((both.slopes.x - by_x).abs() < 1e-3 && (both.slopes.y - by_y).abs() < 1e-3, "{both:?}");
        assert_eq!((both.slopes.z, both.slopes.w), (0.0, 0.0));
        let turned = |v: [f32; 3]| Triple(v).cross(Triple([0.0, 0.0, 1.0])).0;
        assert_eq!(turned([1.0, 0.0, 0.0]), [0.0, -1.0, 0.0]);
    }
}
