//! A model with a smaller texture that looks the same (the paper's same-model mode, Table 7).
//!
//! The surface stays, so nothing has to be seen from anywhere: what the texture shall show is
//! read off the model's own texture all over its surface, texture coordinates are moved for
//! it, and the texture is one least-squares problem, mip levels included.
//!
//! Texels are compared as they are stored, as when a picture is scaled. So are the colours that
//! coordinates are moved for, which is about what viewers of glTF show; in the paper's pictures
//! stored values are light, and its curve makes far more of dark colours: by that convention
//! they are compared as shown.

use crate::bake::{Baked, bake_pair};
use crate::bridge::Bridge;
use crate::error::BakeError;
use crate::message::{Message, Stage, Watcher};
use crate::options::{BakeOptions, Convention, Method, Parallax, UvMode};
use crate::pair::{common_frame, placed};
use crate::report::{BakeReport, LossStep, StageTime, Work};
use crate::unfold::{Source, SurfaceTexture, UnfoldOptions, Unfolded, mend, solve_on_surface, unfold};
use parbake_model::{Image, Material, Model, TextureSlot, Wrap};
use parbake_render::scene::Scene;
use std::time::Instant;

/// Here texture coordinates are all that takes time, and may take more steps than in a bake.
const STEPS_FACTOR: usize = 8;

/// Bakes a model onto itself with a smaller texture.
///
/// A model with a normal map is baked as a pair is, since its normal map must follow the
/// coordinates.
///
/// # Errors
/// As of [`crate::bake`].
pub fn compress(model: &Model, options: &BakeOptions, watcher: &impl Watcher) -> Result<Baked, BakeError> {
    if options.parallax != Parallax::None {
        let (option, range) = ("parallax", "none where a model is compressed: its surface stays".into());
        return Err(BakeError::Option { option, value: "sh".into(), range });
    }
    if model.materials.iter().any(|m| m.normal_texture.is_some()) {
        return bake_pair(model, model, true, options, watcher);
    }
    options.check()?;
    let begin = Instant::now();
    let watcher = &Bridge::new(watcher, begin, options.time_budget);
    let frame = common_frame(model)?;
    // Colours are read as they are stored.
    let interpretation = Convention::Paper.interpretation();
    let scene = Scene::new(placed(model, &frame), &model.materials, &model.images, interpretation);
    let stored = Source { scene: &scene, surface: None, reach: 0.0, encode: false, pixel: Source::SAMPLE };
    let shown = Source { encode: options.convention == Convention::Paper, ..stored };
    let mut stages = Vec::new();
    let mut lap = |stage, since: &mut Instant| {
        stages.push(StageTime { stage, seconds: since.elapsed().as_secs_f64() });
        *since = Instant::now();
    };
    let mut since = begin;
    lap(Stage::Prepare, &mut since);
    let solved = |low: &Model| {
        let mut mesh = low.mesh.clone();
        frame.apply(&mut mesh);
        solve_on_surface(&mesh, &stored, options.texture_size)
            .ok_or_else(|| BakeError::FlatTextureCoordinates { model: model.name.clone() })
    };
    let as_it_is = options.unfold_as(UvMode::Keep);
    let kept = unfold(mend(model, &as_it_is)?, &frame, &shown, &as_it_is, watcher);
    if kept.model.mesh.uvs.is_empty() {
        return Err(BakeError::NoTextureCoordinates { model: model.name.clone() });
    }
    let ordinary = solved(&kept.model)?;
    lap(Stage::Solve, &mut since);
    let asked = options.unfold();
    let factor = if options.method == Method::Fit { STEPS_FACTOR } else { 1 };
    let steps = options.uv_steps.unwrap_or(factor * asked.steps);
    let asked = UnfoldOptions { steps, ..asked };
    let mut unfolded = unfold(mend(model, &asked)?, &frame, &shown, &asked, watcher);
    lap(Stage::Unfold, &mut since);
    let mut written = solved(&unfolded.model)?;
    if asked.mode == UvMode::Optimize && written.errors[0] > ordinary.errors[0] {
        // Fewer samples had said otherwise.
        unfolded = Unfolded { model: kept.model.clone(), moves: None, ..unfolded };
        unfolded.report.utilisation[1] = unfolded.report.utilisation[0];
        written = ordinary.clone();
    }
    lap(Stage::Solve, &mut since);
    let mut warnings = Vec::new();
    for done in &unfolded.report.mended {
        let warning = format!("{}: {done}", model.name);
        watcher.message(Message::Warning(warning.clone()));
        warnings.push(warning);
    }
    unfolded.report.relative_error =
        written.errors.iter().zip(&ordinary.errors).map(|(a, b)| a / b.max(1e-12)).collect();
    let loss = |moved: &str, solved: &SurfaceTexture| LossStep {
        moved: moved.into(),
        seconds: 0.0,
        mean_square: solved.errors[0],
    };
    let report = BakeReport {
        work: Work::Compress,
        shape: None,
        depth: None,
        unfold: Some(unfolded.report.clone()),
        options: options.clone(),
        high_triangles: model.mesh.triangles.len(),
        low_triangles: model.mesh.triangles.len(),
        views: 0,
        samples: written.samples,
        covered_texels: 0,
        unseen_texels: 0,
        overlapping_texels: 0,
        missed_texels: 0,
        uv: crate::check::check_mesh(&unfolded.model.mesh, options.texture_size),
        losses: vec![loss("start", &ordinary), loss("color", &written)],
        stages,
        stopped_early: watcher.stopped_a_stage(),
        warnings,
        peak_memory: crate::memory::peak_memory(),
    };
    Ok(Baked {
        model: textured(unfolded.model, &written),
        projected: textured(kept.model, &ordinary),
        report,
        uv_moves: unfolded.moves,
    })
}

/// The model with its one texture.
fn textured(mut model: Model, solved: &SurfaceTexture) -> Model {
    let size = solved.texture.size;
    let texel = |t: &parbake_model::glam::Vec4| {
        let [r, g, b, _] = t.to_array().map(|x| (x * 255.0).round() as u8);
        [r, g, b, 255]
    };
    let pixels = solved.texture.texels.iter().map(texel).collect();
    model.mesh.colors.clear();
    model.mesh.uvs1.clear();
    let slot = TextureSlot { image: 0, wrap: [Wrap::Clamp; 2], ..TextureSlot::default() };
    model.materials =
        vec![Material { name: model.name.clone(), base_color_texture: Some(slot), ..Material::default() }];
    model.images = vec![Image { name: "base color".into(), width: size, height: size, pixels }];
    model
}
