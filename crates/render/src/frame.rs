//! The tangent frame at a sample, as the headlight sees it.
//!
//! With interpolated (not re-normalised) normal n and tangent t, handedness w and
//! b = w · n × t (MikkTSpace; what engines do), F = [t b n] turns a tangent-space
//! normal m into a world normal. The shading needs only `light = Fᵀ d` (d the
//! unit vector to the light) and the Gram matrix `gram = FᵀF`, since
//! `d·N / |N| = light·m / √(mᵀ gram m)`.
//! Adjoint: `dL/dF = d · gᵀ + F (G + Gᵀ)`, then through b into n and t.
//!
//! Contract: on a face seen from behind `facing` is −1 and flips the normal.

use glam::{Mat3, Vec3};

/// What the shading of one sample needs to know of the surface's orientation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TangentLight {
    /// Direction to the light, in the (not orthonormal) tangent frame, flipped
    /// with the face.
    pub light: Vec3,
    /// FᵀF as (tt, bb, nn, tb, tn, bn).
    pub gram: [f32; 6],
}

/// The same for light that does not stand with the viewer: the frame itself, and the viewer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Orientation {
    /// Interpolated tangent, flipped with the face.
    pub tangent: Vec3,
    /// Bitangent, flipped with the face.
    pub bitangent: Vec3,
    /// Interpolated normal, flipped with the face.
    pub normal: Vec3,
    /// Unit vector to the viewer.
    pub to_viewer: Vec3,
}

/// Interpolated normal and tangent to [`Orientation`].
#[inline]
pub fn orientation(
    normal: Vec3,
    tangent: Vec3,
    handedness: f32,
    to_viewer: Vec3,
    facing: f32,
) -> Orientation {
    let bitangent = normal.cross(tangent) * handedness;
    Orientation {
        tangent: tangent * facing,
        bitangent: bitangent * facing,
        normal: normal * facing,
        to_viewer,
    }
}

/// Forward: interpolated normal and tangent to [`TangentLight`].
#[inline]
pub fn tangent_light(
    normal: Vec3,
    tangent: Vec3,
    handedness: f32,
    to_light: Vec3,
    facing: f32,
) -> TangentLight {
    let bitangent = normal.cross(tangent) * handedness;
    let (t, b, n) = (tangent, bitangent, normal);
    TangentLight {
        light: Vec3::new(t.dot(to_light), b.dot(to_light), n.dot(to_light)) * facing,
        gram: [t.dot(t), b.dot(b), n.dot(n), t.dot(b), t.dot(n), b.dot(n)],
    }
}

/// Adjoint of [`tangent_light`]: gradients of (normal, tangent, direction to the
/// light).
#[inline]
pub fn tangent_light_adjoint(
    normal: Vec3,
    tangent: Vec3,
    handedness: f32,
    to_light: Vec3,
    facing: f32,
    gradient: &TangentLight,
) -> (Vec3, Vec3, Vec3) {
    let bitangent = normal.cross(tangent) * handedness;
    let frame = Mat3::from_cols(tangent, bitangent, normal);
    let g = gradient.light * facing;
    let [tt, bb, nn, tb, tn, bn] = gradient.gram;
    let mut to_t = to_light * g.x + tangent * (2.0 * tt) + bitangent * tb + normal * tn;
    let to_b = to_light * g.y + bitangent * (2.0 * bb) + tangent * tb + normal * bn;
    let mut to_n = to_light * g.z + normal * (2.0 * nn) + tangent * tn + bitangent * bn;
    to_n += tangent.cross(to_b) * handedness;
    to_t += to_b.cross(normal) * handedness;
    (to_n, to_t, frame * g)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the gradients of normals and tangents (and so of moved vertices).
    #[test]
    fn adjoint_matches_central_differences() {
        let inputs = [Vec3::new(0.1, 0.2, 0.9), Vec3::new(0.8, -0.3, 0.1), Vec3::new(0.4, 0.3, 0.8)];
        let weight =
            TangentLight { light: Vec3::new(0.4, -0.8, 1.2), gram: [0.3, -0.2, 0.6, 0.9, -0.5, 0.7] };
        for (handedness, facing) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)] {
            let value = |v: &[Vec3; 3]| {
                let out = tangent_light(v[0], v[1], handedness, v[2], facing);
                let gram: f32 = out.gram.iter().zip(weight.gram).map(|(a, b)| a * b).sum();
                out.light.dot(weight.light) + gram
            };
            let (n, t, d) =
                tangent_light_adjoint(inputs[0], inputs[1], handedness, inputs[2], facing, &weight);
            for (k, analytic) in [n, t, d].into_iter().enumerate() {
                for axis in 0..3 {
                    let (mut lo, mut hi) = (inputs, inputs);
                    lo[k][axis] -= 1e-2;
                    hi[k][axis] += 1e-2;
                    let numeric = (value(&hi) - value(&lo)) / 2e-2;
                    assert!((numeric - analytic[axis]).abs() < 2e-3, "{k}{axis}: {numeric} {analytic}");
                }
            }
        }
    }
}
