//! The linear system of Tutte's embedding, solved by conjugate gradients with Jacobi's
//! preconditioner. Weights are symmetric and positive, so the matrix is too.

use glam::DVec2;

/// Iterations at most; meshes need about as many as they have points across.
const MOST_ITERATIONS: usize = 20_000;

/// Places in which each point that is not fixed is the weighted mean of its neighbours.
pub(super) fn balanced(
    triangles: &[[u32; 3]],
    fixed: &[Option<DVec2>],
    weight: impl Fn(u32, u32) -> f64,
) -> Vec<DVec2> {
    let mut edges: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .filter(|[a, b]| a != b)
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let weighted: Vec<([usize; 2], f64)> =
        edges.iter().map(|&[a, b]| ([a as usize, b as usize], weight(a, b))).collect();
    let free = |p: usize| fixed[p].is_none();
    let mut diagonal = vec![0.0; fixed.len()];
    for &([a, b], w) in &weighted {
        diagonal[a] += w;
        diagonal[b] += w;
    }
    // Rows of fixed points are left out: their entries stay 0.
    let times = |x: &[DVec2]| {
        let mut y: Vec<DVec2> = x.iter().zip(&diagonal).map(|(&x, &d)| x * d).collect();
        for &([a, b], w) in &weighted {
            if free(a) && free(b) {
                y[a] -= x[b] * w;
                y[b] -= x[a] * w;
            }
        }
        y
    };
    let mut residual = vec![DVec2::ZERO; fixed.len()];
    for &([a, b], w) in &weighted {
        for (p, q) in [(a, b), (b, a)] {
            if let (None, Some(place)) = (fixed[p], fixed[q]) {
                residual[p] += place * w;
            }
        }
    }
    let precondition = |r: &[DVec2]| -> Vec<DVec2> {
        r.iter().zip(&diagonal).map(|(&r, &d)| if d > 0.0 { r / d } else { DVec2::ZERO }).collect()
    };
    // The two coordinates are two systems that share the matrix.
    let dot = |a: &[DVec2], b: &[DVec2]| a.iter().zip(b).map(|(&a, &b)| a * b).sum::<DVec2>();
    let mut x = vec![DVec2::ZERO; fixed.len()];
    let mut z = precondition(&residual);
    let mut direction = z.clone();
    let mut energy = dot(&residual, &z);
    let goal = energy * 1e-30;
    for _ in 0..MOST_ITERATIONS {
        if energy.cmple(goal).all() {
            break;
        }
        let product = times(&direction);
        let step = quotient(energy, dot(&direction, &product));
        for i in 0..x.len() {
            x[i] += direction[i] * step;
            residual[i] -= product[i] * step;
        }
        z = precondition(&residual);
        let next = dot(&residual, &z);
        let factor = quotient(next, energy);
        energy = next;
        for (d, &z) in direction.iter_mut().zip(&z) {
            *d = z + *d * factor;
        }
    }
    x.iter().zip(fixed).map(|(&x, fixed)| fixed.unwrap_or(x)).collect()
}

/// Quotients by coordinate, 0 where there is nothing left to divide by.
fn quotient(a: DVec2, b: DVec2) -> DVec2 {
    let divide = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
    DVec2::new(divide(a.x, b.x), divide(a.y, b.y))
}
