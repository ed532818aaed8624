//! A bake, from two models to a third.
//!
//! ```text
//! high ─ placed ─┬ Scene ──────┬ reference views ──────────────┬───────┐
//!                └ HighSurface ┴ projection ────────┐          │       │
//! low ─ lit ─ mend ─ shape ─ unfold ─ LowPoly ───── start ─── depth ─ samples ─ fit ─ Model
//!   (normals)    (vertices) (coordinates) (texel map, charts)  (cutout, parallax)
//! ```

use crate::algorithm_one::algorithm_one;
use crate::bridge::{Bridge, Clock};
use crate::check::{check_mesh, warning};
use crate::depth::{DepthMaps, fit_depth};
use crate::error::BakeError;
use crate::low::{LowPoly, lit};
use crate::message::{Message, Stage, Watcher};
use crate::options::{BakeOptions, UvMode};
use crate::pair::{common_frame, placed};
use crate::report::{BakeReport, Work};
use crate::shape::{Target, shape};
use crate::unfold::{Source, mend_with_room, unfold};
use crate::uv_animation::UvMoves;
use parbake_fit::quantise::{color_image, normal_image};
use parbake_fit::reference::render_references;
use parbake_fit::samples::{collect_samples, shifted_samples};
use parbake_fit::schedule::fit_textures;
use parbake_fit::sighted::sighted_views;
use parbake_fit::start::project;
use parbake_fit::view_walk::{Beyond, Walker};
use parbake_fit::views::{Rig, view_pool};
use parbake_mesh::HighSurface;
use parbake_model::{Image, Material, Mesh, Model, TextureSlot, Wrap};
use parbake_render::camera::Projection;
use parbake_render::scene::Scene;
use parbake_render::shade::Lambert;
use std::mem::take;
use std::time::Instant;

/// The training cameras: the paper's distance, and the field of view at which a
/// model fills most of the picture.
const RIG: Rig = Rig { radius: 3.5, projection: Projection::Perspective(0.4) };

/// A finished bake.
#[derive(Clone, Debug)]
pub struct Baked {
    /// The low-poly with its fitted textures.
    pub model: Model,
    /// The same with projected textures, as an ordinary baker would deliver it.
    pub projected: Model,
    /// What the run saw.
    pub report: BakeReport,
    /// The way of the texture coordinates through the run, where they moved.
    pub uv_moves: Option<UvMoves>,
}

/// The shares of stages in the time that a budget leaves them: textures are worth most, and
/// what reference pictures show must be solved for.
const SHAPE_SHARE: f64 = 0.2;
const UNFOLD_SHARE: f64 = 0.15;
const REFERENCE_SHARE: f64 = 0.25;
const DEPTH_SHARE: f64 = 0.35;

/// Bakes the high-poly's look onto the low-poly.
///
/// Runs on rayon's current thread pool. When the watcher asks to stop, the best
/// state so far is returned; it is never worse than the projection.
pub fn bake(
    high: &Model,
    low: &Model,
    options: &BakeOptions,
    watcher: &impl Watcher,
) -> Result<Baked, BakeError> {
    bake_pair(high, low, false, options, watcher)
}

/// `same` says that both are one model, triangle by triangle.
pub(crate) fn bake_pair(
    high: &Model,
    low: &Model,
    same: bool,
    options: &BakeOptions,
    watcher: &impl Watcher,
) -> Result<Baked, BakeError> {
    options.check()?;
    let mut plan = options.plan();
    if same {
        // Nothing is moved by parallax, so sharper samples only bring out more.
        plan.reference.filter = (0.5 * plan.reference.filter).max(1.0 / 16.0);
    }
    let (convention, size) = (options.convention, options.texture_size);
    let begin = Instant::now();
    let bridge = Bridge::new(watcher, begin, options.time_budget);
    let mut clock = Clock::new(begin);
    let frame = common_frame(high)?;
    // One model twice keeps its vertices, whatever their normals are like.
    let (turned, warnings) = (!same).then(|| lit(low)).unzip();
    let low = turned.as_ref().unwrap_or(low);
    let mut warnings = warnings.unwrap_or_default();
    let mesh = placed(high, &frame);
    let (scene, surface) = rayon::join(
        || Scene::new(mesh.clone(), &high.materials, &high.images, convention.interpretation()),
        || HighSurface::new(&mesh),
    );
    drop(mesh);
    let (display, reach) = (convention.display(), 2.0 * options.reach);
    let (mut shaped, mut unfolded) = (None, None);
    let target = Target { scene: &scene, surface: &surface, reach, display, rig: RIG };
    let shape_plan = options.shape_plan().filter(|_| !same);
    let algorithm_plan = options.algorithm_plan().filter(|_| !same);
    let mut unfold_options = options.unfold();
    let mut map_of_paper = None;
    if options.uv != UvMode::Keep || shape_plan.is_some() || algorithm_plan.is_some() {
        let mut low = mend_with_room(low, &mut unfold_options)?;
        clock.lap(Stage::Prepare);
        if let Some(plan) = &shape_plan {
            let share = bridge.share(SHAPE_SHARE);
            shaped = Some(shape(&mut low, &frame, &target, plan, options.seed, &share)?);
            clock.lap(Stage::Shape);
        }
        let source = Source {
            scene: &scene,
            surface: (!same).then_some(&surface),
            reach,
            encode: convention.decodes_srgb(),
        };
        let mut moved = unfold(low, &frame, &source, &unfold_options, &bridge.share(UNFOLD_SHARE));
        clock.lap(Stage::Unfold);
        if let Some(plan) = &algorithm_plan {
            let share = bridge.share(DEPTH_SHARE);
            let outcome = algorithm_one(&mut moved.model, &frame, &target, plan, options.seed, &share)?;
            (shaped, map_of_paper) = (outcome.report, outcome.map);
            clock.lap(Stage::Shape);
        }
        unfolded = Some(moved);
    }
    let low = unfolded.as_ref().map_or(low, |u| &u.model);
    let LowPoly { written, placed, map, atlas, warnings: of_low } = LowPoly::new(low, &frame, size)?;
    warnings.extend(of_low);
    warnings.extend(
        unfolded.iter().flat_map(|u| u.report.mended.iter().map(|done| format!("{}: {done}", low.name))),
    );
    for warning in &warnings {
        watcher.message(Message::Warning(warning.clone()));
    }
    clock.lap(Stage::Prepare);

    let start = project(&placed, &map, &atlas, &scene, &surface, reach);
    clock.lap(Stage::Start);

    let pool = view_pool(plan.views, &RIG, options.seed);
    let references =
        render_references(&scene, &Lambert, &pool, &plan.reference, 1, &bridge.share(REFERENCE_SHARE));
    clock.lap(Stage::Reference);

    let beyond = match options.silhouette_weight() {
        0.0 => Beyond::Ignore,
        weight => Beyond::Background(options.backdrop.light(), weight),
    };
    let srgb = convention.decodes_srgb();
    let walker = Walker::new(&placed, plan.reference.size, &display, beyond);
    let mut depth = None;
    if let Some(plan) = options.depth_plan().filter(|_| !same) {
        let share = bridge.share(DEPTH_SHARE);
        depth = Some(fit_depth(low, &frame, &target, &references, &walker, srgb, &plan, &share)?);
        clock.lap(Stage::Parallax);
    }
    drop(surface);
    let of_paper = map_of_paper.map(|parallax| DepthMaps { parallax, cutout: None });
    let mut sighted = depth.as_mut().map(|d| take(&mut d.views)).unwrap_or_default();
    let maps = depth.as_ref().map(|d| &d.maps).or(of_paper.as_ref());
    let views = references.len();
    let samples = match maps {
        None => {
            let samples = collect_samples(&walker, &references, size, &bridge);
            drop(references);
            samples
        }
        Some(DepthMaps { parallax, cutout }) => {
            let walker = walker.with_cutout(cutout.as_ref());
            sighted.extend(sighted_views(&walker, &references[sighted.len()..]));
            drop(references);
            shifted_samples(sighted, size, parallax, &bridge)
        }
    };
    if samples.is_empty() {
        return Err(BakeError::OutOfView { low: low.name.clone(), high: high.name.clone() });
    }
    clock.lap(Stage::Sampling);

    let fitted = fit_textures(&samples, &atlas, &start, display, srgb, &plan.schedule, &bridge);
    clock.lap(Stage::Solve);

    let uv = check_mesh(&written, size);
    if let Some(warning) = warning(&low.name, &uv) {
        watcher.message(Message::Warning(warning.clone()));
        warnings.push(warning);
    }
    let report = BakeReport {
        work: if same { Work::Compress } else { Work::Bake },
        shape: shaped,
        depth: depth.as_ref().map(|d| d.report.clone()),
        unfold: unfolded.as_ref().filter(|_| options.uv != UvMode::Keep).map(|u| u.report.clone()),
        options: options.clone(),
        high_triangles: high.mesh.triangles.len(),
        low_triangles: low.mesh.triangles.len(),
        views,
        samples: samples.len(),
        covered_texels: fitted.covered,
        unseen_texels: fitted.unseen,
        overlapping_texels: map.overlaps,
        missed_texels: start.missed,
        uv,
        losses: fitted.losses.iter().map(Into::into).collect(),
        stages: clock.stages,
        stopped_early: fitted.stopped || views < plan.views || bridge.stopped_a_stage(),
        warnings,
        peak_memory: crate::memory::peak_memory(),
    };
    let projected = textured(
        low,
        &written,
        color_image("base color", &start.color, srgb),
        normal_image("normal", &start.normal),
        None,
    );
    Ok(Baked {
        model: textured(low, &written, fitted.color, fitted.normal, maps),
        projected,
        report,
        uv_moves: unfolded.as_ref().and_then(|u| u.moves.clone()),
    })
}

/// The low-poly with one material of these two textures and these maps.
fn textured(low: &Model, mesh: &Mesh, color: Image, normal: Image, maps: Option<&DepthMaps>) -> Model {
    let mut mesh = mesh.clone();
    mesh.colors.clear();
    mesh.uvs1.clear();
    mesh.triangle_materials.fill(0);
    let slot = |image| TextureSlot { image, wrap: [Wrap::Repeat; 2], ..TextureSlot::default() };
    let mut images = vec![color, normal];
    let parallax = maps.map(|maps| maps.pack(&mut images));
    let material = Material {
        parallax,
        name: low.name.clone(),
        base_color_texture: Some(slot(0)),
        normal_texture: Some(slot(1)),
        ..Material::default()
    };
    Model { name: low.name.clone(), mesh, materials: vec![material], images }
}
