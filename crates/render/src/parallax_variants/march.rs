//! The march of steep parallax mapping and of parallax occlusion mapping.
//!
//! Forward (Table 1, Knodt et al. 2023; "we multiply translation by a function of depth
//! (depth/#layers), so that it can be optimized"), with k layers and p where a height of 1
//! is met:
//!
//! `t_0 = t`, `t_{i+1} = t_i + p h(t_i) / k` while `h(t_i) > i / k`
//!
//! ends at the first layer n that the surface lies above; steep parallax takes t_n. Occlusion
//! mapping draws a line between the last two layers: with `a = h(t_{n−1}) − (n−1)/k` below
//! the surface's and `b = n/k − h(t_n)` above it, `t' = t_{n−1} + (t_n − t_{n−1}) a / (a + b)`.
//!
//! Adjoint: n is held, since a shift jumps where it changes; all heights on the way are
//! differentiated, and so are the places where they were fetched.

use super::heights::Heights;
use parbake_image::FloatImage;
use parbake_model::glam::Vec2;

/// Layers that marches go through, as in the paper.
pub const LAYERS: usize = 16;
/// Height of a layer.
const STEP: f32 = 1.0 / LAYERS as f32;
/// a + b is no less: a line through two layers that nearly agree could lead anywhere.
const LEAST: f32 = 0.1 * STEP;

/// One march.
pub(super) struct March {
    /// Shift for a height of 1.
    full: Vec2,
    /// t_0 … t_n.
    places: [Vec2; LAYERS + 1],
    /// h at t_0 … t_n.
    heights: [f32; LAYERS + 1],
    /// n.
    last: usize,
    /// Whether the last two layers are joined by a line.
    line: bool,
}

impl March {
    /// Goes from `uv` along `full`.
    pub fn new(map: &Heights, uv: Vec2, full: Vec2, line: bool) -> Self {
        let mut march = Self { full, places: [uv; LAYERS + 1], heights: [0.0; LAYERS + 1], last: 0, line };
        march.heights[0] = map.at(uv);
        while march.last < LAYERS && march.heights[march.last] > march.last as f32 * STEP {
            let i = march.last;
            march.places[i + 1] = march.places[i] + full * (march.heights[i] * STEP);
            march.heights[i + 1] = map.at(march.places[i + 1]);
            march.last += 1;
        }
        march
    }

    /// a and b, where there is a line between two layers.
    fn ends(&self) -> Option<(f32, f32)> {
        let n = self.last;
        let above = n as f32 * STEP - self.heights[n];
        (self.line && n > 0 && above > 0.0).then(|| (self.heights[n - 1] - (n - 1) as f32 * STEP, above))
    }

    /// From the first place to where the surface is met.
    pub fn shift(&self) -> Vec2 {
        let n = self.last;
        let whole = self.places[n] - self.places[0];
        self.ends().map_or(whole, |(a, b)| {
            let before = self.places[n - 1] - self.places[0];
            before.lerp(whole, a / (a + b).max(LEAST))
        })
    }

    /// Adds the gradients of the heights.
    pub fn adjoint(&self, map: &Heights, to_shift: Vec2, into: &mut FloatImage<[f32; 1]>) {
        let mut n = self.last;
        let mut to_place = to_shift;
        if let Some((a, b)) = self.ends() {
            let sum = (a + b).max(LEAST);
            let along = (self.places[n] - self.places[n - 1]).dot(to_shift);
            let [to_a, to_b] = match a + b > LEAST {
                true => [b / (sum * sum), -a / (sum * sum)].map(|d| d * along),
                false => [along / sum, 0.0],
            };
            let at = map.taps(self.places[n]);
            into.scatter(&at, &[-to_b]);
            // t_n counts by its share in the line, and by where b was fetched.
            let to_last = to_shift * (a / sum) + map.level.uv_adjoint(&at, &[-to_b]);
            to_place = to_shift * (1.0 - a / sum) + to_last;
            let to_height = to_a + self.full.dot(to_last) * STEP;
            n -= 1;
            self.fetched(map, n, &mut to_place, to_height, into);
        }
        for i in (0..n).rev() {
            let to_height = self.full.dot(to_place) * STEP;
            self.fetched(map, i, &mut to_place, to_height, into);
        }
    }

    /// Takes the gradient of h(t_i) to the texels and to t_i.
    fn fetched(
        &self,
        map: &Heights,
        i: usize,
        to_place: &mut Vec2,
        to_height: f32,
        into: &mut FloatImage<[f32; 1]>,
    ) {
        let at = map.taps(self.places[i]);
        into.scatter(&at, &[to_height]);
        *to_place += map.level.uv_adjoint(&at, &[to_height]);
    }
}

#[cfg(test)]
impl March {
    /// What a small change of heights must leave alone for the shift to be smooth: the layer of
    /// the end, the kinks of the line, and the texels of each fetch.
    pub fn path(&self, map: &Heights) -> (usize, [bool; 2], Vec<[u32; 4]>) {
        let kinks = self.ends().map_or([false; 2], |(a, b)| [true, a + b > LEAST]);
        (self.last, kinks, self.places[..=self.last].iter().map(|&t| map.taps(t).index).collect())
    }
}
