//! Coordinates that must not change: those of points that slide along the border of
//! the square, and of points that touch others at the start.

use glam::DVec2;

/// For each point a mask: 1 where a coordinate is free, 0 where it is fixed.
///
/// The optimiser multiplies gradients and directions with it, so that a fixed
/// coordinate keeps its value bit by bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constraints {
    /// P masks, in the order of the layout's points.
    pub masks: Vec<DVec2>,
}

impl Constraints {
    /// All points free.
    pub fn free(points: usize) -> Self {
        Self { masks: vec![DVec2::ONE; points] }
    }

    /// Sets the fixed coordinates of P vectors to zero, even where they are not finite.
    pub fn apply(&self, vectors: &mut [DVec2]) {
        for (vector, &mask) in vectors.iter_mut().zip(&self.masks) {
            *vector = DVec2::select(mask.cmpeq(DVec2::ZERO), DVec2::ZERO, *vector);
        }
    }

    /// How many coordinates are fixed, of 2 P.
    pub fn fixed(&self) -> usize {
        self.masks.iter().map(|m| usize::from(m.x == 0.0) + usize::from(m.y == 0.0)).sum()
    }

    pub(super) fn hold(&mut self, point: u32) {
        self.masks[point as usize] = DVec2::ZERO;
    }
}
