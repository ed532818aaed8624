//! A bake, from two models to a third.
//!
//! ```text
//! high ─ placed ─┬ Scene ──────┬ reference views ─┐
//!                └ HighSurface ┴ projection ──┐   │
//! low ── LowPoly (texel map, charts) ─────── start ┴ samples ─ fit ─ Model
//! ```

use crate::check::{check_mesh, warning};
use crate::error::BakeError;
use crate::low::LowPoly;
use crate::message::{Message, Stage, Watcher};
use crate::options::{BakeOptions, UvMode};
use crate::pair::{common_frame, placed};
use crate::parallax::parallax;
use crate::report::{BakeReport, StageTime};
use crate::shape::{Target, shape};
use crate::unfold::{Source, mend, unfold};
use crate::uv_animation::UvMoves;
use parbake_fit::quantise::{color_image, normal_image};
use parbake_fit::reference::render_references;
use parbake_fit::samples::collect_samples;
use parbake_fit::schedule::fit_textures;
use parbake_fit::start::project;
use parbake_fit::view_walk::{Beyond, Walker};
use parbake_fit::views::{Rig, view_pool};
use parbake_fit::watch;
use parbake_mesh::HighSurface;
use parbake_model::{Image, Material, Mesh, Model, TextureSlot, Wrap};
use parbake_render::camera::Projection;
use parbake_render::parallax::ShParallax;
use parbake_render::scene::Scene;
use parbake_render::shade::Lambert;
use std::time::{Duration, Instant};

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

/// Passes the fit's messages on, and its question whether to stop.
struct Bridge<'a, W> {
    watcher: &'a W,
    /// When a budget is spent, besides what the watcher says.
    until: Option<Instant>,
}

impl<W: Watcher> Bridge<'_, W> {
    /// The same for a stage that may take this share of the time that is left.
    fn share(&self, share: f64) -> Self {
        let own = self.until.map(|until| until.saturating_duration_since(Instant::now()).as_secs_f64());
        let left = own.into_iter().chain(self.watcher.seconds_left()).reduce(f64::min);
        let until = left.map(|left| Instant::now() + Duration::from_secs_f64((left * share).clamp(0.0, 1e9)));
        Self { watcher: self.watcher, until }
    }
}

impl<W: Watcher> Watcher for Bridge<'_, W> {
    fn message(&self, message: Message) {
        self.watcher.message(message);
    }

    fn stopped(&self) -> bool {
        watch::Watch::should_stop(self)
    }
}

impl<W: Watcher> watch::Watch for Bridge<'_, W> {
    fn progress(&self, stage: watch::Stage, done: usize, total: usize) {
        let stage = match stage {
            watch::Stage::Shape => Stage::Shape,
            watch::Stage::Reference => Stage::Reference,
            watch::Stage::Start => Stage::Start,
            watch::Stage::Sampling => Stage::Sampling,
            watch::Stage::Cutout => Stage::Cutout,
            watch::Stage::Parallax => Stage::Parallax,
            watch::Stage::Solve => Stage::Solve,
        };
        self.watcher.message(Message::Progress { stage, done, total });
    }

    fn should_stop(&self) -> bool {
        self.watcher.stopped() || self.until.is_some_and(|until| Instant::now() >= until)
    }
}

/// The share of vertices in a time budget.
const SHAPE_SHARE: f64 = 0.3;

/// The share of the parallax map in a time budget.
const PARALLAX_SHARE: f64 = 0.5;

/// The share of texture coordinates in a time budget: textures are worth more.
const UNFOLD_SHARE: f64 = 0.3;

/// The reference pictures' share of a time budget: what they show must be solved for.
const REFERENCE_SHARE: f64 = 0.3;

struct Clock {
    since: Instant,
    stages: Vec<StageTime>,
}

impl Clock {
    fn lap(&mut self, stage: Stage) {
        let seconds = self.since.elapsed().as_secs_f64();
        self.since = Instant::now();
        self.stages.push(StageTime { stage, seconds });
    }
}

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
    let until = options.time_budget.map(|seconds| begin + Duration::from_secs_f64(seconds.min(1e9)));
    let bridge = Bridge { watcher, until };
    let mut clock = Clock { since: begin, stages: Vec::new() };
    let frame = common_frame(high)?;
    let mesh = placed(high, &frame);
    let (scene, surface) = rayon::join(
        || Scene::new(mesh.clone(), &high.materials, &high.images, convention.interpretation()),
        || HighSurface::new(&mesh),
    );
    drop(mesh);
    let (display, reach) = (convention.display(), 2.0 * options.reach);
    let (mut shaped, mut unfolded) = (None, None);
    let shape_plan = options.shape_plan().filter(|_| !same);
    let unfold_options = options.unfold();
    if options.uv != UvMode::Keep || shape_plan.is_some() {
        let mut low = mend(low, &unfold_options)?;
        clock.lap(Stage::Prepare);
        if let Some(plan) = &shape_plan {
            let target = Target { scene: &scene, surface: &surface, reach, display, rig: RIG };
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
        unfolded = Some(unfold(low, &frame, &source, &unfold_options, &bridge.share(UNFOLD_SHARE)));
        clock.lap(Stage::Unfold);
    }
    let low = unfolded.as_ref().map_or(low, |u| &u.model);
    let LowPoly { written, placed, map, atlas, mut warnings } = LowPoly::new(low, &frame, size)?;
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

    let beyond = match options.silhouette {
        0.0 => Beyond::Ignore,
        weight => Beyond::Background(options.backdrop.light(), weight),
    };
    let walker = Walker::new(&placed, plan.reference.size, &display, beyond);
    let env = |name: &str, default: f32| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    let _ = std::fs::remove_file("/tmp/cutout.bin");
    let cut = (env("C_STEPS", 0.0) > 0.0).then(|| {
        let o = parbake_fit::cutout::CutoutOptions {
            order: env("C_ORDER", 2.0) as usize,
            size: env("C_SIZE", 64.0) as usize,
            steps: env("C_STEPS", 200.0) as usize,
            rate: env("C_RATE", 0.1),
            ..Default::default()
        };
        let t = Instant::now();
        let ex = parbake_fit::cutout::examples(&walker, &references, o.size);
        let t1 = t.elapsed();
        let (map, wrong) = parbake_fit::cutout::fit_cutout(&ex, &o, &bridge);
        eprintln!("cutout {:?} {t1:?} {:?} of {}", wrong, t.elapsed(), ex.iter().map(Vec::len).sum::<usize>());
        let mut b: Vec<u8> = vec![o.order as u8, o.size as u8];
        for c in &map.coefficients { b.extend(c.to_le_bytes()); }
        std::fs::write("/tmp/cutout.bin", b).unwrap();
        map
    });
    let walker = walker.with_cutout(cut.as_ref());
    let srgb = convention.decodes_srgb();
    let mut shifts = None;
    if let Some(plan) = options.parallax_plan() {
        let target = Target { scene: &scene, surface: &surface, reach, display, rig: RIG };
        let share = bridge.share(PARALLAX_SHARE);
        shifts = Some(parallax(low, &frame, &target, &references, &walker, srgb, &plan, &share)?);
        clock.lap(Stage::Parallax);
    }
    drop(surface);
    let shift_map = shifts.as_ref().map(|(map, _)| map);
    let samples = collect_samples(&walker, &references, size, shift_map, &bridge);
    let views = references.len();
    drop(references);
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
        shape: shaped,
        parallax: shifts.as_ref().map(|(_, report)| report.clone()),
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
        stopped_early: fitted.stopped || views < plan.views,
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
        model: textured(low, &written, fitted.color, fitted.normal, shift_map),
        projected,
        report,
        uv_moves: unfolded.as_ref().and_then(|u| u.moves.clone()),
    })
}

/// The low-poly with one material of these two textures and this parallax map.
fn textured(low: &Model, mesh: &Mesh, color: Image, normal: Image, shifts: Option<&ShParallax>) -> Model {
    let mut mesh = mesh.clone();
    mesh.colors.clear();
    mesh.uvs1.clear();
    mesh.triangle_materials.fill(0);
    let slot = |image| TextureSlot { image, wrap: [Wrap::Repeat; 2], ..TextureSlot::default() };
    let mut images = vec![color, normal];
    let parallax = shifts.map(|map| map.pack(&mut images));
    let material = Material {
        parallax,
        name: low.name.clone(),
        base_color_texture: Some(slot(0)),
        normal_texture: Some(slot(1)),
        ..Material::default()
    };
    Model { name: low.name.clone(), mesh, materials: vec![material], images }
}
