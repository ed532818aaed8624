//! The linear system of Tutte's embedding, solved by conjugate gradients with Jacobi's
//! preconditioner. Weights are symmetric and positive, so the matrix is too.
//!
//! The two coordinates are two systems that share the matrix.

use glam::DVec2;
use parbake_solve::conjugate_gradient::{Stop, descend, squared_norm};
use parbake_solve::operator::{DoubleLanes, Inner, Operator};
use rayon::prelude::*;

/// Iterations at most; meshes need about as many as they have points across.
const MOST_ITERATIONS: usize = 20_000;

/// The residual's squared norm, over its first one, at which the solution is as good as
/// double precision can tell.
const ENOUGH: f64 = 1e-30;

/// Points of a task: smaller disks are not worth a second thread.
const POINTS_OF_TASK: usize = 4096;

/// Places in which each point that is not fixed is the weighted mean of its neighbours.
pub(super) fn balanced(
    triangles: &[[u32; 3]],
    fixed: &[Option<DVec2>],
    weight: impl Fn(u32, u32) -> f64,
) -> Vec<DVec2> {
    // Both ways: sorted, they are the neighbours of each point in turn.
    let mut edges: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a], [b, a], [c, b], [a, c]])
        .filter(|[a, b]| a != b)
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let mut laplacian = Laplacian { rows: vec![Row::default(); fixed.len()], neighbours: Vec::new() };
    let mut right = vec![DVec2::ZERO; fixed.len()];
    for of_point in edges.chunk_by(|a, b| a[0] == b[0]) {
        let p = of_point[0][0];
        let row = &mut laplacian.rows[p as usize];
        row.first = laplacian.neighbours.len();
        // Rows of fixed points are left out: their entries stay 0.
        if fixed[p as usize].is_none() {
            for &[_, q] in of_point {
                let w = weight(p.min(q), p.max(q));
                row.diagonal += w;
                match fixed[q as usize] {
                    Some(place) => right[p as usize] += place * w,
                    None => laplacian.neighbours.push((q, w)),
                }
            }
        }
        row.end = laplacian.neighbours.len();
    }
    let mut x = vec![DVec2::ZERO; fixed.len()];
    let first = squared_norm(&laplacian, &right);
    let stop = Stop { steps: MOST_ITERATIONS, enough: DoubleLanes(first.0 * ENOUGH), least_gain: 0.0 };
    descend(&mut laplacian, &mut x, &mut right, first, None, &stop);
    x.iter().zip(fixed).map(|(&x, fixed)| fixed.unwrap_or(x)).collect()
}

/// A point's row of the matrix.
#[derive(Clone, Copy, Default)]
struct Row {
    /// Sum of the weights of all its edges.
    diagonal: f64,
    /// Its free neighbours in the list of all points', from `first` to `end` (exclusive).
    first: usize,
    end: usize,
}

/// The weighted graph Laplacian of the free points.
struct Laplacian {
    rows: Vec<Row>,
    /// Free neighbours with their weights, point by point.
    neighbours: Vec<(u32, f64)>,
}

impl Operator for Laplacian {
    type Inner = DoubleLanes;

    fn width(&self) -> usize {
        POINTS_OF_TASK
    }

    fn product(&mut self, p: &[DVec2], q: &mut Vec<DVec2>) -> DoubleLanes {
        let sums: Vec<DoubleLanes> = (q.par_chunks_mut(POINTS_OF_TASK).enumerate())
            .map(|(task, q)| {
                let mut sum = DoubleLanes::ZERO;
                for (i, q) in (task * POINTS_OF_TASK..).zip(q) {
                    let row = &self.rows[i];
                    *q = p[i] * row.diagonal;
                    for &(neighbour, w) in &self.neighbours[row.first..row.end] {
                        *q -= p[neighbour as usize] * w;
                    }
                    sum.add(p[i], *q);
                }
                sum
            })
            .collect();
        DoubleLanes::total(&sums)
    }

    #[inline(always)]
    fn precondition(&self, i: usize, r: DVec2) -> DVec2 {
        let diagonal = self.rows[i].diagonal;
        if diagonal > 0.0 { r / diagonal } else { DVec2::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    /// A square of `n` × `n` points whose border is fixed on a circle, and weights of its edges.
    fn square(n: u32) -> (Vec<[u32; 3]>, Vec<Option<DVec2>>) {
        let at = |x: u32, y: u32| y * n + x;
        let triangles = (0..(n - 1) * (n - 1))
            .map(|i| (i % (n - 1), i / (n - 1)))
            .flat_map(|(x, y)| {
                let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let fixed = (0..n * n)
            .map(|i| {
                let (x, y) = (i % n, i / n);
                let border = x == 0 || y == 0 || x + 1 == n || y + 1 == n;
                let centred = |v: u32| 2.0 * f64::from(v) / f64::from(n - 1) - 1.0;
                border.then(|| dvec2(centred(x), centred(y)).normalize())
            })
            .collect();
        (triangles, fixed)
    }

    fn weight(a: u32, b: u32) -> f64 {
        1.0 + f64::from((a * 31 + b * 17) % 13)
    }

    /// Protects the solution, and that its bytes do not depend on the number of threads, for a
    /// disk of more than one task.
    #[test]
    fn free_points_are_weighted_means() {
        let (triangles, fixed) = square(80);
        assert!(fixed.len() > POINTS_OF_TASK);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| balanced(&triangles, &fixed, weight))
        };
        let points = on(1);
        let bits = |points: &[DVec2]| -> Vec<[u64; 2]> {
            points.iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect()
        };
        assert!([2, 5].into_iter().all(|threads| bits(&on(threads)) == bits(&points)));
        let mut sums = vec![(DVec2::ZERO, 0.0); fixed.len()];
        // Each inner edge comes twice, once from either side; so does its weight.
        for [a, b] in triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]) {
            let w = weight(a.min(b), a.max(b));
            for (p, q) in [(a, b), (b, a)] {
                sums[p as usize].0 += points[q as usize] * w;
                sums[p as usize].1 += w;
            }
        }
        for (i, (sum, weights)) in sums.into_iter().enumerate() {
            match fixed[i] {
                Some(place) => assert_eq!(points[i], place),
                None => assert!((points[i] - sum / weights).length() < 1e-13, "{i}"),
            }
        }
    }
}
