//! A nine-point system whose solution stays within [0, 1]: conjugate gradients with an active
//! set. Lanes that leave the box are put on its face and held, and the rest is corrected (Moré and
//! Toraldo 1991, simplified).

use crate::conjugate_gradient::Outcome;
use crate::stencil::{Diagonal, Stencil};
use glam::Vec4;
use rayon::prelude::*;

/// Rounds of the active set: more change nothing that eight bits would show.
const ROUNDS: usize = 3;

/// Moves `values` towards the solution of `A d = b` for their change d, `b` being the matrix's own
/// right-hand side; values end within [0, 1]. `solve` solves `A d = r` from zero, for a right-hand side r and
/// lanes that are free (1) or held (0).
pub fn solve_in_box(
    matrix: &Stencil<Diagonal>,
    values: &mut [Vec4],
    solve: impl Fn(&[Vec4], &[Vec4]) -> (Vec<Vec4>, Outcome),
) -> Outcome {
    let right = matrix.right();
    // A lane on a face that is pushed outwards is held from the beginning.
    let mut free: Vec<Vec4> = values
        .par_iter()
        .zip(&right)
        .map(|(x, b)| {
            Vec4::from(std::array::from_fn::<f32, 4, _>(|k| {
                f32::from(!(x[k] <= 0.0 && b[k] < 0.0 || x[k] >= 1.0 && b[k] > 0.0))
            }))
        })
        .collect();
    let begin = values.to_vec();
    let mut total = Outcome { steps: 0, reduction: 1.0 };
    let mut residual = right.clone();
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
        let change: Vec<Vec4> = values.par_iter().zip(&begin).map(|(x, b)| *x - *b).collect();
        matrix.product(&change, &mut residual);
        residual.par_iter_mut().zip(&right).for_each(|(r, b)| *r = *b - *r);
    }
    total
}
