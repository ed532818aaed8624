//! Variable projection: texture coordinates move so that what is left *after the best
//! texture for them* becomes least (Golub and Pereyra 1973).
//!
//! `E(U) = min_T R(U, T) / R₀ + μ D(U) / 4 + contact`, R the samples' weighted squared
//! error, R₀ its value at the start, D the symmetric Dirichlet energy of the triangles
//! relative to their shapes at the start (4 where nothing moved). At the best texture the
//! derivative of R for T is zero, so its derivative for U is the explicit one.
//!
//! The texture is kept between evaluations as the next solve's start: the only state,
//! and it decides how long a solve takes, not what it finds.

use crate::best_texture::{Mapped, Solve, Texture, best_texture};
use crate::contact::Contact;
use crate::descent::Objective;
use crate::distortion::Distortion;
use crate::residual::residual;
use glam::DVec2;

/// The objective.
pub struct VariableProjection<'a> {
    /// What is mapped; its points are those of the start.
    pub mapped: Mapped<'a>,
    /// The best texture found last.
    pub texture: Texture,
    /// Holds triangles open.
    pub distortion: &'a Distortion,
    /// μ: weight of the distortion.
    pub distortion_weight: f64,
    /// Holds charts apart.
    pub contact: Option<&'a Contact>,
    /// Weight of the contact barrier.
    pub contact_weight: f64,
    /// How exactly textures are solved for.
    pub solve: Solve,
    /// 1 / R₀.
    pub scale: f64,
}

impl Objective for VariableProjection<'_> {
    fn evaluate(&mut self, points: &[DVec2], gradient: &mut [DVec2]) -> f64 {
        gradient.fill(DVec2::ZERO);
        let mapped = Mapped { points, ..self.mapped };
        let start = std::mem::take(&mut self.texture);
        self.texture = best_texture(&mapped, start, &self.solve);
        let left = residual(&mapped, &self.texture, gradient);
        let error = left.iter().map(|r| r.error).sum::<f64>() * self.scale;
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
        error + distortion + contact
    }
}
