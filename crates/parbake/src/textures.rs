//! From views to maps: what is fitted to the light that views show (`--shading lambert`), or to the
//! materials that they see (`pbr`); parallax maps before either.
//!
//! Normals of plain materials are fitted to the high-poly's normals, too, unless a headlight is asked for:
//! what a headlight shows of normals does not tell left from right, so normals that are fitted to its light
//! alone are grainy under others.

use crate::budget::{shares, solving_share};
use crate::error::BakeError;
use crate::order::Order;
use crate::snapshots::OfMaps;
use crate::work::Work;
use parbake_fit::backend::Backend;
use parbake_fit::baked_materials::Look;
use parbake_fit::parallax_maps::{
    FittedMaps, ParallaxInput, ParallaxMaps, ParallaxPlan, ParallaxReport, fit_parallax_maps,
};
use parbake_fit::schedule::{Comparison, Fitted, fit_textures};
use parbake_fit::separate_maps::fit_separate_maps;
use parbake_image::MapKind;
use parbake_image::quantise::from_image;
use parbake_model::Model;
use parbake_model::glam::{Vec2, Vec3};
use parbake_progress::{Clock, Portion, ProgressScope, Showing, Stage};
use parbake_render::directions::{VertexFrame, view_direction};
use parbake_render::parallax::ParallaxCoefficients;
use parbake_views::alpha_layers::{LayerKind, alpha_layers};
use parbake_views::high_poly::{Conventions, HEADLIGHT_BRDF, ViewSet};
use parbake_views::low_poly::LowPoly;
use parbake_views::material_sampler::MaterialSampler;
use parbake_views::projection::ProjectedMaps;
use parbake_views::reference::Reference;
use parbake_views::view_sampler::ViewSampler;
use std::sync::Arc;

/// Maps, and what they were fitted to.
pub(crate) struct FittedTextures {
    pub fitted: Fitted,
    pub views: usize,
    pub samples: usize,
    pub parallax: Option<ParallaxMaps>,
    pub parallax_report: Option<ParallaxReport>,
}

/// The low-poly whose maps are fitted.
#[derive(Clone, Copy)]
pub(crate) struct Subject<'a> {
    pub model: &'a Model,
    pub prepared: &'a LowPoly,
    pub projected: &'a ProjectedMaps,
    /// The layer of each triangle.
    pub kinds: &'a [LayerKind],
    /// Whether snapshots show it.
    pub is_seen: bool,
}

/// The training views of an order.
fn view_set(order: &Order) -> ViewSet {
    let &Order { plan, options, .. } = order;
    ViewSet { count: plan.views, seed: options.seed, jitter: true, sampling: plan.reference }
}

fn parallax_plan(order: &Order) -> Option<ParallaxPlan> {
    order.options.parallax_plan().filter(|_| order.work != Work::Compress)
}

/// The pictures that [`fit_views`] needs; none where materials are fitted alone, for what is seen of these needs none.
pub(crate) fn training_views(order: &Order, scope: &ProgressScope) -> Option<Arc<Vec<Reference>>> {
    let is_needed = !order.high.is_whole_material || parallax_plan(order).is_some();
    is_needed.then(|| order.high.references(&view_set(order), &scope.share(shares::REFERENCE)))
}

/// Fits the maps of a low-poly whose shape and coordinates stay from now on to `references`
/// ([`training_views`]). `given` is a parallax map that was fitted before.
///
/// # Errors
/// Where no view shows the low-poly before the high-poly.
pub(crate) fn fit_views(
    order: &Order,
    subject: Subject,
    references: Option<Arc<Vec<Reference>>>,
    given: Option<ParallaxCoefficients>,
    scope: &ProgressScope,
    clock: &mut Clock,
) -> Result<FittedTextures, BakeError> {
    let &Order { high, plan, options, backend, .. } = order;
    let Subject { model: low, prepared, projected, kinds, is_seen } = subject;
    let (size, placed) = (options.texture_size, &prepared.placed);
    let Conventions { display, .. } = high.conventions;
    let set = view_set(order);
    let parallax_plan = parallax_plan(order);
    let whole = high.is_whole_material;

    let look = Look::without_extensions(high, kinds.to_vec());
    let srgb = high.conventions.srgb();
    let comparison = Comparison { backend, brdf: &HEADLIGHT_BRDF, display, srgb };
    let solving = Portion::new(scope, 0.0..solving_share(options));
    let seen = OfMaps::new(&look, low, &prepared.written, &projected.maps, srgb);

    let mut sampler = ViewSampler::new(placed, plan.reference.size, &display, options.uncovered_pixels());
    if let Some(plan) = &parallax_plan {
        sampler = sampler.in_basis(plan.parallax.basis);
    }
    let parallax = match (parallax_plan, &references) {
        (Some(plan), Some(references)) => {
            let share = scope.share(shares::PARALLAX);
            let share = Showing::new(&share, |snapshot| seen.complete(snapshot, None)).only_if(is_seen);
            let input = ParallaxInput { low, prepared, projected, high, references, sampler: &sampler };
            let fitted = fit_parallax_maps(&input, &comparison, &plan, &share)?;
            clock.lap(Stage::Parallax);
            Some(fitted)
        }
        _ => given.map(FittedMaps::given),
    };
    let unseen = || BakeError::OutOfView { low: low.name.clone(), high: high.name.clone() };
    let (atlas, start) = (&prepared.atlas, &projected.maps);
    let sampled = |maps: Option<&ParallaxMaps>| {
        let shift = maps.map(shift_of);
        let shift = shift.as_ref().map(|shift| shift as _);
        let layers = alpha_layers(kinds, high);
        let sampler = MaterialSampler { high, low: placed, layers: &layers, shift };
        backend.material_samples(&sampler, &set, size, scope)
    };
    if whole {
        drop(references);
        let (maps, parallax_report) = parallax.map(|fitted| (fitted.maps, fitted.report)).unzip();
        let (mut samples, views) = sampled(maps.as_ref());
        if samples.is_empty() {
            return Err(unseen());
        }
        clock.lap(Stage::Sampling);
        let showing =
            Showing::new(&solving, |snapshot| seen.complete(snapshot, maps.as_ref())).only_if(is_seen);
        let schedule = plan.material_schedule();
        let fitted = fit_separate_maps(&mut samples, atlas, start, backend, srgb, &schedule, &showing);
        let (samples, parallax_report) = (samples.len(), parallax_report.flatten());
        return Ok(FittedTextures { fitted, views, samples, parallax: maps, parallax_report });
    }
    let references = references.unwrap_or_default();
    let views = references.len();
    let (samples, maps, parallax_report) = match parallax {
        None => {
            // Textures that follow others may need fewer than were rendered.
            let some = &references[..views.min(plan.views)];
            let samples = backend.view_samples(&sampler, some, size, scope);
            drop(references);
            (samples, None, None)
        }
        Some(FittedMaps { maps, views: mut view_samples, report }) => {
            let sampler = sampler.with_cutout(maps.cutout.as_ref());
            view_samples.extend(backend.sample_views(&sampler, &references[view_samples.len()..]));
            drop(references);
            (backend.shifted_view_samples(view_samples, size, &maps.parallax, scope), Some(maps), report)
        }
    };
    if samples.is_empty() {
        return Err(unseen());
    }
    clock.lap(Stage::Sampling);
    let showing = Showing::new(&solving, |snapshot| seen.complete(snapshot, maps.as_ref())).only_if(is_seen);
    let (mut start, mut schedule) = (start.clone(), plan.schedule);
    if schedule.normal_steps > 0 && !options.fits_normals_to_headlight() {
        let (mut samples, _) = sampled(maps.as_ref());
        let (normals, schedule_of_normals) = (start.only(MapKind::Normal), plan.material_schedule());
        let fitted =
            fit_separate_maps(&mut samples, atlas, &normals, backend, srgb, &schedule_of_normals, &showing);
        for (kind, image) in fitted.images {
            start.insert(kind, from_image(kind, &image, srgb));
        }
        schedule.normal_steps = 0;
    }
    // What a headlight shows of a surface of one colour is its shape. Painted onto it, that would be wrong under other lights.
    let is_of_one_color = high.scene.has_one_base_color() && start.get(MapKind::Emissive).is_none();
    if is_of_one_color && !options.fits_normals_to_headlight() {
        (schedule.color_steps, schedule.final_steps) = (0, 0);
    }
    let fitted = fit_textures(&samples, atlas, &start, &comparison, &schedule, &showing);
    Ok(FittedTextures { fitted, views, samples: samples.len(), parallax: maps, parallax_report })
}

/// Where a point's maps are fetched, seen along a direction; none where it is cut out.
fn shift_of(maps: &ParallaxMaps) -> impl Fn(Vec2, Vec3, &VertexFrame) -> Option<Vec2> + Sync + '_ {
    move |uv, to_viewer, frame| {
        let view_direction = view_direction(maps.parallax.basis, frame, to_viewer);
        let is_cut =
            maps.cutout.as_ref().is_some_and(|cutout| cutout.opacity(uv, view_direction.direction) < 0.0);
        (!is_cut).then(|| uv + maps.parallax.shift(uv, &view_direction))
    }
}
