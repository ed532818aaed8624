//! The one float image: it serves reading, mip levels, fitting and writing.
//!
//! Texels are of any type: `[f32; C]` for C channels, or a `Vec4` whose lanes go through SIMD
//! registers. Row 0 is on top.

use glam::Vec4;

/// width × height texels, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatImage<T> {
    /// Texels along u.
    pub width: usize,
    /// Texels along v.
    pub height: usize,
    /// width × height texels, row after row.
    pub texels: Vec<T>,
}

impl<T: Copy> FloatImage<T> {
    /// A square of size² texels of one value.
    pub fn solid(size: usize, value: T) -> Self {
        Self::square(size, vec![value; size * size])
    }
}

impl<T> FloatImage<T> {
    /// A square of these size² texels.
    pub fn square(size: usize, texels: Vec<T>) -> Self {
        Self { width: size, height: size, texels }
    }
}

impl<T> Default for FloatImage<T> {
    fn default() -> Self {
        Self { width: 0, height: 0, texels: Vec::new() }
    }
}

/// A texel that can be zero.
pub trait Texel: Copy {
    /// All channels 0.
    const ZERO: Self;
}

impl<const C: usize> Texel for [f32; C] {
    const ZERO: Self = [0.0; C];
}

impl Texel for Vec4 {
    const ZERO: Self = Vec4::ZERO;
}

impl<T: Texel> FloatImage<T> {
    /// An image of zeros.
    pub fn zeros(width: usize, height: usize) -> Self {
        Self { width, height, texels: vec![T::ZERO; width * height] }
    }
}

impl FloatImage<Vec4> {
    /// The weighted sum of four texels, given by their indices.
    #[inline]
    pub fn blend(&self, texels: [usize; 4], weights: [f32; 4]) -> Vec4 {
        let t = &self.texels;
        t[texels[0]] * weights[0]
            + t[texels[1]] * weights[1]
            + t[texels[2]] * weights[2]
            + t[texels[3]] * weights[3]
    }
}
