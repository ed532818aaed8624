//! What all levels of a chain are made of, and the steps of one level: triangles and a bake, which give a draft, and
//! figures.
//!
//! Contract: nothing here says which drafts are made, nor which one is taken (`ways.rs`, `target.rs`).

use super::candidate::{Candidate, Shown, Way};
use super::chain::{Chain, LevelWatcher, hurried};
use super::options::LodOptions;
use crate::bake::{Baked, bake_as, prepare_high_poly};
use crate::budget::check_budget;
use crate::error::BakeError;
use crate::low_poly::{check_triangles, coarse_surfaces, least_of, low_poly};
use crate::options::{BakeOptions, ShapeMode};
use crate::work::Work;
use parbake_atlas::AtlasError;
use parbake_evaluate::renderer::PlacedModel;
use parbake_evaluate::screen_size::{AtSize, ScreenComparison};
use parbake_levels::face_frames::with_face_tangents;
use parbake_levels::screen::{self, largest_texture};
use parbake_model::Model;
use parbake_progress::Watcher;
use parbake_simplify::start::triangles_within;
use parbake_simplify::{CoarseSurfaces, LayerReport};
use parbake_views::high_poly::HighPoly;
use rayon::prelude::*;
use std::time::Instant;

/// What all levels are made of.
pub(crate) struct Maker<'a> {
    pub model: &'a Model,
    pub high: HighPoly,
    pub options: &'a LodOptions,
    /// Pictures as viewers make them.
    pub screens: ScreenComparison,
    /// The model, ready for these.
    pub original: PlacedModel,
    /// The fewest triangles that a level may have.
    pub least: usize,
    /// Triangles of each level, as its size or an option says.
    pub wanted: Vec<usize>,
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
    pub fn candidate(&self, Shown { psnr, close_up }: Shown) -> Candidate {
        let model = &self.baked.model;
        let (triangles, texture_size) = (model.mesh.triangles.len(), largest_texture(model));
        Candidate { way: self.way, triangles, texture_size, psnr, close_up }
    }
}

/// What pictures say of a level.
pub(crate) struct Figures {
    pub at_screen_size: AtSize,
    pub switch_pixels: Option<f64>,
    pub against_before: Option<AtSize>,
}

impl<'a> Maker<'a> {
    /// `whole`: triangles with hidden parts; ratios are shares of these.
    pub fn new(model: &'a Model, whole: usize, options: &'a LodOptions) -> Result<Self, BakeError> {
        let high = prepare_high_poly(model, &options.bake(options.max_texture_size))?;
        options.triangles.iter().try_for_each(|&count| check_triangles(&high, model, count))?;
        let least = least_of(&high, model);
        let screens = ScreenComparison::new(model);
        let original = screens.place(&with_face_tangents(model))?;
        let wanted = wanted_triangles(&high, whole, options, least);
        let start = coarse_surfaces(&high, model);
        Ok(Self { model, high, options, screens, original, least, wanted, start })
    }

    /// Chooses so many triangles and bakes, to be finished by `until`; the texture's size follows the level's where
    /// none is given. None where the watcher said stop before the triangles were chosen.
    pub fn draft(
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
    pub fn baked_again(
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
    pub fn baked(
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

    /// Pictures of a level, which is finished, against the original and the level before.
    ///
    /// # Errors
    /// A model without extent.
    pub fn figures(
        &self,
        level: usize,
        placed: &PlacedModel,
        before: Option<&PlacedModel>,
    ) -> Result<Figures, BakeError> {
        let (screens, screen_size) = (&self.screens, self.options.screen_size[level]);
        let at_screen_size = screens.compare(&self.original, placed, screen_size)?;
        let others: Vec<&PlacedModel> = [Some(&self.original), before].into_iter().flatten().collect();
        let switch_pixels = screens.largest_same(placed, &others, screen_size, self.options.switch_psnr)?;
        let last = others[others.len() - 1];
        let against_before = switch_pixels.map(|pixels| screens.compare(last, placed, pixels)).transpose()?;
        Ok(Figures { at_screen_size, switch_pixels, against_before })
    }

    /// Texels along a side of a level's texture.
    pub fn texture_size(&self, low: &Model, screen_size: f64) -> usize {
        self.power_of_two(self.texels_along(low, screen_size))
    }

    /// About a texel for each pixel that the surface covers at this size, where charts fill three quarters of the
    /// texture.
    pub fn texels_along(&self, low: &Model, screen_size: f64) -> f64 {
        screen::texels_along(&low.mesh, f64::from(self.high.frame.scale), screen_size)
    }

    pub fn power_of_two(&self, side: f64) -> usize {
        screen::texture_size(side, self.options.max_texture_size)
    }

    /// The mip level at which a level is last meant to be seen ([`screen::smallest_mip`]).
    pub fn smallest_mip(&self, level: usize, share: f64) -> f64 {
        screen::smallest_mip(&self.options.screen_size, level, share)
    }
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
fn wanted_triangles(high: &HighPoly, whole: usize, options: &LodOptions, least: usize) -> Vec<usize> {
    let wanted = |level: usize| match (options.triangles.get(level), options.ratio.get(level)) {
        (Some(&count), _) => count,
        (None, Some(share)) => ((share * whole as f64).round() as usize).max(least),
        (None, None) => {
            let (size, error) = (options.screen_size[level], options.error);
            let within = screen::distance_of_pixels(error, size);
            let needed = triangles_within(high.scene.mesh(), within as f32);
            needed.min(screen::most_triangles(size, LodOptions::default().error / error)).max(least)
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
