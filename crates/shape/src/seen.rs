//! The high-poly as vertices are fitted to it: views that they follow, and others that tell whether they had better
//! stayed.
//!
//! Contract: whole pixels are averaged, and none is shifted, so that edges are told from each other by how much of a
//! pixel they cover.

use crate::views::Views;
use parbake_image::display::Display;
use parbake_progress::Watcher;
use parbake_render::background::Background;
use parbake_render::camera::Projection;
use parbake_render::loss::Comparison;
use parbake_views::high_poly::{HighPoly, ViewSet};
use parbake_views::reference::{Reference, Sampling};
use std::sync::Arc;

/// Views of one size.
#[derive(Clone)]
pub struct Seen {
    /// The high-poly, seen from each of them.
    pub references: Arc<Vec<Reference>>,
    /// Side of a view in pixels.
    pub size: usize,
    /// Samples along a side of a pixel.
    pub samples: usize,
}

/// Two sets of views from different directions.
#[derive(Clone)]
pub struct ShapeViews {
    /// Views whose gradients vertices follow.
    pub fitted: Seen,
    /// Views that tell whether outlines came closer.
    pub checked: Seen,
}

/// Views at most whose outlines are measured.
const MEASURED: usize = 48;

impl Seen {
    /// What a surface is compared with: a coverage of this weight beside the picture, before this background.
    pub(crate) fn views(&self, display: Display, coverage: f32, background: Background) -> Views<'_> {
        let comparison = Comparison { coverage, ..Comparison::default() };
        Views {
            references: &self.references,
            size: self.size,
            display,
            comparison,
            background,
            reads_a_quarter: true,
        }
    }

    /// Views whose outlines are measured, each with a seed for its background.
    pub(crate) fn measured(&self) -> Vec<(usize, u64)> {
        (0..self.references.len().min(MEASURED)).map(|i| (i, i as u64)).collect()
    }

    /// Width of a pixel in the common frame, around its origin; 0 without views.
    pub(crate) fn pixel_width(&self) -> f32 {
        let Some(first) = self.references.first() else { return 0.0 };
        let camera = &first.view.camera;
        let half = match camera.projection {
            Projection::Perspective(half) => half * camera.eye.length(),
            Projection::Orthographic(half) => half,
        };
        2.0 * half / self.size as f32
    }
}

/// The high-poly from so many views of `size`² pixels, with `samples`² samples of coverage a pixel: pictures for gradients
/// through silhouettes. `seed` chooses the directions. Fewer views where the watcher stops them.
pub fn smooth_references(
    high: &HighPoly,
    views: usize,
    size: usize,
    samples: usize,
    seed: u64,
    watcher: &dyn Watcher,
) -> Arc<Vec<Reference>> {
    let sampling = Sampling { size, filter: 1.0, samples };
    high.references(&ViewSet { count: views, seed, jitter: false, sampling }, watcher)
}
