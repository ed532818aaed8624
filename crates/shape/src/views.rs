//! What rendered views say of a surface: their loss, its gradients, and where on the surface
//! the errors lie.
//!
//! Contract: references are of one size and were rendered without jitter. Views are summed in
//! their order, so the results do not depend on the number of threads.

use parbake_fit::reference::Reference as Rendered;
use parbake_render::background::{Background, Composer};
use parbake_render::display::Display;
use parbake_render::loss::{Comparison, LossValue, Reference};
use parbake_render::pipeline::{Gradients, Tape, View, adjoint, forward};
use parbake_render::raster::NOTHING;
use parbake_render::shade::Lambert;
use parbake_render::surface::{Surface, Textures};
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
}

/// What some views say.
pub struct Judgement {
    /// Mean over the views.
    pub loss: LossValue,
    /// Sum over the views.
    pub gradients: Gradients,
    /// F sums of the squared differences of the pixels that show each triangle, and their
    /// numbers.
    pub by_triangle: Vec<[f64; 2]>,
}

impl Views<'_> {
    /// Looks from these views, each an index and a seed for its background.
    pub fn look(&self, surface: &Surface, textures: &Textures, views: &[(usize, u64)]) -> Judgement {
        let each: Vec<Judgement> =
            views.par_iter().map(|&(index, seed)| self.look_once(surface, textures, index, seed)).collect();
        let mut sum = Judgement {
            loss: LossValue::default(),
            gradients: Gradients::zeros(surface, textures, true),
            by_triangle: vec![[0.0; 2]; surface.triangles.len()],
        };
        for one in each {
            sum.loss.image += one.loss.image / views.len() as f64;
            sum.loss.coverage += one.loss.coverage / views.len() as f64;
            sum.gradients.add(&one.gradients);
            for (sum, one) in sum.by_triangle.iter_mut().zip(one.by_triangle) {
                *sum = [sum[0] + one[0], sum[1] + one[1]];
            }
        }
        sum
    }

    fn look_once(&self, surface: &Surface, textures: &Textures, index: usize, seed: u64) -> Judgement {
        let rendered = &self.references[index];
        let composer = Composer::new(self.background.for_view(seed), self.display, self.size);
        let rgba: Vec<[f32; 4]> = rendered.pixels.iter().map(|p| p.map(f32::from)).collect();
        let reference = Reference::new(&rgba, self.size, &composer);
        let view = View {
            camera: &rendered.view.camera,
            reference: &reference,
            composer: &composer,
            comparison: self.comparison,
            antialias: true,
        };
        let tape = forward(surface, textures, &Lambert, &view);
        let mut gradients = Gradients::zeros(surface, textures, true);
        adjoint(surface, textures, &Lambert, &view, &tape, &mut gradients);
        let by_triangle = errors_by_triangle(&tape, &reference, &composer, surface.triangles.len());
        Judgement { loss: tape.loss, gradients, by_triangle }
    }
}

fn errors_by_triangle(
    tape: &Tape,
    reference: &Reference,
    composer: &Composer,
    triangles: usize,
) -> Vec<[f64; 2]> {
    let mut sums = vec![[0.0; 2]; triangles];
    let pixels = tape.seen.triangle.iter().zip(tape.rgba.iter().zip(&reference.pixels));
    for (pixel, (&triangle, (rgba, wanted))) in pixels.enumerate() {
        if triangle == NOTHING {
            continue;
        }
        let shown = composer.forward(rgba, pixel % reference.size, pixel / reference.size).value;
        let square: f32 =
            shown.iter().zip(&wanted[..3]).map(|(x, y)| (x.min(1.0) - y.min(1.0)).powi(2)).sum();
        let sum = &mut sums[triangle as usize];
        *sum = [sum[0] + f64::from(square / 3.0), sum[1] + 1.0];
    }
    sums
}
