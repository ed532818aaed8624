//! The factorisation, on matrices whose inverse is known or easily checked.

use parbake_cholesky::{Cholesky, LowerHalf};

/// `[[4, 2, 0], [2, 5, 1], [0, 1, 3]]` by its lower half.
fn small(diagonal: [f64; 3]) -> LowerHalf {
    LowerHalf {
        pointers: vec![0, 2, 4, 5],
        rows: vec![0, 1, 1, 2, 2],
        values: vec![diagonal[0], 2.0, diagonal[1], 1.0, diagonal[2]],
    }
}

/// Protects solutions, of several right-hand sides at once.
#[test]
fn solutions_solve_the_equations() {
    let factors = Cholesky::new(small([4.0, 5.0, 3.0])).expect("positive definite");
    let (mut a, mut b) = ([1.0, -2.0, 0.5], [0.0, 3.0, 1.0]);
    let wanted = [a, b];
    factors.solve([&mut a, &mut b]);
    for (x, wanted) in [a, b].into_iter().zip(wanted) {
        let product = [4.0 * x[0] + 2.0 * x[1], 2.0 * x[0] + 5.0 * x[1] + x[2], x[1] + 3.0 * x[2]];
        for (got, want) in product.into_iter().zip(wanted) {
            assert!((got - want).abs() < 1e-12, "{got}, {want} wanted");
        }
    }
}

/// Protects callers from a panic: a matrix that is not positive definite has no factors, and one without rows is solved.
#[test]
fn what_is_not_positive_definite_has_no_factors() {
    assert!(Cholesky::new(small([4.0, -5.0, 3.0])).is_none());
    let nothing = Cholesky::new(LowerHalf { pointers: vec![0], ..LowerHalf::default() });
    nothing.expect("nothing to factorise").solve([&mut []]);
}

/// Protects the order of the unknowns, which the factorisation chooses by itself: a long chain is solved in the caller's order.
#[test]
fn unknowns_keep_their_order() {
    let count = 200;
    let mut chain = LowerHalf::default();
    for j in 0..count {
        chain.pointers.push(chain.rows.len());
        chain.rows.push(j);
        chain.values.push(2.5 + j as f64 * 0.01);
        if j + 1 < count {
            chain.rows.push(j + 1);
            chain.values.push(-1.0);
        }
    }
    chain.pointers.push(chain.rows.len());
    let factors = Cholesky::new(chain).expect("positive definite");
    let mut x: Vec<f64> = (0..count).map(|i| (i as f64 * 0.7).sin()).collect();
    factors.solve([&mut x]);
    for i in 0..count {
        let beside = |j: Option<usize>| j.and_then(|j| x.get(j)).copied().unwrap_or(0.0);
        let product = (2.5 + i as f64 * 0.01) * x[i] - beside(i.checked_sub(1)) - beside(Some(i + 1));
        assert!((product - (i as f64 * 0.7).sin()).abs() < 1e-12, "{i}: {product}");
    }
}
