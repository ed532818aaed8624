//! What of a low-poly moves before there is a texture: vertices, then texture coordinates; or, by
//! the paper's method, coordinates and then the rest of its Algorithm 1.
//!
//! ```text
//! low ─ repair ─┬─ shape ─ UV stage ─ offsets for a cutout ─ (fit)
//!               └───────── UV stage ─ paper_joint_fit ────── (paper)
//! ```
//!
//! Contract: what is not moved keeps its value to the bit; with nothing to move there is no copy.

use crate::budget::shares;
use crate::error::BakeError;
use crate::options::{BakeOptions, UvMode};
use crate::snapshots::of_surface;
use crate::work::Work;
use parbake_model::Model;
use parbake_progress::{Clock, ProgressScope, Showing, Stage};
use parbake_render::parallax::ParallaxCoefficients;
use parbake_shape::paper_joint_fit::paper_joint_fit;
use parbake_shape::stage::{ShapeReport, grow_for_cutout, shape};
use parbake_uv::surface::{
    RepairedLowPoly, RepairedLowPolys, Source, UvStageResult, optimise_uvs, repair_uvs_with_room,
};
use parbake_views::high_poly::HighPoly;
use parbake_views::importance::importances_of;

/// What moved.
#[derive(Default)]
pub struct Geometry {
    /// The low-poly with its coordinates; none where nothing was to move.
    pub uv_stage: Option<UvStageResult>,
    /// The low-poly with its own coordinates, repaired and not moved; none where nothing was to move, where a model is
    /// compressed, and where the user asked for other coordinates or for a gutter.
    pub repaired: Option<RepairedLowPoly>,
    /// How vertices moved, where they did.
    pub shape: Option<ShapeReport>,
    /// How far vertices reach beyond the high-poly for a cutout to take away, if they do: the offsets of
    /// `uv_stage`'s mesh.
    pub growth: Option<ShapeReport>,
    /// The map of the paper's method, where it was asked for.
    pub map: Option<ParallaxCoefficients>,
}

/// Moves what the options ask for of a low-poly. One that is compressed is the high-poly itself, whose
/// surface stays.
///
/// # Errors
/// Where its texture coordinates have no area, or its charts do not fit into the texture.
pub fn move_geometry(
    low: &Model,
    work: Work,
    high: &HighPoly,
    options: &BakeOptions,
    scope: &ProgressScope,
    clock: &mut Clock,
) -> Result<Geometry, BakeError> {
    let same = work == Work::Compress;
    let mut shape_plan = options.shape_plan().filter(|_| !same);
    if let Some(plan) = shape_plan.as_mut().filter(|_| work == Work::Level) {
        // There is no artist's shape to keep. Outlines that come hardly closer cost more inside than they gain: a barrel
        // of 1,692 triangles at 0.97 loses 0.4 dB on grey, a controller of 1,000 at 0.94 gains 0.5.
        plan.fit.worth_moving = 0.96;
    }
    let paper_joint_plan = options.paper_joint_plan().filter(|_| !same);
    let mut geometry = Geometry::default();
    if options.uv == UvMode::Keep && shape_plan.is_none() && paper_joint_plan.is_none() {
        return Ok(geometry);
    }
    let mut uv_options = options.uv_stage_for(work);
    // As `baseline.rs` asks for it.
    let is_own = matches!(options.uv, UvMode::Optimize | UvMode::Repair) && !uv_options.gutter_required;
    let RepairedLowPolys { plain, roomy } = repair_uvs_with_room(low, &mut uv_options)?;
    let mut low = roomy.unwrap_or_else(|| plain.clone());
    geometry.repaired = (is_own && !same).then_some(plain);
    clock.lap(Stage::Prepare);
    let name = low.name.clone();
    let shown = |snapshot| Some(of_surface(&name, high, snapshot));
    let share = scope.share(shares::SHAPE);
    let share = &Showing::new(&share, shown);
    let mut seen = None;
    if let Some(plan) = &shape_plan {
        let (report, views) = shape(&low.name, &mut low.mesh, high, plan, share)?;
        (geometry.shape, seen) = (Some(report), Some(views));
        clock.lap(Stage::Shape);
    }
    let growth_plan = options.growth_plan(geometry.shape.as_ref()).filter(|_| !same);
    let seen = seen.filter(|_| growth_plan.is_some());
    let importances = importances_of(&low.mesh, high);
    if options.uv != UvMode::Keep {
        low.weigh_charts(&importances, &uv_options)?;
    }
    let source = Source {
        scene: &high.scene,
        surface: (!same).then_some(&high.surface),
        importances: &importances,
        max_distance: high.conventions.max_distance,
        brightened: if high.conventions.srgb() { 1.0 } else { 0.0 },
        normals: true,
        pixel: Source::PIXEL,
    };
    let share = scope.share(shares::UV);
    let share = &Showing::new(&share, shown);
    let mut uv_stage = optimise_uvs(low, &high.frame, &source, &uv_options, share);
    clock.lap(Stage::Uv);
    if let (Some(plan), Some(seen)) = (growth_plan, &seen) {
        let share = scope.share(shares::GROWTH);
        let share = &Showing::new(&share, shown);
        let mesh = &mut uv_stage.model.mesh;
        geometry.growth = Some(grow_for_cutout(&name, mesh, high, seen, &plan, share)?);
        clock.lap(Stage::Shape);
    }
    if let Some(plan) = &paper_joint_plan {
        let share = scope.share(shares::PARALLAX);
        let outcome = paper_joint_fit(&mut uv_stage.model, high, plan, options.seed, &share)?;
        (geometry.shape, geometry.map) = (outcome.report, outcome.map);
        clock.lap(Stage::Shape);
    }
    geometry.uv_stage = Some(uv_stage);
    Ok(geometry)
}
