//! A model with a smaller texture that looks the same (the paper's same-model mode, Table 7).
//!
//! The surface stays, so nothing has to be seen from anywhere: what the texture shall show is
//! read off the model's own texture all over its surface, texture coordinates are moved for
//! it, and the texture is one least-squares problem, mip levels included. What other parts hide
//! counts for as much as is seen of it.
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
use parbake_mesh::{HighSurface, exposures};
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
    let surface = placed(model, &frame);
    let exposures = exposures(&surface, &HighSurface::new(&surface));
    let stored = Source {
        scene: &scene,
        surface: None,
        exposures: &exposures,
        reach: 0.0,
        encode: false,
        pixel: Source::SAMPLE,
    };
    let shown = Source { encode: options.convention == Convention::Paper, ..stored };
    let mut stages = Vec::new();
    let mut lap = |stage, since: &mut Instant| {
        stages.push(StageTime { stage, seconds: since.elapsed().as_secs_f64() });
        *since = Instant::now();
    };
    let mut since = begin;
    lap(Stage::Prepare, &mut since);
    let solved = |low: &Unfolded| {
        solve_on_surface(&surface, low, &stored, options.texture_size)
            .ok_or_else(|| BakeError::FlatTextureCoordinates { model: model.name.clone() })
    };
    let as_it_is = options.unfold_as(UvMode::Keep);
    let kept = unfold(mend(model, &as_it_is)?, &frame, &shown, &as_it_is, watcher);
    if kept.model.mesh.uvs.is_empty() {
        return Err(BakeError::NoTextureCoordinates { model: model.name.clone() });
    }
    let ordinary = solved(&kept)?;
    lap(Stage::Solve, &mut since);
    let asked = options.unfold();
    let factor = if options.method == Method::Fit { STEPS_FACTOR } else { 1 };
    let steps = options.uv_steps.unwrap_or(factor * asked.steps);
    let asked = UnfoldOptions { steps, ..asked };
    let mended = mend(model, &asked)?;
    let unmoved = unfold(mended.clone(), &frame, &shown, &UnfoldOptions { steps: 0, ..asked }, watcher);
    let mut unfolded = unfold(mended, &frame, &shown, &asked, watcher);
    lap(Stage::Unfold, &mut since);
    let solved_anew = |low: &Unfolded| {
        if low.model.mesh.uvs == kept.model.mesh.uvs { Ok(ordinary.clone()) } else { solved(low) }
    };
    let mut written = solved_anew(&unfolded)?;
    if unfolded.moves.is_some() {
        let begun = solved_anew(&unmoved)?;
        if written.errors.iter().zip(&begun.errors).any(|(now, before)| now > before) {
            // Fewer samples had said otherwise.
            (unfolded, written) = (unmoved, begun);
        }
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
        low_triangles: unfolded.model.mesh.triangles.len(),
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

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::Mesh;
    use parbake_model::glam::{Vec3, vec2};

    /// A box's six sides in a row of the texture from `top` on, a square each.
    fn add_box(mesh: &mut Mesh, half: f32, top: f32) {
        for side in 0..6u32 {
            let (axis, sign) = (side as usize % 3, if side < 3 { 1.0f32 } else { -1.0 });
            let first = mesh.positions.len() as u32;
            for (x, y) in [(0.0f32, 0.0f32), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                let mut p = [0.0; 3];
                p[axis] = sign * half;
                p[(axis + 1) % 3] = sign * (2.0 * x - 1.0) * half;
                p[(axis + 2) % 3] = (1.0 - 2.0 * y) * half;
                mesh.positions.push(Vec3::from(p));
                mesh.uvs.push(vec2((side as f32 + 0.1 + 0.8 * x) / 6.0, top + 0.02 + 0.13 * y));
            }
            mesh.triangles.extend([[first, first + 3, first + 1], [first + 1, first + 3, first + 2]]);
        }
        mesh.triangle_materials.resize(mesh.triangles.len(), 0);
    }

    /// A texture of noise on a mesh.
    fn noisy(mesh: Mesh) -> Model {
        let size = 192usize;
        let noise =
            |i: usize| (i as u32).wrapping_mul(2_654_435_761).rotate_left(13).wrapping_mul(40_503) >> 24;
        let pixels = (0..size * size).map(|i| [noise(i) as u8, noise(i + 7) as u8, 128, 255]).collect();
        let slot = TextureSlot { image: 0, wrap: [Wrap::Clamp; 2], ..TextureSlot::default() };
        Model {
            name: "boxes".into(),
            mesh,
            materials: vec![Material { base_color_texture: Some(slot), ..Material::default() }],
            images: vec![Image { name: "noise".into(), width: size, height: size, pixels }],
        }
    }

    /// Protects texels of what is seen: a box within another, which nobody sees, gives most of its
    /// texels to the outer one, though its picture is as detailed.
    #[test]
    fn what_is_hidden_gets_few_texels() {
        let mut mesh = Mesh::default();
        add_box(&mut mesh, 1.0, 0.1);
        add_box(&mut mesh, 0.9, 0.6);
        let model = noisy(mesh);
        let options = BakeOptions { texture_size: 64, ..BakeOptions::default() };
        let baked = compress(&model, &options, &()).expect("boxes can be compressed");
        let mesh = &baked.model.mesh;
        let area = |of: fn(Vec3) -> bool| -> f32 {
            let doubled = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|i| mesh.uvs[i as usize]);
                (b - a).perp_dot(c - a).abs()
            };
            let is_of = |t: &&[u32; 3]| t.iter().all(|&i| of(mesh.positions[i as usize]));
            mesh.triangles.iter().filter(is_of).map(doubled).sum()
        };
        let inner = area(|p| p.abs().max_element() < 0.95);
        let outer = area(|p| p.abs().max_element() > 0.95);
        assert!(inner > 0.0 && inner < 0.5 * outer, "{inner} of {outer}");
        assert!(baked.report.uv.is_bijective());
    }

    /// Protects soundness: boxes that share their texels have more of them each, and are given their
    /// own all the same.
    #[test]
    fn what_overlaps_is_not_written_back() {
        let mut mesh = Mesh::default();
        for i in 0..24 {
            let first = mesh.positions.len();
            add_box(&mut mesh, 1.0, 0.1);
            mesh.positions[first..].iter_mut().for_each(|p| p.x += 3.0 * i as f32);
        }
        let options = BakeOptions { texture_size: 128, ..BakeOptions::default() };
        let baked = compress(&noisy(mesh), &options, &()).expect("boxes can be compressed");
        let [before, after] = [0, 1].map(|i| baked.report.losses[i].mean_square);
        assert!(after > before, "{after} of {before}");
        assert!(baked.report.uv.is_bijective());
    }
}
