//! What one step of the texture coordinates minimises while the texture stands still.
//!
//! `E(U) = Σₜ Aₜ (λ_uv Dₜ + λ_I (eₜ⁰ Dₜ + Dₜ⁰ eₜ)) + λ_IPC · contact`
//!
//! with `Dₜ = s² ‖J‖² + ‖J⁻¹‖² / s²`, J the map from the rest shape to the texture, eₜ the mean
//! squared image error in triangle t, and ⁰ for what it is where the step begins. The
//! content-aware term (paper, section 4.1) is `Σ Aₜ eₜ Dₜ`; section 4.4 prints its gradient as
//! a product rule, whose two parts are those of the bracket. In words it holds eₜ, which is
//! the first part alone; [`Guide`] has both readings. Without the term the bracket is the
//! image loss L_diff itself.

use super::texture_loss::TextureLoss;
use super::{Guide, PaperOptions, PaperPoint};
use crate::contact::Contact;
use crate::descent::Objective;
use crate::distortion::Distortion;
use crate::least_squares_texture::ParameterizedSignal;
use crate::residual::{residual, residual_by_triangle};
use crate::signal::Signal;
use glam::Vec4;
use glam::{DMat2, DVec2};
use parbake_image::FloatImage;
use std::borrow::Cow;

/// What stays the same in all steps.
pub(super) struct Problem<'a> {
    mapped: ParameterizedSignal<'a>,
    signal: &'a Signal,
    rest: &'a [DMat2],
    contact: Option<(&'a Contact, f64)>,
    options: &'a PaperOptions,
    /// W C: all that the squared error is a mean over…
    mean_over: f64,
    /// …and each triangle's part of it, at least a little.
    triangle_mean_over: Vec<f64>,
}

/// The energy of one step.
pub(super) struct StepEnergy<'a> {
    problem: &'a Problem<'a>,
    distortion: Distortion,
    /// The texture, and the samples with their weights in the energy.
    image: Option<(&'a FloatImage<Vec4>, Cow<'a, Signal>, f64)>,
}

impl<'a> Problem<'a> {
    /// `mapped` has one scale, `signal`, without mip levels.
    pub fn new(
        mapped: ParameterizedSignal<'a>,
        signal: &'a Signal,
        rest: &'a [DMat2],
        contact: Option<&'a Contact>,
        size: usize,
        options: &'a PaperOptions,
    ) -> Self {
        let channels = f64::from(options.channels.max(1));
        let weight = |t| signal.of(t).iter().map(|s| f64::from(s.weight)).sum::<f64>();
        let triangle_mean_over: Vec<f64> =
            (0..mapped.triangles.len()).map(|t| (channels * weight(t)).max(f64::MIN_POSITIVE)).collect();
        // With r = gap / d₀, ours is d₀ f(r) in texels, the paper's is d₀² f(r) in squares.
        let unit = options.contact_texels / (size * size) as f64;
        let contact = contact.map(|contact| (contact, options.contact_weight * unit));
        let mean_over = triangle_mean_over.iter().sum();
        Self { mapped, signal, rest, contact, options, mean_over, triangle_mean_over }
    }

    /// L_diff for a texture of size² texels.
    pub fn loss(&self, points: &[DVec2], size: usize) -> TextureLoss {
        TextureLoss::new(&ParameterizedSignal { points, ..self.mapped }, size, self.mean_over)
    }

    /// L_diff; overwrites `errors` with eₜ of all triangles.
    pub fn errors(&self, points: &[DVec2], texture: &FloatImage<Vec4>, errors: &mut [f64]) -> f64 {
        let mapped = ParameterizedSignal { points, ..self.mapped };
        let left = residual_by_triangle(&mapped, texture);
        for ((error, part), mean_over) in errors.iter_mut().zip(&left).zip(&self.triangle_mean_over) {
            *error = part / mean_over;
        }
        left.iter().sum::<f64>() / self.mean_over
    }

    /// L_diff and L_I∘UV after so many iterations; overwrites `errors` with eₜ of all triangles.
    pub fn point(
        &self,
        iteration: usize,
        points: &[DVec2],
        texture: &FloatImage<Vec4>,
        errors: &mut [f64],
    ) -> PaperPoint {
        let loss = self.errors(points, texture, errors);
        let distortion = Distortion::symmetric_dirichlet(self.rest, self.options.scale, |_| 1.0);
        let content = (distortion.elements.iter().zip(self.mapped.triangles).zip(errors.iter()))
            .map(|((element, corners), error)| {
                let [a, b, c] = corners.map(|i| points[i as usize]);
                if element.area > 0.0 {
                    error * element.evaluate(DMat2::from_cols(b - a, c - a)).0
                } else {
                    0.0
                }
            })
            .sum();
        PaperPoint { iteration, loss, content }
    }

    /// The energy of a step from `points`, with the errors and the texture there.
    pub fn energy(
        &'a self,
        points: &[DVec2],
        texture: &'a FloatImage<Vec4>,
        errors: &[f64],
    ) -> StepEnergy<'a> {
        let PaperOptions { guide, content_weight, distortion_weight, scale, .. } = *self.options;
        let held = if guide == Guide::ImageLoss { 0.0 } else { content_weight };
        let distortion =
            Distortion::symmetric_dirichlet(self.rest, scale, |t| distortion_weight + held * errors[t]);
        let image = match guide {
            Guide::ImageLoss => Some((texture, Cow::Borrowed(self.signal), 1.0 / self.mean_over)),
            Guide::ContentAware => Some((texture, Cow::Owned(self.distorted(points)), content_weight)),
        };
        StepEnergy { problem: self, distortion, image }
    }

    /// The samples, weighted so that their squared error is `Σ Aₜ Dₜ eₜ` with Dₜ at `points`.
    fn distorted(&self, points: &[DVec2]) -> Signal {
        let plain = Distortion::symmetric_dirichlet(self.rest, self.options.scale, |_| 1.0);
        let mut signal = self.signal.clone();
        for (t, (element, corners)) in plain.elements.iter().zip(self.mapped.triangles).enumerate() {
            let [a, b, c] = corners.map(|i| points[i as usize]);
            let edges = DMat2::from_cols(b - a, c - a);
            let energy = if element.area > 0.0 { element.evaluate(edges).0 } else { 0.0 };
            let factor = (energy / self.triangle_mean_over[t]) as f32;
            let range = signal.first[t] as usize..signal.first[t + 1] as usize;
            signal.samples[range].iter_mut().for_each(|sample| sample.weight *= factor);
        }
        signal
    }
}

impl Objective for StepEnergy<'_> {
    fn evaluate(&mut self, points: &[DVec2], gradient: &mut [DVec2]) -> f64 {
        gradient.fill(DVec2::ZERO);
        let problem = self.problem;
        let mut energy = 0.0;
        // Those with a factor come first, since they scale what is there.
        if let Some((texture, signal, weight)) = &self.image {
            let signal_scales = std::slice::from_ref(signal.as_ref());
            let mapped = ParameterizedSignal { points, signal_scales, ..problem.mapped };
            energy += weight * residual(&mapped, texture, gradient).iter().sum::<f64>();
            gradient.iter_mut().for_each(|g| *g *= *weight);
        }
        if let Some((contact, weight)) = problem.contact {
            let mut push = vec![DVec2::ZERO; points.len()];
            energy += weight * contact.energy_and_gradient(points, &mut push);
            for (g, push) in gradient.iter_mut().zip(push) {
                *g += weight * push;
            }
        }
        energy + self.distortion.add(points, problem.mapped.triangles, 1.0, gradient)
    }
}
