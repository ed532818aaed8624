//! The Laplacian term of earlier differentiable renderers, for comparison (Luan et al. 2021;
//! NV* in Knodt et al. 2023, Table 11): vertices may go anywhere, but what their
//! neighbourhood looks like is held.
//!
//! With Δ the uniform Laplacian, `(Δ p)_i = p_i − mean of i's neighbours`, and d = p − rest,
//! the energy is the mean over points of `‖(Δ d)_i‖²`. Adjoint: `2 Δᵀ Δ d / P`.
//!
//! Contract: neighbours are those of the welded points; a point without any has no term.

use glam::Vec3;
use std::collections::BTreeSet;

/// Who is whose neighbour.
#[derive(Clone, Debug)]
pub struct Laplacian {
    neighbours: Vec<Vec<u32>>,
}

impl Laplacian {
    /// From triangles of `count` points.
    pub fn new(count: usize, triangles: &[[u32; 3]]) -> Self {
        let mut sets = vec![BTreeSet::new(); count];
        for &[a, b, c] in triangles {
            for (p, q) in [(a, b), (b, c), (c, a)].into_iter().filter(|(p, q)| p != q) {
                sets[p as usize].insert(q);
                sets[q as usize].insert(p);
            }
        }
        Self { neighbours: sets.into_iter().map(|set| set.into_iter().collect()).collect() }
    }

    fn apply(&self, d: &[Vec3]) -> Vec<Vec3> {
        let at = |i: usize, own: &Vec<u32>| match own.len() {
            0 => Vec3::ZERO,
            n => d[i] - own.iter().map(|&j| d[j as usize]).sum::<Vec3>() / n as f32,
        };
        self.neighbours.iter().enumerate().map(|(i, own)| at(i, own)).collect()
    }

    /// The energy of displacements, and its gradient.
    pub fn energy(&self, displacements: &[Vec3]) -> (f64, Vec<Vec3>) {
        let rough = self.apply(displacements);
        let share = 1.0 / displacements.len().max(1) as f32;
        let energy = rough.iter().map(|r| f64::from(r.length_squared() * share)).sum();
        let mut gradient: Vec<Vec3> = rough.iter().map(|r| *r * (2.0 * share)).collect();
        for (rough, own) in rough.iter().zip(&self.neighbours) {
            for &j in own {
                gradient[j as usize] -= *rough * (2.0 * share / own.len() as f32);
            }
        }
        (energy, gradient)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the gradient, and that moving all together is free.
    #[test]
    fn gradient_matches_central_differences() {
        let laplacian = Laplacian::new(6, &[[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        let at = |i: usize| Vec3::new((i * i) as f32 * 0.1, 0.3 - i as f32 * 0.2, (i % 2) as f32);
        let displacements: Vec<Vec3> = (0..6).map(at).collect();
        let (_, gradient) = laplacian.energy(&displacements);
        for i in 0..6 {
            for axis in 0..3 {
                let value = |h: f32| {
                    let mut moved = displacements.clone();
                    moved[i][axis] += h;
                    laplacian.energy(&moved).0
                };
                let numeric = (value(1e-2) - value(-1e-2)) / 2e-2;
                assert!((numeric - f64::from(gradient[i][axis])).abs() < 1e-4, "{numeric} {gradient:?}");
            }
        }
        assert!(laplacian.energy(&[Vec3::ONE; 6]).0 < 1e-12);
    }
}
