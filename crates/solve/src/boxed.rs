//! A nine-point system whose solution stays within [0, 1]: conjugate gradients with an active
//! set. Lanes that leave the box are put on its face and held, and the rest is corrected (Moré and
//! Toraldo 1991, simplified).

use crate::conjugate_gradient::Outcome;
use crate::stencil::{Diagonal, Stencil};
use glam::Vec4;
use rayon::prelude::*;

/// Rounds of the active set: more change nothing that eight bits would show.
const ROUNDS: usize = 3;

/// 1 in lanes that may move, 0 in those that are held: lanes on a face of the box, or beyond it, that the residual
/// pushes outwards.
pub fn free_lanes(values: &[Vec4], residual: &[Vec4]) -> Vec<Vec4> {
    let is_free = |x: f32, r: f32| f32::from(!(x <= 0.0 && r < 0.0 || x >= 1.0 && r > 0.0));
    (values.par_iter().zip(residual))
        .map(|(x, r)| Vec4::from_array(std::array::from_fn(|k| is_free(x[k], r[k]))))
        .collect()
}

/// Moves `values` towards the solution of `A d = b` for their change d, `b` being the matrix's own
/// right-hand side; values end within [0, 1]. `solve` solves `A d = r` from zero, for a right-hand side r and
/// lanes that are free (1) or held (0).
pub fn solve_in_box(
    matrix: &Stencil<Diagonal>,
    values: &mut [Vec4],
    solve: impl Fn(&[Vec4], &[Vec4]) -> (Vec<Vec4>, Outcome),
) -> Outcome {
    let mut residual = matrix.right();
    let mut free = free_lanes(values, &residual);
    let begin = values.to_vec();
    let mut total = Outcome { steps: 0, reduction: 1.0 };
    for round in 0..ROUNDS {
        let (step, outcome) = solve(&residual, &free);
        total.steps += outcome.steps;
        total.reduction = outcome.reduction;
        let hits: usize = values
            .par_iter_mut()
            .zip(&step)
            .zip(&mut free)
            .map(|((x, step), free)| {
                let moved = *x + *step;
                *x = moved.clamp(Vec4::ZERO, Vec4::ONE);
                let mut hits = 0;
                for k in 0..3 {
                    if moved[k] != x[k] {
                        free[k] = 0.0;
                        hits += 1;
                    }
                }
                hits
            })
            .sum();
        if hits == 0 || round + 1 == ROUNDS {
            break;
        }
        drop(step);
        let change: Vec<Vec4> = values.par_iter().zip(&begin).map(|(x, b)| *x - *b).collect();
        matrix.product(&change, &mut residual);
        residual.par_iter_mut().zip(&matrix.rows).for_each(|(r, row)| *r = row.right - *r);
    }
    total
}
