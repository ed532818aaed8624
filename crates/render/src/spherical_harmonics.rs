//! Real spherical harmonics, orders 0 to 7, and their derivatives.
//!
//! With K the usual orthonormal factors and P the associated Legendre functions without
//! the Condon–Shortley phase (Sloan 2008, "Stupid Spherical Harmonics Tricks", appendix
//! A1, with +x for m = 1, +y for m = −1, +z for m = 0):
//!
//! `Y_{l,m}(d) = K_l^|m| · P̂_l^|m|(z) · (√2 Re | 1 | √2 Im) (x + i y)^|m|`
//! for m > 0, m = 0, m < 0, where `P̂_l^m = P_l^m / (1 − z²)^{m/2}` is a polynomial in z:
//! nothing is divided, the poles are points like any other. Function l, m has the index
//! `l² + l + m`.
//!
//! Contract: d is a unit vector. The derivatives are those of the polynomials above, in
//! x, y and z as if these were independent; their part across d is what turning d does.

use parbake_model::glam::Vec3;

/// The highest order there is.
pub const HIGHEST_ORDER: usize = 7;

/// Functions of all orders up to the highest.
pub const MOST_FUNCTIONS: usize = (HIGHEST_ORDER + 1) * (HIGHEST_ORDER + 1);

/// How many functions there are up to this order.
pub const fn functions(order: usize) -> usize {
    (order + 1) * (order + 1)
}

/// The factors K_l^m · (√2 for m > 0), at l (l + 1) / 2 + m.
const FACTORS: [f32; (HIGHEST_ORDER + 1) * (HIGHEST_ORDER + 2) / 2] = factors();

const fn square_root(x: f64) -> f64 {
    let mut root = if x > 1.0 { x } else { 1.0 };
    let mut step = 0;
    // Newton's iteration; halving brings it near, the last few steps double the digits.
    while step < 80 {
        root = 0.5 * (root + x / root);
        step += 1;
    }
    root
}

const fn factors() -> [f32; (HIGHEST_ORDER + 1) * (HIGHEST_ORDER + 2) / 2] {
    let mut all = [0.0; (HIGHEST_ORDER + 1) * (HIGHEST_ORDER + 2) / 2];
    let mut l = 0;
    while l <= HIGHEST_ORDER {
        let mut m = 0;
        // (l − m)! / (l + m)!
        let mut ratio = 1.0f64;
        while m <= l {
            if m > 0 {
                ratio /= ((l + m) * (l - m + 1)) as f64;
            }
            let twice = if m > 0 { 2.0 } else { 1.0 };
            let square = twice * (2 * l + 1) as f64 * ratio / (4.0 * std::f64::consts::PI);
            all[l * (l + 1) / 2 + m] = square_root(square) as f32;
            m += 1;
        }
        l += 1;
    }
    all
}

/// Calls `with` with the order as a constant, so that the compiler can lay loops over functions out
/// as straight lines: maps are fetched once a sample, a hundred million times a fit.
#[inline(always)]
pub(crate) fn as_constant<R>(order: usize, with: impl FnOnce(usize) -> R) -> R {
    match order {
        0 => with(0),
        1 => with(1),
        2 => with(2),
        3 => with(3),
        4 => with(4),
        5 => with(5),
        6 => with(6),
        _ => with(HIGHEST_ORDER),
    }
}

/// Y of all functions up to `order` at the unit vector d; the rest stays as it is.
#[inline(always)]
pub fn evaluate(order: usize, d: Vec3, values: &mut [f32; MOST_FUNCTIONS]) {
    walk(order, d, |index, value, _| values[index] = value);
}

/// Adjoint of [`evaluate`]: the gradient of d, given those of the values.
pub fn adjoint(order: usize, d: Vec3, to_values: &[f32; MOST_FUNCTIONS]) -> Vec3 {
    let mut to_d = Vec3::ZERO;
    as_constant(order, |order| {
        walk(order, d, |index, _, derivative| to_d += derivative * to_values[index]);
    });
    to_d
}

/// Calls `each` with the index, the value and the derivative of every function.
#[inline(always)]
fn walk(order: usize, d: Vec3, mut each: impl FnMut(usize, f32, Vec3)) {
    let Vec3 { x, y, z } = d;
    // (x + i y)^m, and that of m − 1, whose m-fold is the derivative.
    let (mut re, mut im) = (1.0f32, 0.0f32);
    let (mut last_re, mut last_im) = (0.0f32, 0.0f32);
    // P̂_m^m = (2 m − 1)!!
    let mut diagonal = 1.0f32;
    // Half-open ranges: the compiler unrolls them where the order is a constant.
    for m in 0..order + 1 {
        // P̂ of degrees l and l − 1, and their derivatives by z.
        let (mut p, mut p_below) = (diagonal, 0.0f32);
        let (mut q, mut q_below) = (0.0f32, 0.0f32);
        for l in m..order + 1 {
            if l > m {
                let (a, b) = ((2 * l - 1) as f32, (l + m - 1) as f32);
                let share = 1.0 / (l - m) as f32;
                let next = (a * z * p - b * p_below) * share;
                let next_q = (a * (p + z * q) - b * q_below) * share;
                (p_below, p) = (p, next);
                (q_below, q) = (q, next_q);
            }
            let factor = FACTORS[l * (l + 1) / 2 + m];
            let (index, slope) = (l * l + l, m as f32);
            let (fp, fq) = (factor * p, factor * q);
            let of = |own: f32, x: f32, y: f32| Vec3::new(fp * slope * x, fp * slope * y, fq * own);
            each(index + m, fp * re, of(re, last_re, -last_im));
            if m > 0 {
                each(index - m, fp * im, of(im, last_im, last_re));
            }
        }
        (last_re, last_im) = (re, im);
        (re, im) = (x * re - y * im, x * im + y * re);
        diagonal *= (2 * m + 1) as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::fibonacci_sphere;

    fn values(d: Vec3) -> [f32; MOST_FUNCTIONS] {
        let mut out = [0.0; MOST_FUNCTIONS];
        evaluate(HIGHEST_ORDER, d, &mut out);
        out
    }

    /// Protects readers of our files: signs and order of the first nine functions.
    #[test]
    fn low_orders_are_the_usual_ones() {
        let d = Vec3::new(0.48, -0.6, 0.64);
        let Vec3 { x, y, z } = d;
        let want = [
            0.282_094_8,
            0.488_602_5 * y,
            0.488_602_5 * z,
            0.488_602_5 * x,
            1.092_548_4 * x * y,
            1.092_548_4 * y * z,
            0.315_391_6 * (3.0 * z * z - 1.0),
            1.092_548_4 * x * z,
            0.546_274_2 * (x * x - y * y),
        ];
        for (have, want) in values(d).into_iter().zip(want) {
            assert!((have - want).abs() < 1e-6, "{have} {want}");
        }
    }

    /// Protects every order: the functions are orthonormal on the sphere.
    #[test]
    fn functions_are_orthonormal() {
        let directions = fibonacci_sphere(20_000, 0.0);
        let all: Vec<_> = directions.into_iter().map(values).collect();
        let share = 4.0 * std::f64::consts::PI / all.len() as f64;
        for i in 0..MOST_FUNCTIONS {
            for j in 0..=i {
                let dot: f64 = all.iter().map(|v| f64::from(v[i]) * f64::from(v[j])).sum::<f64>() * share;
                assert!((dot - f64::from(u8::from(i == j))).abs() < 5e-3, "{i} {j} {dot}");
            }
        }
    }

    /// Protects the gradient by the direction, and so by moved vertices.
    #[test]
    fn adjoint_matches_central_differences() {
        let weights: [f32; MOST_FUNCTIONS] = std::array::from_fn(|k| ((k * 7 + 3) % 11) as f32 - 5.0);
        let value = |d: Vec3| -> f32 { values(d).iter().zip(&weights).map(|(v, w)| v * w).sum() };
        for d in fibonacci_sphere(50, 0.3).into_iter().chain([Vec3::Z, -Vec3::Z]) {
            let analytic = adjoint(HIGHEST_ORDER, d, &weights);
            let side = d.any_orthonormal_vector();
            for across in [side, d.cross(side)] {
                let h = 2e-3;
                let turned = |h: f32| value((d + across * h).normalize());
                let numeric = (turned(h) - turned(-h)) / (2.0 * h);
                assert!((numeric - analytic.dot(across)).abs() < 0.2, "{numeric} {analytic}");
            }
        }
    }
}
