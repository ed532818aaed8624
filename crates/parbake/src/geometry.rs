//! What of a low-poly moves before there is a texture: vertices, then texture coordinates; or, by
//! the paper's method, coordinates and then the rest of its Algorithm 1.
//!
//! ```text
//! low ─ mend ─┬─ shape ─── unfold ────────────────── (fit)
//!             └─────────── unfold ─ algorithm_one ── (paper)
//! ```
//!
//! Contract: what is not moved keeps its value to the bit; with nothing to move there is no copy.

use crate::algorithm_one::algorithm_one;
use crate::bridge::{Bridge, Clock, shares};
use crate::error::BakeError;
use crate::message::{Stage, Watcher};
use crate::options::{BakeOptions, UvMode};
use crate::report::Work;
use crate::shape::{ShapeReport, Target, shape};
use crate::unfold::{Source, Unfolded, mend_with_room, unfold};
use parbake_model::{Model, Placement};
use parbake_render::parallax::ShParallax;

/// What moved.
#[derive(Default)]
pub struct Geometry {
    /// The low-poly with its coordinates; none where nothing was to move.
    pub unfolded: Option<Unfolded>,
    /// How vertices moved, where they did.
    pub shape: Option<ShapeReport>,
    /// The map of the paper's method, where it was asked for.
    pub map: Option<ShParallax>,
}

/// Moves what the options ask for of a low-poly that `frame` places. `same` says that it is the
/// high-poly itself, whose surface stays.
///
/// # Errors
/// Where its texture coordinates have no area, or its charts do not fit into the texture.
pub fn move_geometry<W: Watcher>(
    low: &Model,
    same: bool,
    frame: &Placement,
    target: &Target,
    options: &BakeOptions,
    bridge: &Bridge<W>,
    clock: &mut Clock,
) -> Result<Geometry, BakeError> {
    let shape_plan = options.shape_plan().filter(|_| !same);
    let algorithm_plan = options.algorithm_plan().filter(|_| !same);
    let mut geometry = Geometry::default();
    if options.uv == UvMode::Keep && shape_plan.is_none() && algorithm_plan.is_none() {
        return Ok(geometry);
    }
    let mut unfold_options = options.unfold_for(if same { Work::Compress } else { Work::Bake });
    let mut low = mend_with_room(low, &mut unfold_options)?;
    clock.lap(Stage::Prepare);
    if let Some(plan) = &shape_plan {
        let share = bridge.share(shares::SHAPE);
        geometry.shape = Some(shape(&mut low, frame, target, plan, options.seed, &share)?);
        clock.lap(Stage::Shape);
    }
    let source = Source {
        scene: target.scene,
        surface: (!same).then_some(target.surface),
        exposures: &[],
        reach: target.reach,
        brightened: if target.srgb { 1.0 } else { 0.0 },
        normals: true,
        pixel: Source::PIXEL,
    };
    let mut unfolded = unfold(low, frame, &source, &unfold_options, &bridge.share(shares::UNFOLD));
    clock.lap(Stage::Unfold);
    if let Some(plan) = &algorithm_plan {
        let share = bridge.share(shares::DEPTH);
        let outcome = algorithm_one(&mut unfolded.model, frame, target, plan, options.seed, &share)?;
        (geometry.shape, geometry.map) = (outcome.report, outcome.map);
        clock.lap(Stage::Shape);
    }
    geometry.unfolded = Some(unfolded);
    Ok(geometry)
}
