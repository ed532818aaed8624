//! The common frame of a pair: the high-poly's bounding box is centred and its
//! longest side becomes 2, so that it lies in [−1, 1]³. Both meshes move by that
//! one transform; normalising each by its own box would misalign them.

use crate::Mesh;
use glam::Vec3;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: Vec3,
    /// Largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// Of the vertices that triangles use; `None` when there are none.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        let mut used = mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]);
        let first = used.next()?;
        Some(used.fold(Self { min: first, max: first }, |b, p| Self { min: b.min.min(p), max: b.max.max(p) }))
    }

    /// Side lengths.
    pub fn size(&self) -> Vec3 {
        self.max - self.min
    }
}

/// `p ↦ (p − centre) · scale`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Becomes the origin.
    pub centre: Vec3,
    /// Uniform and positive.
    pub scale: f32,
}

impl Placement {
    /// Puts this box into [−1, 1]³. `None` when the box is a point, or has no measure in
    /// single precision.
    pub fn unit_box(bounds: &Bounds) -> Option<Self> {
        let longest = bounds.size().max_element();
        let placement = Self { centre: (bounds.min + bounds.max) * 0.5, scale: 2.0 / longest };
        let usable = longest > 0.0 && longest.is_finite() && placement.scale.is_finite();
        (usable && placement.centre.is_finite()).then_some(placement)
    }

    /// Into the common frame. Directions do not change.
    pub fn apply(&self, mesh: &mut Mesh) {
        for p in &mut mesh.positions {
            *p = (*p - self.centre) * self.scale;
        }
        for offset in &mut mesh.parallax_offsets {
            *offset *= self.scale;
        }
    }
}
