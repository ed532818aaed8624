//! The preconditioner `(L + κ)⁻¹`: a layout's graph Laplacian L, whose rows are divided
//! by nothing, with a shift κ that keeps charts' common motion possible.
//!
//! Gradients of texture coordinates are rough: neighbours are pulled in opposite ways.
//! Smoothed by the inverse Laplacian (a Sobolev gradient) they move whole regions in one
//! step. The matrix stays while a layout's connectivity does, so it is factorised once.

use crate::descent::Preconditioner;
use glam::{DVec2, dvec2};
use parbake_cholesky::{Cholesky, LowerHalf};

/// `(L + κ)⁻¹`, factorised.
pub struct Laplacian {
    factors: Option<Cholesky>,
}

impl Laplacian {
    /// The Laplacian of the triangles' edges, each of weight 1, shifted by `shift` > 0.
    pub fn new(points: usize, triangles: &[[u32; 3]], shift: f64) -> Self {
        let mut edges: Vec<[u32; 2]> = triangles
            .iter()
            .flat_map(|t| (0..3).map(move |k| [t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3])]))
            .filter(|[a, b]| a != b)
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let mut diagonal = vec![shift; points];
        for edge in &edges {
            edge.iter().for_each(|&i| diagonal[i as usize] += 1.0);
        }
        let mut matrix = LowerHalf::default();
        let mut edges = edges.into_iter().peekable();
        for (a, &own) in diagonal.iter().enumerate() {
            matrix.pointers.push(matrix.rows.len());
            matrix.rows.push(a);
            matrix.values.push(own);
            while let Some([_, b]) = edges.next_if(|edge| edge[0] as usize == a) {
                matrix.rows.push(b as usize);
                matrix.values.push(-1.0);
            }
        }
        matrix.pointers.push(matrix.rows.len());
        // A positive shift makes the matrix positive definite; should memory run out, plain
        // L-BFGS goes on without it.
        let factors = Cholesky::new(matrix);
        Self { factors }
    }
}

impl Preconditioner for Laplacian {
    fn apply(&self, vector: &mut [DVec2]) {
        let Some(factors) = &self.factors else { return };
        let [mut x, mut y] = [0, 1].map(|axis| vector.iter().map(|v| v[axis]).collect::<Vec<f64>>());
        factors.solve([&mut x, &mut y]);
        for (v, (x, y)) in vector.iter_mut().zip(x.into_iter().zip(y)) {
            *v = dvec2(x, y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the factorisation: for two points and one edge the inverse is known.
    #[test]
    fn inverts_the_shifted_laplacian() {
        let laplacian = Laplacian::new(3, &[[0, 1, 1]], 0.5);
        let mut v = [dvec2(1.0, 0.0), dvec2(0.0, 1.0), dvec2(1.0, 2.0)];
        laplacian.apply(&mut v);
        // [[1.5, −1], [−1, 1.5]]⁻¹ = [[1.2, 0.8], [0.8, 1.2]]
        assert!((v[0] - dvec2(1.2, 0.8)).length() < 1e-12);
        assert!((v[1] - dvec2(0.8, 1.2)).length() < 1e-12);
        assert!((v[2] - dvec2(2.0, 4.0)).length() < 1e-12);
    }
}
