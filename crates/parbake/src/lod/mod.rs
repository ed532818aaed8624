//! A chain of levels of detail from one model, from fine to coarse.
//!
//! ```text
//! model ─ HighPoly (once) ─┬ triangles (low_poly.rs) ─ bake ─ level ─ figures, switch (switch.rs) ─┐
//!                          └ … the next level may start from the triangles of this one ◁───────────┘
//! ```
//!
//! `ways.rs` makes a level in several ways and takes the best (`delivered.rs`: those that keep the model's layout).
//! `target.rs` makes a level of several bakes where a PSNR is asked for; `chain.rs` is progress and time.
//!
//! Each level is made for a size on screen. From that follow how far its surface may be off, hence its triangles, and
//! how many texels it needs.
//!
//! Contract: levels have fewer and fewer triangles. Each is finished before the next one begins, and handed over;
//! a chain that is stopped keeps those that are finished. Deterministic.

pub(crate) mod chain;
mod delivered;
pub mod document;
mod face_frames;
pub mod layout;
mod maps;
mod merged;
pub mod options;
mod scaled;
pub mod search;
mod see_through;
pub mod switch;
pub mod target;
mod ways;
mod written;

use crate::bake::{Baked, bake_as, prepare_high_poly};
use crate::budget::check_budget;
use crate::error::BakeError;
use crate::low_poly::{check_triangles, coarse_surfaces, least_of, low_poly};
use crate::options::{BakeOptions, ShapeMode};
use crate::parts::{PartReport, draw_calls, part_reports, with_kept_parts, with_parted_materials};
use crate::work::Work;
use chain::{Chain, LevelWatcher, hurried};
use options::LodOptions;
use parbake_atlas::AtlasError;
use parbake_files::WriteOptions;
use parbake_model::Model;
use parbake_progress::Watcher;
use parbake_simplify::start::triangles_within;
use parbake_simplify::{CoarseSurfaces, LayerReport};
use parbake_views::high_poly::HighPoly;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::time::Instant;
use switch::{AtSize, Lineup, Subject};
use target::TargetReport;
use ways::as_viewers_do;
use written::as_written;

/// A finished level.
#[derive(Clone, Debug)]
pub struct Level {
    /// The bake, with the model.
    pub baked: Baked,
    /// How its file is to be written: as asked for, with a lower quality of textures where a target allows that.
    pub write: WriteOptions,
    /// What there is to say of it.
    pub report: LevelReport,
}

/// How a level was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// Triangles were chosen by their pictures, the layout is new, maps were fitted.
    #[default]
    New,
    /// Edges of the model collapsed, its layout was repaired, maps were fitted.
    Delivered,
    /// Edges of the model collapsed; it has its own layout and its own maps, with fewer texels.
    Scaled,
}

/// A way that was tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// How.
    pub way: Way,
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side of its largest texture.
    pub texture_size: usize,
    /// PSNR in dB against the original in pictures as viewers make them, the mean of the level's size and, up to 300
    /// pixels, twice that; before anything was compressed.
    pub psnr: f64,
}

/// What `lods.json` holds of a level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelReport {
    /// Its place in the chain; 0 is the finest.
    pub level: usize,
    /// Pixels that it was made for.
    pub screen_size: f64,
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side of its textures.
    pub texture_size: usize,
    /// Texels of all its textures.
    pub texels: usize,
    /// Texels between the two charts that come nearest, at the texture's own size; none where there is one chart.
    #[serde(default)]
    pub gutter: Option<f64>,
    /// The same at the smallest mip level that the level is meant for: where it is as small as the next level's size, or
    /// as half of the last one's own.
    #[serde(default)]
    pub smallest_gutter: Option<f64>,
    /// Draw calls: one for each material, of each part that stays apart and of the rest.
    pub draw_calls: usize,
    /// The nodes that stay apart.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartReport>,
    /// How it was made.
    #[serde(default)]
    pub way: Way,
    /// The ways that were tried; that with finer maps once more.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub candidates: Vec<Candidate>,
    /// How the triangles of each layer (opaque, cut out, blended, transmitting) were found; empty where it has the
    /// model's own vertices.
    pub low_poly: Vec<LayerReport>,
    /// Against the original, at the size that it was made for; of what the file holds.
    pub at_screen_size: AtSize,
    /// Pixels that the model spans below which this level cannot be told from the one before, nor from the
    /// original; none where it always can.
    pub switch_pixels: Option<f64>,
    /// The same as a share of the screen's height.
    pub switch_coverage: Option<f64>,
    /// Against the level before (the original for the first), at that size.
    pub against_before: Option<AtSize>,
    /// How the search for a PSNR went, where one was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetReport>,
    /// Whether a time budget or a signal ended a step early.
    #[serde(default)]
    pub stopped_early: bool,
    /// Seconds that triangles, bake and figures took; of a search for a PSNR those of all its bakes. Ways that were not
    /// taken count with the figures.
    pub seconds: [f64; 3],
}

/// Makes the levels of a model one by one and hands each over as soon as it is finished. Returns how many there are:
/// fewer than asked for where the watcher said stop, or where a level would have no fewer triangles than the one
/// before.
///
/// # Errors
/// An option out of range; a model without extent; parts that are not there, or too many for so few triangles; what
/// `on_level` returns.
pub fn make_levels<E: From<BakeError>>(
    model: &Model,
    options: &LodOptions,
    watcher: &dyn Watcher,
    mut on_level: impl FnMut(Level) -> Result<(), E>,
) -> Result<usize, E> {
    options.check()?;
    let start = Instant::now();
    let kept = with_kept_parts(model, &options.keep_parts)?;
    let model = &*with_parted_materials(&kept);
    let maker = Maker::new(model, options)?;
    let sizes = (0..options.screen_size.len())
        .map(|level| (maker.wanted[level], maker.texture_size(model, options.screen_size[level])));
    let mut chain = Chain::new(watcher, start, options, &sizes.collect::<Vec<_>>());
    let mut before: Option<(Model, Subject)> = None;
    let mut count = 0;
    for index in 0..options.screen_size.len() {
        let finer = before.as_ref().map(|(low, _)| low);
        let made = match options.target_psnr {
            Some(target) => target::find(&maker, &mut chain, index, finer, target)?
                .map(|found| (found.draft, found.write, Some(found.report))),
            None => {
                let most = finer.map_or(maker.high.triangles, |low| low.mesh.triangles.len());
                let (wanted, until) = (maker.wanted[index].min(most), chain.level_until(index));
                let draft = ways::draft(&maker, &mut chain, index, finer, wanted, until)?;
                draft.map(|draft| (draft, options.write, None))
            }
        };
        let Some((draft, write, target)) = made else { break };
        let begin = Instant::now();
        let written = as_written(&draft.baked.model, &write, options.normal_y)?.model;
        let subject = maker.lineup.subject(&as_viewers_do(&written))?;
        let figures = maker.figures(index, &subject, before.as_ref().map(|(_, subject)| subject))?;
        let Draft { low, layers, baked, way, candidates, seconds: [chosen, fitted, compared] } = draft;
        let mip = baked.report.options.smallest_mip.unwrap_or(0.0);
        let gutter = baked.report.uv.gutter.as_ref().map(|gutter| (gutter.texels, mip));
        let report = LevelReport {
            level: index,
            screen_size: options.screen_size[index],
            triangles: baked.model.mesh.triangles.len(),
            texture_size: largest_texture(&baked.model),
            texels: texels_of(&baked.model),
            gutter: gutter.map(|(texels, _)| texels),
            smallest_gutter: gutter.map(|(texels, mip)| texels / mip.exp2()),
            draw_calls: draw_calls(&baked.model),
            parts: part_reports(&baked.model),
            way,
            candidates,
            low_poly: layers,
            at_screen_size: figures.at_screen_size,
            switch_pixels: figures.switch_pixels,
            switch_coverage: figures.switch_pixels.map(|pixels| (pixels / options.viewport_height).min(1.0)),
            against_before: figures.against_before,
            target,
            stopped_early: baked.report.stopped_early,
            seconds: [chosen, fitted, compared + begin.elapsed().as_secs_f64()],
        };
        before = Some((low, subject));
        count += 1;
        on_level(Level { baked, write, report })?;
    }
    Ok(count)
}

/// What all levels are made of.
pub(crate) struct Maker<'a> {
    pub model: &'a Model,
    pub high: HighPoly,
    pub options: &'a LodOptions,
    /// Pictures as viewers make them.
    pub lineup: Lineup,
    /// The model, ready for these.
    pub original: Subject,
    /// The fewest triangles that a level may have.
    pub least: usize,
    /// Triangles of each level, as its size or an option says.
    wanted: Vec<usize>,
    /// What the triangles of all levels begin with.
    start: CoarseSurfaces,
}

/// A baked level without figures.
pub(crate) struct Draft {
    /// Its triangles as they were chosen.
    pub low: Model,
    pub layers: Vec<LayerReport>,
    pub baked: Baked,
    pub way: Way,
    pub candidates: Vec<Candidate>,
    /// That choosing triangles, baking and pictures took, those of bakes that were not taken included.
    pub seconds: [f64; 3],
}

impl Draft {
    fn candidate(&self, psnr: f64) -> Candidate {
        let model = &self.baked.model;
        let (triangles, texture_size) = (model.mesh.triangles.len(), largest_texture(model));
        Candidate { way: self.way, triangles, texture_size, psnr }
    }
}

/// What pictures say of a level.
struct Figures {
    at_screen_size: AtSize,
    switch_pixels: Option<f64>,
    against_before: Option<AtSize>,
}

impl<'a> Maker<'a> {
    fn new(model: &'a Model, options: &'a LodOptions) -> Result<Self, BakeError> {
        let high = prepare_high_poly(model, &options.bake(options.max_texture_size))?;
        options.triangles.iter().try_for_each(|&count| check_triangles(&high, model, count))?;
        let least = least_of(&high, model);
        let lineup = Lineup::new(model);
        let original = lineup.subject(&as_viewers_do(model))?;
        let wanted = wanted_triangles(&high, options, least);
        let start = coarse_surfaces(&high, model);
        Ok(Self { model, high, options, lineup, original, least, wanted, start })
    }

    /// Chooses so many triangles and bakes, to be finished by `until`; the texture's size follows the level's where
    /// none is given. None where the watcher said stop before the triangles were chosen.
    fn draft(
        &self,
        chain: &mut Chain,
        (level, bake): (usize, usize),
        finer: Option<&Model>,
        (triangles, texture_size): (usize, Option<usize>),
        until: Option<Instant>,
    ) -> Result<Option<Draft>, BakeError> {
        let begin = Instant::now();
        let watcher = chain.bake(level, bake, until);
        let options = self.options.bake(self.options.max_texture_size);
        let (low, layers) =
            low_poly(&self.high, self.model, &self.start, finer, triangles, &options, &watcher)?;
        if watcher.stopped() {
            // There may be too many triangles still.
            return Ok(None);
        }
        let chosen = begin.elapsed().as_secs_f64();
        let baked = self.baked(&low, (level, texture_size), None, until, &watcher)?;
        let seconds = [chosen, begin.elapsed().as_secs_f64() - chosen, 0.0];
        Ok(Some(Draft { low, layers, baked, way: Way::New, candidates: Vec::new(), seconds }))
    }

    /// The bake of a draft of a new layout with another texture size.
    fn baked_again(
        &self,
        chain: &mut Chain,
        level: usize,
        draft: &Draft,
        texture_size: usize,
    ) -> Result<Draft, BakeError> {
        let begin = Instant::now();
        let (low, layers) = (draft.low.clone(), draft.layers.clone());
        let watcher = chain.bake(level, 0, None);
        let baked = self.baked(&low, (level, Some(texture_size)), None, None, &watcher)?;
        let seconds = [draft.seconds[0], begin.elapsed().as_secs_f64(), 0.0];
        Ok(Draft { low, layers, baked, way: Way::New, candidates: Vec::new(), seconds })
    }

    /// Bakes onto a low-poly, with twice the texels along a side as often as its charts do not fit.
    fn baked(
        &self,
        low: &Model,
        (level, texture_size): (usize, Option<usize>),
        shape: Option<ShapeMode>,
        until: Option<Instant>,
        watcher: &LevelWatcher,
    ) -> Result<Baked, BakeError> {
        let first = hurried(self.bake_options(low, level, texture_size), until).texture_size;
        with_room(first, self.options.max_texture_size, |size| {
            let mut options = self.bake_options(low, level, Some(size));
            options.shape = shape.unwrap_or(options.shape);
            options.time_budget = hurried(options.clone(), until).time_budget;
            // Where charts need more texels than there is time for, the bake has the least time that these can be written in.
            if let Err(BakeError::Budget { least, .. }) = check_budget(&options) {
                options.time_budget = Some(least);
            }
            bake_as(Work::Level, &self.high, low, &options, &watcher.after_triangles())
        })
    }

    /// The options of the bake of a level, without a budget.
    fn bake_options(&self, low: &Model, level: usize, texture_size: Option<usize>) -> BakeOptions {
        let side = self.texels_along(low, self.options.screen_size[level]);
        let texture_size = texture_size.unwrap_or_else(|| self.power_of_two(side));
        let smallest_mip = Some(self.smallest_mip(level, texture_size as f64 / side));
        BakeOptions { smallest_mip, ..self.options.bake(texture_size) }
    }

    fn figures(
        &self,
        level: usize,
        subject: &Subject,
        before: Option<&Subject>,
    ) -> Result<Figures, BakeError> {
        let (lineup, screen_size) = (&self.lineup, self.options.screen_size[level]);
        let at_screen_size = lineup.compare(&self.original, subject, screen_size)?;
        let others: Vec<&Subject> = [Some(&self.original), before].into_iter().flatten().collect();
        let switch_pixels = lineup.largest_same(subject, &others, screen_size, self.options.switch_psnr)?;
        let last = others[others.len() - 1];
        let against_before = switch_pixels.map(|pixels| lineup.compare(last, subject, pixels)).transpose()?;
        Ok(Figures { at_screen_size, switch_pixels, against_before })
    }

    /// Texels along a side of a level's texture.
    fn texture_size(&self, low: &Model, screen_size: f64) -> usize {
        self.power_of_two(self.texels_along(low, screen_size))
    }

    /// About a texel for each pixel that the surface covers at this size, where charts fill three quarters of the
    /// texture.
    fn texels_along(&self, low: &Model, screen_size: f64) -> f64 {
        let area: f64 =
            (0..low.mesh.triangles.len()).map(|t| 0.5 * f64::from(low.mesh.area_normal(t).length())).sum();
        let pixels_per_unit = 0.5 * screen_size * f64::from(self.high.frame.scale);
        (area * pixels_per_unit.powi(2) / 0.75).sqrt().max(1.0)
    }

    fn power_of_two(&self, side: f64) -> usize {
        let most = self.options.max_texture_size;
        (2f64.powf(side.log2().round()) as usize).clamp(32.min(most), most)
    }

    /// The mip level with a texel for each pixel at the size where a level is no longer meant to be seen: that which the
    /// next one is made for, or half of the last one's own. `share` is how many times as many texels along a side the
    /// texture has as the level's own size needs.
    fn smallest_mip(&self, level: usize, share: f64) -> f64 {
        let sizes = &self.options.screen_size;
        let smaller = sizes.get(level + 1).copied().unwrap_or(0.5 * sizes[level]);
        (share * sizes[level] / smaller).log2().max(0.0)
    }
}

/// Texels along the longest side of a model's textures; 0 where it has none.
fn largest_texture(model: &Model) -> usize {
    model.images.iter().map(|image| image.width.max(image.height)).max().unwrap_or(0)
}

/// Texels of all textures of a model.
fn texels_of(model: &Model) -> usize {
    model.images.iter().map(|image| image.width * image.height).sum()
}

/// What comes of a texture of this size, or of twice that as often as charts do not fit.
fn with_room<T>(
    size: usize,
    most: usize,
    mut of_size: impl FnMut(usize) -> Result<T, BakeError>,
) -> Result<T, BakeError> {
    let next = (2 * size).min(most);
    match of_size(size) {
        Err(BakeError::Atlas(AtlasError::NoRoom { .. })) if next > size => with_room(next, most, of_size),
        result => result,
    }
}

/// Triangles of each level, of which none has fewer than `least`.
fn wanted_triangles(high: &HighPoly, options: &LodOptions, least: usize) -> Vec<usize> {
    let wanted = |level: usize| match (options.triangles.get(level), options.ratio.get(level)) {
        (Some(&count), _) => count,
        (None, Some(share)) => ((share * high.triangles as f64).round() as usize).max(least),
        (None, None) => {
            // The longest side is 2 long in the common frame.
            let error = 2.0 * options.error / options.screen_size[level];
            triangles_within(high.scene.mesh(), error as f32).max(least)
        }
    };
    (0..options.screen_size.len()).into_par_iter().map(wanted).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects chains from ending at a model of many parts: its charts get a texture in which they fit, where one may be
    /// so large.
    #[test]
    fn many_charts_get_a_larger_texture() {
        let fits_from = |least: usize| {
            move |size: usize| match size < least {
                true => {
                    let error = AtlasError::NoRoom { charts: 5128, texture_size: size, gutter_texels: 1.0 };
                    Err(BakeError::Atlas(error))
                }
                false => Ok(size),
            }
        };
        assert!(matches!(with_room(64, 512, fits_from(64)), Ok(64)));
        assert!(matches!(with_room(64, 512, fits_from(200)), Ok(256)));
        assert!(matches!(with_room(64, 200, fits_from(200)), Ok(200)));
        let fails = with_room(64, 512, fits_from(1024));
        assert!(matches!(fails, Err(BakeError::Atlas(AtlasError::NoRoom { texture_size: 512, .. }))));
    }
}
