//! A nine-point system whose solution stays within [0, 1]: conjugate gradients with an active
//! set. Lanes that leave the box are put on its face and held, and the rest is corrected (Moré and
//! Toraldo 1991, simplified).

use crate::conjugate_gradient::Outcome;
use crate::free_lanes::FreeLanes;
use crate::stencil::{Diagonal, Stencil};
use glam::Vec4;
use rayon::prelude::*;

/// Rounds of the active set: more change nothing that eight bits would show.
const ROUNDS: usize = 3;

/// Which lanes may move: not those on a face of the box, or beyond it, that the residual pushes outwards.
pub fn free_lanes<R>(values: &[Vec4], residual: R) -> Vec<FreeLanes>
where
    R: IntoParallelIterator<Item = Vec4, Iter: IndexedParallelIterator>,
{
    let is_held = |x: f32, r: f32| x <= 0.0 && r < 0.0 || x >= 1.0 && r > 0.0;
    (values.par_iter().zip(residual))
        .map(|(x, r)| {
            let mut free = FreeLanes::ALL;
            (0..4).filter(|&k| is_held(x[k], r[k])).for_each(|k| free.hold(k));
            free
        })
        .collect()
}

/// Moves `values` towards the solution of `A d = b` for their change d, `b` being the matrix's own
/// right-hand side, which ends as what is left of it; values end within [0, 1]. `solve` solves `A d = b` from zero, for
/// the lanes that are free.
pub fn solve_in_box(
    matrix: &mut Stencil<Diagonal>,
    values: &mut [Vec4],
    solve: impl Fn(&Stencil<Diagonal>, &[FreeLanes]) -> (Vec<Vec4>, Outcome),
) -> Outcome {
    let mut free = free_lanes(values, matrix.rows.par_iter().map(|row| row.right));
    let mut total = Outcome { steps: 0, reduction: 1.0 };
    for round in 0..ROUNDS {
        let (mut step, outcome) = solve(matrix, &free);
        total.steps += outcome.steps;
        total.reduction = outcome.reduction;
        let hits: usize = values
            .par_iter_mut()
            .zip(&mut step)
            .zip(&mut free)
            .map(|((x, step), free)| {
                let (before, moved) = (*x, *x + *step);
                *x = moved.clamp(Vec4::ZERO, Vec4::ONE);
                *step = *x - before;
                let mut hits = 0;
                for k in 0..3 {
                    if moved[k] != x[k] {
                        free.hold(k);
                        hits += 1;
                    }
                }
                hits
            })
            .sum();
        if hits == 0 || round + 1 == ROUNDS {
            break;
        }
        let mut answer = vec![Vec4::ZERO; step.len()];
        matrix.product(&step, &mut answer);
        drop(step);
        matrix.rows.par_iter_mut().zip(&answer).for_each(|(row, answer)| row.right -= *answer);
    }
    total
}
