//! A node of a file's hierarchy (glTF 2.0, 3.5.2), and how it is placed in its parent.
//!
//! Contract: where nodes are in a list, a node comes after its parent; transforms are finite.

use glam::{DAffine3, DQuat, DVec3};

/// A node.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Its name in the file; may be empty.
    pub name: String,
    /// Index of its parent, which is less than its own.
    pub parent: Option<usize>,
    /// From its space to its parent's while nothing moves.
    pub rest: NodeTransform,
}

/// How a node is placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NodeTransform {
    /// Scaled, then rotated, then moved; animations may replace each.
    Parts {
        /// Translation.
        translation: DVec3,
        /// Rotation, of unit length.
        rotation: DQuat,
        /// Scale.
        scale: DVec3,
    },
    /// A matrix, which animations leave alone.
    Matrix(DAffine3),
}

impl NodeTransform {
    /// No move at all.
    pub const IDENTITY: Self =
        Self::Parts { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };

    /// To the parent's space.
    pub fn to_parent(&self) -> DAffine3 {
        match *self {
            Self::Parts { translation, rotation, scale } => {
                DAffine3::from_scale_rotation_translation(scale, rotation, translation)
            }
            Self::Matrix(matrix) => matrix,
        }
    }
}
