//! What rendered views say of a surface: their loss and its gradients.
//!
//! Contract: references are of one size and were rendered without jitter. Views are summed in
//! their order, so the results do not depend on the number of threads.

use parbake_image::display::Display;
use parbake_render::background::{Background, Composer};
use parbake_render::gradient_pixels::GradientPixels;
use parbake_render::loss::{Comparison, LossValue, Reference};
use parbake_render::pipeline::{Gradients, View, adjoint, forward};
use parbake_render::surface::{Surface, Textures};
use parbake_solve::random::mixed;
use parbake_views::high_poly::HEADLIGHT_BRDF;
use parbake_views::reference::Reference as Rendered;
use rayon::prelude::*;

/// The views, and how the surface is compared with them.
#[derive(Clone, Copy)]
pub struct Views<'a> {
    /// The high-poly, seen from each of them.
    pub references: &'a [Rendered],
    /// Side of a view in pixels.
    pub size: usize,
    /// How light is shown.
    pub display: Display,
    /// The loss.
    pub comparison: Comparison,
    /// What is behind both.
    pub background: Background,
    /// Whether gradients and losses are those of a quarter of the pixels ([`GradientPixels::Quarter`]), chosen by each view's seed.
    pub reads_a_quarter: bool,
}

/// What some views say.
pub struct Judgement {
    /// Mean over the views, and over the pixels that gradients are of.
    pub loss: LossValue,
    /// Sum over the views.
    pub gradients: Gradients,
}

impl Views<'_> {
    /// Looks from these views, each an index and a seed for its background.
    pub fn look(&self, surface: &Surface, textures: &Textures, views: &[(usize, u64)]) -> Judgement {
        let each: Vec<Judgement> =
            views.par_iter().map(|&(index, seed)| self.look_once(surface, textures, index, seed)).collect();
        let mut sum =
            Judgement { loss: LossValue::default(), gradients: Gradients::zeros(surface, textures, true) };
        for one in each {
            sum.loss.image += one.loss.image / views.len() as f64;
            sum.loss.coverage += one.loss.coverage / views.len() as f64;
            sum.gradients.add(&one.gradients);
        }
        sum
    }

    /// Mean of the pictures' losses alone, over all pixels.
    pub fn picture_loss(&self, surface: &Surface, textures: &Textures, views: &[(usize, u64)]) -> f64 {
        let all = Views { reads_a_quarter: false, ..*self };
        let of = |&(index, seed): &(usize, u64)| {
            all.with_view(index, seed, |view| forward(surface, textures, &HEADLIGHT_BRDF, view).loss.image)
        };
        let each: Vec<f64> = views.par_iter().map(of).collect();
        each.iter().fold(0.0, |sum, loss| sum + loss / views.len() as f64)
    }

    fn look_once(&self, surface: &Surface, textures: &Textures, index: usize, seed: u64) -> Judgement {
        self.with_view(index, seed, |view| {
            let tape = forward(surface, textures, &HEADLIGHT_BRDF, view);
            let mut gradients = Gradients::zeros(surface, textures, true);
            adjoint(surface, textures, &HEADLIGHT_BRDF, view, &tape, &mut gradients);
            Judgement { loss: tape.loss, gradients }
        })
    }

    fn with_view<T>(&self, index: usize, seed: u64, look: impl FnOnce(&View) -> T) -> T {
        let rendered = &self.references[index];
        let composer = Composer::new(self.background.for_view(seed), self.display, self.size);
        let reference = Reference { size: self.size, pixels: rendered.linear() };
        look(&View {
            camera: &rendered.view.camera,
            reference: &reference,
            composer: &composer,
            comparison: self.comparison,
            antialias: true,
            gradient_pixels: match self.reads_a_quarter {
                // Mixed twice: a background is chosen by bits of a seed that is mixed once.
                true => GradientPixels::Quarter(mixed(mixed(seed))),
                false => GradientPixels::All,
            },
        })
    }
}
