//! Which way a level is made: several are finished, and the one whose pictures show most of the model is taken.
//!
//! ```text
//! its own maps, scaled (delivered.rs) ──────── excellent: taken
//! triangles chosen by pictures, new layout ──┐
//! its own layout, baked (delivered.rs) ──────┼─ the best ─ maps show at this size? ─ baked again with finer ones
//! ```
//!
//! All are photographed as viewers show them: four samples a pixel, each shaded; rougher where vertex normals turn within
//! a pixel (`render/turning_normals.rs`); in every other view under a lamp from the side, which shows each normal.
//! So vertices that stay in place lose nothing at edges, where a shift by a twentieth of a pixel already flips samples.
//! A level takes over at up to twice the size that it is made for, so maps may be worth twice as many texels along a side.
//!
//! Contract: deterministic without a budget. A budget is for one bake; a watcher that says stop is heeded between pictures.

use super::chain::Chain;
use super::delivered::{Coarser, baked_draft, coarser, may_keep_vertices, scaled, scaled_draft, texels};
use super::maps::{Reduction, level_maps, with_reductions};
use super::switch::Pictures;
use super::{Candidate, Draft, Maker, Way};
use crate::error::BakeError;
use parbake_model::Model;
use std::time::Instant;

/// Pixels that a model spans at most in the larger ones of the pictures that are compared.
const LARGEST: f64 = 300.0;
/// Decibels from which on nobody would see what other ways gain.
const EXCELLENT: f64 = 50.0;
/// Decibels by which another way has to be better than a new layout, and a bake than scaled maps.
pub(crate) const WORTHWHILE: f64 = 0.3;
/// Decibels that a bake has to lose by halving its maps for finer ones to be tried, and those that finer ones have to gain.
const SHOWN_BY_MAPS: f64 = 1.0;
const GAINED_BY_MAPS: f64 = 0.5;
/// Share of a level's time budget after which no more collapses are tried.
const TRYING: f64 = 0.2;

/// The level as that way makes it which shows most of the model. Ways are left out where they cannot win: a new layout
/// where scaled maps are excellent, another bake where even finer maps would show less. None where the watcher said stop
/// before there was one.
pub(crate) fn draft(
    maker: &Maker,
    chain: &mut Chain,
    level: usize,
    finer: Option<&Model>,
    triangles: usize,
    until: Option<Instant>,
) -> Result<Option<Draft>, BakeError> {
    let begin = Instant::now();
    chain.tell(level, 0);
    let judge = Judge::new(maker, maker.options.screen_size[level])?;
    let enough = until.map(|until| begin + until.saturating_duration_since(begin).mul_f64(TRYING));
    let is_over = || chain.stopped() || enough.is_some_and(|enough| Instant::now() > enough);
    let side = maker.texels_along(maker.model, maker.options.screen_size[level]);
    let own = match may_keep_vertices(maker, triangles) {
        true => coarser(maker, &judge, triangles, side, &is_over)?,
        false => None,
    };
    if chain.stopped() {
        return Ok(None);
    }
    let mut candidates = Vec::new();
    let mut best: Option<Tried> = None;
    if let Some((model, psnr)) = own.as_ref().map(|own| scaled(maker, &judge, own)).transpose()?.flatten() {
        let seconds = [begin.elapsed().as_secs_f64(), 0.0, 0.0];
        let draft = scaled_draft(maker, level, model, side, seconds);
        let candidate = draft.candidate(psnr);
        candidates.push(candidate);
        best = Some((draft, candidate));
    }
    if best.as_ref().is_none_or(|(_, scaled)| scaled.psnr < EXCELLENT) {
        let Some(new) = maker.draft(chain, (level, 0), finer, (triangles, None), until)? else {
            return Ok(None);
        };
        let candidate = judge.candidate(&new)?;
        candidates.insert(0, candidate);
        if best.as_ref().is_none_or(|(_, scaled)| scaled.psnr <= candidate.psnr + WORTHWHILE) {
            best = Some((new, candidate));
        }
        let is_behind =
            |own: &&Coarser| best.as_ref().is_some_and(|(_, best)| own.psnr > best.psnr + WORTHWHILE);
        // A budget is for one bake.
        let is_free = until.is_none() && !chain.stopped();
        if let Some(own) = own.as_ref().filter(is_behind).filter(|_| is_free) {
            let baked = baked_draft(maker, chain, level, own, None)?;
            let candidate = judge.candidate(&baked)?;
            candidates.push(candidate);
            if best.as_ref().is_none_or(|(_, best)| candidate.psnr > best.psnr + WORTHWHILE)
                && !chain.stopped()
            {
                best = Some((baked, candidate));
            }
        }
        if let Some(tried) = best.as_ref().filter(|_| until.is_none() && !chain.stopped())
            && let Some((finer, candidate)) =
                with_finer_maps(maker, chain, &judge, level, tried, own.as_ref())?
        {
            candidates.push(candidate);
            if candidate.psnr >= tried.1.psnr + GAINED_BY_MAPS && !chain.stopped() {
                best = Some((finer, candidate));
            }
        }
    }
    Ok(best.map(|(mut draft, _)| {
        draft.candidates = candidates;
        draft.seconds[2] = begin.elapsed().as_secs_f64() - draft.seconds[0] - draft.seconds[1];
        draft
    }))
}

/// What a way came to.
type Tried = (Draft, Candidate);

/// The same bake with twice the texels along a side, where its maps show at this size and all of them still have at most
/// half of the model's texels.
fn with_finer_maps(
    maker: &Maker,
    chain: &mut Chain,
    judge: &Judge,
    level: usize,
    (draft, candidate): &Tried,
    own: Option<&Coarser>,
) -> Result<Option<Tried>, BakeError> {
    let of_all = |model: &Model| model.images.iter().map(texels).sum::<usize>();
    let size = 2 * candidate.texture_size;
    let baked = &draft.baked.model;
    let is_small = size <= maker.options.max_texture_size && 8 * of_all(baked) <= of_all(maker.model);
    if draft.way == Way::Scaled || !is_small {
        return Ok(None);
    }
    let maps = level_maps(baked);
    let halved: Vec<Reduction> = maps.iter().map(|_| Reduction::Halved(1)).collect();
    if judge.psnr(&with_reductions(baked, &maps, &halved))? > candidate.psnr - SHOWN_BY_MAPS {
        return Ok(None);
    }
    let finer = match own {
        Some(own) if draft.way == Way::Delivered => baked_draft(maker, chain, level, own, Some(size))?,
        _ => maker.baked_again(chain, level, draft, size)?,
    };
    let candidate = judge.candidate(&finer)?;
    Ok(Some((finer, candidate)))
}

/// Compares ways by their pictures.
pub(crate) struct Judge<'m> {
    maker: &'m Maker<'m>,
    /// The original at the level's size, and where that is small at twice that: a level is seen from closer, too.
    pictures: Vec<Pictures>,
}

impl<'m> Judge<'m> {
    /// For a level of so many pixels.
    fn new(maker: &'m Maker<'m>, pixels: f64) -> Result<Self, BakeError> {
        let sizes = [pixels, (2.0 * pixels).min(LARGEST)];
        let sizes = sizes.into_iter().enumerate().filter(|&(k, size)| k == 0 || size > pixels);
        let pictures = sizes.map(|(_, size)| maker.viewer.pictures(&maker.original, size));
        Ok(Self { maker, pictures: pictures.collect::<Result<_, _>>()? })
    }

    /// PSNR in dB, the mean over the sizes.
    pub(crate) fn psnr(&self, model: &Model) -> Result<f64, BakeError> {
        let viewer = &self.maker.viewer;
        let subject = viewer.subject(model)?;
        let sum: f64 = self.pictures.iter().map(|pictures| viewer.psnr(pictures, &subject)).sum();
        Ok(sum / self.pictures.len() as f64)
    }

    fn candidate(&self, draft: &Draft) -> Result<Candidate, BakeError> {
        Ok(draft.candidate(self.psnr(&draft.baked.model)?))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::options::LodOptions;
    use super::super::{LevelReport, make_levels};
    use super::*;
    use parbake_model::glam::{Vec3, vec2};
    use parbake_model::{Image, Material, Mesh, TextureSlot};

    fn level(model: &Model, options: &LodOptions) -> LevelReport {
        let mut reports = Vec::new();
        make_levels::<BakeError>(model, options, &(), |level| {
            reports.push(level.report);
            Ok(())
        })
        .unwrap();
        reports.remove(0)
    }

    /// A square of many triangles with a chequered texture of so many fields along a side, in two materials, so that its
    /// maps cannot be scaled.
    fn chequered(fields: usize) -> Model {
        let (cells, side, mut mesh) = (12u32, 1024, Mesh::default());
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
        let material = Material { base_color_texture: Some(slot), double_sided: true, ..Material::default() };
        let materials = vec![material.clone(), material];
        Model { name: "fields".into(), mesh, materials, images, ..Model::default() }
    }

    /// Protects small print: a level has twice the texels along a side where these show.
    #[test]
    fn maps_are_finer_where_that_shows() {
        let options = LodOptions { screen_size: vec![48.0], triangles: vec![200], ..LodOptions::default() };
        let LevelReport { candidates, texture_size, way, .. } = level(&chequered(19), &options);
        let usual = candidates[0].texture_size;
        assert_eq!(texture_size, 2 * usual, "{candidates:?}");
        let of_size = |size| candidates.iter().find(|c| c.texture_size == size && c.way == way).unwrap().psnr;
        assert!(of_size(texture_size) >= of_size(usual) + GAINED_BY_MAPS, "{candidates:?}");
    }
}
