//! Preconditioned conjugate gradients (Hestenes and Stiefel 1952) on any [`Operator`], and on a [`Stencil`], whose
//! preconditioner is the inverses of its centre blocks (block Jacobi).
//!
//! Contract: the matrix is positive semi-definite on the elements it touches; texels whose centre block has no
//! inverse stay as they are. Inner products are summed row by row in order: the result does not depend on the
//! number of threads.

use crate::free_lanes::FreeLanes;
use crate::operator::{Coupled, Element, ElementOf, Inner, Operator};
use crate::stencil::{Block, Stencil};
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

/// Where [`descend`] ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop<I> {
    /// After so many steps,
    pub steps: usize,
    /// once the squared norm of the preconditioned residual is this or less,
    pub enough: I,
    /// or after a step that takes less than this from the energy.
    pub least_gain: f64,
}

/// `rᵀ M r`, M being the preconditioner: the squared norm that [`Stop`] speaks of.
pub fn squared_norm<O: Operator>(operator: &O, r: &[ElementOf<O>]) -> O::Inner {
    let width = operator.width();
    let rows: Vec<O::Inner> = (r.par_chunks(width).enumerate())
        .map(|(row, r)| {
            let mut sum = O::Inner::ZERO;
            for (k, r) in r.iter().enumerate() {
                sum.add(*r, operator.precondition(row * width + k, *r));
            }
            sum
        })
        .collect();
    O::Inner::total(&rows)
}

/// Moves `x` towards the solution. `r` is the residual `b − A x`, zero in lanes that are held, and `rho` its
/// [`squared_norm`]; `free` says which lanes may move, if any is held. Returns
/// the steps done and the squared norm that is left.
pub fn descend<O: Operator>(
    operator: &mut O,
    x: &mut [ElementOf<O>],
    r: &mut [ElementOf<O>],
    mut rho: O::Inner,
    free: Option<&[FreeLanes]>,
    stop: &Stop<O::Inner>,
) -> (usize, O::Inner) {
    let width = operator.width();
    let mask = |i: usize| free.map_or(ElementOf::<O>::ONE, |f| ElementOf::<O>::mask(f[i]));
    // Masked like r, the preconditioned residual keeps the direction p inside the mask, so that A p needs
    // no mask of its own before it meets p.
    let masked = |operator: &O, i: usize, r: ElementOf<O>| operator.precondition(i, r) * mask(i);
    let own: &O = operator;
    // A row is the least task here too: what fits into one is solved without other threads.
    let mut p: Vec<ElementOf<O>> =
        r.par_iter().enumerate().with_min_len(width).map(|(i, r)| masked(own, i, *r)).collect();
    let mut q = vec![ElementOf::<O>::ZERO; x.len()];
    let mut steps = 0;
    while steps < stop.steps && !rho.is_within(stop.enough) {
        let curvature = operator.product(&p, &mut q);
        if !curvature.is_positive() {
            break;
        }
        let own: &O = operator;
        let alpha = rho.over(curvature);
        // One pass over all vectors: the memory is what they wait for.
        let rows: Vec<O::Inner> = (x.par_chunks_mut(width).zip(r.par_chunks_mut(width)))
            .enumerate()
            .map(|(row, (x, r))| {
                let mut sum = O::Inner::ZERO;
                for (k, i) in (row * width..row * width + x.len()).enumerate() {
                    x[k] += p[i] * alpha;
                    r[k] -= q[i] * mask(i) * alpha;
                    sum.add(r[k], masked(own, i, r[k]));
                }
                sum
            })
            .collect();
        let (next, gain) = (O::Inner::total(&rows), rho.gain(alpha));
        let beta = next.over(rho);
        rho = next;
        steps += 1;
        if gain < stop.least_gain {
            break;
        }
        p.par_iter_mut()
            .enumerate()
            .with_min_len(width)
            .for_each(|(i, p)| *p = masked(own, i, r[i]) + *p * beta);
    }
    (steps, rho)
}

/// A stencil with the inverses of its centre blocks.
struct BlockJacobi<'a, B> {
    matrix: &'a Stencil<B>,
    inverse: Vec<B>,
}

impl<B: Block> Operator for BlockJacobi<'_, B> {
    type Inner = Coupled;

    fn width(&self) -> usize {
        self.matrix.size
    }

    fn product(&mut self, p: &[Vec4], q: &mut Vec<Vec4>) -> Coupled {
        Coupled(self.matrix.product(p, q))
    }

    #[inline(always)]
    fn precondition(&self, i: usize, r: Vec4) -> Vec4 {
        self.inverse[i].product(r)
    }
}

/// Squared norms up to this count as 0.
const NOTHING: f64 = 1e-30;

/// Solves `A x = b`, starting at zero; b is the matrix's own right-hand side. `free`, if given, says which lanes
/// may move.
pub fn solve<B: Block>(
    matrix: &Stencil<B>,
    free: Option<&[FreeLanes]>,
    effort: &Effort,
) -> (Vec<Vec4>, Outcome) {
    let inverse = matrix.rows.par_iter().map(|r| r.centre.inverse()).collect();
    let mut operator = BlockJacobi { matrix, inverse };
    let mask = |i: usize| free.map_or(Vec4::ONE, |f| f[i].mask());
    let mut x = vec![Vec4::ZERO; matrix.rows.len()];
    let mut r: Vec<Vec4> = matrix.rows.par_iter().enumerate().map(|(i, row)| row.right * mask(i)).collect();
    let first = squared_norm(&operator, &r);
    let enough = Coupled((first.0 * effort.tolerance * effort.tolerance).max(NOTHING));
    let stop = Stop { steps: effort.steps, enough, least_gain: 0.0 };
    let (steps, last) = descend(&mut operator, &mut x, &mut r, first, free, &stop);
    let reduction = if first.0 > 0.0 { (last.0 / first.0).sqrt() } else { 0.0 };
    (x, Outcome { steps, reduction })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::Lanes;
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
        let (x, outcome) = solve(&a, None, &Effort { steps: 50, tolerance: 1e-6 });
        let mut y = vec![Vec4::ZERO; 16];
        a.product(&x, &mut y);
        assert!(a.rows.iter().zip(&y).all(|(r, y)| (r.right - *y).length() < 1e-3), "{outcome:?}");
    }

    /// Protects the box-constrained finish: held lanes do not move, the others
    /// solve what is left.
    #[test]
    fn held_lanes_stay() {
        let a = chain();
        let mut free = vec![FreeLanes::ALL; 16];
        free[5].hold(0);
        let (x, _) = solve(&a, Some(&free), &Effort { steps: 60, tolerance: 1e-7 });
        let mut y = vec![Vec4::ZERO; 16];
        a.product(&x, &mut y);
        assert_eq!(x[5].x, 0.0);
        assert!((a.rows[6].right.x - y[6].x).abs() < 1e-3);
    }

    /// A matrix of two texels for each lane by itself: `[[2, 1], [1, 3]]`.
    struct Two;

    impl Operator for Two {
        type Inner = Lanes;

        fn width(&self) -> usize {
            1
        }

        fn product(&mut self, p: &[Vec4], q: &mut Vec<Vec4>) -> Lanes {
            *q = vec![2.0 * p[0] + p[1], p[0] + 3.0 * p[1]];
            let mut sum = Lanes::ZERO;
            p.iter().zip(q.iter()).for_each(|(p, q)| sum.add(*p, *q));
            sum
        }

        fn precondition(&self, i: usize, r: Vec4) -> Vec4 {
            r / [2.0, 3.0][i]
        }
    }

    /// Protects channels from each other: each has its own step lengths, so that all are exact after as many
    /// steps as there are texels, whatever their sizes; a lane of zeros stays, and so does a small gain's end.
    #[test]
    fn lanes_are_solved_side_by_side() {
        let right = [Vec4::new(1.0, 1e4, -1e-3, 0.0), Vec4::new(2.0, -1e4, 5e-3, 0.0)];
        let run = |least_gain| {
            let (mut x, mut r) = (vec![Vec4::ZERO; 2], right.to_vec());
            let rho = squared_norm(&Two, &r);
            let stop = Stop { steps: 2, enough: Lanes(Vec4::splat(1e-30)), least_gain };
            let (steps, _) = descend(&mut Two, &mut x, &mut r, rho, None, &stop);
            (x, steps)
        };
        let (x, steps) = run(0.0);
        // The inverse is [[3, −1], [−1, 2]] / 5.
        for lane in 0..4 {
            let want = [3.0 * right[0][lane] - right[1][lane], 2.0 * right[1][lane] - right[0][lane]];
            for (x, want) in x.iter().zip(want) {
                assert!((x[lane] - 0.2 * want).abs() <= 1e-5 * want.abs(), "{lane}: {x} {want}");
            }
        }
        assert_eq!((steps, run(1e12).1), (2, 1));
    }
}
