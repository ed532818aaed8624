//! A small network in the place of a map: what freer functions of place and direction could
//! reach (Knodt et al. 2023, Fig. 19). For comparison; no file holds one.
//!
//! Forward: `t' = t + s / max(|n·d|, limit) · W₃ φ(W₂ φ(W₁ x))` with φ a leaky rectifier and
//! x = (v, sin 2π2ᵏt, cos 2π2ᵏt for k < [`OCTAVES`], 1): the direction in the tangent frame,
//! and the coordinate as Fourier features (Tancik et al. 2020). Hidden layers have a constant
//! of their own beside them.
//! Adjoint: of the weights, by back-propagation; the rectifier's kink has the slope of its
//! upper side.

use super::shift_map::{ShiftMap, TangentView};
use parbake_model::glam::{Vec2, Vec4};
use std::f32::consts::TAU;

/// Frequencies of the coordinate: 1 to 2⁵ waves a texture width.
pub const OCTAVES: usize = 6;
/// Numbers that go in: direction, sines and cosines of both coordinates, a constant.
const INPUTS: usize = 3 + 4 * OCTAVES + 1;
/// Lanes of a hidden layer of 32.
const LANES: usize = 8;
const HIDDEN: usize = 4 * LANES;
/// Columns of W₂: the first hidden layer and a constant.
const INNER: usize = HIDDEN + 1;
/// Where W₂ and W₃ begin; W₃ is two rows, then a constant for each.
const SECOND: usize = INPUTS * LANES;
const THIRD: usize = SECOND + INNER * LANES;
const WEIGHTS: usize = THIRD + 2 * LANES + 1;
/// Slope of the rectifier below 0.
const LEAK: f32 = 0.1;

type Hidden = [Vec4; LANES];

/// The network.
#[derive(Clone, Debug, PartialEq)]
pub struct NeuralParallax {
    /// W₁, W₂ and W₃; the first two column by column.
    weights: Vec<Vec4>,
    /// Texture widths that an output of 1 spans, > 0.
    pub scale: f32,
    /// The least |n·d| that the shift is divided by, > 0.
    pub limit: f32,
}

/// What went through the layers for one sample.
struct Passed {
    input: [f32; INPUTS],
    first: Hidden,
    second: Hidden,
    output: Vec2,
}

/// SplitMix64 (Steele et al. 2014), −1 … 1.
fn random(seed: u64) -> f32 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 40) as f32 / (1u64 << 23) as f32 - 1.0
}

fn rectified(x: Vec4) -> Vec4 {
    x.max(x * LEAK)
}

/// The rectifier's slope, read off what came out of it.
fn slope(y: Vec4) -> Vec4 {
    Vec4::select(y.cmpge(Vec4::ZERO), Vec4::ONE, Vec4::splat(LEAK))
}

impl Default for NeuralParallax {
    /// Hidden layers of even spread (He et al. 2015), the same on every run; shifts are 0.
    fn default() -> Self {
        let spread = |columns: usize| (6.0 / columns as f32).sqrt();
        let weight = |i: usize| match i {
            i if i < 4 * SECOND => random(i as u64) * spread(INPUTS),
            i if i < 4 * THIRD => random(i as u64) * spread(INNER),
            _ => 0.0,
        };
        let weights = (0..WEIGHTS).map(|w| Vec4::from(std::array::from_fn(|k| weight(4 * w + k)))).collect();
        Self { weights, scale: 1e-2, limit: 0.25 }
    }
}

impl NeuralParallax {
    /// Numbers that a file would have to hold.
    pub const NUMBERS: usize = 4 * WEIGHTS - 2;

    fn input(uv: Vec2, from: &TangentView) -> [f32; INPUTS] {
        let mut input = [1.0; INPUTS];
        input[..3].copy_from_slice(&from.tangent.to_array());
        let ((mut su, mut cu), (mut sv, mut cv)) = ((uv.x * TAU).sin_cos(), (uv.y * TAU).sin_cos());
        for features in input[3..INPUTS - 1].chunks_exact_mut(4) {
            features.copy_from_slice(&[su, cu, sv, cv]);
            // The double angle.
            (su, cu) = (2.0 * su * cu, 1.0 - 2.0 * su * su);
            (sv, cv) = (2.0 * sv * cv, 1.0 - 2.0 * sv * sv);
        }
        input
    }

    /// A column of W₁ or W₂.
    #[inline]
    fn column(weights: &[Vec4], start: usize, i: usize) -> &[Vec4] {
        &weights[start + i * LANES..start + (i + 1) * LANES]
    }

    fn layer(&self, start: usize, input: impl Iterator<Item = f32>) -> Hidden {
        let mut sum = [Vec4::ZERO; LANES];
        for (i, x) in input.enumerate() {
            for (sum, w) in sum.iter_mut().zip(Self::column(&self.weights, start, i)) {
                *sum += *w * x;
            }
        }
        sum.map(rectified)
    }

    fn pass(&self, uv: Vec2, from: &TangentView) -> Passed {
        let input = Self::input(uv, from);
        let first = self.layer(0, input.into_iter());
        let second = self.layer(SECOND, with_constant(&first));
        let row = |r: usize| -> f32 {
            (second.iter().zip(Self::column(&self.weights, THIRD, r))).map(|(h, w)| h.dot(*w)).sum()
        };
        let constants = self.weights[WEIGHTS - 1];
        Passed { input, first, second, output: Vec2::new(row(0) + constants.x, row(1) + constants.y) }
    }

    fn steepness(&self, from: &TangentView) -> f32 {
        self.scale / from.view_direction.cosine.abs().max(self.limit)
    }
}

/// A hidden layer's values and the constant beside them.
fn with_constant(hidden: &Hidden) -> impl Iterator<Item = f32> {
    hidden.iter().flat_map(|h| h.to_array()).chain([1.0])
}

/// Adds the gradient of a layer's weights.
fn add_outer(into: &mut [Vec4], input: impl Iterator<Item = f32>, to_sum: &Hidden) {
    for (column, x) in into.chunks_exact_mut(LANES).zip(input) {
        for (to, g) in column.iter_mut().zip(to_sum) {
            *to += *g * x;
        }
    }
}

impl ShiftMap for NeuralParallax {
    fn shift(&self, uv: Vec2, from: &TangentView) -> Vec2 {
        self.pass(uv, from).output * self.steepness(from)
    }

    fn adjoint_of_maps(&self, uv: Vec2, from: &TangentView, to_shift: Vec2, into: &mut Self) {
        let Passed { input, first, second, .. } = self.pass(uv, from);
        let to_output = to_shift * self.steepness(from);
        let [row_u, row_v] = [0, 1].map(|r| Self::column(&self.weights, THIRD, r));
        let to_second: Hidden =
            std::array::from_fn(|j| (row_u[j] * to_output.x + row_v[j] * to_output.y) * slope(second[j]));
        let mut to_first = [Vec4::ZERO; LANES];
        for (j, to) in to_first.iter_mut().enumerate() {
            let sum = |k: usize| -> f32 {
                let column = Self::column(&self.weights, SECOND, 4 * j + k);
                column.iter().zip(&to_second).fold(Vec4::ZERO, |sum, (w, g)| sum + *w * *g).element_sum()
            };
            *to = Vec4::new(sum(0), sum(1), sum(2), sum(3)) * slope(first[j]);
        }
        add_outer(&mut into.weights[..SECOND], input.into_iter(), &to_first);
        add_outer(&mut into.weights[SECOND..THIRD], with_constant(&first), &to_second);
        for (j, h) in second.into_iter().enumerate() {
            into.weights[THIRD + j] += h * to_output.x;
            into.weights[THIRD + LANES + j] += h * to_output.y;
        }
        into.weights[WEIGHTS - 1] += to_output.extend(0.0).extend(0.0);
    }

    fn zeros_like(&self) -> Self {
        Self { weights: vec![Vec4::ZERO; WEIGHTS], ..*self }
    }

    fn parameters(&self) -> Vec<Vec4> {
        self.weights.clone()
    }

    fn set_parameters(&mut self, lanes: &[Vec4]) {
        for (weight, lane) in self.weights.iter_mut().zip(lanes) {
            *weight = *lane;
        }
    }

    /// Many weights move an output together, so that each moves little: at the usual rate of
    /// 3e-4 texture widths by 3e-3, a usual rate for networks.
    fn rate_scale(&self) -> f32 {
        0.1 / self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::super::shift_map::tests::{noise, test_view, worst_gradient};
    use super::*;

    /// Protects back-propagation through all three layers.
    #[test]
    fn adjoint_matches_central_differences() {
        let mut map = NeuralParallax { scale: 0.3, ..NeuralParallax::default() };
        for (i, weight) in map.weights[THIRD..].iter_mut().enumerate() {
            *weight = Vec4::from(std::array::from_fn(|k| noise(4 * i + k)));
        }
        for i in 0..4 {
            let (uv, from) =
                (Vec2::new(0.5 + 0.4 * noise(5 * i), 0.5 + 0.4 * noise(3 * i + 1)), test_view(i));
            // Which side of its kink each rectifier is on.
            let sides = |m: &NeuralParallax| {
                let passed = m.pass(uv, &from);
                [passed.first, passed.second].map(|h| h.map(|h| h.cmpge(Vec4::ZERO).bitmask()))
            };
            let worst = worst_gradient(&map, uv, &from, 2e-3, |down, up| sides(down) == sides(up));
            assert!(worst < 2e-3, "{i}: {worst}");
        }
    }

    /// Protects the start: nothing is shifted, on every run alike.
    #[test]
    fn it_begins_with_no_shift() {
        let map = NeuralParallax::default();
        assert_eq!(map, NeuralParallax::default());
        assert_eq!(map.shift(Vec2::splat(0.3), &test_view(2)), Vec2::ZERO);
        assert_eq!(NeuralParallax::NUMBERS, 2018);
    }
}
