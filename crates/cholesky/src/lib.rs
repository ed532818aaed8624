//! The factorisation `A = L Lᵀ` of a sparse, symmetric, positive definite matrix, and solutions of `A x = b` by it.
//!
//! faer does the work, with a fill-reducing order of the unknowns. Its generic code is compiled here, once for all that use it.
//!
//! Contract: deterministic, whatever the number of threads. A matrix that is not positive definite, or whose factors memory does not
//! suffice for, has none.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Mat, Side};

/// The lower half of a symmetric matrix, as compressed sparse columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LowerHalf {
    /// For each column where its entries begin, and where the last one's end: one more than the matrix has columns.
    pub pointers: Vec<usize>,
    /// The row of each entry: ascending in a column, from the diagonal on.
    pub rows: Vec<usize>,
    /// The value of each entry.
    pub values: Vec<f64>,
}

/// The factors of a matrix.
pub struct Cholesky {
    factors: Llt<usize, f64>,
}

impl Cholesky {
    /// Factorises a matrix. None if it is not positive definite, or if memory runs out.
    ///
    /// # Panics
    /// If `pointers`, `rows` and `values` are not those of a matrix.
    pub fn new(LowerHalf { pointers, rows, values }: LowerHalf) -> Option<Self> {
        let size = pointers.len().saturating_sub(1);
        let pattern = SymbolicSparseColMat::new_checked(size, size, pointers, None, rows);
        let factors = SparseColMat::new(pattern, values).sp_cholesky(Side::Lower).ok()?;
        Some(Self { factors })
    }

    /// Solves `A x = b` for several right-hand sides, each as long as the matrix, and
    /// puts the solutions in their place.
    ///
    /// # Panics
    /// If a side has another length, or there is none.
    pub fn solve<const COUNT: usize>(&self, mut sides: [&mut [f64]; COUNT]) {
        self.solve_all(&mut sides);
    }

    fn solve_all(&self, sides: &mut [&mut [f64]]) {
        let size = sides.first().map_or(0, |side| side.len());
        let mut right = Mat::from_fn(size, sides.len(), |i, k| sides[k][i]);
        self.factors.solve_in_place(&mut right);
        for (k, side) in sides.iter_mut().enumerate() {
            side.iter_mut().enumerate().for_each(|(i, value)| *value = right[(i, k)]);
        }
    }
}
