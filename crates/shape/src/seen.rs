//! The high-poly as vertices are fitted to it: views that they follow, and others that tell whether they had better
//! stayed.
//!
//! Contract: whole pixels are averaged, and none is shifted, so that edges are told from each other by how much of a
//! pixel they cover. Everything depends on the high-poly, the low-poly's outlines and the plan alone.

use crate::joint::{ShapeOptions, gap};
use crate::stage::ShapePlan;
use crate::views::Views;
use parbake_image::display::Display;
use parbake_model::Mesh;
use parbake_progress::{Portion, Stage, Watcher};
use parbake_render::camera::Projection;
use parbake_render::loss::Comparison;
use parbake_solve::random::mixed;
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
}

/// What vertices are fitted to, and what they are checked with.
#[derive(Clone)]
pub struct ShapeViews {
    /// Views whose gradients vertices follow.
    pub fitted: Seen,
    /// Others.
    pub checked: Seen,
}

/// Views at most whose outlines are measured.
const MEASURED: usize = 48;
/// Views that vertices are checked with.
const CHECKED: usize = 24;
/// Their seed differs from that of the views that vertices are fitted to.
const OF_CHECKS: u64 = 0x5eed_c4ec;
/// Distance between outlines, in pixels, that views show well enough to move vertices by.
const SHOWN: f32 = 0.25;
/// Share of the time that the pictures of the high-poly take.
const LOOKING: f64 = 0.2;

impl ShapeViews {
    /// Views for a low-poly in the common frame: where its outlines are close to the high-poly's already, they are
    /// larger, up to [`ShapePlan::largest_size`].
    pub fn new(placed: &Mesh, high: &HighPoly, plan: &ShapePlan, watcher: &dyn Watcher) -> Self {
        let look = |views, size, seed, share| {
            let watcher = Portion::new(watcher, share).of_stage(Stage::Reference, Stage::Shape);
            Seen { references: smooth_references(high, views, size, plan.samples, seed, &watcher), size }
        };
        let seed = plan.fit.seed;
        let checked =
            look(CHECKED.min(plan.views), plan.view_size, mixed(seed ^ OF_CHECKS), 0.0..0.2 * LOOKING);
        let apart = gap(placed, &checked, high.conventions.display) / checked.pixel_width().max(1e-9);
        let wanted = (plan.view_size as f32 * SHOWN / apart.max(1e-3)) as usize / 2 * 2;
        let size = wanted.clamp(plan.view_size, plan.view_size.max(plan.largest_size));
        Self { fitted: look(plan.views, size, seed, 0.2 * LOOKING..LOOKING), checked }
    }

    /// The part of a stage's progress after these views.
    pub fn moving(watcher: &dyn Watcher) -> Portion<'_> {
        Portion::new(watcher, LOOKING..1.0)
    }
}

impl Seen {
    /// What a surface is compared with.
    pub(crate) fn views(&self, display: Display, options: &ShapeOptions) -> Views<'_> {
        let comparison = Comparison { coverage: options.coverage, ..Comparison::default() };
        Views {
            references: &self.references,
            size: self.size,
            display,
            comparison,
            background: options.background,
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

/// Views of the high-poly for gradients through silhouettes.
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
