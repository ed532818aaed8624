//! Conjugate gradients on a [`Stencil`], preconditioned by the inverses of its
//! centre blocks (Hestenes and Stiefel 1952; block Jacobi).
//!
//! Contract: the matrix is positive semi-definite on the texels it touches; texels
//! whose centre block has no inverse stay as they are. Inner products are summed
//! in double precision, row by row in order: the result does not depend on the
//! number of threads.

use crate::stencil::{Block, Stencil};
use parbake_model::glam::Vec4;
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

fn dot(size: usize, a: &[Vec4], b: &[Vec4]) -> f64 {
    let rows: Vec<f64> = a
        .par_chunks(size)
        .zip(b.par_chunks(size))
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| f64::from(a.dot(*b))).sum())
        .collect();
    rows.iter().sum()
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
    let precondition = |r: &[Vec4], z: &mut [Vec4]| {
        z.par_iter_mut().enumerate().for_each(|(i, z)| *z = inverse[i].product(r[i]) * mask(i));
    };
    let mut z = vec![Vec4::ZERO; count];
    precondition(&r, &mut z);
    let mut p = z.clone();
    let mut q = vec![Vec4::ZERO; count];
    let first = dot(size, &r, &z);
    let mut rho = first;
    let mut steps = 0;
    while steps < effort.steps && rho > first * effort.tolerance * effort.tolerance && rho > 1e-30 {
        matrix.product(&p, &mut q);
        if free.is_some() {
            q.par_iter_mut().enumerate().for_each(|(i, q)| *q *= mask(i));
        }
        let curvature = dot(size, &p, &q);
        if curvature <= 0.0 {
            break;
        }
        let alpha = (rho / curvature) as f32;
        x.par_iter_mut().zip(&p).for_each(|(x, p)| *x += *p * alpha);
        r.par_iter_mut().zip(&q).for_each(|(r, q)| *r -= *q * alpha);
        precondition(&r, &mut z);
        let next = dot(size, &r, &z);
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
