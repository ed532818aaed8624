//! A bake, from two models to a third.
//!
//! ```text
//! high ─ placed ─┬ Scene ──────┬ reference views ──────────────┬───────┐
//!                └ HighSurface ┴ projection ────────┐          │       │
//! low ─ lit ─ mend ─ shape ─ unfold ─ LowPoly ───── start ─── depth ─ samples ─ fit ─ Model
//!   (normals)    (vertices) (coordinates) (texel map, charts)  (cutout, parallax)
//! ```

use crate::bridge::{Bridge, Clock, shares};
use crate::check::{check_mesh, warning};
use crate::depth::{Depth, DepthMaps, fit_depth};
use crate::error::BakeError;
use crate::geometry::{Geometry, move_geometry};
use crate::low::{LowPoly, lit};
use crate::message::{Message, Stage, Watcher};
use crate::options::{BakeOptions, UvMode};
use crate::pair::{common_frame, placed};
use crate::report::{BakeReport, Work};
use crate::shape::Target;
use crate::uv_animation::UvMoves;
use parbake_fit::quantise::{color_image, normal_image};
use parbake_fit::reference::render_references;
use parbake_fit::samples::{collect_samples, shifted_samples};
use parbake_fit::schedule::fit_textures;
use parbake_fit::sighted::sighted_views;
use parbake_fit::start::project;
use parbake_fit::view_walk::Walker;
use parbake_fit::views::{Rig, view_pool};
use parbake_mesh::HighSurface;
use parbake_model::{Image, Material, Mesh, Model, Placement, TextureSlot, Wrap};
use parbake_render::camera::Projection;
use parbake_render::interpretation::Interpretation;
use parbake_render::scene::Scene;
use parbake_render::shade::Lambert;
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
    let (display, srgb) = (convention.display(), convention.decodes_srgb());
    let begin = Instant::now();
    let bridge = Bridge::new(watcher, begin, options.time_budget);
    let mut clock = Clock::new(begin);
    let mut warnings = Warnings { watcher, told: Vec::new() };
    let frame = common_frame(high)?;
    // One model twice keeps its vertices, whatever their normals are like.
    let turned = (!same).then(|| lit(low));
    let low = turned.as_ref().map_or(low, |(model, _)| model);
    warnings.tell(turned.iter().flat_map(|(_, of_normals)| of_normals.clone()));
    let (scene, surface) = seen_and_touched(high, &frame, convention.interpretation());
    let target =
        Target { scene: &scene, surface: &surface, reach: 2.0 * options.reach, display, srgb, rig: RIG };
    let Geometry { unfolded, shape, map } =
        move_geometry(low, same, &frame, &target, options, &bridge, &mut clock)?;
    let low = unfolded.as_ref().map_or(low, |u| &u.model);
    let LowPoly { written, placed, map: texels, atlas, warnings: of_low } = LowPoly::new(low, &frame, size)?;
    warnings.tell(of_low);
    let mended = unfolded.iter().flat_map(|u| &u.report.mended);
    warnings.tell(mended.map(|done| format!("{}: {done}", low.name)));
    clock.lap(Stage::Prepare);

    let start = project(&placed, &texels, &atlas, &scene, &surface, target.reach);
    clock.lap(Stage::Start);

    let pool = view_pool(plan.views, &RIG, options.seed);
    let share = bridge.share(shares::REFERENCE);
    let references = render_references(&scene, &Lambert, &pool, &plan.reference, 1, &share);
    let views = references.len();
    clock.lap(Stage::Reference);

    let walker = Walker::new(&placed, plan.reference.size, &display, options.beyond());
    let depth = match options.depth_plan().filter(|_| !same) {
        Some(plan) => {
            let share = bridge.share(shares::DEPTH);
            let depth = fit_depth(low, &frame, &target, &references, &walker, &plan, &share)?;
            clock.lap(Stage::Parallax);
            Some(depth)
        }
        None => map.map(Depth::given),
    };
    drop(surface);
    let (samples, maps, depth_report) = match depth {
        None => {
            let samples = collect_samples(&walker, &references, size, &bridge);
            drop(references);
            (samples, None, None)
        }
        Some(Depth { maps, views: mut sighted, report }) => {
            let walker = walker.with_cutout(maps.cutout.as_ref());
            sighted.extend(sighted_views(&walker, &references[sighted.len()..]));
            drop(references);
            (shifted_samples(sighted, size, &maps.parallax, &bridge), Some(maps), report)
        }
    };
    if samples.is_empty() {
        return Err(BakeError::OutOfView { low: low.name.clone(), high: high.name.clone() });
    }
    clock.lap(Stage::Sampling);

    let fitted = fit_textures(&samples, &atlas, &start, display, srgb, &plan.schedule, &bridge);
    clock.lap(Stage::Solve);

    let uv = check_mesh(&written, size);
    warnings.tell(warning(&low.name, &uv));
    let report = BakeReport {
        work: if same { Work::Compress } else { Work::Bake },
        shape,
        depth: depth_report,
        unfold: unfolded.as_ref().filter(|_| options.uv != UvMode::Keep).map(|u| u.report.clone()),
        options: options.clone(),
        high_triangles: high.mesh.triangles.len(),
        low_triangles: low.mesh.triangles.len(),
        views,
        samples: samples.len(),
        covered_texels: fitted.covered,
        unseen_texels: fitted.unseen,
        overlapping_texels: texels.overlaps,
        missed_texels: start.missed,
        uv,
        losses: fitted.losses.iter().map(Into::into).collect(),
        stages: clock.stages,
        stopped_early: fitted.stopped || views < plan.views || bridge.stopped_a_stage(),
        warnings: warnings.told,
        peak_memory: crate::memory::peak_memory(),
    };
    let (color, normal) =
        (color_image("base color", &start.color, srgb), normal_image("normal", &start.normal));
    Ok(Baked {
        projected: textured(low, &written, color, normal, None),
        model: textured(low, &written, fitted.color, fitted.normal, maps.as_ref()),
        report,
        uv_moves: unfolded.and_then(|u| u.moves),
    })
}

/// The high-poly in the common frame, as cameras see it and as rays touch it.
fn seen_and_touched(high: &Model, frame: &Placement, interpretation: Interpretation) -> (Scene, HighSurface) {
    let mesh = placed(high, frame);
    rayon::join(
        || Scene::new(mesh.clone(), &high.materials, &high.images, interpretation),
        || HighSurface::new(&mesh),
    )
}

/// What the user is told of as it is found, and reads again in the report.
struct Warnings<'a, W> {
    watcher: &'a W,
    told: Vec<String>,
}

impl<W: Watcher> Warnings<'_, W> {
    fn tell(&mut self, found: impl IntoIterator<Item = String>) {
        for warning in found {
            self.watcher.message(Message::Warning(warning.clone()));
            self.told.push(warning);
        }
    }
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
