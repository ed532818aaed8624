//! The functions that the coefficients of parallax maps and cutouts multiply, and the directions that they are
//! functions of ([`Basis`]).
//!
//! Harmonics: of the direction d to the viewer in the mesh's own axes (`spherical_harmonics.rs`).
//! In the tangent frame: of the line of sight w = ±(d·t, d·b, d·n) with w.z ≥ 0, where n is the interpolated
//! vertex normal, t the interpolated tangent made perpendicular to it, both of unit length, and b = ±n × t the
//! bitangent.
//!
//! * Shifts: x, y, xz, yz. Divided by z, as shifts are, the first two are classic parallax mapping, the last two
//!   parallax mapping with offset limiting (Kaneko et al. 2001; Welsh 2004), both with a matrix of two by two
//!   in the place of a height.
//! * Cutouts: what leaves a surface out is a horizon, whose height depends on the azimuth: up to three waves
//!   around the normal, and polynomials in z. They are orthonormal over the hemisphere, as those of Gautron et
//!   al. 2004 are: with monomials the fit is so ill-conditioned that it loses 2 dB at outlines.
//!
//! Contract: directions are unit vectors; the derivatives are those of the polynomials, in x, y and z as if these
//! were independent.

use crate::spherical_harmonics::{self, MOST_FUNCTIONS, as_constant};
use parbake_model::Basis;
use parbake_model::glam::Vec3;

/// What a direction is told in: the interpolated normal and tangent of a surface, of any length, in the mesh's
/// axes, and the tangent frame's handedness.
#[derive(Clone, Copy, Debug)]
pub struct VertexFrame {
    /// Interpolated `NORMAL`.
    pub normal: Vec3,
    /// Interpolated `TANGENT`.
    pub tangent: Vec3,
    /// 1, or −1 where the texture is mirrored.
    pub handedness: f32,
}

/// From where a point is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewDirection {
    /// Unit vector to the viewer in the mesh's axes, or the line of sight in the tangent frame.
    pub direction: Vec3,
    /// Cosine between that and the vertex normal, −1 … 1; of a line 0 … 1.
    pub cosine: f32,
}

/// From where a surface is seen, as the functions of a basis have it; `to_viewer` is of unit length.
#[inline]
pub fn view_direction(basis: Basis, frame: &VertexFrame, to_viewer: Vec3) -> ViewDirection {
    let normal = frame.normal.normalize_or_zero();
    let cosine = normal.dot(to_viewer);
    if !basis.is_tangent() {
        return ViewDirection { direction: to_viewer, cosine };
    }
    let tangent = (frame.tangent - normal * normal.dot(frame.tangent)).normalize_or_zero();
    let bitangent = normal.cross(tangent) * frame.handedness;
    let line = Vec3::new(to_viewer.dot(tangent), to_viewer.dot(bitangent), cosine);
    let line = if cosine < 0.0 { -line } else { line };
    ViewDirection { direction: line, cosine: line.z }
}

/// Calls `with` with the number of functions as a constant, so that the compiler can lay loops over them out as
/// straight lines, and with their values: maps are fetched once a sample, a hundred million times a fit.
#[inline(always)]
pub(crate) fn with_values<R>(
    basis: Basis,
    d: Vec3,
    with: impl FnOnce(usize, &[f32; MOST_FUNCTIONS]) -> R,
) -> R {
    let mut values = [0.0; MOST_FUNCTIONS];
    match basis {
        Basis::Harmonics(order) => as_constant(order, |order| {
            spherical_harmonics::evaluate(order, d, &mut values);
            with(spherical_harmonics::functions(order), &values)
        }),
        Basis::TangentShift => {
            values[..4].copy_from_slice(&of_shift(d));
            with(4, &values)
        }
        Basis::TangentCutout => {
            values[..12].copy_from_slice(&of_cutout(d));
            with(12, &values)
        }
    }
}

/// The gradient of d, given those of the functions' values.
pub(crate) fn adjoint(basis: Basis, d: Vec3, to_values: &[f32; MOST_FUNCTIONS]) -> Vec3 {
    let Vec3 { x, y, z } = d;
    match basis {
        Basis::Harmonics(order) => spherical_harmonics::adjoint(order, d, to_values),
        Basis::TangentShift => {
            let [a, b, c, d, ..] = *to_values;
            Vec3::new(a + c * z, b + d * z, c * x + d * y)
        }
        Basis::TangentCutout => {
            let g: [f32; 12] = std::array::from_fn(|k| SCALES[k] * to_values[k]);
            let (cos_2, sin_2, t) = (x * x - y * y, 2.0 * x * y, z - TILT);
            Vec3::new(
                g[4] + g[6] * t + 2.0 * (g[8] * x + g[9] * y) + 3.0 * (g[10] * cos_2 + g[11] * sin_2),
                g[5] + g[7] * t + 2.0 * (g[9] * x - g[8] * y) + 3.0 * (g[11] * cos_2 - g[10] * sin_2),
                2.0 * g[1]
                    + (12.0 * z - 6.0) * g[2]
                    + (60.0 * z * (z - 1.0) + 12.0) * g[3]
                    + g[6] * x
                    + g[7] * y,
            )
        }
    }
}

/// x, y, xz, yz.
#[inline(always)]
fn of_shift(w: Vec3) -> [f32; 4] {
    [w.x, w.y, w.x * w.z, w.y * w.z]
}

/// Makes the functions of cutouts unit vectors: the mean of their squares over the hemisphere is 1.
const SCALES: [f32; 12] = [
    1.0,
    1.732_050_8,
    2.236_068,
    2.645_751_3,
    1.732_050_8,
    1.732_050_8,
    7.108_338,
    7.108_338,
    1.936_491_7,
    1.936_491_7,
    2.091_65,
    2.091_65,
];
/// The mean of z, weighed by the square of x, so that x (z − TILT) and x are orthogonal.
const TILT: f32 = 0.375;

/// 1; Legendre polynomials of 2z − 1; x and y, and both times z − 3/8; two and three waves around the normal.
#[inline(always)]
fn of_cutout(w: Vec3) -> [f32; 12] {
    let Vec3 { x, y, z } = w;
    let (cos_2, sin_2) = (x * x - y * y, 2.0 * x * y);
    let (cos_3, sin_3) = (x * cos_2 - y * sin_2, x * sin_2 + y * cos_2);
    let (square, tilted) = (z * z, z - TILT);
    let second = 6.0 * (square - z) + 1.0;
    let third = (20.0 * z - 30.0) * square + 12.0 * z - 1.0;
    let own = [1.0, 2.0 * z - 1.0, second, third, x, y, x * tilted, y * tilted, cos_2, sin_2, cos_3, sin_3];
    std::array::from_fn(|k| SCALES[k] * own[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects readers of our files: order and signs of the functions.
    #[test]
    fn functions_are_those_of_the_format() {
        let w = Vec3::new(0.48, -0.6, 0.64);
        let want = [0.48, -0.6, 0.3072, -0.384];
        with_values(Basis::TangentShift, w, |count, have| {
            assert!(
                count == 4 && have.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-6),
                "{:?}",
                &have[..4]
            );
        });
        let want = CUTOUT_AT_W;
        with_values(Basis::TangentCutout, w, |count, have| {
            assert!(
                count == 12 && have.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-5),
                "{:?}",
                &have[..12]
            );
        });
    }

    const CUTOUT_AT_W: [f32; 12] = [
        1.0, 0.484_974, -0.855_073, -0.966_018, 0.831_384, -1.039_23, 0.904_181, -1.130_226, -0.250_969,
        -1.115_419, -0.852_992, -0.415_653,
    ];

    /// Protects the fit's conditioning: the functions of cutouts are orthonormal over the hemisphere.
    #[test]
    fn functions_of_cutouts_are_orthonormal() {
        let (rings, steps) = (200, 60);
        let mut gram = [[0.0f64; 12]; 12];
        for (ring, step) in (0..rings).flat_map(|r| (0..steps).map(move |s| (r, s))) {
            let z = (ring as f32 + 0.5) / rings as f32;
            let (sin, cos) = (step as f32 / steps as f32 * std::f32::consts::TAU).sin_cos();
            let across = (1.0 - z * z).sqrt();
            let values = of_cutout(Vec3::new(across * cos, across * sin, z));
            for (row, a) in gram.iter_mut().zip(values) {
                row.iter_mut().zip(values).for_each(|(sum, b)| *sum += f64::from(a * b));
            }
        }
        for (i, k) in (0..12).flat_map(|i| (0..12).map(move |k| (i, k))) {
            let (mean, want) = (gram[i][k] / f64::from(rings * steps), if i == k { 1.0 } else { 0.0 });
            assert!((mean - want).abs() < 2e-3, "{i} {k}: {mean}");
        }
    }

    /// Protects the fit of vertices behind a map: derivatives of all functions by central differences.
    #[test]
    fn adjoint_matches_central_differences() {
        for basis in [Basis::TangentShift, Basis::TangentCutout, Basis::Harmonics(2)] {
            let w = Vec3::new(0.48, -0.6, 0.64);
            let mut to_values = [0.0; MOST_FUNCTIONS];
            (0..basis.count()).for_each(|k| to_values[k] = ((k * 37 + 11) % 101) as f32 / 50.0 - 1.0);
            let sum = |w| with_values(basis, w, |n, v| (0..n).map(|k| v[k] * to_values[k]).sum::<f32>());
            let have = adjoint(basis, w, &to_values);
            for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                let step = 3e-3;
                let want = (sum(w + axis * step) - sum(w - axis * step)) / (2.0 * step);
                assert!((have.dot(axis) - want).abs() < 2e-3, "{basis:?} {axis}: {} {want}", have.dot(axis));
            }
        }
    }

    /// Protects both sides of a sheet, and mirrored texture: the line is the same from either end, and turns with
    /// the frame.
    #[test]
    fn a_line_has_no_direction() {
        let frame =
            VertexFrame { normal: Vec3::Z * 2.0, tangent: Vec3::new(3.0, 0.0, 1.0), handedness: -1.0 };
        let d = Vec3::new(0.48, -0.6, 0.64);
        let line = view_direction(Basis::TangentShift, &frame, d);
        assert!(
            (line.direction - Vec3::new(0.48, 0.6, 0.64)).length() < 1e-6 && line.cosine == line.direction.z
        );
        assert_eq!(view_direction(Basis::TangentShift, &frame, -d), line);
        let harmonic = view_direction(Basis::Harmonics(1), &frame, -d);
        assert_eq!((harmonic.direction, harmonic.cosine), (-d, -0.64));
    }
}
