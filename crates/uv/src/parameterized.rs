//! A signal with texture coordinates: what a texture is solved for.

use crate::signal::Signal;
use crate::triangle_batches::TriangleBatches;
use glam::DVec2;

/// Texture coordinates and the signals that they carry.
#[derive(Clone, Copy)]
pub struct ParameterizedSignal<'a> {
    /// P points.
    pub points: &'a [DVec2],
    /// F triangles.
    pub triangles: &'a [[u32; 3]],
    /// What the texture shall show: the same surface at one or more sizes.
    pub signal_scales: &'a [Signal],
    /// The triangles, shared out.
    pub runs: &'a TriangleBatches,
}
