//! Adam (Kingma and Ba 2015), for the four channels of texels at once.
//!
//! With g the gradient of step t,
//!
//! `m ← β₁ m + (1 − β₁) g`, `v ← β₂ v + (1 − β₂) g²`,
//! `x ← x − r (m / (1 − β₁ᵗ)) / (√(v / (1 − β₂ᵗ)) + ε)`.
//!
//! Each number goes by itself, so the result does not depend on the number of threads.

use glam::Vec4;
use rayon::prelude::*;

/// Numbers of one task.
const BAND: usize = 4096;

/// How it goes; the defaults are those of the original paper but for the rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdamOptions {
    /// r: about how far a number moves in a step, > 0.
    pub rate: f32,
    /// β₁ in [0, 1): how much of the mean gradient is kept.
    pub first_decay: f32,
    /// β₂ in [0, 1): how much of the mean square is kept.
    pub second_decay: f32,
    /// ε > 0, in units of the gradient: gradients well below it move nothing.
    pub epsilon: f32,
}

impl Default for AdamOptions {
    fn default() -> Self {
        Self { rate: 0.01, first_decay: 0.9, second_decay: 0.999, epsilon: 1e-8 }
    }
}

/// Share of the steps that go at the full rate.
const FULL_RATE: f32 = 0.3;

/// The share of its rate at which the step of so many goes: all of it at first, then falling along a cosine to
/// 1/500.
pub fn rate_at(step: usize, steps: usize) -> f32 {
    let t = (step as f32 / steps.max(1) as f32 - FULL_RATE).max(0.0) / (1.0 - FULL_RATE);
    0.002 + 0.998 * 0.5 * (1.0 + (std::f32::consts::PI * t).cos())
}

/// The moments of N values.
#[derive(Clone, Debug)]
pub struct Adam {
    options: AdamOptions,
    steps: i32,
    moments: Vec<[Vec4; 2]>,
}

impl Adam {
    /// For `count` values that have not moved yet.
    pub fn new(count: usize, options: AdamOptions) -> Self {
        Self { options, steps: 0, moments: vec![[Vec4::ZERO; 2]; count] }
    }

    /// Moves the N values against their gradient, with `share` of the rate.
    pub fn step(&mut self, values: &mut [Vec4], gradient: &[Vec4], share: f32) {
        self.steps = self.steps.saturating_add(1);
        let AdamOptions { rate, first_decay, second_decay, epsilon } = self.options;
        let first = rate * share / (1.0 - first_decay.powi(self.steps));
        let second = 1.0 / (1.0 - second_decay.powi(self.steps));
        let bands = values.par_chunks_mut(BAND).zip(gradient.par_chunks(BAND));
        bands.zip(self.moments.par_chunks_mut(BAND)).for_each(|((values, gradient), moments)| {
            for ((value, g), [m, v]) in values.iter_mut().zip(gradient).zip(moments) {
                *m = *m * first_decay + *g * (1.0 - first_decay);
                *v = *v * second_decay + *g * *g * (1.0 - second_decay);
                let root = (*v * second).map(f32::sqrt);
                *value -= *m * first / (root + epsilon);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the bias correction: the first step is as long as the rate, whatever the
    /// gradient's size; a lane without a gradient stays.
    #[test]
    fn the_first_step_has_the_rate() {
        let mut adam = Adam::new(1, AdamOptions::default());
        let mut x = [Vec4::ZERO];
        adam.step(&mut x, &[Vec4::new(1e-3, -5.0, 0.0, 40.0)], 1.0);
        let want = Vec4::new(-0.01, 0.01, 0.0, -0.01);
        assert!((x[0] - want).abs().max_element() < 1e-6);
    }

    /// Protects the method: a quadratic's minimum is found in all lanes.
    #[test]
    fn a_quadratic_is_minimised() {
        let (stiffness, minimum) = (Vec4::new(0.1, 1.0, 10.0, 100.0), Vec4::new(0.3, -0.2, 0.7, 0.0));
        let mut adam = Adam::new(2, AdamOptions::default());
        let mut x = [Vec4::ONE, Vec4::ZERO];
        for step in 0..1000 {
            let gradient = x.map(|x| (x - minimum) * stiffness);
            adam.step(&mut x, &gradient, 1.0 - step as f32 / 1000.0);
        }
        for x in x {
            assert!((x - minimum).abs().max_element() < 1e-3, "{x}");
        }
    }
}
