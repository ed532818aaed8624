//! The set: models, lights and where the camera stands in each frame.

use super::TurntableOptions;
use super::layout::{Colors, Layout};
use super::palette::Palette;
use super::sheet::{Sheet, bytes};
use parbake::BakeError;
use parbake::{PlacedModel, Renderer};
use parbake_image::display::{Curve, Display};
use parbake_metric::Rgb;
use parbake_model::Model;
use parbake_model::glam::Vec3;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Frames from which a palette is found, the largest side of their pictures, and their samples: more than
/// one along a side, so that outlines' mixed colours are among them.
const PALETTE_FRAMES: usize = 12;
const PALETTE_SIDE: usize = 192;
const PALETTE_SUPERSAMPLE: usize = 2;

/// Everything that frames are rendered from.
pub(super) struct Set<'a> {
    options: &'a TurntableOptions,
    renderer: Renderer,
    /// A quicker one, which looks for colours.
    scout: Renderer,
    models: Vec<PlacedModel>,
    background: [f32; 3],
    colors: Colors,
    pub layout: Layout,
    blank: Sheet,
}

impl<'a> Set<'a> {
    /// Brings all models in.
    pub fn new(high: &Model, lows: &[&Model], options: &'a TurntableOptions) -> Result<Self, BakeError> {
        let background = options.background()?;
        let renderer = Renderer::new(high, &options.views_of(options.resolution, options.supersample))?;
        let (side, samples) =
            (options.resolution.min(PALETTE_SIDE), options.supersample.min(PALETTE_SUPERSAMPLE));
        let scout = Renderer::new(high, &options.views_of(side, samples))?;
        let models = [&[high], lows].concat().into_iter().map(|model| renderer.place(model)).collect();
        let names: Vec<String> =
            std::iter::once("high-poly".into()).chain(lows.iter().map(|low| low.name.clone())).collect();
        let display = Display { gain: 1.0, curve: Curve::Srgb };
        let colors = Colors::before(bytes(background.map(|light| display.encode(light))));
        let layout = Layout::new(options.resolution, names.len(), !options.no_captions);
        let blank = layout.blank(&colors, &names);
        Ok(Self { options, renderer, scout, models, background, colors, layout, blank })
    }

    /// Frame `index`; the one after the last is the first.
    pub fn frame(&self, index: usize) -> Sheet {
        let mut sheet = self.blank.clone();
        for (column, picture) in self.pictures(&self.renderer, index).enumerate() {
            self.layout.place(&mut sheet, column, &picture);
        }
        sheet
    }

    /// Colours for the whole turn.
    pub fn palette(&self) -> Palette {
        let frames = self.options.frames;
        let count = PALETTE_FRAMES.min(frames);
        let seen: Vec<Vec<[u8; 3]>> = (0..count)
            .into_par_iter()
            .map(|i| {
                let pictures = self.pictures(&self.scout, i * frames / count);
                pictures.flat_map(|picture| picture.pixels).map(bytes).collect()
            })
            .collect();
        Palette::new(&self.colors, &seen.concat())
    }

    fn pictures<'b>(&'b self, renderer: &'b Renderer, index: usize) -> impl Iterator<Item = Rgb> + 'b {
        let direction = self.direction(index);
        self.models.iter().map(move |model| {
            let view = renderer.render(model, direction);
            renderer.tonemap(&view, self.background)
        })
    }

    /// Where the camera stands: in front at first (+Z), then towards +X.
    pub fn direction(&self, index: usize) -> Vec3 {
        let turn = (TAU * index as f64 / self.options.frames as f64) as f32;
        let height = self.options.height.to_radians();
        Vec3::new(height.cos() * turn.sin(), height.sin(), height.cos() * turn.cos())
    }
}
