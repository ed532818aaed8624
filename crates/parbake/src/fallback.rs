//! Textures for viewers that do not know parallax maps: base colour and normals as of a bake without maps.
//!
//! Textures that are sharp where they shift are wrong where they do not. Those of a plain bake are the mean of what views
//! see, as blurred as triangles are coarse, so few texels do for them. Where the size is not given, sides are tried from a
//! quarter of the texture's on, until the next one would hardly show more. A doubling was seen to gain a third of the one
//! before: 0.37 and 0.12 dB (mask, 218 triangles), 0.23 and 0.06 (toy figure, 108). Normals have half the side of the
//! colours: on four models that brought −0.06 to +0.16 dB on black, up to +0.1 on white, and took 3 to 6 % of the file
//! away. Where the maps' own textures show as much, they serve all viewers.
//!
//! Contract: pictures are judged on black under a headlight, from training views.

use crate::budget::solving_share;
use crate::error::BakeError;
use crate::options::{BakeOptions, Parallax};
use crate::order::Order;
use crate::plan::Plan;
use crate::textures::{Subject, fit_views};
use parbake_fit::baked_materials::add_fallback;
use parbake_image::MapKind;
use parbake_image::display::Display;
use parbake_image::reduced::reduced;
use parbake_metric::psnr_from_mse;
use parbake_model::{Image, Model};
use parbake_progress::{Clock, Portion, ProgressScope, Stage, Watcher};
use parbake_render::interpretation::Interpretation;
use parbake_views::alpha_layers::LayerKind;
use parbake_views::frame::scene;
use parbake_views::high_poly::HEADLIGHT_BRDF;
use parbake_views::low_poly::LowPoly;
use parbake_views::pool::View;
use parbake_views::projection::project;
use parbake_views::reference::{Reference, render_references};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Instant;

/// Decibels that a doubling of the side has to gain, and those from which on the next one is tried.
const WORTH_DOUBLING: f64 = 0.06;
const WORTH_ANOTHER: f64 = 0.4;

/// Decibels by which textures of their own have to be better than those for the maps.
const WORTH_THEIR_BYTES: f64 = 0.12;

/// The least side, in texels.
const LEAST: usize = 16;

/// Training views that score.
const JUDGING: usize = 48;

/// What was tried.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FallbackReport {
    /// Sides in texels with the PSNR in dB of what viewers without the maps show.
    pub tried: Vec<(usize, f64)>,
    /// The same with the textures for the maps.
    pub shared: f64,
    /// The side that was taken; none where the textures for the maps serve all.
    pub side: Option<usize>,
}

/// What came of it.
#[derive(Default)]
pub(crate) struct Fallback {
    /// The textures; none where the maps' own serve all viewers.
    pub maps: Vec<(MapKind, Image)>,
    /// What was tried; none where there was no time to.
    pub report: Option<FallbackReport>,
}

/// Textures of one size.
struct Tried {
    maps: Vec<(MapKind, Image)>,
    side: usize,
    psnr: f64,
}

/// The textures of viewers without the maps; `with_maps` is the model as it is finished but for these.
///
/// # Errors
/// As of [`fit_views`].
pub(crate) fn fit_fallback(
    order: &Order,
    (low, kinds): (&Model, &[LayerKind]),
    with_maps: &Model,
    references: Arc<Vec<Reference>>,
    scope: &ProgressScope,
    clock: &mut Clock,
) -> Result<Fallback, BakeError> {
    let judged = &references[..references.len().min(JUDGING)];
    // To judge is no stage of its own.
    let quiet = &Portion::new(scope, 0.0..0.0).of_stage(Stage::Solve, Stage::Solve);
    let psnr = |maps: &[(MapKind, Image)]| psnr(order, with_maps, maps, judged, quiet);
    let mut report = FallbackReport::default();
    let mut best: Option<Tried> = None;
    let (sides, before) = (sides(order.options), solving_share(order.options));
    for (place, &side) in sides.iter().enumerate() {
        if scope.stopped() {
            break;
        }
        let share = |tried: usize| before + (1.0 - before) * tried as f64 / sides.len() as f64;
        let own = Portion::new(scope, share(place)..share(place + 1)).of_stage(Stage::Solve, Stage::Solve);
        let own = ProgressScope::new(&own, Instant::now(), None);
        let maps = fit(order, low, kinds, side, references.clone(), &own, clock)?;
        let found = psnr(&maps);
        clock.lap(Stage::Solve);
        report.tried.push((side, found));
        let gain = best.as_ref().map_or(f64::INFINITY, |before| found - before.psnr);
        if gain >= WORTH_DOUBLING {
            best = Some(Tried { maps, side, psnr: found });
        }
        if gain < WORTH_ANOTHER {
            break;
        }
    }
    let Some(Tried { maps, side, psnr: found }) = best else { return Ok(Fallback::default()) };
    report.shared = psnr(&[]);
    // What was asked for is written.
    if order.options.fallback_size.is_none() && report.shared > found - WORTH_THEIR_BYTES {
        return Ok(Fallback { maps: Vec::new(), report: Some(report) });
    }
    report.side = Some(side);
    Ok(Fallback { maps, report: Some(report) })
}

/// Sides to try, growing.
fn sides(options: &BakeOptions) -> Vec<usize> {
    match options.fallback_size {
        Some(0) => Vec::new(),
        Some(side) => vec![side],
        None => {
            let mut sides = [4, 2, 1].map(|divisor| (options.texture_size / divisor).max(LEAST)).to_vec();
            sides.dedup();
            sides
        }
    }
}

fn fit(
    order: &Order,
    low: &Model,
    kinds: &[LayerKind],
    side: usize,
    references: Arc<Vec<Reference>>,
    scope: &ProgressScope,
    clock: &mut Clock,
) -> Result<Vec<(MapKind, Image)>, BakeError> {
    let &Order { high, plan, options, .. } = order;
    let options = BakeOptions { parallax: Parallax::None, texture_size: side, ..options.clone() };
    let schedule = options.plan().schedule;
    // Fewer texels need fewer views.
    let views = if side < order.options.texture_size { plan.views.div_ceil(2) } else { plan.views };
    let plan = &Plan { schedule, views, ..*plan };
    let prepared = &LowPoly::new(low, &high.frame, side)?;
    let projected = &project(prepared, high);
    let subject = Subject { model: low, prepared, projected, kinds, is_seen: false };
    let order = Order { plan, options: &options, ..*order };
    let mut images = fit_views(&order, subject, Some(references), None, scope, clock)?.fitted.images;
    images.retain(|(kind, _)| matches!(kind, MapKind::BaseColor | MapKind::Normal));
    for (kind, image) in &mut images {
        if *kind == MapKind::Normal && image.width >= 2 * LEAST {
            *image = reduced(*kind, image, high.conventions.srgb(), [1; 2]);
        }
    }
    Ok(images)
}

/// How well viewers without the maps show the high-poly, with these textures of their own.
fn psnr(
    order: &Order,
    with_maps: &Model,
    maps: &[(MapKind, Image)],
    judged: &[Reference],
    watcher: &dyn Watcher,
) -> f64 {
    let high = order.high;
    let mut model = with_maps.clone();
    add_fallback(&mut model, maps.to_vec());
    let interpretation = Interpretation { parallax: false, ..high.conventions.interpretation };
    let scene = scene(&model, &high.frame, interpretation);
    let views: Vec<View> = judged.iter().map(|reference| reference.view).collect();
    let shown =
        render_references(&scene, &HEADLIGHT_BRDF, &views, &order.plan.reference, views.len(), watcher);
    let display = &high.conventions.display;
    let squares: f64 = judged.iter().zip(&shown).map(|(wanted, shown)| square(wanted, shown, display)).sum();
    let values: usize = judged.iter().map(|reference| 3 * reference.pixels.len()).sum();
    psnr_from_mse(squares / values.max(1) as f64)
}

/// The sum of squared differences of two pictures, as displayed on black.
fn square(wanted: &Reference, shown: &Reference, display: &Display) -> f64 {
    let pixels = wanted.linear().into_iter().zip(shown.linear());
    let differences = pixels.flat_map(|(wanted, shown)| [0, 1, 2].map(|k| (wanted[k], shown[k])));
    differences.map(|(a, b)| f64::from(display.encode(a) - display.encode(b)).powi(2)).sum()
}
