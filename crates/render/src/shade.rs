//! Shading: colour and tangent-space normal to the light that leaves the surface.
//!
//! The paper's eq. 2, `shade(d, C, N) = (d·N) C`, a Lambert surface under a
//! headlight of unit strength, which sends out E besides: `k = max(0, light·m / √(mᵀ gram m))`,
//! out = k C + E.
//! [`Brdf`] is the one replaceable piece: glTF's metallic-roughness material is another, in
//! `metallic_roughness.rs`.
//! Adjoint: `dL/dC = k g`; `dL/dE = g`; `dL/dk = C·g`, zero where the clamp holds.
//!
//! Contract: `map_normal` need not be of unit length. Where what it maps to is shorter than
//! [`SHORTEST`], as between vertex normals that look away from each other, directions say nothing:
//! light fades to black there, and derivatives stay finite.

use crate::frame::TangentLight;
use crate::material_layers::{LayeredLight, MaterialLayers};
use glam::{Vec3, Vec4};
use parbake_image::{MapKind, MapValues};

/// Length of a mapped normal below which it fades: about what 16 bits leave of a frame
/// (`parbake_views::samples`).
pub const SHORTEST: f32 = 1e-2;

/// Derivative of a loss by all that shading reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrdfGradient<S = TangentLight> {
    /// By the value of each map.
    pub maps: MapValues,
    /// By the surface's orientation.
    pub surface: S,
}

impl<S: Default> Default for BrdfGradient<S> {
    fn default() -> Self {
        Self { maps: MapValues::ZERO, surface: S::default() }
    }
}

/// How the light of a sample changes with the value of one map: three channels by three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Jacobian {
    /// Each channel of the light depends on the same channel of the map: the diagonal.
    Diagonal(Vec4),
    /// All channels of the light depend on the map through one number: `light · valueᵀ`.
    RankOne {
        /// Change of the light with that number.
        light: Vec4,
        /// Change of that number with the map's value.
        value: Vec3,
        /// Where the surface is turned away from the light, a change can only make it brighter.
        only_brighter: bool,
    },
    /// Any other: how the light changes with each channel of the map.
    Full([Vec4; 3]),
}

impl Jacobian {
    /// The gradient by the map's value, given that by the light: `Jᵀ g`.
    #[inline(always)]
    pub fn pull(&self, to_light: Vec4) -> Vec4 {
        match *self {
            Self::Diagonal(slopes) => to_light * slopes,
            Self::RankOne { light, value, only_brighter } => {
                let along = to_light.dot(light);
                if only_brighter && along >= 0.0 { Vec4::ZERO } else { (value * along).extend(0.0) }
            }
            Self::Full(columns) => Vec3::from(columns.map(|column| to_light.dot(column))).extend(0.0),
        }
    }
}

/// A BRDF with its light: the one replaceable piece of shading. Renderer, references, texture
/// solves, the parallax fit and vertices know no other.
///
/// `S` is what it needs to know of the surface's orientation: with a light that stands with the viewer a
/// [`TangentLight`], which is all that samples of a fit carry, else an
/// [`Orientation`](crate::frame::Orientation).
pub trait Brdf<S = TangentLight>: Sync {
    /// Whether the light depends on this map.
    fn reads(&self, kind: MapKind) -> bool;

    /// Outgoing linear light, three channels.
    fn light(&self, surface: &S, maps: &MapValues) -> Vec3;

    /// The same of a surface with what glTF's extensions change of it; a BRDF that knows none ignores them.
    fn light_in_layers(&self, surface: &S, maps: &MapValues, _: &MaterialLayers) -> LayeredLight {
        LayeredLight { light: self.light(surface, maps), passes: Vec3::ZERO }
    }

    /// Adjoint of [`Brdf::light`]: the gradient by all inputs, given that by the light.
    fn adjoint(&self, surface: &S, maps: &MapValues, gradient: Vec3) -> BrdfGradient<S>;

    /// Outgoing light as of [`Brdf::light`], and its derivative by one map that the BRDF reads.
    fn jacobian(&self, kind: MapKind, surface: &S, maps: &MapValues) -> (Vec4, Jacobian);
}

/// Lambert surface that may shine by itself, light at the camera: `max(0, k) C + E`.
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

impl Brdf for Lambert {
    #[inline(always)]
    fn reads(&self, kind: MapKind) -> bool {
        matches!(kind, MapKind::BaseColor | MapKind::Normal | MapKind::Emissive)
    }

    #[inline]
    fn light(&self, surface: &TangentLight, maps: &MapValues) -> Vec3 {
        let k = cosine(surface, maps[MapKind::Normal].truncate()).max(0.0);
        maps[MapKind::BaseColor].truncate() * k + maps[MapKind::Emissive].truncate()
    }

    #[inline]
    fn adjoint(&self, surface: &TangentLight, maps: &MapValues, gradient: Vec3) -> BrdfGradient {
        let (color, m) = (maps[MapKind::BaseColor].truncate(), maps[MapKind::Normal].truncate());
        let (k, dk_dm) = cosine_with_derivative(surface, m);
        let mut out = BrdfGradient::default();
        out.maps[MapKind::Emissive] = gradient.extend(0.0);
        if k <= 0.0 {
            return out;
        }
        let to_k = color.dot(gradient);
        let (square, _) = gram_product(&surface.gram, m);
        // k = l·m / √q: dk/dl = m / √q, dk/dq = −k / (2q), dq/dgram = m mᵀ.
        let inverse = inverse_length(square);
        let to_q = -0.5 * k * to_k * inverse * inverse;
        out.maps[MapKind::BaseColor] = (gradient * k).extend(0.0);
        out.maps[MapKind::Normal] = (dk_dm * to_k).extend(0.0);
        out.surface = TangentLight {
            light: m * (to_k * inverse),
            gram: [m.x * m.x, m.y * m.y, m.z * m.z, 2.0 * m.x * m.y, 2.0 * m.x * m.z, 2.0 * m.y * m.z]
                .map(|d| d * to_q),
        };
        out
    }

    #[inline]
    fn jacobian(&self, kind: MapKind, surface: &TangentLight, maps: &MapValues) -> (Vec4, Jacobian) {
        let (albedo, emissive) = (maps[MapKind::BaseColor], maps[MapKind::Emissive]);
        let m = maps[MapKind::Normal].truncate();
        if kind == MapKind::Normal {
            let (k, value) = cosine_with_derivative(surface, m);
            let slope = Jacobian::RankOne { light: albedo, value, only_brighter: k <= 0.0 };
            return (albedo * k.max(0.0) + emissive, slope);
        }
        let k = cosine(surface, m).max(0.0);
        let slopes = match kind {
            MapKind::BaseColor => Vec4::splat(k),
            MapKind::Emissive => Vec4::ONE,
            _ => Vec4::ZERO,
        };
        (albedo * k + emissive, Jacobian::Diagonal(slopes))
    }
}

impl Brdf for Unlit {
    #[inline(always)]
    fn reads(&self, kind: MapKind) -> bool {
        kind == MapKind::BaseColor
    }

    #[inline]
    fn light(&self, _: &TangentLight, maps: &MapValues) -> Vec3 {
        maps[MapKind::BaseColor].truncate()
    }

    #[inline]
    fn adjoint(&self, _: &TangentLight, _: &MapValues, gradient: Vec3) -> BrdfGradient {
        let mut out = BrdfGradient::default();
        out.maps[MapKind::BaseColor] = gradient.extend(0.0);
        out
    }

    #[inline]
    fn jacobian(&self, kind: MapKind, _: &TangentLight, maps: &MapValues) -> (Vec4, Jacobian) {
        let slope = if kind == MapKind::BaseColor { Vec4::ONE } else { Vec4::ZERO };
        (maps[MapKind::BaseColor], Jacobian::Diagonal(slope))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weighted(brdf: &dyn Brdf, s: &TangentLight, c: Vec3, m: Vec3, g: Vec3) -> f32 {
        brdf.light(s, &MapValues::of(c, m)).dot(g)
    }

    /// Protects the gradients of colour, normal map and frame through the light.
    #[test]
    fn lambert_adjoint_matches_central_differences() {
        let s = TangentLight { light: Vec3::new(0.2, -0.3, 0.8), gram: [0.9, 0.7, 0.8, 0.1, -0.2, 0.05] };
        let (c, m, g) = (Vec3::new(0.3, 0.6, 0.9), Vec3::new(0.2, 0.1, 0.9), Vec3::new(1.0, -0.4, 0.7));
        let a = Lambert.adjoint(&s, &MapValues::of(c, m), g);
        let h = 1e-2;
        for axis in 0..3 {
            let mut e = Vec3::ZERO;
            e[axis] = h;
            let d = |f: &dyn Fn(Vec3) -> f32| (f(e) - f(-e)) / (2.0 * h);
            let color = d(&|e| weighted(&Lambert, &s, c + e, m, g));
            let normal = d(&|e| weighted(&Lambert, &s, c, m + e, g));
            let light = d(&|e| weighted(&Lambert, &TangentLight { light: s.light + e, ..s }, c, m, g));
            assert!((color - a.maps[MapKind::BaseColor][axis]).abs() < 1e-3);
            assert!((normal - a.maps[MapKind::Normal][axis]).abs() < 1e-3, "{normal} {a:?}");
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
        assert_eq!(Lambert.light(&s, &MapValues::of(Vec3::ONE, Vec3::Z)), Vec3::ZERO);
        let gradient = Lambert.adjoint(&s, &MapValues::of(Vec3::ONE, Vec3::Z), Vec3::ONE);
        for kind in [MapKind::BaseColor, MapKind::Normal] {
            assert_eq!(gradient.maps[kind], Vec4::ZERO);
        }
        assert_eq!(gradient.surface, TangentLight::default());
    }

    /// Protects every map's solve: the Jacobian is the light's derivative, channel by channel, and the
    /// adjoint is its transpose.
    #[test]
    fn jacobians_match_central_differences() {
        let s = TangentLight { light: Vec3::new(0.2, -0.3, 0.8), gram: [0.9, 0.7, 0.8, 0.1, -0.2, 0.05] };
        let mut values = MapValues::of(Vec3::new(0.3, 0.6, 0.9), Vec3::new(0.2, 0.1, 0.9));
        values[MapKind::Emissive] = Vec4::new(0.1, 0.4, 0.2, 0.0);
        let (g, h) = (Vec3::new(1.0, -0.4, 0.7), 1e-2);
        let adjoint = Lambert.adjoint(&s, &values, g);
        for kind in MapKind::ALL.into_iter().filter(|kind| Lambert.reads(*kind)) {
            let (light, jacobian) = Lambert.jacobian(kind, &s, &values);
            assert_eq!(light.truncate(), Lambert.light(&s, &values));
            let pulled = jacobian.pull(g.extend(0.0));
            for axis in 0..3 {
                let at = |step: f32| {
                    let mut moved = values;
                    moved[kind][axis] += step;
                    Lambert.light(&s, &moved).dot(g)
                };
                let difference = (at(h) - at(-h)) / (2.0 * h);
                assert!((difference - pulled[axis]).abs() < 1e-3, "{kind:?} {axis}: {difference} {pulled}");
                assert!((pulled[axis] - adjoint.maps[kind][axis]).abs() < 1e-5, "{kind:?} {axis}");
            }
        }
    }
}
