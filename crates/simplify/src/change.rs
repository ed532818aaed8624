//! A change of a surface: triangles that go, triangles that come, and at most one point that moves or is new.
//! Collapses, flips, splits, moves and removals of whole parts (`operations.rs`) are all of this kind, so they are
//! judged by one function (`pictures.rs`) and compared with each other.

use crate::triangle::Triangle;
use glam::Vec3;

/// What goes and what comes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Triangles that go.
    pub removed: Vec<u32>,
    /// Triangles that come.
    pub added: Vec<Triangle>,
    /// A point and its new place; the number of points for a new one.
    pub moved: Option<(u32, Vec3)>,
}

impl Change {
    /// How many triangles fewer there are.
    pub fn saved(&self) -> isize {
        self.removed.len() as isize - self.added.len() as isize
    }
}
