//! The way of a texture layout through a run.

use glam::Vec2;

/// Layouts that follow each other, all of the same triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UvMoves {
    /// Of each layout its P points, v down; the texture is the square from (0, 0) to (1, 1).
    pub frames: Vec<Vec<Vec2>>,
    /// F triangles of these points as a `parbake_atlas::Layout` has them:
    /// those with a negative area are shown as flipped.
    pub triangles: Vec<[u32; 3]>,
    /// F chart indices.
    pub charts: Vec<u32>,
}
