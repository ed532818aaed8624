//! What makes the values of a map change evenly from texel to texel: a thin plate, which resists
//! bending. A membrane resists slopes too, which maps that follow an outline or a fold need.
//!
//! Energy: `½ k Σ |x₋ − 2 x₀ + x₊|²` over all three texels in a row or a column that all count.
//! Gradient: the same second difference of the second differences. A ramp has neither.
//!
//! Contract: texels that do not count neither move nor hold others; the result does not depend on
//! the number of threads.

use rayon::prelude::*;

/// The texels that a plate lies on.
#[derive(Clone, Debug)]
pub struct ThinPlate {
    /// Texels along u.
    width: usize,
    /// Which count, width × height, row 0 on top.
    counted: Vec<bool>,
}

impl ThinPlate {
    /// A plate on those of width × height texels that count.
    pub fn new(width: usize, counted: Vec<bool>) -> Self {
        Self { width, counted }
    }

    /// Adds the energy's gradient, k being `stiffness`. `values` has as many values for each of the
    /// width × height texels, one texel after the other, and `gradient` its length; a rest too short for
    /// another value in each texel is padding.
    pub fn add_gradient(&self, values: &[f32], stiffness: f32, gradient: &mut [f32]) {
        let texels = self.counted.len();
        let each = values.len() / texels.max(1);
        if each == 0 {
            return;
        }
        for step in [1, self.width] {
            let bends = self.bends(values, each, step);
            gradient.par_chunks_mut(each).enumerate().for_each(|(texel, into)| {
                let neighbours = [texel.checked_sub(step), Some(texel), Some(texel + step)];
                for (other, share) in neighbours.into_iter().zip([1.0, -2.0, 1.0]) {
                    let bends = other.and_then(|t| bends.get(t * each..(t + 1) * each)).unwrap_or_default();
                    into.iter_mut().zip(bends).for_each(|(to, bend)| *to += stiffness * share * bend);
                }
            });
        }
    }

    /// `x₋ − 2 x₀ + x₊` at each texel, 0 where one of the three does not count; neighbours are a
    /// `step` apart, 1 along u and the width along v.
    fn bends(&self, values: &[f32], each: usize, step: usize) -> Vec<f32> {
        let of = |texel: usize| &values[texel * each..(texel + 1) * each];
        let mut bends = vec![0.0; values.len()];
        bends.par_chunks_mut(each).enumerate().for_each(|(texel, bends)| {
            let u = texel % self.width;
            let inside = step != 1 || (u > 0 && u + 1 < self.width);
            let Some(before) = texel.checked_sub(step).filter(|_| inside) else { return };
            let counts = |t: usize| self.counted.get(t).copied().unwrap_or(false);
            if [before, texel, texel + step].into_iter().all(counts) {
                let ends = of(before).iter().zip(of(texel + step));
                for ((bend, middle), (a, c)) in bends.iter_mut().zip(of(texel)).zip(ends) {
                    *bend = a - 2.0 * middle + c;
                }
            }
        });
        bends
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 4;
    const HEIGHT: usize = 5;

    fn plate() -> ThinPlate {
        ThinPlate::new(WIDTH, (0..WIDTH * HEIGHT).map(|t| t != 9).collect())
    }

    fn gradient(values: &[f32]) -> Vec<f32> {
        let mut gradient = vec![0.0; values.len()];
        plate().add_gradient(values, 0.3, &mut gradient);
        gradient
    }

    /// Protects the gradient by central differences of the energy, at the map's edges and beside a
    /// texel that does not count.
    #[test]
    fn the_gradient_is_the_energys() {
        let mut values: Vec<f32> = (0..2 * WIDTH * HEIGHT).map(|i| ((7 * i) % 11) as f32 * 0.1).collect();
        let energy = |values: &[f32]| -> f64 {
            let value = |u: usize, v: usize, k: usize| f64::from(values[2 * (v * WIDTH + u) + k]);
            let mut sum = 0.0;
            for (u, v) in (0..WIDTH).flat_map(|u| (0..HEIGHT).map(move |v| (u, v))) {
                let along_u = (u + 2 < WIDTH).then(|| [(u, v), (u + 1, v), (u + 2, v)]);
                let along_v = (v + 2 < HEIGHT).then(|| [(u, v), (u, v + 1), (u, v + 2)]);
                for three in [along_u, along_v].into_iter().flatten() {
                    if three.iter().all(|&(u, v)| v * WIDTH + u != 9) {
                        for k in 0..2 {
                            let [a, b, c] = three.map(|(u, v)| value(u, v, k));
                            sum += (a - 2.0 * b + c).powi(2);
                        }
                    }
                }
            }
            0.5 * 0.3 * sum
        };
        let slopes = gradient(&values);
        for i in 0..values.len() {
            let was = values[i];
            let mut at = |step: f32| {
                values[i] = was + step;
                energy(&values)
            };
            let difference = (at(0.01) - at(-0.01)) / 0.02;
            values[i] = was;
            assert!((f64::from(slopes[i]) - difference).abs() < 1e-3, "{i}: {} {difference}", slopes[i]);
        }
        assert_eq!(slopes[18..20], [0.0, 0.0]);
    }

    /// Protects what a plate is for: a ramp, which a membrane would flatten, is left alone.
    #[test]
    fn a_ramp_does_not_bend() {
        let ramp: Vec<f32> =
            (0..WIDTH * HEIGHT).map(|i| (i % WIDTH) as f32 * 0.5 - (i / WIDTH) as f32).collect();
        assert!(gradient(&ramp).iter().all(|g| g.abs() < 1e-6));
    }

    /// Protects maps without texels or values.
    #[test]
    fn nothing_has_no_gradient() {
        ThinPlate::new(0, Vec::new()).add_gradient(&[], 1.0, &mut []);
        ThinPlate::new(2, vec![true; 4]).add_gradient(&[], 1.0, &mut []);
    }
}
