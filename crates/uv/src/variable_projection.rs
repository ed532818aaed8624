//! Variable projection: texture coordinates move so that what is left *after the best
//! texture for them* becomes least (Golub and Pereyra 1973).
//!
//! `E(U) = min_T R(U, T) / R₀ + μ D(U) / 4 + contact`, R the samples' weighted squared
//! error, R₀ its value at the start, D the symmetric Dirichlet energy of the triangles
//! relative to their shapes at the start (4 where nothing moved). At the best texture the
//! derivative of R for T is zero, so its derivative for U is the explicit one.
//!
//! That holds at the best texture only. Where a texture is nearly right already, a solve that
//! ends early leaves as much as a move of the points would gain, and the descent stands still:
//! so a solve goes on until its own steps gain next to nothing.
//!
//! What is kept between evaluations is the best place so far: its texture is the next solve's
//! start, since with the texture of a step that went too far a shorter one would look bad too;
//! its error tells what next to nothing is. It decides how long a solve takes, not what it finds.

use crate::contact::Contact;
use crate::descent::Objective;
use crate::distortion::Distortion;
use crate::least_squares_texture::{ParameterizedSignal, Solve, least_squares_texture};
use crate::residual::residual;
use glam::DVec2;
use glam::Vec4;
use parbake_image::FloatImage;

/// The objective.
pub struct VariableProjection<'a> {
    /// What is mapped; its points are those of the start.
    pub mapped: ParameterizedSignal<'a>,
    /// The best place's texture.
    pub texture: FloatImage<Vec4>,
    /// Holds triangles open.
    pub distortion: &'a Distortion,
    /// μ: weight of the distortion.
    pub distortion_weight: f64,
    /// Holds charts apart.
    pub contact: Option<&'a Contact>,
    /// Weight of the contact barrier.
    pub contact_weight: f64,
    /// How exactly textures are solved for, at most.
    pub solve: Solve,
    /// 1 / R₀.
    pub scale: f64,
    /// The best place.
    pub best: Best,
}

/// The best place so far; infinite before anything was evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Best {
    /// The objective there.
    value: f64,
    /// R there.
    error: f64,
}

impl Default for Best {
    fn default() -> Self {
        Self { value: f64::INFINITY, error: f64::INFINITY }
    }
}

/// A solve ends when a step takes less than this share of the error. Three times as much costs
/// pictures at 256² 0.2 dB; three times less gains nothing.
const SETTLED: f64 = 3e-4;

impl Objective for VariableProjection<'_> {
    fn evaluate(&mut self, points: &[DVec2], gradient: &mut [DVec2]) -> f64 {
        gradient.fill(DVec2::ZERO);
        let mapped = ParameterizedSignal { points, ..self.mapped };
        let known = if self.best.error.is_finite() { self.best.error } else { 0.0 };
        let solve = Solve { least_gain: SETTLED * known, ..self.solve };
        let texture = least_squares_texture(&mapped, self.texture.clone(), &solve);
        let left = residual(&mapped, &texture, gradient);
        let error = left.iter().sum::<f64>();
        for g in gradient.iter_mut() {
            *g *= self.scale;
        }
        let weight = 0.25 * self.distortion_weight;
        let distortion = self.distortion.add(points, self.mapped.triangles, weight, gradient);
        let mut contact = 0.0;
        if let Some(barrier) = self.contact {
            let mut push = vec![DVec2::ZERO; points.len()];
            contact = barrier.energy_and_gradient(points, &mut push) * self.contact_weight;
            for (g, p) in gradient.iter_mut().zip(push) {
                *g += p * self.contact_weight;
            }
        }
        let value = error * self.scale + distortion + contact;
        if value < self.best.value {
            self.best = Best { value, error };
            self.texture = texture;
        }
        value
    }
}
