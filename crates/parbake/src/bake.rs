//! A bake, from two models to a third.
//!
//! ```text
//! high ─ make_shadeable ─ Scene ─ reference views ─┐
//!                           └──── projection ──┐   │
//! low ── make_shadeable ─ texel map, charts ─ start ┴ samples ─ fit ─ Model
//! ```

use crate::error::BakeError;
use crate::message::{Message, Stage, Watcher};
use crate::options::BakeOptions;
use crate::pair::{common_frame, make_shadeable};
use crate::report::{BakeReport, StageTime};
use parbake_fit::atlas::Atlas;
use parbake_fit::quantise::{color_image, normal_image};
use parbake_fit::reference::render_references;
use parbake_fit::samples::{Beyond, collect_samples};
use parbake_fit::schedule::fit_textures;
use parbake_fit::start::project;
use parbake_fit::views::{Rig, view_pool};
use parbake_fit::watch;
use parbake_mesh::{HighSurface, charts, texel_map};
use parbake_model::{Image, Material, Mesh, Model, TextureSlot, Wrap};
use parbake_render::camera::Projection;
use parbake_render::scene::Scene;
use parbake_render::shade::Lambert;
use std::time::Instant;

/// The training cameras: the paper's distance, and the field of view at which a
/// model fills most of the picture.
const RIG: Rig = Rig { radius: 3.5, projection: Projection::Perspective(0.4) };

/// Charts are grown by so many texels: bilinear fetches reach one, the rest is for
/// the borders of thin triangles.
const CHART_RINGS: usize = 2;

/// A finished bake.
#[derive(Clone, Debug)]
pub struct Baked {
    /// The low-poly with its fitted textures.
    pub model: Model,
    /// The same with projected textures, as an ordinary baker would deliver it.
    pub projected: Model,
    /// What the run saw.
    pub report: BakeReport,
}

/// Passes the fit's messages on, and its question whether to stop.
struct Bridge<'a, W>(&'a W);

impl<W: Watcher> watch::Watch for Bridge<'_, W> {
    fn progress(&self, stage: watch::Stage, done: usize, total: usize) {
        let stage = match stage {
            watch::Stage::Reference => Stage::Reference,
            watch::Stage::Start => Stage::Start,
            watch::Stage::Sampling => Stage::Sampling,
            watch::Stage::Solve => Stage::Solve,
        };
        self.0.message(Message::Progress { stage, done, total });
    }

    fn should_stop(&self) -> bool {
        self.0.stopped()
    }
}

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

/// Bakes the high-poly's look onto the low-poly's own texture coordinates.
///
/// Runs on rayon's current thread pool. When the watcher asks to stop, the best
/// state so far is returned; it is never worse than the projection.
pub fn bake(
    high: &Model,
    low: &Model,
    options: &BakeOptions,
    watcher: &impl Watcher,
) -> Result<Baked, BakeError> {
    options.check()?;
    let plan = options.plan();
    let (convention, size) = (options.convention, options.texture_size);
    let bridge = Bridge(watcher);
    let mut clock = Clock { since: Instant::now(), stages: Vec::new() };
    let mut warnings = Vec::new();
    let mut warn = |text: String| {
        watcher.message(Message::Warning(text.clone()));
        warnings.push(text);
    };

    let mut high = high.clone();
    let frame = common_frame(&high)?;
    make_shadeable(&mut high, false, false);
    frame.apply(&mut high.mesh);
    let mut written = low.clone();
    if written.mesh.uvs.is_empty() {
        return Err(BakeError::NoTextureCoordinates { model: low.name.clone() });
    }
    let repaired = make_shadeable(&mut written, true, true);
    if repaired > 0 && !low.mesh.normals.is_empty() {
        warn(format!("{}: repaired {repaired} unusable normals", low.name));
    }
    let mut placed = written.mesh.clone();
    frame.apply(&mut placed);
    let map = texel_map(&placed, size);
    let atlas = Atlas::new(&map, &charts(&placed), CHART_RINGS);
    if !atlas.covered.contains(&true) {
        return Err(BakeError::FlatTextureCoordinates { model: low.name.clone() });
    }
    if map.overlaps * 50 > size * size {
        warn(format!(
            "{}: {} texels are shared by several triangles and show a compromise; unwrap without overlaps to avoid that",
            low.name, map.overlaps
        ));
    }
    let scene = Scene::new(&high, convention.interpretation());
    let surface = HighSurface::new(&high.mesh);
    clock.lap(Stage::Prepare);

    let start = project(&placed, &map, &atlas, &scene, &surface, 2.0 * options.reach);
    drop(surface);
    clock.lap(Stage::Start);

    let pool = view_pool(plan.views, &RIG, options.seed);
    let references = render_references(&scene, &Lambert, &pool, &plan.reference, 1, &bridge);
    clock.lap(Stage::Reference);

    let beyond = match options.silhouette {
        0.0 => Beyond::Ignore,
        weight => Beyond::Background(options.backdrop.light(), weight),
    };
    let display = convention.display();
    let samples = collect_samples(&placed, &references, plan.reference.size, size, &display, beyond, &bridge);
    let views = references.len();
    drop(references);
    clock.lap(Stage::Sampling);

    let srgb = convention.decodes_srgb();
    let fitted = fit_textures(&samples, &atlas, &start, display, srgb, &plan.schedule, &bridge);
    clock.lap(Stage::Solve);

    let report = BakeReport {
        options: options.clone(),
        high_triangles: high.mesh.triangles.len(),
        low_triangles: low.mesh.triangles.len(),
        views,
        samples: samples.len(),
        covered_texels: fitted.covered,
        unseen_texels: fitted.unseen,
        overlapping_texels: map.overlaps,
        missed_texels: start.missed,
        losses: fitted.losses.iter().map(Into::into).collect(),
        stages: clock.stages,
        stopped_early: fitted.stopped || views < plan.views,
        warnings,
        peak_memory: crate::memory::peak_memory(),
    };
    let projected = textured(
        low,
        &written.mesh,
        color_image("base color", &start.color, srgb),
        normal_image("normal", &start.normal),
    );
    Ok(Baked { model: textured(low, &written.mesh, fitted.color, fitted.normal), projected, report })
}

/// The low-poly with one material of these two textures.
fn textured(low: &Model, mesh: &Mesh, color: Image, normal: Image) -> Model {
    let mut mesh = mesh.clone();
    mesh.colors.clear();
    mesh.uvs1.clear();
    mesh.triangle_materials.fill(0);
    let slot = |image| TextureSlot { image, wrap: [Wrap::Repeat; 2], ..TextureSlot::default() };
    let material = Material {
        name: low.name.clone(),
        base_color_texture: Some(slot(0)),
        normal_texture: Some(slot(1)),
        ..Material::default()
    };
    Model { name: low.name.clone(), mesh, materials: vec![material], images: vec![color, normal] }
}
