//! Which lanes of a texel a solver may change, and which it holds.
//!
//! Contract: a lane that is held has 0 in its mask, all others 1.

use glam::Vec4;

/// Which of a texel's four lanes may move: a bit each, the lowest for the first. A byte a texel, since solvers
/// read it in every step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct FreeLanes(u8);

impl FreeLanes {
    /// All of them.
    pub const ALL: Self = Self(0b1111);

    /// 1 in lanes that may move, 0 in those that are held.
    #[inline(always)]
    pub fn mask(self) -> Vec4 {
        MASKS[usize::from(self.0 & 0b1111)]
    }

    /// Holds a lane.
    pub fn hold(&mut self, lane: usize) {
        self.0 &= !(1 << lane);
    }
}

/// [`FreeLanes::mask`] of every byte.
const MASKS: [Vec4; 16] = {
    let mut masks = [Vec4::ZERO; 16];
    let mut bits = 0;
    while bits < 16 {
        masks[bits] = Vec4::new(
            (bits & 1) as f32,
            (bits >> 1 & 1) as f32,
            (bits >> 2 & 1) as f32,
            (bits >> 3 & 1) as f32,
        );
        bits += 1;
    }
    masks
};
