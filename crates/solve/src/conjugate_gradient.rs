//! Conjugate gradients on a [`Stencil`], preconditioned by the inverses of its
//! centre blocks (Hestenes and Stiefel 1952; block Jacobi).
//!
//! Contract: the matrix is positive semi-definite on the texels it touches; texels
//! whose centre block has no inverse stay as they are. Inner products are summed
//! in double precision, row by row in order: the result does not depend on the
//! number of threads.

use crate::stencil::{Block, Stencil, dot};
use glam::Vec4;
use rayon::prelude::*;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// At most so many steps.
    pub steps: usize,
    /// Once the preconditioned residual's norm has fallen by this factor.
    pub tolerance: f64,
}

/// What it took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Steps done.
    pub steps: usize,
    /// Final over initial norm of the preconditioned residual.
    pub reduction: f64,
}

/// Solves `A x = b`, starting at zero. `free`, if given, holds 1 in lanes that may
/// move and 0 in those that must not.
pub fn solve<B: Block>(
    matrix: &Stencil<B>,
    right: &[Vec4],
    free: Option<&[Vec4]>,
    effort: &Effort,
) -> (Vec<Vec4>, Outcome) {
    let size = matrix.size;
    let count = size * size;
    let mask = |i: usize| free.map_or(Vec4::ONE, |f| f[i]);
    let inverse: Vec<B> = matrix.rows.par_iter().map(|r| r.centre.inverse()).collect();
    let mut x = vec![Vec4::ZERO; count];
    let mut r: Vec<Vec4> = right.par_iter().enumerate().map(|(i, b)| *b * mask(i)).collect();
    // z is r preconditioned; masked like r, it keeps the direction p inside the mask,
    // so that A p needs no mask of its own before it meets p.
    let mut z: Vec<Vec4> =
        r.par_iter().zip(&inverse).enumerate().map(|(i, (r, m))| m.product(*r) * mask(i)).collect();
    let mut p = z.clone();
    let mut q = vec![Vec4::ZERO; count];
    let dots: Vec<f64> = r.par_chunks(size).zip(z.par_chunks(size)).map(|(r, z)| dot(r, z)).collect();
    let first: f64 = dots.iter().sum();
    let (mut rho, mut steps) = (first, 0);
    while steps < effort.steps && rho > first * effort.tolerance * effort.tolerance && rho > 1e-30 {
        let curvature = matrix.product(&p, &mut q);
        if curvature <= 0.0 {
            break;
        }
        let alpha = (rho / curvature) as f32;
        // One pass over all vectors: the memory is what they wait for.
        let dots: Vec<f64> = (x.par_chunks_mut(size).zip(r.par_chunks_mut(size)))
            .zip(z.par_chunks_mut(size))
            .enumerate()
            .map(|(row, ((x, r), z))| {
                let mut sum = 0.0;
                for (k, i) in (row * size..(row + 1) * size).enumerate() {
                    x[k] += p[i] * alpha;
                    r[k] -= q[i] * mask(i) * alpha;
                    z[k] = inverse[i].product(r[k]) * mask(i);
                    sum += f64::from(r[k].dot(z[k]));
                }
                sum
            })
            .collect();
        let next: f64 = dots.iter().sum();
        let beta = (next / rho) as f32;
        p.par_iter_mut().zip(&z).for_each(|(p, z)| *p = *z + *p * beta);
        rho = next;
        steps += 1;
    }
    let reduction = if first > 0.0 { (rho / first).sqrt() } else { 0.0 };
    (x, Outcome { steps, reduction })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stencil::{Diagonal, Row, Stencil};

    fn chain() -> Stencil<Diagonal> {
        let rows = (0..16)
            .map(|i| Row {
                centre: Diagonal::identity(4.1),
                east: Diagonal::identity(-1.0),
                south: Diagonal::identity(-1.0),
                right: Vec4::new(i as f32, 1.0, (i * i % 7) as f32, 0.0),
                ..Default::default()
            })
            .collect();
        Stencil { size: 4, rows }
    }

    /// Protects the solution itself.
    #[test]
    fn the_residual_vanishes() {
        let a = chain();
        let (x, outcome) = solve(&a, &a.right(), None, &Effort { steps: 50, tolerance: 1e-6 });
        let mut y = vec![Vec4::ZERO; 16];
        a.product(&x, &mut y);
        assert!(a.rows.iter().zip(&y).all(|(r, y)| (r.right - *y).length() < 1e-3), "{outcome:?}");
    }

    /// Protects the box-constrained finish: held lanes do not move, the others
    /// solve what is left.
    #[test]
    fn held_lanes_stay() {
        let a = chain();
        let mut free = vec![Vec4::ONE; 16];
        free[5] = Vec4::new(0.0, 1.0, 1.0, 1.0);
        let (x, _) = solve(&a, &a.right(), Some(&free), &Effort { steps: 60, tolerance: 1e-7 });
        let mut y = vec![Vec4::ZERO; 16];
        a.product(&x, &mut y);
        assert_eq!(x[5].x, 0.0);
        assert!((a.rows[6].right.x - y[6].x).abs() < 1e-3);
    }
}
