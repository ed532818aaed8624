//! A bake, from two models to a third.
//!
//! ```text
//! high ─ HighPoly ─┬ scene ─── reference views ─────────────────────────┬───────────┐
//!                  └ surface ─ projection ───────────────┐              │           │
//! low ─ normals ┬ repair ─ vertices ─ UVs ─ LowPoly ─ projected maps ─ parallax ─ samples ─ maps ─ Model
//!               │          (geometry.rs)  (texel map, charts)        (and cutout)
//!               └ baseline ─ LowPoly ─ ray-cast maps ─ Model (to compare with)
//! ```

use crate::baseline::other_baseline;
use crate::budget::{at_the_end, check_budget, left_out, shares, stage_weights};
use crate::error::BakeError;
use crate::fallback::{Fallback, fit_fallback};
use crate::geometry::{Geometry, move_geometry};
use crate::map_images::images;
use crate::options::{BakeOptions, Shading, UvMode};
use crate::order::{BakeBackend, Order};
use crate::report::{BakeReport, layout_warning};
use crate::snapshots::show;
use crate::textures::{FittedTextures, Subject, fit_views, training_views};
use crate::warnings::{Warnings, for_plain_materials, swapped, unseen};
use crate::work::Work;
use parbake_atlas::check_mesh;
use parbake_fit::baked_materials::{Look, add_fallback};
use parbake_mesh::parts::with_parts;
use parbake_mesh::rigs::{carried, rigged};
use parbake_model::Model;
use parbake_progress::{Clock, Message, ProgressScope, Stage, Watcher};
use parbake_render::camera::Projection;
use parbake_uv::moves::UvMoves;
use parbake_views::alpha_layers::layer_kinds;
use parbake_views::high_poly::{Conventions, HighPoly};
use parbake_views::importance::importances;
use parbake_views::lost::{lost, not_compared};
use parbake_views::low_poly::{LowPoly, lit};
use parbake_views::pool::Rig;
use parbake_views::projection::project;
use parbake_views::unlit::was_unlit;
use std::time::Instant;

/// The training cameras: the paper's distance, and the field of view at which a
/// model fills most of the picture.
const RIG: Rig = Rig { radius: 3.5, projection: Projection::Perspective(0.4) };

/// A finished bake.
#[derive(Clone, Debug)]
pub struct Baked {
    /// The low-poly with its fitted textures.
    pub model: Model,
    /// What the result is compared with: what an ordinary ray-cast baker makes of the same two models.
    /// The low-poly as it was delivered, vertices included, with its own texture coordinates where they
    /// are sound or were to be kept (else repaired as [`UvMode::Repair`](crate::UvMode::Repair) does), and with maps of the same
    /// size that were projected along its normals. Where a model is compressed: its own surface with the
    /// best texture for its own coordinates.
    pub ray_cast: Model,
    /// What the run saw.
    pub report: BakeReport,
    /// The way of the texture coordinates through the run, where they moved.
    pub uv_moves: Option<UvMoves>,
}

/// Bakes the high-poly's look onto the low-poly. A low-poly without a rig takes over the high-poly's.
///
/// Runs on rayon's current thread pool. When the watcher asks to stop, the best
/// state so far is returned; it is never worse than the projection.
///
/// # Errors
/// An option out of range; a model without extent; texture coordinates that are missing, have no area,
/// or charts that do not fit into the texture; models that lie apart.
pub fn bake(
    high: &Model,
    low: &Model,
    options: &BakeOptions,
    watcher: &dyn Watcher,
) -> Result<Baked, BakeError> {
    options.check()?;
    let begin = Instant::now();
    run(&prepare(high, options)?, &rigged(high, low), Work::Bake, true, options, watcher, begin)
}

/// Prepares a high-poly for any number of bakes with [`bake_prepared`]: its frame, its scene, its
/// surface, and the views that bakes render of it, which are kept (some 300 MB with the default options).
///
/// # Errors
/// An option out of range; a model without extent.
pub fn prepare_high_poly(high: &Model, options: &BakeOptions) -> Result<HighPoly, BakeError> {
    options.check()?;
    Ok(prepare(high, options)?.keeping_views())
}

/// Bakes a prepared high-poly's look onto a low-poly; the result is that of [`bake`].
///
/// # Errors
/// As of [`bake`]; options whose `convention` or `max_distance` are not those that the high-poly was prepared with.
pub fn bake_prepared(
    high: &HighPoly,
    low: &Model,
    options: &BakeOptions,
    watcher: &dyn Watcher,
) -> Result<Baked, BakeError> {
    bake_as(Work::Bake, high, low, options, watcher)
}

/// The same as a work of this kind. A level is compared by who asks for it: [`Baked::ray_cast`] is then only what the bake began with.
pub(crate) fn bake_as(
    work: Work,
    high: &HighPoly,
    low: &Model,
    options: &BakeOptions,
    watcher: &dyn Watcher,
) -> Result<Baked, BakeError> {
    options.check()?;
    if high.conventions != conventions(options) {
        return Err(BakeError::OtherConventions { model: high.name.clone() });
    }
    run(high, low, work, work != Work::Level, options, watcher, Instant::now())
}

/// Bakes a model onto itself, triangle by triangle; `low` is the same with other texture coordinates, or the same.
pub(crate) fn bake_onto_itself(
    model: &Model,
    low: &Model,
    options: &BakeOptions,
    watcher: &dyn Watcher,
) -> Result<Baked, BakeError> {
    options.check()?;
    let begin = Instant::now();
    bake_prepared_onto_itself(&prepare(model, options)?, low, options, watcher, begin)
}

/// The same of a model that is prepared already, for several bakes of it; a time budget counts from `begin`.
pub(crate) fn bake_prepared_onto_itself(
    prepared: &HighPoly,
    low: &Model,
    options: &BakeOptions,
    watcher: &dyn Watcher,
    begin: Instant,
) -> Result<Baked, BakeError> {
    run(prepared, low, Work::Compress, true, options, watcher, begin)
}

pub(crate) fn conventions(options: &BakeOptions) -> Conventions {
    Conventions {
        interpretation: options.convention.interpretation(),
        display: options.convention.display(),
        rig: RIG,
        whole_material: match options.shading {
            Shading::Auto => None,
            shading => Some(shading == Shading::Pbr),
        },
        max_distance: 2.0 * options.max_distance,
    }
}

/// A high-poly that is ready for one bake with these options, which are in range.
pub(crate) fn prepare(high: &Model, options: &BakeOptions) -> Result<HighPoly, BakeError> {
    let mut prepared = HighPoly::new(high, conventions(options))?;
    prepared.importances = importances(high, &options.importance, options.importance_attribute.as_deref())?;
    Ok(prepared)
}

/// A run whose user is told this before it begins, and reads it again in the report.
///
/// # Errors
/// Those of the run.
pub(crate) fn told_before(
    told: Vec<String>,
    watcher: &dyn Watcher,
    run: impl FnOnce() -> Result<Baked, BakeError>,
) -> Result<Baked, BakeError> {
    told.iter().for_each(|text| watcher.message(Message::Warning(text.clone())));
    let mut baked = run()?;
    baked.report.warnings.splice(0..0, told);
    Ok(baked)
}

/// A bake from its first stage to its report; it began at `begin`. Without `has_baseline` nothing is cast for [`Baked::ray_cast`].
pub(crate) fn run(
    high: &HighPoly,
    low: &Model,
    work: Work,
    has_baseline: bool,
    options: &BakeOptions,
    watcher: &dyn Watcher,
    begin: Instant,
) -> Result<Baked, BakeError> {
    check_budget(options)?;
    let mut plan = options.plan();
    let same = work == Work::Compress;
    if same {
        // Nothing is moved by parallax, so sharper samples only bring out more.
        plan.reference.filter = (0.5 * plan.reference.filter).max(1.0 / 16.0);
    }
    let size = options.texture_size;
    let scope = ProgressScope::new(watcher, begin, options.time_budget).keeping_back(at_the_end(size));
    watcher.message(Message::Plan(stage_weights(options)));
    show(low, high, watcher);
    let mut clock = Clock::new(begin);
    let mut warnings = Warnings::new(watcher);
    warnings.tell((work == Work::Bake).then(|| swapped(high, low)).flatten());
    warnings.tell((work == Work::Bake).then(|| left_out(options, work, high.is_whole_material)).flatten());
    let is_asked = high.is_whole_material && work != Work::Level;
    warnings.tell(is_asked.then(|| for_plain_materials(&high.name, options)).flatten());
    let given = low;
    // One model twice keeps its vertices, whatever their normals are like.
    let turned = (!same).then(|| lit(low));
    let low = turned.as_ref().map_or(low, |(model, _)| model);
    let delivered = low;
    // Of a low-poly that was made here there is nothing that its maker should mend.
    let is_given = work != Work::Level;
    warnings.tell(turned.iter().filter(|_| is_given).flat_map(|(_, of_normals)| of_normals.clone()));
    let Geometry { uv_stage, repaired, shape, growth, map } =
        move_geometry(low, work, high, options, &scope, &mut clock)?;
    let low = uv_stage.as_ref().map_or(low, |u| &u.model);
    // The surface that maps are fitted on: that which viewers of parallax maps show.
    let prepared = LowPoly::for_parallax(low, &high.frame, size)?;
    warnings.tell(prepared.warnings.iter().cloned());
    let done = uv_stage.iter().filter(|_| is_given).flat_map(|u| &u.report.repaired);
    warnings.tell(done.map(|done| format!("{}: {done}", low.name)));
    clock.lap(Stage::Prepare);

    let projected = project(&prepared, high);
    clock.lap(Stage::Start);

    let kinds = layer_kinds(&prepared.placed, delivered, high);
    let subject =
        Subject { model: low, prepared: &prepared, projected: &projected, kinds: &kinds, is_seen: true };
    let order = Order { high, plan: &plan, options, work, backend: &BakeBackend::default() };
    show(low, high, watcher);
    let references = training_views(&order, &scope);
    clock.lap(Stage::Reference);
    let for_fallback = references.clone().filter(|_| options.has_fallback());
    let for_textures = scope.share(if for_fallback.is_some() { shares::SHIFTED_TEXTURES } else { 1.0 });
    let textures = fit_views(&order, subject, references, map, &for_textures, &mut clock)?;
    let FittedTextures { fitted, views, samples, parallax, parallax_report } = textures;
    let LowPoly { written, map: texels, .. } = &prepared;
    // A model that keeps its triangles has no holes that it had not.
    let keeps_sides = options.keep_sides || same;
    clock.lap(Stage::Solve);
    let (look, srgb) = (Look::new(high, &prepared, kinds, keeps_sides), high.conventions.srgb());
    let mut model = look.textured(low, written, fitted.images, parallax.as_ref());
    let mut fallback = None;
    if let Some(references) = for_fallback {
        let subject = (low, &look.kinds[..]);
        let Fallback { maps, report } =
            fit_fallback(&order, subject, &model, references, &scope, &mut clock)?;
        add_fallback(&mut model, maps);
        clock.lap(Stage::Solve);
        if report.is_none() {
            warnings.tell([format!(
                "{}: there was no time for textures of viewers without parallax maps; these show the maps' textures",
                low.name
            )]);
        }
        fallback = report;
    }
    let is_whole = high.is_whole_material;
    let unfit = if is_whole { look.extensions.lost.clone() } else { lost(high.extensions.materials()) };
    let own = high.extensions.materials().iter().filter(|material| !was_unlit(material));
    let unjudged = not_compared(own).filter(|_| is_whole);
    let unfit = unfit.into_iter().chain(high.changed.clone()).chain(unjudged);
    warnings.tell(unfit.map(|text| format!("{}: {text}", high.name)));

    let missed_texels = projected.missed;
    let baseline =
        has_baseline.then(|| other_baseline(delivered, repaired, &prepared, work, high, options)).flatten();
    let ray_cast = match baseline {
        // What was projected to begin with makes room for what is projected now.
        Some(baseline) => {
            drop(projected);
            let maps = project(&baseline, high).maps;
            let kinds = layer_kinds(&baseline.placed, delivered, high);
            let look = Look::new(high, &baseline, kinds, keeps_sides);
            look.textured(delivered, &baseline.written, images(&maps, srgb), None)
        }
        None => look.textured(low, written, images(&projected.maps, srgb), None),
    };
    clock.lap(Stage::Baseline);

    let uv = check_mesh(written, size);
    warnings.tell(layout_warning(&low.name, &uv));
    let only_projected = plan.schedule.rounds == 0;
    // A chain has no options for it, and compares its levels in pictures.
    let tells_unseen = !only_projected && work != Work::Level;
    warnings.tell(tells_unseen.then(|| unseen(&low.name, fitted.unseen, fitted.covered)).flatten());
    let report = BakeReport {
        work,
        shape,
        growth,
        parallax_maps: parallax_report,
        fallback,
        uv_stage: uv_stage.as_ref().filter(|_| options.uv != UvMode::Keep).map(|u| u.report.clone()),
        options: options.clone(),
        high_triangles: high.triangles,
        low_triangles: low.mesh.triangles.len(),
        views,
        samples,
        covered_texels: fitted.covered,
        unseen_texels: fitted.unseen,
        overlapping_texels: texels.overlaps,
        missed_texels,
        uv,
        comparison: None,
        losses: fitted.losses.iter().map(Into::into).collect(),
        stages: clock.stages,
        stopped_early: fitted.stopped || views < plan.views || scope.stopped_a_stage(),
        warnings: warnings.told,
        written: None,
        peak_memory: crate::memory::peak_memory(),
    };
    let moving = |model: Model| with_parts(Model { rig: carried(given, &model.mesh), ..model }, given);
    Ok(Baked {
        ray_cast: moving(ray_cast),
        model: moving(model),
        report,
        uv_moves: uv_stage.and_then(|u| u.moves),
    })
}
