//! What glTF's extensions change of the metallic-roughness material, for pictures that are compared.
//!
//! - `KHR_materials_specular`, `KHR_materials_ior`: what dielectrics reflect, `F₀ = min(((n − 1) / (n + 1))² · colour, 1) ·
//!   strength` and `F₉₀ = strength` instead of 0.04 and 1.
//! - `KHR_materials_transmission`, `KHR_materials_volume`: of the light that a dielectric does not reflect, the share t
//!   passes instead of being scattered, tinted by the base colour c and, over the thickness d, by the attenuation
//!   colour a with its distance s:
//!
//!   ```text
//!   diffuse ← (1 − t) diffuse,  passes = t (1 − metallic) (1 − E(F₀)) c a^(d / s)
//!   ```
//!
//! - `KHR_materials_sheen`: a layer with the distribution of Charlie (Estevez and Kulla, "Production Friendly Microfacet
//!   Sheen BRDF", 2017) and the visibility of Neubelt and Pettineo (2013), with α = roughness² and colour s:
//!
//!   ```text
//!   D = (2 + 1/α) |n × h|^(1/α) / 2π,  V = 1 / (4 (n·l + n·v − n·l n·v))
//!   out = (1 − max(s) E) base + s (E · even and soft light + D V n·l · directional light)
//!   ```
//!
//!   with E the layer's albedo at n·v, by the fit that three.js uses (`parbake_image::material_maps`).
//! - `KHR_materials_clearcoat`: a dielectric layer of strength k with a normal n_c and a roughness of its own,
//!   `out = (1 − k F) base + k coat`, `F = F₀ + (1 − F₀) (1 − n_c·v)⁵`, `F₀ = 0.04`.
//!
//! `behind.rs` bends and blurs what passes; it is not dispersed.
//!
//! `metallic_roughness.rs` puts them together.
//!
//! Contract: forward only. What passes is from 0 to 1.

use crate::behind::Refraction;
use crate::lighting::{DirectionalLight, Lighting};
use crate::real::Triple;
use crate::split_sum::{LEAST_COSINE, LEAST_ROUGHNESS, fifth, scale_and_bias};
use glam::Vec3;
use parbake_image::material_maps::sheen_albedo_at;
use std::f32::consts::PI;

/// What a coat reflects of light that falls on it from above.
const COAT: f32 = 0.04;
/// Smoother sheens are shaded as if they had this roughness: the distribution would have no width.
const LEAST_SHEEN_ROUGHNESS: f32 = 0.07;

/// How a surface that is not metal meets light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// What it reflects of light that falls on it from above, by channel, 0 to 1.
    pub f0: Vec3,
    /// What it reflects of light that grazes it, 0 to 1.
    pub f90: f32,
    /// Share of the light that it does not reflect which it scatters, 0 to 1; the rest passes.
    pub scatters: f32,
}

impl Default for Dielectric {
    /// That of glTF without extensions: an index of refraction of 1.5, nothing passes.
    fn default() -> Self {
        Self { f0: Vec3::splat(0.04), f90: 1.0, scatters: 1.0 }
    }
}

/// The sheen of cloth: fibres that reflect at grazing angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheenLayer {
    /// Linear RGB, each from 0 to 1.
    pub color: Vec3,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
}

/// A clearcoat: a thin dielectric layer, as of varnish.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatLayer {
    /// 0 to 1.
    pub strength: f32,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// Unit vector in the frame of the picture's surface, on the viewer's side.
    pub normal: Vec3,
}

/// What lies over, and passes, a metallic-roughness material at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialLayers {
    /// What it does where it is not metal.
    pub dielectric: Dielectric,
    /// What the inside leaves of light that passes, by channel, 0 to 1.
    pub attenuation: Vec3,
    /// Where that light comes from.
    pub refraction: Refraction,
    /// Over the base.
    pub sheen: Option<SheenLayer>,
    /// Above all else.
    pub coat: Option<CoatLayer>,
}

impl Default for MaterialLayers {
    /// Nothing but a material without extensions.
    fn default() -> Self {
        Self {
            dielectric: Dielectric::default(),
            attenuation: Vec3::ONE,
            refraction: Refraction::default(),
            sheen: None,
            coat: None,
        }
    }
}

/// Light that leaves a surface, and what of the light behind it comes through.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayeredLight {
    /// Linear RGB.
    pub light: Vec3,
    /// Multiplies the light from behind, by channel.
    pub passes: Vec3,
}

impl SheenLayer {
    /// What a sheen adds, and what multiplies all that is below it.
    pub(crate) fn light(
        &self,
        lighting: &Lighting,
        normal: Vec3,
        to_viewer: Vec3,
        occlusion: f32,
    ) -> (Vec3, f32) {
        let roughness = self.roughness.clamp(LEAST_SHEEN_ROUGHNESS, 1.0);
        let cosine = normal.dot(to_viewer).clamp(LEAST_COSINE, 1.0);
        let albedo = sheen_albedo_at(cosine, roughness).min(1.0);
        let mut light = Vec3::from(lighting.diffuse(Triple(normal.to_array())).0) * albedo * occlusion;
        for lamp in &lighting.directional {
            let Some((nl, half)) = lit(lamp, normal, to_viewer) else { continue };
            let inverse = 1.0 / (roughness * roughness);
            let sine = normal.cross(half).length().min(1.0);
            let distribution = (2.0 + inverse) * sine.powf(inverse) / (2.0 * PI);
            light += lamp.color * (distribution / (4.0 * (nl + cosine - nl * cosine)) * nl);
        }
        (light * self.color, 1.0 - self.color.max_element() * albedo)
    }
}

impl CoatLayer {
    /// What a coat adds, and what multiplies all that is below it.
    pub(crate) fn light(&self, lighting: &Lighting, to_viewer: Vec3, occlusion: f32) -> (Vec3, f32) {
        let roughness = self.roughness.clamp(LEAST_ROUGHNESS, 1.0);
        let alpha = roughness * roughness;
        let towards = self.normal.dot(to_viewer);
        let cosine = towards.clamp(LEAST_COSINE, 1.0);
        let mirrored = self.normal * (2.0 * towards) - to_viewer;
        let [scale, bias] = scale_and_bias(cosine, roughness);
        let reflected = Vec3::from(lighting.reflected(Triple(mirrored.to_array()), alpha).0);
        let mut light = reflected * (COAT * scale + bias) * occlusion;
        for lamp in &lighting.directional {
            let Some((nl, half)) = lit(lamp, self.normal, to_viewer) else { continue };
            let (nh, across, width) =
                (self.normal.dot(half), self.normal.cross(half).length_squared(), alpha * alpha);
            let spread = across + width * nh * nh;
            let masked = |a: f32, b: f32| a * (b * b * (1.0 - width) + width).sqrt();
            let visibility = 0.5 / (masked(nl, cosine) + masked(cosine, nl));
            let fresnel = COAT + (1.0 - COAT) * fifth((1.0 - to_viewer.dot(half)).max(0.0));
            light += lamp.color * (width / (PI * spread * spread) * visibility * fresnel * nl);
        }
        let fresnel = COAT + (1.0 - COAT) * fifth(1.0 - cosine);
        (light * self.strength, 1.0 - self.strength * fresnel)
    }
}

/// The cosine to a lamp, and the half vector; none where the lamp is behind the surface or the viewer.
fn lit(lamp: &DirectionalLight, normal: Vec3, to_viewer: Vec3) -> Option<(f32, Vec3)> {
    let nl = normal.dot(lamp.direction);
    let sum = lamp.direction + to_viewer;
    (nl > 0.0 && sum.length_squared() >= 1e-8).then(|| (nl, sum.normalize()))
}
