//! The preconditioner `(L + κ)⁻¹`: a layout's graph Laplacian L, whose rows are divided
//! by nothing, with a shift κ that keeps charts' common motion possible.
//!
//! Gradients of texture coordinates are rough: neighbours are pulled in opposite ways.
//! Smoothed by the inverse Laplacian (a Sobolev gradient) they move whole regions in one
//! step. The matrix stays while a layout's connectivity does, so it is factorised once
//! (sparse Cholesky, faer).

use crate::descent::Preconditioner;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use glam::{DVec2, dvec2};

/// `(L + κ)⁻¹`, factorised.
pub struct Laplacian {
    factors: Option<Llt<usize, f64>>,
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
        let mut triplets = Vec::with_capacity(points + edges.len());
        for [a, b] in edges {
            diagonal[a as usize] += 1.0;
            diagonal[b as usize] += 1.0;
            triplets.push(Triplet::new(b as usize, a as usize, -1.0));
        }
        triplets.extend(diagonal.iter().enumerate().map(|(i, d)| Triplet::new(i, i, *d)));
        // A positive shift makes the matrix positive definite; should memory run out, plain
        // L-BFGS goes on without it.
        let factors = SparseColMat::try_new_from_triplets(points, points, &triplets)
            .ok()
            .and_then(|matrix| matrix.sp_cholesky(Side::Lower).ok());
        Self { factors }
    }
}

impl Preconditioner for Laplacian {
    fn apply(&self, vector: &mut [DVec2]) {
        let Some(factors) = &self.factors else { return };
        let mut right = Mat::from_fn(vector.len(), 2, |i, k| vector[i][k]);
        factors.solve_in_place(&mut right);
        for (i, v) in vector.iter_mut().enumerate() {
            *v = dvec2(right[(i, 0)], right[(i, 1)]);
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
