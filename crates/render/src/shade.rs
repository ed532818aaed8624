//! Shading: colour and tangent-space normal to the light that leaves the surface.
//!
//! The paper's eq. 2, `shade(d, C, N) = (d·N) C`, a Lambert surface under a
//! headlight of unit strength: `k = max(0, light·m / √(mᵀ gram m))`, out = k C.
//! [`Shading`] is the one replaceable piece: another BRDF implements it.
//! Adjoint: `dL/dC = k g`; `dL/dk = C·g`, zero where the clamp holds.
//!
//! Contract: `map_normal` need not be of unit length. Where what it maps to is shorter than
//! [`SHORTEST`], as between vertex normals that look away from each other, directions say nothing:
//! light fades to black there, and derivatives stay finite.

use crate::frame::TangentLight;
use glam::Vec3;

/// Length of a mapped normal below which it fades: about what 16 bits leave of a frame
/// (`parbake_fit::samples`).
pub const SHORTEST: f32 = 1e-2;

/// Gradients of a shaded sample's inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShadeGradient {
    /// Of the colour.
    pub color: Vec3,
    /// Of the tangent-space normal.
    pub map_normal: Vec3,
    /// Of the surface's orientation.
    pub surface: TangentLight,
}

/// A shading function with its adjoint.
pub trait Shading: Sync {
    /// Outgoing linear colour.
    fn forward(&self, surface: &TangentLight, color: Vec3, map_normal: Vec3) -> Vec3;
    /// Gradients of all inputs, given that of the output.
    fn adjoint(&self, surface: &TangentLight, color: Vec3, map_normal: Vec3, gradient: Vec3)
    -> ShadeGradient;
}

/// Lambert surface, light at the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lambert;

/// No light at all: the colour as it is (for pictures on planes).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unlit;

/// `mᵀ gram m`, and `gram m`.
#[inline]
fn gram_product(gram: &[f32; 6], m: Vec3) -> (f32, Vec3) {
    let [tt, bb, nn, tb, tn, bn] = *gram;
    let gm = Vec3::new(
        tt * m.x + tb * m.y + tn * m.z,
        tb * m.x + bb * m.y + bn * m.z,
        tn * m.x + bn * m.y + nn * m.z,
    );
    (gm.dot(m), gm)
}

/// One over a length, given its square.
#[inline]
fn inverse_length(square: f32) -> f32 {
    1.0 / square.max(SHORTEST * SHORTEST).sqrt()
}

/// Cosine between light and mapped normal, before the clamp at zero.
#[inline]
pub fn cosine(surface: &TangentLight, map_normal: Vec3) -> f32 {
    let (square, _) = gram_product(&surface.gram, map_normal);
    // Where the frame was rounded, the quotient may be more than 1.
    (surface.light.dot(map_normal) * inverse_length(square)).clamp(-1.0, 1.0)
}

/// The cosine and its derivative with respect to the map's normal.
#[inline]
pub fn cosine_with_derivative(surface: &TangentLight, map_normal: Vec3) -> (f32, Vec3) {
    let (square, gm) = gram_product(&surface.gram, map_normal);
    let inverse = inverse_length(square);
    let k = (surface.light.dot(map_normal) * inverse).clamp(-1.0, 1.0);
    (k, (surface.light - gm * (k * inverse)) * inverse)
}

impl Shading for Lambert {
    #[inline]
    fn forward(&self, surface: &TangentLight, color: Vec3, map_normal: Vec3) -> Vec3 {
        color * cosine(surface, map_normal).max(0.0)
    }

    #[inline]
    fn adjoint(
        &self,
        surface: &TangentLight,
        color: Vec3,
        map_normal: Vec3,
        gradient: Vec3,
    ) -> ShadeGradient {
        let (k, dk_dm) = cosine_with_derivative(surface, map_normal);
        if k <= 0.0 {
            return ShadeGradient::default();
        }
        let to_k = color.dot(gradient);
        let (square, _) = gram_product(&surface.gram, map_normal);
        let m = map_normal;
        // k = l·m / √q: dk/dl = m / √q, dk/dq = −k / (2q), dq/dgram = m mᵀ.
        let inverse = inverse_length(square);
        let to_q = -0.5 * k * to_k * inverse * inverse;
        ShadeGradient {
            color: gradient * k,
            map_normal: dk_dm * to_k,
            surface: TangentLight {
                light: m * (to_k * inverse),
                gram: [m.x * m.x, m.y * m.y, m.z * m.z, 2.0 * m.x * m.y, 2.0 * m.x * m.z, 2.0 * m.y * m.z]
                    .map(|d| d * to_q),
            },
        }
    }
}

impl Shading for Unlit {
    #[inline]
    fn forward(&self, _: &TangentLight, color: Vec3, _: Vec3) -> Vec3 {
        color
    }

    #[inline]
    fn adjoint(&self, _: &TangentLight, _: Vec3, _: Vec3, gradient: Vec3) -> ShadeGradient {
        ShadeGradient { color: gradient, ..Default::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weighted(shading: &dyn Shading, s: &TangentLight, c: Vec3, m: Vec3, g: Vec3) -> f32 {
        shading.forward(s, c, m).dot(g)
    }

    /// Protects the gradients of colour, normal map and frame through the light.
    #[test]
    fn lambert_adjoint_matches_central_differences() {
        let s = TangentLight { light: Vec3::new(0.2, -0.3, 0.8), gram: [0.9, 0.7, 0.8, 0.1, -0.2, 0.05] };
        let (c, m, g) = (Vec3::new(0.3, 0.6, 0.9), Vec3::new(0.2, 0.1, 0.9), Vec3::new(1.0, -0.4, 0.7));
        let a = Lambert.adjoint(&s, c, m, g);
        let h = 1e-2;
        for axis in 0..3 {
            let mut e = Vec3::ZERO;
            e[axis] = h;
            let d = |f: &dyn Fn(Vec3) -> f32| (f(e) - f(-e)) / (2.0 * h);
            let color = d(&|e| weighted(&Lambert, &s, c + e, m, g));
            let normal = d(&|e| weighted(&Lambert, &s, c, m + e, g));
            let light = d(&|e| weighted(&Lambert, &TangentLight { light: s.light + e, ..s }, c, m, g));
            assert!((color - a.color[axis]).abs() < 1e-3);
            assert!((normal - a.map_normal[axis]).abs() < 1e-3, "{normal} {}", a.map_normal);
            assert!((light - a.surface.light[axis]).abs() < 1e-3);
        }
        for k in 0..6 {
            let shifted = |e: f32| {
                let mut t = s;
                t.gram[k] += e;
                weighted(&Lambert, &t, c, m, g)
            };
            let numeric = (shifted(h) - shifted(-h)) / (2.0 * h);
            assert!((numeric - a.surface.gram[k]).abs() < 1e-3, "{k}: {numeric} {}", a.surface.gram[k]);
        }
    }

    /// Protects every fit: one degenerate frame must not outweigh all others, nor make light.
    #[test]
    fn degenerate_frames_stay_finite() {
        for gram in [[0.0; 6], [1e-12; 6], [1.0, 1.0, -1e-5, 0.0, 1e-5, 0.0]] {
            for light in [Vec3::ZERO, Vec3::splat(1e-4), Vec3::Z] {
                let (k, by_normal) = cosine_with_derivative(&TangentLight { light, gram }, Vec3::Z);
                assert!(k.abs() <= 1.0 && by_normal.length() <= 3.0 / SHORTEST, "{k} {by_normal}");
                assert_eq!(k, cosine(&TangentLight { light, gram }, Vec3::Z));
            }
        }
    }

    /// Protects against light from behind: clamped, and without a gradient.
    #[test]
    fn a_surface_turned_away_is_black() {
        let s = TangentLight { light: Vec3::new(0.0, 0.0, -1.0), gram: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0] };
        assert_eq!(Lambert.forward(&s, Vec3::ONE, Vec3::Z), Vec3::ZERO);
        assert_eq!(Lambert.adjoint(&s, Vec3::ONE, Vec3::Z, Vec3::ONE), ShadeGradient::default());
    }
}
