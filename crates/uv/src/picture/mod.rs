//! The texture coordinates of a picture on a plane: they spread what is detailed over many texels and
//! press what is plain into few (the paper's 2D mode).
//!
//! ```text
//! picture ─ signal scales ─┬ shape (coarse grid) ─ refine ─ finer grid ─ refine … (coarse_to_fine)
//!                          └ the paper's method, one grid (paper)
//! ```
//!
//! Colours are those that the file stores: what is compared is the picture as shown.

pub mod balance;
pub mod coarse_to_fine;
pub mod paper;
pub mod plane;
pub mod rounding;
pub mod signal_scales;
pub mod texture;

use crate::convergence::Convergence;
use crate::moves::UvMoves;
use crate::paper::Guide;
use glam::{DVec2, Vec2};
use plane::Plane;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureOptions {
    /// Texels along a side.
    pub texture_size: usize,
    /// Cells along a side of the plane.
    pub grid: usize,
    /// Steps at most on each grid, or rounds of the paper's method.
    pub steps: usize,
    /// What moves coordinates in the paper's method.
    pub guide: Guide,
}

/// Frames and steps so far, and how the paper's method went.
pub struct Moves {
    /// The grid that frames are of: a run that was stopped may not have come to the finest.
    pub plane: Plane,
    /// Points of the grid after each step.
    pub frames: Vec<Vec<Vec2>>,
    /// Steps that texture coordinates took.
    pub steps: usize,
    /// How the paper's method went, where it was asked for.
    pub convergence: Option<Convergence>,
}

/// Cells along a side that an animation shows: the lines of more run together.
const DRAWN_CELLS: usize = 50;

impl Moves {
    /// None yet, on this grid.
    pub fn new(plane: Plane) -> Self {
        Self { plane, frames: Vec::new(), steps: 0, convergence: None }
    }

    /// The moves of so many of the plane's cells as can be drawn; none where nothing moved.
    pub fn drawn(self) -> Option<UvMoves> {
        if self.frames.is_empty() {
            return None;
        }
        let (plane, kept) = self.plane.thinned(DRAWN_CELLS);
        let layout = plane.layout(as_f64(&plane.points()));
        let frames = self.frames.into_iter().map(|frame| kept.iter().map(|&i| frame[i]).collect());
        Some(UvMoves { frames: frames.collect(), triangles: layout.triangles, charts: layout.charts })
    }
}

/// Points in double precision.
pub fn as_f64(points: &[Vec2]) -> Vec<DVec2> {
    points.iter().map(|p| p.as_dvec2()).collect()
}
