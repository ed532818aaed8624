//! Light from all sides without files: an even part, soft lamps as spherical Gaussians, and lamps far away.
//!
//! The radiance from direction ω is `A + Σ aᵢ exp(λᵢ (μᵢ·ω − 1))`. Of such a sum both integrals that split-sum
//! shading needs have closed forms:
//!
//! - Irradiance: Stephen Hill's fit to a Gaussian over the clamped cosine (in Pettineo, "SG Series Part 3: Diffuse
//!   Lighting From an SG Light Source", 2016), whose error is below 2.5 % of the peak (tested).
//! - Prefiltered radiance at a roughness: GGX's lobe about the mirrored direction, seen from above, is close to a
//!   Gaussian of sharpness `λ = 1 / (2 α²)` (Wang et al., "All-Frequency Rendering of Dynamic, Spatially-Varying
//!   Reflectance", 2009, section 4.3). Two Gaussians of sharpness λ and λᵢ, one smoothed by the other, give about
//!   one of `λ λᵢ / (λ + λᵢ)` with the same integral.
//!
//! Contract: directions are unit vectors of the common frame, +Y up, +Z to the front. Nothing casts shadows.

use crate::real::{Real, Triple};
use glam::Vec3;
use std::f32::consts::PI;

/// A soft lamp: `color · exp(sharpness (axis·ω − 1))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftLight {
    /// Unit vector to its middle.
    axis: Vec3,
    /// More is narrower; above 0.
    sharpness: f32,
    /// Linear radiance in its middle.
    color: Vec3,
    /// What multiplies the fitted cosine of [`SoftLight::diffuse`].
    scale: f32,
    /// What is added to it then.
    bias: f32,
    /// Of the range of cosines around 0 over which Hill's fit is a parabola.
    width: f32,
    /// `∫ exp(λ (μ·ω − 1)) dω`.
    whole: f32,
}

/// A lamp so far away that its light is parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Unit vector to it.
    pub direction: Vec3,
    /// Linear irradiance on a surface that faces it.
    pub color: Vec3,
}

/// All light that falls on a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lighting {
    /// Linear radiance from everywhere.
    pub ambient: Vec3,
    /// Soft lamps.
    pub soft: Vec<SoftLight>,
    /// Lamps far away.
    pub directional: Vec<DirectionalLight>,
}

/// `∫ exp(λ (μ·ω − 1)) dω`.
fn integral<T: Real>(sharpness: T) -> T {
    ((sharpness * -2.0).exp() * -1.0 + 1.0) * (2.0 * PI) / sharpness
}

impl SoftLight {
    /// A lamp about `axis`, a unit vector, with this linear radiance in its middle; the larger `sharpness`, which is above 0,
    /// the narrower.
    pub fn new(axis: Vec3, sharpness: f32, color: Vec3) -> Self {
        let (once, twice) = ((-sharpness).exp(), (-2.0 * sharpness).exp());
        let scale = 1.0 + 2.0 * twice - 1.0 / sharpness;
        let bias = (once - twice) / sharpness - twice;
        let width = (1.0 - scale).max(1e-6).sqrt();
        Self { axis, sharpness, color, scale, bias, width, whole: integral(sharpness) }
    }

    /// Irradiance over π for a surface whose normal has this cosine to the axis, as a share of the colour.
    fn diffuse<T: Real>(&self, cosine: T) -> T {
        const SHARE: f32 = 0.36;
        let (x0, x1) = (cosine * SHARE, self.width / (4.0 * SHARE));
        let lit = if x0.value().abs() <= x1 {
            let n = x0 + x1;
            n * n * (1.0 / self.width)
        } else {
            cosine.at_least(0.0).at_most(1.0)
        };
        (lit * self.scale + self.bias).at_least(0.0) * (self.whole / PI)
    }

    /// Radiance about a direction with this cosine to the axis, smoothed by a lobe of this sharpness, as a share of
    /// the colour.
    fn smoothed<T: Real>(&self, cosine: T, lobe: T) -> T {
        let own = T::constant(self.sharpness);
        let sharpness = lobe * own / (lobe + own);
        (sharpness * (cosine + -1.0)).exp() * T::constant(self.whole) / integral(sharpness)
    }
}

impl Lighting {
    /// The built-in light: that of a bright room with a window above, soft lamps on three sides, and one lamp far
    /// away. White matte surfaces are nowhere much brighter than white.
    pub fn studio() -> Self {
        let soft = |axis: [f32; 3], sharpness, color: [f32; 3]| {
            SoftLight::new(Vec3::from(axis).normalize(), sharpness, Vec3::from(color))
        };
        Self {
            ambient: Vec3::new(0.16, 0.165, 0.175),
            soft: vec![
                soft([0.0, 1.0, 0.0], 2.0, [0.42, 0.44, 0.48]),
                soft([0.0, -1.0, 0.0], 2.5, [0.14, 0.12, 0.10]),
                soft([0.6, 0.7, 0.5], 24.0, [4.6, 4.4, 4.1]),
                soft([-0.9, 0.25, 0.35], 16.0, [1.2, 1.35, 1.6]),
                soft([-0.3, 0.45, -0.85], 30.0, [3.4, 3.4, 3.6]),
                soft([0.95, 0.05, -0.3], 60.0, [4.2, 3.8, 3.2]),
            ],
            directional: vec![DirectionalLight {
                direction: Vec3::new(-0.3, 0.8, 0.55).normalize(),
                color: Vec3::new(0.95, 0.92, 0.86),
            }],
        }
    }

    /// Irradiance over π of all but the directional lights: what a white matte surface with this normal sends out.
    pub(crate) fn diffuse<T: Real>(&self, normal: Triple<T>) -> Triple<T> {
        let of = |sum: Triple<T>, light: &SoftLight| {
            let share = light.diffuse(Triple::constant(light.axis).dot(normal));
            sum.plus(Triple::constant(light.color).scale(share))
        };
        self.soft.iter().fold(Triple::constant(self.ambient), of)
    }

    /// Radiance about a direction, smoothed as wide as a surface of this α = roughness² reflects.
    pub(crate) fn reflected<T: Real>(&self, direction: Triple<T>, alpha: T) -> Triple<T> {
        let lobe = T::constant(0.5) / (alpha * alpha);
        let of = |sum: Triple<T>, light: &SoftLight| {
            let share = light.smoothed(Triple::constant(light.axis).dot(direction), lobe);
            sum.plus(Triple::constant(light.color).scale(share))
        };
        self.soft.iter().fold(Triple::constant(self.ambient), of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::fibonacci_sphere;

    /// The mean over many directions, times the sphere's area.
    fn over_sphere(of: impl Fn(Vec3) -> f32) -> f32 {
        let directions = fibonacci_sphere(40_000, 0.1);
        let sum: f64 = directions.iter().map(|&d| f64::from(of(d))).sum();
        (sum * 4.0 * std::f64::consts::PI / directions.len() as f64) as f32
    }

    /// Protects matte surfaces: the closed form is the integral over the clamped cosine.
    #[test]
    fn irradiance_matches_the_integral() {
        for sharpness in [2.0, 8.0, 30.0, 60.0] {
            let light = SoftLight::new(Vec3::Y, sharpness, Vec3::ONE);
            let peak = light.diffuse(1.0f32);
            for cosine in [-0.9f32, -0.3, 0.0, 0.2, 0.6, 1.0] {
                let normal = Vec3::new((1.0 - cosine * cosine).sqrt(), cosine, 0.0);
                let radiance = |d: Vec3| (sharpness * (d.y - 1.0)).exp();
                let exact = over_sphere(|d| radiance(d) * d.dot(normal).max(0.0)) / PI;
                let found = light.diffuse(cosine);
                assert!((found - exact).abs() < 0.025 * peak, "{sharpness} {cosine}: {found} {exact}");
            }
        }
    }

    /// Protects mirrors: smooth ones show the lamp as it is, rough ones the same light spread out.
    #[test]
    fn smoothing_keeps_the_light() {
        let light = SoftLight::new(Vec3::Y, 20.0, Vec3::ONE);
        assert!((light.smoothed(0.9f32, 1e6) - (20.0f32 * -0.1).exp()).abs() < 1e-3);
        let whole = integral::<f32>(20.0);
        for lobe in [0.5f32, 5.0, 100.0] {
            let kept = over_sphere(|d| light.smoothed(d.y, lobe));
            assert!((kept / whole - 1.0).abs() < 0.01, "{lobe} {kept} {whole}");
        }
        assert!(light.smoothed(1.0f32, 5.0) < light.smoothed(1.0f32, 100.0));
    }

    /// Protects pictures from clipping: white matte surfaces stay near white under the built-in light, and none is
    /// black.
    #[test]
    fn the_studio_is_neither_dark_nor_glaring() {
        let studio = Lighting::studio();
        for normal in fibonacci_sphere(200, 0.0) {
            let mut light = Vec3::from(studio.diffuse(Triple(normal.to_array())).0);
            for lamp in &studio.directional {
                light += lamp.color * (lamp.direction.dot(normal).max(0.0) / PI);
            }
            assert!(light.min_element() > 0.15 && light.max_element() < 1.3, "{normal} {light}");
        }
    }
}
