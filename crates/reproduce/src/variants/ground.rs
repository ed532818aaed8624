//! What all variants have in common: the two models, views, samples, and the way from a map
//! that shifts nothing to figures and pictures.

use super::look::Look;
use super::measured_heights::MeasuredHeights;
use super::options::VariantsOptions;
use super::report::VariantFigures;
use super::stored::Stored;
use parbake::{BakeError, Message, Watcher};
use parbake::{EvaluateOptions, Metrics, compare_pictures, mean_figures, tonemapped};
use parbake_fit::backend::{Backend, Cpu};
use parbake_fit::parallax::{State, fit_parallax_of};
use parbake_fit::schedule::{Comparison, Fitted, fit_textures};
use parbake_image::MapSet;
use parbake_image::display_table::DisplayTable;
use parbake_image::quantise::from_image;
use parbake_metric::Rgb;
use parbake_model::glam::Vec3;
use parbake_model::{Image, Model};
use parbake_render::camera::{Camera, Projection, fibonacci_sphere};
use parbake_render::parallax_variants::shift_map::Unshifted;
use parbake_render::shade::Brdf;
use parbake_views::high_poly::{Conventions, HEADLIGHT_BRDF, HighPoly, ViewSet};
use parbake_views::low_poly::LowPoly;
use parbake_views::pool::Rig;
use parbake_views::projection::{ProjectedMaps, project};
use parbake_views::reference::Reference;
use parbake_views::samples::shifted_samples;
use parbake_views::view_sample::ViewSample;
use parbake_views::view_sampler::{UncoveredPixels, ViewSampler};
use std::sync::Arc;
use std::time::Instant;

/// Where training cameras stand: those of a bake.
const RIG: Rig = Rig { radius: 3.5, projection: Projection::Perspective(0.4) };
/// How far projection looks to either side in the common frame: as a bake by default.
const REACH: f32 = 0.1;
/// Silhouettes are treated as a bake by default treats them.
const BEYOND: UncoveredPixels = UncoveredPixels::Background([0.0; 3], 0.5);
/// Sides to look at: azimuth from +Z towards +X and height in degrees, and half the width of
/// the view at unit depth.
const SIDES: [([f32; 2], f32); 2] = [([25.0, 12.0], 0.36), ([62.0, 24.0], 0.17)];
/// Side of these pictures in pixels, and samples along a side of each.
const PICTURE: (usize, usize) = (384, 2);
/// Before dark grey, as in the report of a bake; linear light.
const GREY: [f32; 3] = [0.04; 3];
/// Maps that are fitted along with a variant: base colour and normal, which [`Look`] shows.
const FITTED: usize = 2;
/// Steps at either end whose mean the report gives.
const REPORTED: usize = 10;

/// The models and all that is rendered or projected once.
pub struct Subject {
    high: HighPoly,
    low: LowPoly,
    start: ProjectedMaps,
    /// The textures that are fitted along with maps, as they begin.
    small: (LowPoly, ProjectedMaps),
    references: Arc<Vec<Reference>>,
    /// Measured, where that was asked for.
    pub heights: Option<MeasuredHeights>,
}

impl Subject {
    /// Renders and projects.
    pub fn new(
        high: &Model,
        low: &Model,
        options: &VariantsOptions,
        watcher: &dyn Watcher,
    ) -> Result<Self, BakeError> {
        let convention = options.convention;
        let conventions = Conventions {
            whole_material: Some(false),
            interpretation: convention.interpretation(),
            display: convention.display(),
            rig: RIG,
            max_distance: REACH,
        };
        let high = HighPoly::new(high, conventions)?;
        let made = |size| -> Result<(LowPoly, ProjectedMaps), BakeError> {
            let low = LowPoly::new(low, &high.frame, size)?;
            let start = project(&low, &high);
            Ok((low, start))
        };
        let (ready, start) = made(options.texture_size)?;
        let small = made(options.fitted_texels())?;
        for warning in &ready.warnings {
            watcher.message(Message::Warning(warning.clone()));
        }
        let heights = match options.measured_heights {
            true => {
                let low = LowPoly::new(low, &high.frame, options.height_size)?;
                Some(MeasuredHeights::new(&low, &high.surface, REACH))
            }
            false => None,
        };
        let sampling = options.sampling();
        let set = ViewSet { count: options.views, seed: options.seed, jitter: true, sampling };
        let references = high.references(&set, watcher);
        let made = Self { high, low: ready, start, small, references, heights };
        let sampler = made.sampler(options);
        let mut seen = 0;
        made.references.iter().for_each(|reference| sampler.fragments(reference, |_| seen += 1));
        match seen {
            0 => Err(BakeError::OutOfView { low: low.name.clone(), high: made.high.name.clone() }),
            _ => Ok(made),
        }
    }

    /// How maps become light, and how that is shown.
    fn comparison(&self) -> Comparison<'static, impl Brdf + use<>, Cpu> {
        let conventions = &self.high.conventions;
        Comparison {
            backend: &Cpu,
            brdf: &HEADLIGHT_BRDF,
            display: conventions.display,
            srgb: conventions.srgb(),
        }
    }

    fn sampler(&self, options: &VariantsOptions) -> ViewSampler<'_> {
        ViewSampler::new(&self.low.placed, options.view_size, &self.high.conventions.display, BEYOND)
    }
}

/// The same, ready for fits.
pub struct Ground<'a> {
    subject: &'a Subject,
    options: &'a VariantsOptions,
    views: Vec<Vec<ViewSample>>,
    /// Small textures that were solved for without parallax.
    begin: MapSet,
    evaluate: EvaluateOptions,
    /// The high-poly in each held-out view.
    wanted: Vec<(Camera, Rgb)>,
}

impl<'a> Ground<'a> {
    /// Collects samples and renders the held-out views.
    pub fn new(subject: &'a Subject, options: &'a VariantsOptions, watcher: &dyn Watcher) -> Self {
        let sampler = subject.sampler(options);
        let (low, start) = &subject.small;
        let views = Cpu.sample_views(&sampler, &subject.references);
        let samples = shifted_samples(&views, options.fitted_texels(), &Unshifted, watcher);
        let comparison = subject.comparison();
        let begin =
            fit_textures(&samples, &low.atlas, &start.maps, &comparison, &options.schedule(), watcher);
        let mut maps = MapSet::new(options.fitted_texels());
        for (kind, image) in &begin.images {
            maps.insert(*kind, from_image(*kind, image, comparison.srgb));
        }
        let display = comparison.display;
        let evaluate = EvaluateOptions { resolution: options.resolution, ..EvaluateOptions::default() };
        let wanted = (fibonacci_sphere(options.held_out, 0.0).into_iter())
            .map(|direction| {
                let camera = Camera::towards_origin(direction, evaluate.radius, evaluate.projection());
                let (size, supersample) = (evaluate.resolution, evaluate.supersample);
                let picture = subject.high.scene.render(&HEADLIGHT_BRDF, &camera, size, supersample);
                (camera, tonemapped(&picture, &display, [0.0; 3]))
            })
            .collect();
        Self { views, begin: maps, subject, options, evaluate, wanted }
    }

    /// The high-poly from the sides to look at.
    pub fn high_sides(&self) -> Vec<Rgb> {
        let scene = &self.subject.high.scene;
        SIDES
            .map(|side| self.grey(&scene.render(&HEADLIGHT_BRDF, &camera(side), PICTURE.0, PICTURE.1)))
            .into()
    }

    fn grey(&self, picture: &parbake_render::scene::Picture) -> Rgb {
        tonemapped(picture, &self.subject.high.conventions.display, GREY)
    }

    /// The next variant, unless it shall stop: half a fit would be no fair comparison.
    pub fn next<M: Stored>(
        &self,
        name: &str,
        map: impl FnOnce() -> M,
        watcher: &dyn Watcher,
    ) -> Option<(VariantFigures, Vec<Rgb>)> {
        let variant = (!watcher.stopped()).then(|| self.variant(name, map(), watcher));
        variant.filter(|_| !watcher.stopped())
    }

    /// Fits a map, keeps it, solves for textures, and looks at the result.
    pub fn variant<M: Stored>(
        &self,
        name: &str,
        map: M,
        watcher: &dyn Watcher,
    ) -> (VariantFigures, Vec<Rgb>) {
        let (since, options) = (Instant::now(), self.options);
        let Subject { low, start, .. } = self.subject;
        let comparison = self.subject.comparison();
        let display = &comparison.display;
        let fit = options.fit();
        let stays = map.is_height() && self.subject.heights.is_some();
        let mut state = State { map, maps: self.begin.clone() };
        let losses = match stays || state.map.parameters().is_empty() {
            true => Vec::new(),
            false => fit_parallax_of::<_, _, _, FITTED>(
                comparison.backend,
                &self.views,
                &mut state,
                comparison.brdf,
                &DisplayTable::new(display),
                &fit,
                watcher,
            ),
        };
        let (map, cost) = state.map.stored();
        let samples = shifted_samples(&self.views, options.texture_size, &map, watcher);
        let fitted =
            fit_textures(&samples, &low.atlas, &start.maps, &comparison, &options.schedule(), watcher);
        drop(samples);
        let seconds = since.elapsed().as_secs_f64();

        let look = Look::new(&low.placed, image(&fitted, 0), image(&fitted, 1), comparison.srgb, map);
        let (size, supersample) = (self.evaluate.resolution, self.evaluate.supersample);
        let views: Vec<_> = (self.wanted.iter())
            .map(|(camera, wanted)| {
                let picture = tonemapped(&look.render(camera, size, supersample), display, [0.0; 3]);
                compare_pictures(wanted, &picture, Metrics { ms_ssim: true, flip: false })
            })
            .collect();
        let figures = mean_figures(&views);
        let average = |losses: &[f64]| losses.iter().sum::<f64>() / losses.len().max(1) as f64;
        let few = REPORTED.min(losses.len());
        let fitted = [average(&losses[..few]), average(&losses[losses.len() - few..])];
        let figures = VariantFigures {
            name: name.into(),
            psnr: figures.psnr,
            ms_ssim: figures.ms_ssim,
            fitted: (few > 0).then_some(fitted),
            bytes: cost.bytes,
            places: cost.places,
            fetches: cost.fetches,
            seconds,
        };
        let sides = SIDES.map(|side| self.grey(&look.render(&camera(side), PICTURE.0, PICTURE.1)));
        (figures, sides.into())
    }
}

/// Base colour and normal, in this order, which every bake fits.
fn image(fitted: &Fitted, index: usize) -> &Image {
    &fitted.images[index].1
}

fn camera(([azimuth, height], half_width): ([f32; 2], f32)) -> Camera {
    let (azimuth, height) = (azimuth.to_radians(), height.to_radians());
    let direction = Vec3::new(height.cos() * azimuth.sin(), height.sin(), height.cos() * azimuth.cos());
    Camera::towards_origin(direction, RIG.radius, Projection::Perspective(half_width))
}
