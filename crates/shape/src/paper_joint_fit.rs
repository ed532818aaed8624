//! The paper's Algorithm 1 after its steps of texture coordinates (`parbake_uv::surface`): the
//! parallax map with its depth and the displacement along the normals, by Adam from nothing
//! (`parbake_shape::paper`). Its textures are thrown away, as the ones that are written are
//! solved for afterwards with all else held, which leaves less error than its last k₂ steps.
//!
//! Contract: as of `stage.rs`.

use crate::paper::{PaperOptions, paper_fit};
use crate::seen::smooth_references;
use crate::stage::{ShapeReport, move_vertices};
use crate::views::Views;
use parbake_model::Model;
use parbake_progress::Watcher;
use parbake_render::background::Background;
use parbake_render::loss::{Comparison, ImageLoss};
use parbake_render::parallax::ParallaxCoefficients;
use parbake_views::PrepareError;
use parbake_views::high_poly::HighPoly;
use parbake_views::low_poly::LowPoly;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperJointPlan {
    /// Views in the pool.
    pub views: usize,
    /// Side of a view in pixels.
    pub view_size: usize,
    /// The optimiser's own.
    pub fit: PaperOptions,
}

/// Samples along a side of each pixel of the high-poly's views.
const SAMPLES: usize = 3;

/// What came out: how vertices moved, where they did, and the map, where there is one.
pub struct Outcome {
    /// How vertices moved; none where they were kept.
    pub report: Option<ShapeReport>,
    /// The parallax map, as a reader sees it.
    pub map: Option<ParallaxCoefficients>,
}

/// Runs it on a low-poly that `frame` places; its vertices are moved.
///
/// # Errors
/// Where its texture coordinates have no area.
pub fn paper_joint_fit(
    low: &mut Model,
    high: &HighPoly,
    plan: &PaperJointPlan,
    seed: u64,
    watcher: &dyn Watcher,
) -> Result<Outcome, PrepareError> {
    let LowPoly { placed, .. } = LowPoly::new(low, &high.frame, plan.fit.texture_size)?;
    let references = smooth_references(high, plan.views, plan.view_size, SAMPLES, seed, watcher);
    let views = Views {
        references: &references,
        size: plan.view_size,
        display: high.conventions.display,
        comparison: Comparison { image: ImageLoss::L1, ..Comparison::default() },
        background: Background::Black,
        reads_a_quarter: false,
    };
    let found = paper_fit(&placed, &views, seed, &plan.fit, watcher);
    let map = found.map.map(|map| map.as_stored());
    let report = plan.fit.motion.map(|_| {
        move_vertices(&mut low.mesh, &placed, &found.positions, &high.frame);
        ShapeReport {
            steps: found.losses.len(),
            moved: found.moved.map(|way| 0.5 * way),
            ..ShapeReport::default()
        }
    });
    Ok(Outcome { report, map })
}
