//! A model with a smaller texture that looks the same (the paper's same-model mode, Table 7).
//!
//! The surface stays, so nothing has to be seen from anywhere: what the texture shall show is
//! read off the model's own texture all over its surface, texture coordinates are moved for
//! it, and the texture is one least-squares problem, mip levels included. What other parts hide
//! counts for as much as is seen of it.
//!
//! ```text
//! delivered coordinates ────────────────────────── texture ─────────────────────┐
//! repaired, where they are not sound ─┬─────────── texture ─┬ the better one ───┴ the better one ─ Model
//!              more triangles, moved ─┴─────────── texture ─┘                     (kept.rs)
//! ```
//!
//! Contract: what is written shows the surface no worse than coordinates that were only repaired, and not
//! more than a twentieth of a decibel worse than the delivered ones. It is sound, unless coordinates are to be
//! kept, or delivered ones that share texels show more and no other layout was asked for. Texels are compared as they are stored, as when a picture is
//! scaled.

use crate::bake::{Baked, bake_onto_itself, bake_prepared_onto_itself, prepare_high_poly, told_before};
use crate::budget::{check_budget, left_out};
use crate::error::BakeError;
use crate::kept;
use crate::options::{BakeOptions, Convention, Parallax, Shading, UvMode};
use crate::report::{BakeReport, LossStep, layout_warning};
use crate::work::Work;
use parbake_atlas::{check_mesh, in_one_tile};
use parbake_mesh::rigs::carried;
use parbake_mesh::{HighSurface, visibilities};
use parbake_model::glam::DVec2;
use parbake_model::{AlphaMode, Image, Material, Mesh, Model, Placement, TextureSlot, Wrap};
use parbake_progress::{Clock, Message, ProgressScope, Stage, Watcher};
use parbake_render::scene::Scene;
use parbake_uv::surface::{
    RepairedLowPoly, Source, SurfaceSamples, SurfaceTexture, UvStageOptions, UvStageResult, optimise_uvs,
    repair_uvs, with_plain_parts_apart,
};
use parbake_views::PrepareError;
use parbake_views::frame::{common_frame, placed};
use parbake_views::lost::lost;
use std::cell::Cell;
use std::time::Instant;

/// How far dark colours are brightened before coordinates move for them. Viewers of glTF show stored
/// values where light has strength 1; stronger light, and the paper's pictures, make more of dark ones.
/// Halfway between the two is within 0.5 dB of the better one in either.
const BRIGHTENED: f32 = 0.5;

/// Bakes a model onto itself with a smaller texture.
///
/// A model with a normal map, or with more to its materials than colour, is baked as a pair is, since all
/// of its maps must follow the coordinates; so is one whose texture repeats, if its coordinates are to be kept.
///
/// # Errors
/// As of [`crate::bake`].
pub fn compress(model: &Model, options: &BakeOptions, watcher: &dyn Watcher) -> Result<Baked, BakeError> {
    if options.parallax != Parallax::None {
        let (option, range) = ("parallax", "none where a model is compressed: its surface stays".into());
        return Err(BakeError::Option {
            option,
            value: format!("{:?}", options.parallax).to_lowercase(),
            range,
        });
    }
    options.check()?;
    check_budget(options)?;
    let told = left_out(options, Work::Compress, false).into_iter().collect();
    told_before(told, watcher, || compressed(model, options, watcher))
}

/// The same with options that were checked.
fn compressed(model: &Model, options: &BakeOptions, watcher: &dyn Watcher) -> Result<Baked, BakeError> {
    let as_it_is = options.uv_stage_as(UvMode::Keep);
    let delivered = repair_uvs(model, &as_it_is)?;
    if options.uv == UvMode::Keep && delivered.mesh.uvs.is_empty() {
        return Err(PrepareError::NoTextureCoordinates { model: model.name.clone() }.into());
    }
    let slack = 0.5 / options.texture_size as f64;
    let keeps_tiles = options.uv == UvMode::Keep && !is_in_the_square(&delivered.mesh, slack);
    if keeps_tiles || !has_colour_alone(model, options) {
        return whole(model, options, watcher);
    }
    // Where no chart is longer than a tile, coordinates can be read in the square.
    let repeats = !is_in_the_square(&delivered.mesh, slack)
        && !delivered.mesh.uvs.is_empty()
        && in_one_tile(&delivered.mesh, slack).is_none();
    if repeats && kept::may_be_kept(options) {
        let plain = |low: &Model, options: &BakeOptions, watcher: &dyn Watcher| match options.uv {
            UvMode::Keep => bake_onto_itself(model, low, options, watcher),
            _ => plain(model, options, watcher),
        };
        return kept::weighed(model, options, watcher, plain);
    }
    plain(model, options, watcher)
}

/// Whether a model's materials have colour and nothing else that is fitted with these options. Its texture is then
/// solved for on its surface, without views.
pub fn has_colour_alone(model: &Model, options: &BakeOptions) -> bool {
    let is_whole = options.shading != Shading::Lambert && options.convention == Convention::Gltf;
    let is_plain = |m: &Material| m.normal_texture.is_none() && !(is_whole && has_more_than_colour(m));
    model.materials.iter().all(is_plain)
}

/// Bakes a model with all its maps onto itself.
fn whole(model: &Model, options: &BakeOptions, watcher: &dyn Watcher) -> Result<Baked, BakeError> {
    let begin = Cell::new(Some(Instant::now()));
    let prepared = prepare_high_poly(model, options)?;
    let baked = kept::weighed(model, options, watcher, |low, options, watcher| {
        // The first bake's time began before the model was prepared.
        let begin = begin.take().unwrap_or_else(Instant::now);
        bake_prepared_onto_itself(&prepared, low, options, watcher, begin)
    })?;
    Ok(kept::with_own_tangents(model, baked))
}

/// Solves for the texture of a model whose materials have colour alone.
fn plain(model: &Model, options: &BakeOptions, watcher: &dyn Watcher) -> Result<Baked, BakeError> {
    let as_it_is = options.uv_stage_as(UvMode::Keep);
    let delivered = repair_uvs(model, &as_it_is)?;
    let slack = 0.5 / options.texture_size as f64;
    let begin = Instant::now();
    let watcher = &ProgressScope::new(watcher, begin, options.time_budget);
    // Coordinates are all that takes long; a texture is solved for those before and after.
    watcher.message(Message::Plan(vec![(Stage::Uv, 4.0), (Stage::Evaluate, 1.0)]));
    let mut clock = Clock::new(begin);
    let frame = common_frame(model)?;
    let surface = placed(model, &frame);
    // Colours are read as they are stored.
    let interpretation = Convention::Paper.interpretation();
    let scene = Scene::new(surface.clone(), &model.materials, &model.images, interpretation);
    let visibilities = visibilities(&surface, &HighSurface::new(&surface));
    let stored = Source {
        scene: &scene,
        surface: None,
        importances: &visibilities,
        max_distance: 0.0,
        brightened: 0.0,
        normals: false,
        pixel: sample_width(&surface, options.texture_size),
    };
    let signal = SurfaceSamples::new(&surface, &stored, options.texture_size)
        .ok_or_else(|| PrepareError::FlatTextureCoordinates { model: model.name.clone() })?;
    let own = OwnSurface { model, frame: &frame, stored, signal, options };
    clock.lap(Stage::Prepare);

    let kept_as_it_is = |kept: RepairedLowPoly| {
        in_the_square(kept, slack).map(|kept| own.textured(own.unmoved(kept, &as_it_is, watcher)))
    };
    let delivered = kept_as_it_is(delivered);
    clock.lap(Stage::Solve);
    let asked = options.uv_stage_for(Work::Compress);
    let repaired = repair_uvs(model, &asked)?;
    let unmoved = own.unmoved(repaired.clone(), &asked, watcher);
    let shown = Source { brightened: BRIGHTENED, ..stored };
    let moved = optimise_uvs(repaired, &frame, &shown, &asked, watcher);
    clock.lap(Stage::Uv);
    let begun = match &delivered {
        Some(same) if same.low.model.mesh.uvs == unmoved.model.mesh.uvs => {
            Solved { low: unmoved, solved: same.solved.clone() }
        }
        _ => own.textured(unmoved),
    };
    let mut written = begun.clone();
    if moved.moves.is_some() {
        let moved = own.textured(moved);
        // The judges of its moves had fewer samples.
        if !moved.is_worse(&begun) {
            written = moved;
        }
    }
    let apart =
        kept::may_be_kept(options).then(|| with_plain_parts_apart(model, options.texture_size)).flatten();
    let moved_apart = match &apart {
        Some(apart) => kept_as_it_is(repair_uvs(apart, &as_it_is)?),
        None => None,
    };
    if let Some(kept) = moved_apart.as_ref().or(delivered.as_ref())
        && kept::may_be_kept(options)
        && kept.low.model.mesh.uvs != written.low.model.mesh.uvs
        && !watcher.stopped()
    {
        let finished = |of: &Solved| own.finished(of.low.model.clone(), &of.solved);
        if let Some(lost) = kept::lost(model, &finished(kept), &finished(&written), options)? {
            written = kept.clone();
            written.low.report.repaired.extend(kept::sentences(model, lost, apart.as_ref()));
        }
    }
    clock.lap(Stage::Solve);

    let (kind, baseline) = delivered.as_ref().map_or(("repaired", &begun), |solved| ("delivered", solved));
    let losses = vec![loss(kind, &baseline.solved), loss("color", &written.solved)];
    let mut report = own.report(baseline, &written, watcher);
    (report.losses, report.stages) = (losses, clock.stages);
    let finished = |of: Model, solved: &SurfaceTexture| {
        let made = own.finished(of, solved);
        Model { rig: carried(model, &made.mesh), ..made }
    };
    Ok(Baked {
        ray_cast: finished(baseline.low.model.clone(), &baseline.solved),
        model: finished(written.low.model, &written.solved),
        report,
        uv_moves: written.low.moves,
    })
}

/// Whether a material has maps or factors that a texture of colours alone would lose.
fn has_more_than_colour(material: &Material) -> bool {
    let is_shiny = (material.metallic, material.roughness) != (0.0, 1.0);
    let is_lit_otherwise = material.occlusion_texture.is_some() || material.emissive != [0.0; 3];
    let has_extensions = material.extensions.show();
    is_shiny
        || is_lit_otherwise
        || has_extensions
        || material.unlit
        || material.alpha_mode != AlphaMode::Opaque
}

/// Width of a sample in the common frame: that of views, or of a texel where those are finer, for who
/// keeps so many will come nearer. Texels of more than 2048² have no sample each.
fn sample_width(surface: &Mesh, texture_size: usize) -> f64 {
    Source::SAMPLE.min(surface.area().sqrt() / texture_size.min(2048) as f64)
}

/// Whether all coordinates lie in the square, give or take `slack`.
fn is_in_the_square(mesh: &Mesh, slack: f64) -> bool {
    let is_inside = |uv: DVec2| uv.min_element() >= -slack && uv.max_element() <= 1.0 + slack;
    !mesh.uvs.is_empty() && mesh.uvs.iter().all(|uv| is_inside(uv.as_dvec2()))
}

/// Delivered coordinates as a texture that does not repeat can be read with them: charts in other tiles
/// are moved back into the square. None where one reaches across a tile's border by more than `slack`.
fn in_the_square(mut delivered: RepairedLowPoly, slack: f64) -> Option<RepairedLowPoly> {
    if !is_in_the_square(&delivered.mesh, slack) {
        delivered.mesh.uvs = in_one_tile(&delivered.mesh, slack)?;
    }
    Some(delivered)
}

/// The surface that a model is compressed for: its own.
struct OwnSurface<'a> {
    model: &'a Model,
    frame: &'a Placement,
    /// Its colours as they are stored.
    stored: Source<'a>,
    /// What its texture is solved for.
    signal: SurfaceSamples,
    options: &'a BakeOptions,
}

/// Coordinates and the texture that was solved for them.
#[derive(Clone)]
struct Solved {
    low: UvStageResult,
    solved: SurfaceTexture,
}

impl Solved {
    /// Whether it shows the surface worse at full size or half.
    fn is_worse(&self, than: &Self) -> bool {
        self.solved.errors.iter().zip(&than.solved.errors).any(|(own, other)| own > other)
    }
}

impl OwnSurface<'_> {
    /// Coordinates as they are.
    fn unmoved(
        &self,
        repaired: RepairedLowPoly,
        options: &UvStageOptions,
        watcher: &dyn Watcher,
    ) -> UvStageResult {
        optimise_uvs(repaired, self.frame, &self.stored, &UvStageOptions { steps: 0, ..*options }, watcher)
    }

    fn textured(&self, low: UvStageResult) -> Solved {
        let solved = self.signal.least_squares_texture(&low);
        Solved { low, solved }
    }

    /// A model with its one texture; it shows backs where any of the original's materials does.
    fn finished(&self, mut model: Model, solved: &SurfaceTexture) -> Model {
        let size = solved.texture.width;
        let texel = |t: &parbake_model::glam::Vec4| {
            let [r, g, b, _] = t.to_array().map(|x| (x * 255.0).round() as u8);
            [r, g, b, 255]
        };
        let pixels = solved.texture.texels.iter().map(texel).collect();
        model.mesh.colors.clear();
        model.mesh.uvs1.clear();
        model.mesh.parallax_offsets.clear();
        let slot = TextureSlot { image: 0, wrap: [Wrap::Clamp; 2], ..TextureSlot::default() };
        let shows_backs = |&material: &u32| self.model.materials[material as usize].double_sided;
        model.materials = vec![Material {
            name: model.name.clone(),
            base_color_texture: Some(slot),
            double_sided: self.model.mesh.triangle_materials.iter().any(shows_backs),
            ..Material::default()
        }];
        model.images = vec![Image { name: "base color".into(), width: size, height: size, pixels }];
        model
    }

    /// What was done, and said to the user where he should know; losses and stages are left to be told.
    fn report(&self, baseline: &Solved, written: &Solved, watcher: &ProgressScope) -> BakeReport {
        let name = &self.model.name;
        let uv = check_mesh(&written.low.model.mesh, self.options.texture_size);
        let repaired = written.low.report.repaired.iter().map(|done| format!("{name}: {done}"));
        // A texture of colours alone has no extensions.
        let lost = lost(&self.model.materials).into_iter().map(|text| format!("{name}: {text}"));
        let warnings: Vec<String> = repaired.chain(layout_warning(name, &uv)).chain(lost).collect();
        warnings.iter().for_each(|warning| watcher.message(Message::Warning(warning.clone())));
        let mut uv_stage = written.low.report.clone();
        let errors = written.solved.errors.iter().zip(&baseline.solved.errors);
        uv_stage.relative_error = errors.map(|(a, b)| a / b.max(1e-12)).collect();
        BakeReport {
            work: Work::Compress,
            shape: None,
            growth: None,
            parallax_maps: None,
            fallback: None,
            uv_stage: (self.options.uv != UvMode::Keep).then_some(uv_stage),
            options: self.options.clone(),
            high_triangles: self.model.mesh.triangles.len(),
            low_triangles: written.low.model.mesh.triangles.len(),
            views: 0,
            samples: written.solved.samples,
            covered_texels: 0,
            unseen_texels: 0,
            overlapping_texels: 0,
            missed_texels: 0,
            uv,
            comparison: None,
            losses: Vec::new(),
            stages: Vec::new(),
            stopped_early: watcher.stopped_a_stage(),
            warnings,
            written: None,
            peak_memory: crate::memory::peak_memory(),
        }
    }
}

fn loss(moved: &str, solved: &SurfaceTexture) -> LossStep {
    LossStep { moved: moved.into(), seconds: 0.0, mean_square: solved.errors[0] }
}

#[cfg(test)]
#[path = "compress_tests.rs"]
mod tests;
