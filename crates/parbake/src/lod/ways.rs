//! Which way a level is made: several are finished, and the one whose pictures show most of the model is taken.
//!
//! ```text
//! its own maps (own_vertices.rs) ────── excellent? taken; else ─┐
//! triangles chosen by pictures, new layout ─────────────────────┼─ the best ─ a bake whose maps show? again with finer ones
//! its own layout, baked (delivered.rs) ─────────────────────────┘
//! ```
//!
//! All are rendered with 2 × 2 samples a pixel, each shaded, so that vertices which stay in place lose
//! nothing at edges, where a shift by a twentieth of a pixel already flips samples. Whole materials are rougher where vertex
//! normals turn (`render/turning_normals.rs`). A level takes over at up to 1.7 times the size that it is made for, and is
//! looked at close up, so maps may be worth two or four times as many texels along a side.
//!
//! Contract: deterministic without a budget. A budget is for one bake; a watcher that says stop is heeded between pictures.

use super::candidate::{Candidate, Way};
use super::chain::Chain;
use super::delivered::{Coarser, baked_draft};
use super::maker::{Draft, Maker};
use super::own_vertices::OwnVertices;
use super::picture_score::{PictureScore, Tried};
use crate::error::BakeError;
use parbake_levels::maps::{Reduction, level_maps, with_reductions};
use parbake_levels::screen::texels_of;
use parbake_model::Model;
use std::time::Instant;

/// Decibels from which on nobody would see what other ways gain.
const EXCELLENT: f64 = 50.0;
/// Decibels by which another way has to be better than a new layout, and a bake than scaled maps.
pub(crate) const WORTHWHILE: f64 = 0.3;
/// Pixels from which on a level is large. At 300 pixels a new layout was 1.2 dB or more below scaled maps on all of twelve models, and at
/// 100 above on some.
const LARGE: f64 = 150.0;
/// Decibels of scaled maps from which on no new layout of a large level is tried.
const CLOSE: f64 = 42.0;
/// Decibels by which a new layout is far below scaled maps.
const FAR_BELOW: f64 = 3.0;
/// Decibels that a bake has to lose by halving its maps for finer ones to be tried, and those that finer ones have to gain; at the
/// level's sizes or close up.
const SHOWN_BY_MAPS: f64 = 1.0;
const GAINED_BY_MAPS: f64 = 0.5;
/// Decibels below which, where that is what finer maps gained, twice as many texels would hardly gain anything.
const HARDLY_MORE: f64 = 1.0;
/// How often a bake may get maps of twice the texels along a side.
const MOST_REFINEMENTS: usize = 2;

/// The level as that way makes it which shows most of the model. Ways are left out that hardly ever win: a new layout
/// where scaled maps are excellent, or close in a large level; the delivered layout where its own vertices show less, even with maps of
/// nearly all texels, or where it would have too few texels. `own` is what the level may keep of the model, `before` the low-poly of the
/// level before. None where the watcher said stop before there was a level.
pub(crate) fn draft(
    maker: &Maker,
    chain: &mut Chain,
    level: usize,
    before: Option<&Model>,
    triangles: usize,
    own: Option<OwnVertices>,
    until: Option<Instant>,
) -> Result<Option<Draft>, BakeError> {
    // Nothing to compare.
    let Some(own) = own else { return maker.draft(chain, (level, 0), before, (triangles, None), until) };
    let begin = Instant::now();
    let OwnVertices { score, coarser: own, scaled, is_cut, seconds: tried, .. } = own;
    let side = maker.texels_along(maker.model, maker.options.screen_size[level]);
    let finished = |chain: &Chain, mut draft: Draft, candidates: Vec<Candidate>| {
        draft.candidates = candidates;
        draft.seconds[2] = tried + begin.elapsed().as_secs_f64() - draft.seconds[0] - draft.seconds[1];
        draft.baked.report.stopped_early |= is_cut || chain.stopped();
        Ok(Some(draft))
    };
    let is_enough = |chain: &Chain, scaled: &Tried| scaled.1.psnr >= EXCELLENT || chain.stopped();
    let scaled = match scaled {
        Some(scaled) if is_enough(chain, &scaled) => return finished(chain, scaled.0, vec![scaled.1]),
        other => other,
    };
    let new = new_layout(maker, chain, level, before, triangles, scaled.as_ref(), until)?;
    let (mut best, mut candidates) = match (new, scaled) {
        // A bake that was cut short shows less than a level that is finished.
        (_, Some(scaled)) if chain.stopped() => return finished(chain, scaled.0, vec![scaled.1]),
        (Some(new), _) if chain.stopped() => return finished(chain, new, Vec::new()),
        (Some(new), scaled) => {
            let mut best = score.tried(new)?;
            let mut candidates = vec![best.1];
            if let Some(scaled) = scaled {
                weigh(&mut best, scaled, WORTHWHILE, &mut candidates);
            }
            (best, candidates)
        }
        (None, Some(scaled)) => {
            let candidates = vec![scaled.1];
            (scaled, candidates)
        }
        (None, None) => return Ok(None),
    };
    // A budget is for one bake.
    let may_bake =
        |chain: &Chain, best: &Tried| until.is_none() && best.1.psnr < EXCELLENT && !chain.stopped();
    let is_promising = |own: &&Coarser| best.1.way == Way::Scaled || own.psnr > best.1.psnr + WORTHWHILE;
    let is_beside_scaled = best.1.way == Way::Scaled;
    let size = is_beside_scaled.then(|| within_half(maker, side));
    if let Some(own) = own.as_ref().filter(is_promising)
        && !size.is_some_and(|size| {
            has_too_few_texels(size, best.1.psnr, texels_of(&best.0.baked.model), &candidates)
        })
        && may_bake(chain, &best)
    {
        let baked = baked_draft(maker, chain, level, own, size)?;
        let fits = !is_beside_scaled || 2 * texels_of(&baked.baked.model) <= texels_of(maker.model);
        if fits && !chain.stopped() {
            weigh(&mut best, score.tried(baked)?, WORTHWHILE, &mut candidates);
        }
    }
    for _ in 0..MOST_REFINEMENTS {
        if !may_bake(chain, &best) {
            break;
        }
        let Some(refined) = refined(maker, chain, &score, level, &best, own.as_ref())? else { break };
        if chain.stopped() {
            break;
        }
        let refined = score.tried(refined)?;
        candidates.push(refined.1);
        let gained = refined.1.shown().above(&best.1.shown());
        if gained < GAINED_BY_MAPS || refined.1.psnr < best.1.psnr - WORTHWHILE {
            break;
        }
        best = refined;
        if gained < HARDLY_MORE {
            break;
        }
    }
    finished(chain, best.0, candidates)
}

/// A new layout, where one may win: not beside scaled maps of a large level that are close. None also where the watcher said stop before
/// its triangles were chosen.
fn new_layout(
    maker: &Maker,
    chain: &mut Chain,
    level: usize,
    before: Option<&Model>,
    triangles: usize,
    scaled: Option<&Tried>,
    until: Option<Instant>,
) -> Result<Option<Draft>, BakeError> {
    let is_large = maker.options.screen_size[level] >= LARGE;
    if scaled.is_some_and(|(_, scaled)| is_large && scaled.psnr >= CLOSE) {
        return Ok(None);
    }
    maker.draft(chain, (level, 0), before, (triangles, None), until)
}

/// Whether a bake with so many texels along a side has too few to show as much as scaled maps with sixteen times as many: a new layout
/// with no fewer shows far less.
fn has_too_few_texels(size: usize, psnr: f64, scaled_texels: usize, candidates: &[Candidate]) -> bool {
    let is_far_below =
        |own: &Candidate| own.way == Way::New && own.texture_size >= size && own.psnr + FAR_BELOW < psnr;
    // Two maps are the fewest that a bake has.
    16 * 2 * size * size <= scaled_texels && candidates.iter().any(is_far_below)
}

/// Texels along a side of a bake of the delivered layout of which two maps, the fewest that it has, would have at most half of the
/// model's texels; 32 or more.
fn within_half(maker: &Maker, side: f64) -> usize {
    let usual = maker.power_of_two(side);
    let fits = |&size: &usize| 4 * size * size <= texels_of(maker.model);
    std::iter::successors(Some(usual), |size| Some(size / 2).filter(|size| *size >= 32))
        .find(fits)
        .unwrap_or(usual)
}

/// Takes the other one where it shows more by at least so many decibels.
fn weigh(best: &mut Tried, other: Tried, least: f64, candidates: &mut Vec<Candidate>) {
    candidates.push(other.1);
    if other.1.psnr >= best.1.psnr + least {
        *best = other;
    }
}

/// The same bake with twice the texels along a side, where its maps show, at this size or close up, and all of them still have at most
/// half of the model's texels.
fn refined(
    maker: &Maker,
    chain: &mut Chain,
    score: &PictureScore,
    level: usize,
    (draft, candidate): &Tried,
    own: Option<&Coarser>,
) -> Result<Option<Draft>, BakeError> {
    let size = 2 * draft.baked.report.options.texture_size;
    let baked = &draft.baked.model;
    let may_grow = size <= maker.options.max_texture_size && 8 * texels_of(baked) <= texels_of(maker.model);
    if baked.images.is_empty() || !may_grow {
        return Ok(None);
    }
    let shows = |score: &PictureScore| -> Result<bool, BakeError> {
        let maps = level_maps(baked);
        let halved: Vec<Reduction> = maps.iter().map(|_| Reduction::Halved([1; 2])).collect();
        let with_fewer = score.shown(&with_reductions(baked, &maps, &halved))?;
        Ok(candidate.shown().above(&with_fewer) >= SHOWN_BY_MAPS)
    };
    match (draft.way, own) {
        (Way::New, _) if shows(score)? => maker.baked_again(chain, level, draft, size).map(Some),
        (Way::Delivered, Some(own)) if shows(score)? => {
            baked_draft(maker, chain, level, own, Some(size)).map(Some)
        }
        _ => Ok(None),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::options::LodOptions;
    use super::super::{LevelReport, make_levels};
    use super::*;
    use parbake_model::glam::{Vec3, vec2};
    use parbake_model::{Image, Material, Mesh, TextureSlot, UvTransform};

    fn level(model: &Model, options: &LodOptions) -> LevelReport {
        let mut reports = Vec::new();
        make_levels::<BakeError>(model, options, &(), |level| {
            reports.push(level.report);
            Ok(())
        })
        .unwrap();
        reports.remove(0)
    }

    /// A square of many triangles with a chequered texture of so many fields along a side, in two materials that read it in
    /// two ways, so that its maps cannot be scaled.
    fn chequered(fields: usize) -> Model {
        let (cells, side, mut mesh) = (4u32, 512, Mesh::default());
        for (row, column) in (0..=cells).flat_map(|row| (0..=cells).map(move |column| (row, column))) {
            let (x, y) = (column as f32 / cells as f32, row as f32 / cells as f32);
            mesh.positions.push(Vec3::new(2.0 * x, 2.0 * y, 0.02 * (9.0 * x).sin()));
            mesh.uvs.push(vec2(x, y));
        }
        for (row, column) in (0..cells).flat_map(|row| (0..cells).map(move |column| (row, column))) {
            let a = row * (cells + 1) + column;
            mesh.triangles.extend([[a, a + 1, a + cells + 2], [a, a + cells + 2, a + cells + 1]]);
        }
        mesh.triangle_materials = (0..mesh.triangles.len() as u32).map(|t| t / cells / cells).collect();
        let field = |i: usize| (i % side * fields / side + i / side * fields / side).is_multiple_of(2);
        let color = |i| if field(i) { [230, 220, 200, 255] } else { [20, 40, 90, 255] };
        let pixels = (0..side * side).map(color).collect();
        let images = vec![Image { name: "fields".into(), width: side, height: side, pixels }];
        let slot = TextureSlot { image: 0, ..TextureSlot::default() };
        let transform = UvTransform { rotation: 1.0, ..UvTransform::default() };
        let material = Material {
            base_color_texture: Some(slot),
            occlusion_texture: Some(TextureSlot { transform, ..slot }),
            occlusion_strength: 0.0,
            double_sided: true,
            ..Material::default()
        };
        let materials = vec![material.clone(), material];
        Model { name: "fields".into(), mesh, materials, images, ..Model::default() }
    }

    /// Protects time, and bakes that may win: only one of far fewer texels than scaled maps is left out, if a new layout with as many is
    /// far below.
    #[test]
    fn bakes_of_too_few_texels_are_left_out() {
        let new = |texture_size, psnr| {
            [Candidate { way: Way::New, triangles: 9, texture_size, psnr, close_up: None }]
        };
        let is_left_out = |size, new: [Candidate; 1]| has_too_few_texels(size, 40.0, 3 * 512 * 512, &new);
        assert!(is_left_out(128, new(128, 36.0)));
        assert!(!is_left_out(128, new(128, 38.0)), "a bake of its layout may be above");
        assert!(!is_left_out(256, new(256, 36.0)), "it may have more texels");
        assert!(!is_left_out(128, new(64, 36.0)), "a new layout with fewer texels says little");
    }

    /// Protects small print: a level has twice the texels along a side where these show, and once more twice as many.
    #[test]
    fn maps_are_finer_where_that_shows() {
        let options = LodOptions { screen_size: vec![24.0], triangles: vec![24], ..LodOptions::default() };
        let LevelReport { candidates, texture_size, way, .. } = level(&chequered(10), &options);
        let usual = candidates[0].texture_size;
        assert_eq!(texture_size, 4 * usual, "{candidates:?}");
        let of_size = |size| candidates.iter().find(|c| c.texture_size == size && c.way == way).unwrap().psnr;
        for size in [2 * usual, 4 * usual] {
            assert!(of_size(size) >= of_size(size / 2) + GAINED_BY_MAPS, "{candidates:?}");
        }
    }
}
