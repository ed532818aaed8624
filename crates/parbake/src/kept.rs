//! Whether a model that is baked onto itself had better keep its coordinates.
//!
//! Parts of a model may share texels on purpose: mirrored halves, stacked copies, textures that repeat. A
//! layout in which each part has texels of its own then shows less with as many texels. So both models are
//! finished, rendered as `eval` does (small textures at a lower resolution), and the one that was found has to keep up.

use crate::bake::Baked;
use crate::budget::check_budget;
use crate::comparison::compared_as;
use crate::error::BakeError;
use crate::options::{BakeOptions, UvMode};
use parbake_atlas::sharing;
use parbake_evaluate::evaluate::{Detail, evaluate_each};
use parbake_evaluate::options::EvaluateOptions;
use parbake_mesh::material_uvs;
use parbake_model::{Material, Mesh, Model, TextureSlot};
use parbake_progress::{Message, Watcher, WithoutWarnings};
use parbake_uv::surface::{drawn_part, has_textures, with_plain_parts_apart};
use parbake_views::PrepareError;

/// Decibels that coordinates which are sound may cost.
const MOST_LOST: f64 = 0.05;
/// Views that are compared, in two sets of which the worse counts, since one texture may be luckier in one of them.
const VIEWS: [usize; 2] = [8, 12];
/// Pixels of a compared picture for each texel, along a side: finer pictures of a small texture show no more of it.
const PIXELS_PER_TEXEL: usize = 2;

/// Whether coordinates as they were delivered may be written: a layout that the user asked for in so many
/// words, or a gutter, is not weighed against them.
pub(crate) fn may_be_kept(options: &BakeOptions) -> bool {
    options.uv == UvMode::Optimize && options.gutter.is_none()
}

/// Decibels that `found` shows less of a model than `kept` does, where that is more than it may; shaded as the
/// summary of this bake is.
///
/// # Errors
/// A model without extent.
pub(crate) fn lost(
    model: &Model,
    kept: &Model,
    found: &Model,
    bake: &BakeOptions,
) -> Result<Option<f64>, BakeError> {
    let mut lost = f64::NEG_INFINITY;
    let as_summary = compared_as(bake);
    let resolution = as_summary.resolution.min(PIXELS_PER_TEXEL * bake.texture_size);
    for views in VIEWS {
        let options = EvaluateOptions { views, resolution, no_flip: true, ..as_summary.clone() };
        let compared =
            evaluate_each(model, &[kept, found], &options, &[&options.background], Detail::default(), &())?;
        let mean = |which: usize| {
            let psnr = compared.views.iter().map(|view| view.seen[which][0].psnr);
            psnr.sum::<f64>() / views as f64
        };
        lost = lost.max(mean(0) - mean(1));
    }
    Ok((lost > MOST_LOST).then_some(lost))
}

/// What the user is told of it; `apart` is the model in which materials without textures were moved, where they were.
pub(crate) fn sentences(model: &Model, lost: f64, apart: Option<&Model>) -> Vec<String> {
    let but = if apart.is_some() {
        ", but for materials without textures, which got a few texels each"
    } else {
        ""
    };
    let mut sentences = vec![format!(
        "Texture coordinates were kept as they are{but}: the best layout without shared texels shows {lost:.1} dB less. \
         --uv repair or --gutter TEXELS forces such a layout."
    )];
    // What was moved no longer shares texels with anything else.
    let drawn = apart.map_or_else(|| model.mesh.clone(), drawn_part);
    sentences.extend(sharing(&drawn).sentence());
    sentences
}

/// Runs the bake with its own coordinates after the one that is `found`, if that changed them, and returns
/// the one that shows more. Its own coordinates are those of `model`, in which materials without textures have texels of
/// their own where there is room. `bake` bakes the model onto the one that it is given, with other options.
///
/// # Errors
/// As of `bake`.
pub(crate) fn weighed(
    model: &Model,
    options: &BakeOptions,
    watcher: &dyn Watcher,
    bake: impl Fn(&Model, &BakeOptions, &dyn Watcher) -> Result<Baked, BakeError>,
) -> Result<Baked, BakeError> {
    if !may_be_kept(options) || model.mesh.uvs.is_empty() {
        return bake(model, options, watcher);
    }
    let begin = std::time::Instant::now();
    let quiet = WithoutWarnings(watcher);
    // Of a budget the bake with the coordinates as they are needs the smaller part.
    let first = BakeOptions { time_budget: options.time_budget.map(|s| FIRST_SHARE * s), ..options.clone() };
    if check_budget(&first).is_err() {
        return bake(model, options, watcher);
    }
    let mut found = bake(model, &first, &quiet)?;
    found.report.options = options.clone();
    let has_new = |baked: &Baked| {
        let (before, after) = (&model.mesh, &baked.model.mesh);
        before.uvs != after.uvs || before.triangles != after.triangles
    };
    if has_new(&found) && !watcher.stopped() {
        let time_budget = options.time_budget.map(|s| (s - begin.elapsed().as_secs_f64()).max(0.0));
        let own = BakeOptions { uv: UvMode::Keep, time_budget, ..options.clone() };
        let apart = with_plain_parts_apart(model, options.texture_size);
        let low = apart.as_ref().unwrap_or(model);
        // What is left may not be enough for another bake, and one that was stopped is no fair match.
        let kept = match check_budget(&own).is_ok().then(|| bake(low, &own, &quiet)) {
            // All triangles of a palette's colour lie on one point: there is nothing that could be kept.
            Some(Err(BakeError::Prepare(PrepareError::FlatTextureCoordinates { .. }))) => None,
            other => other.transpose()?.filter(|_| !watcher.stopped()),
        };
        let lost = kept.as_ref().map(|kept| lost(model, &kept.model, &found.model, options)).transpose()?;
        if let (Some(mut kept), Some(lost)) = (kept, lost.flatten()) {
            kept.report.options = options.clone();
            let told = sentences(model, lost, apart.as_ref())
                .into_iter()
                .map(|text| format!("{}: {text}", model.name));
            kept.report.warnings.splice(0..0, told);
            found = kept;
        }
    }
    let warnings = found.report.warnings.iter().cloned();
    warnings.for_each(|warning| watcher.message(Message::Warning(warning)));
    Ok(found)
}

/// The bake without tangents where the model has none and kept the coordinates that its normal maps are read by: each viewer then
/// makes up the same ones for both. glTF asks for MikkTSpace's, which turn smoothly; some viewers take those of each triangle.
pub(crate) fn with_own_tangents(model: &Model, mut baked: Baked) -> Baked {
    let own = material_uvs(&model.mesh, &model.materials);
    let is_drawn: Vec<bool> = model.materials.iter().map(has_textures).collect();
    // Coordinates of the bake are those of base colours.
    let reads_alike = |material: &Material| {
        let of = |slot: TextureSlot| (slot.uv_set, slot.transform);
        let color = material.base_color_texture.map(of).unwrap_or_default();
        let coat = material.extensions.clearcoat.and_then(|coat| coat.normal_texture);
        [material.normal_texture, coat].into_iter().flatten().all(|slot| of(slot) == color)
    };
    let is_kept = |of: &Mesh| {
        let mesh = &model.mesh;
        let mut pairs = mesh.triangles.iter().zip(&of.triangles).zip(&mesh.triangle_materials);
        let same = |(a, b): (u32, u32)| own.get(a as usize) == of.uvs.get(b as usize);
        mesh.triangles.len() == of.triangles.len()
            && pairs.all(|((a, b), &m)| !is_drawn[m as usize] || (0..3).all(|k| same((a[k], b[k]))))
    };
    if model.mesh.tangents.is_empty() && model.materials.iter().all(reads_alike) {
        for of in [&mut baked.model, &mut baked.ray_cast] {
            if is_kept(&of.mesh) {
                of.mesh.tangents.clear();
            }
        }
    }
    baked
}

/// Share of a time budget that the first of two bakes has.
const FIRST_SHARE: f64 = 0.6;

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Protects relief in viewers that make up tangents: a model without gets none with its own coordinates, and those that fit with
    /// others; one with tangents gets them.
    #[test]
    fn tangents_come_with_new_coordinates() {
        let (_, low) = crate::demo_pair();
        let normals = Some(TextureSlot::default());
        let drawn = Material { normal_texture: normals, ..Material::default() };
        let model = Model { materials: vec![drawn], ..low };
        let options = BakeOptions {
            uv: UvMode::Keep,
            preset: crate::Preset::Fast,
            texture_size: 16,
            views: Some(4),
            view_size: Some(32),
            rounds: Some(0),
            ..BakeOptions::default()
        };
        let baked = crate::bake::bake_onto_itself(&model, &model, &options, &()).unwrap();
        assert!(!baked.model.mesh.tangents.is_empty());
        let kept = with_own_tangents(&model, baked.clone());
        assert!(kept.model.mesh.tangents.is_empty() && kept.ray_cast.mesh.tangents.is_empty());
        let mut moved = baked.clone();
        moved.model.mesh.uvs[0].x += 0.01;
        assert_eq!(with_own_tangents(&model, moved.clone()).model, moved.model);
        // Tangents of other coordinates would not fit what was baked.
        let mut elsewhere = model.clone();
        elsewhere.materials[0].normal_texture = Some(TextureSlot { uv_set: 1, ..TextureSlot::default() });
        assert_eq!(with_own_tangents(&elsewhere, baked.clone()).model, baked.model);
        let mut with_tangents = model;
        with_tangents.mesh.tangents = vec![parbake_model::glam::Vec4::X; with_tangents.mesh.positions.len()];
        assert_eq!(with_own_tangents(&with_tangents, baked.clone()).model, baked.model);
    }

    /// Protects time budgets that can hold: neither of two bakes is begun with a share that is refused.
    #[test]
    fn no_share_of_a_budget_is_refused() {
        let (_, model) = crate::demo_pair();
        for budget in [1.5, 2.0, 3.0] {
            let options =
                BakeOptions { texture_size: 1024, time_budget: Some(budget), ..BakeOptions::default() };
            // It would fail on any other error as well.
            let unwritable = || BakeError::OutOfView { low: String::new(), high: String::new() };
            let found = weighed(&model, &options, &(), |_, own, _| check_budget(own).and(Err(unwritable())));
            assert!(matches!(found, Err(BakeError::OutOfView { .. })), "{budget}: {:?}", found.err());
        }
    }
}
