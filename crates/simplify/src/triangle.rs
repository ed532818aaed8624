//! A triangle of a surface, and of the changes of one.
//!
//! Contract: it names no point twice.

/// A triangle: its points, counter-clockwise from the front, and what it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// Points.
    pub corners: [u32; 3],
    /// Material of the mesh that it came from.
    pub material: u32,
}
