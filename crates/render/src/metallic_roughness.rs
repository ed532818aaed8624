//! glTF's metallic-roughness BRDF under a [`Lighting`].
//!
//! Of a light from l (glTF 2.0 specification, Appendix B), with h between l and the viewer v, α = roughness²:
//!
//! ```text
//! D = α² / (π (|n × h|² + α² (n·h)²)²)                                       GGX
//! V = 0.5 / ((n·l) √((n·v)² (1 − α²) + α²) + (n·v) √((n·l)² (1 − α²) + α²))  Smith, height-correlated
//! F(F₀) = F₀ + (1 − F₀) (1 − v·h)⁵                                           Schlick
//! dielectric = mix(c / π, D V, F(0.04)),  metal = D V F(c)
//! out = (n·l) mix(dielectric, metal, metallic) · irradiance
//! ```
//!
//! Of the even and the soft light the split sum of Khronos' sample renderer (ibl.glsl), with a and b of
//! `split_sum.rs`; what bounces more than once is added back (Fdez-Agüera, "A Multiple-Scattering Microfacet Model
//! for Real-Time Image-based Lighting", 2019):
//!
//! ```text
//! k = F₀ + (max(1 − roughness, F₀) − F₀) (1 − n·v)⁵,  once = k a + b,  lost = 1 − a − b
//! E(F₀) = once + lost · once · F̄ / (1 − F̄ lost),  F̄ = F₀ + (1 − F₀) / 21
//! out = occlusion · mix(mix(c · diffuse, reflected, E(0.04)), reflected · E(c), metallic)
//! ```
//!
//! 0.04 stands for what [`Dielectric`] says: extensions change it (`material_layers.rs`). Emission is added. The normal is that of the map in the interpolated frame, as in `frame.rs`.
//!
//! Derivatives are those of the same formulas, carried along by dual numbers (`real.rs`).
//!
//! Contract: roughness is at least [`LEAST_ROUGHNESS`], as in three.js; a normal that looks away from the viewer
//! is shaded as if it were seen edge-on.

use crate::frame::Orientation;
use crate::lighting::{DirectionalLight, Lighting};
use crate::material_layers::{Dielectric, LayeredLight, MaterialLayers};
use crate::real::{Dual, Real, Triple};
use crate::shade::{Brdf, BrdfGradient, Jacobian, SHORTEST};
pub use crate::split_sum::LEAST_ROUGHNESS;
use crate::split_sum::{LEAST_COSINE, fifth, scale_and_bias};
use glam::{Vec3, Vec4};
use parbake_image::{MapKind, MapValues};
use std::f32::consts::PI;

/// glTF's metallic-roughness BRDF under this light. It reads every map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MetallicRoughness {
    /// What falls on the surface.
    pub lighting: Lighting,
}

/// All inputs.
struct Inputs<T> {
    /// The base colour.
    color: Triple<T>,
    /// The mapped normal in the tangent frame.
    mapped: Triple<T>,
    roughness: T,
    metallic: T,
    emissive: Triple<T>,
    occlusion: T,
    /// Columns tangent, bitangent, normal.
    frame: [Triple<T>; 3],
    to_viewer: Triple<T>,
}

impl<T: Real> Inputs<T> {
    fn constant(surface: &Orientation, maps: &MapValues) -> Self {
        let triple = |kind: MapKind| Triple::constant(maps[kind].truncate());
        let [_, roughness, metallic, _] = maps[MapKind::MetallicRoughness].to_array();
        Self {
            color: triple(MapKind::BaseColor),
            mapped: triple(MapKind::Normal),
            roughness: T::constant(roughness),
            metallic: T::constant(metallic),
            emissive: triple(MapKind::Emissive),
            occlusion: T::constant(maps[MapKind::Occlusion].x),
            frame: [surface.tangent, surface.bitangent, surface.normal].map(Triple::constant),
            to_viewer: Triple::constant(surface.to_viewer),
        }
    }
}

impl Inputs<Dual> {
    /// The same where three channels of one map vary.
    fn varying(surface: &Orientation, maps: &MapValues, kind: MapKind) -> Self {
        let mut inputs = Self::constant(surface, maps);
        let value = maps[kind];
        let triple = Triple(std::array::from_fn(|k| Dual::variable(value[k], k)));
        match kind {
            MapKind::BaseColor => inputs.color = triple,
            MapKind::Normal => inputs.mapped = triple,
            MapKind::Emissive => inputs.emissive = triple,
            MapKind::Occlusion => inputs.occlusion = triple.0[0],
            MapKind::MetallicRoughness => [_, inputs.roughness, inputs.metallic] = triple.0,
        }
        inputs
    }
}

/// `E(F₀)` for each channel, with the share that grazing light has, 1 but for weakened dielectrics.
fn reflected_share<T: Real>(
    (f0, f90): (Triple<T>, f32),
    roughness: T,
    grazing: T,
    [scale, bias]: [T; 2],
    lost: T,
) -> Triple<T> {
    f0.map(|f0| {
        let smooth = (-roughness + 1.0) * f90;
        let most = if smooth.value() > f0.value() { smooth } else { f0 };
        let once = (f0 + (most - f0) * grazing) * scale + bias * f90;
        let mean = f0 + (-f0 + 1.0) * (1.0 / 21.0);
        once + lost * once * mean / (-(mean * lost) + 1.0)
    })
}

impl MetallicRoughness {
    /// Under the built-in light.
    pub fn in_studio() -> Self {
        Self { lighting: Lighting::studio() }
    }

    /// The light of a surface without layers, and what its dielectric part reflects of even light, by channel.
    pub(crate) fn base(
        &self,
        surface: &Orientation,
        maps: &MapValues,
        dielectric: Dielectric,
    ) -> (Vec3, Vec3) {
        let (light, reflects) = self.shaded::<f32>(&Inputs::constant(surface, maps), dielectric);
        (Vec3::from(light.0), Vec3::from(reflects.0))
    }

    /// The same over numbers that may carry derivatives.
    fn shaded<T: Real>(&self, inputs: &Inputs<T>, own: Dielectric) -> (Triple<T>, Triple<T>) {
        let Inputs { color, metallic, to_viewer, .. } = *inputs;
        let roughness = inputs.roughness.at_least(LEAST_ROUGHNESS).at_most(1.0);
        let alpha = roughness * roughness;
        let [tangent, bitangent, normal] = inputs.frame;
        let [x, y, z] = inputs.mapped.0;
        let mapped = tangent.scale(x).plus(bitangent.scale(y)).plus(normal.scale(z));
        let length = mapped.dot(mapped).at_least(SHORTEST * SHORTEST).sqrt();
        let normal = mapped.scale(T::constant(1.0) / length);

        let towards = normal.dot(to_viewer);
        let cosine = towards.at_least(LEAST_COSINE).at_most(1.0);
        let mirrored = normal.scale(towards * 2.0).plus(to_viewer.scale(T::constant(-1.0)));
        let table = scale_and_bias(cosine, roughness);
        let (lost, grazing) = (-(table[0] + table[1]) + 1.0, fifth(-cosine + 1.0));
        let share = |f0, f90| reflected_share((f0, f90), roughness, grazing, table, lost);
        let reflected = self.lighting.reflected(mirrored, alpha);
        let scattered = color.map(|c| c * own.scatters);
        let diffuse = self.lighting.diffuse(normal).zip(scattered, |light, c| light * c);
        let reflects = share(Triple::constant(own.f0), own.f90);
        let dielectric = diffuse.mix(reflected, reflects);
        let metal = reflected.zip(share(color, 1.0), |light, share| light * share);
        let metallic = Triple([metallic; 3]);
        let mut out = dielectric.mix(metal, metallic).scale(inputs.occlusion).plus(inputs.emissive);
        for light in &self.lighting.directional {
            if let Some(more) = direct(light, normal, to_viewer, (cosine, alpha), color, metallic, own) {
                out = out.plus(more);
            }
        }
        (out, reflects)
    }
}

/// What a directional light adds; none where the surface is turned away from it.
fn direct<T: Real>(
    light: &DirectionalLight,
    normal: Triple<T>,
    to_viewer: Triple<T>,
    (cosine, alpha): (T, T),
    color: Triple<T>,
    metallic: Triple<T>,
    own: Dielectric,
) -> Option<Triple<T>> {
    let to_light: Triple<T> = Triple::constant(light.direction);
    let nl = normal.dot(to_light);
    let sum = to_light.plus(to_viewer);
    let square = sum.dot(sum);
    if nl.value() <= 0.0 || square.value() < 1e-8 {
        return None;
    }
    let half = sum.scale(T::constant(1.0) / square.sqrt());
    let (nh, vh, across) = (normal.dot(half), to_viewer.dot(half), normal.cross(half));
    let width = alpha * alpha;
    let spread = across.dot(across) + width * nh * nh;
    let distribution = width / (spread * spread * PI);
    let masked = |a: T, b: T| a * (b * b * (-width + 1.0) + width).sqrt();
    let visibility = T::constant(0.5) / (masked(nl, cosine) + masked(cosine, nl));
    let specular = Triple([distribution * visibility; 3]);
    let grazing = fifth((-vh + 1.0).at_least(0.0));
    let fresnel = |f0: T, f90: f32| f0 + (-f0 + f90) * grazing;
    let diffuse = color.map(|c| c * (own.scatters / PI));
    let dielectric = diffuse.mix(specular, Triple::constant(own.f0).map(|f0| fresnel(f0, own.f90)));
    let metal = specular.zip(color.map(|f0| fresnel(f0, 1.0)), |s, f| s * f);
    let irradiance = Triple::constant(light.color).scale(nl);
    Some(dielectric.mix(metal, metallic).zip(irradiance, |a, b| a * b))
}

/// The light, and how it changes with each of three variables.
fn columns(light: Triple<Dual>) -> (Vec4, [Vec4; 3]) {
    let [r, g, b] = light.0;
    let column = |k: usize| Vec4::new(r.slopes[k], g.slopes[k], b.slopes[k], 0.0);
    (Vec4::new(r.value, g.value, b.value, 0.0), std::array::from_fn(column))
}

impl Brdf<Orientation> for MetallicRoughness {
    fn reads(&self, _: MapKind) -> bool {
        true
    }

    fn light(&self, surface: &Orientation, maps: &MapValues) -> Vec3 {
        self.base(surface, maps, Dielectric::default()).0
    }

    fn light_in_layers(
        &self,
        surface: &Orientation,
        maps: &MapValues,
        layers: &MaterialLayers,
    ) -> LayeredLight {
        let (mut light, reflects) = self.base(surface, maps, layers.dielectric);
        let metallic = maps[MapKind::MetallicRoughness].z;
        let tint = maps[MapKind::BaseColor].truncate() * layers.attenuation;
        let passing = (1.0 - metallic) * (1.0 - layers.dielectric.scatters);
        let mut passes = (passing * (Vec3::ONE - reflects) * tint).clamp(Vec3::ZERO, Vec3::ONE);
        let occlusion = maps[MapKind::Occlusion].x;
        if let Some(sheen) = layers.sheen.filter(|s| s.color != Vec3::ZERO) {
            let normal = mapped_normal(surface, maps);
            let (added, below) = sheen.light(&self.lighting, normal, surface.to_viewer, occlusion);
            (light, passes) = (light * below + added, passes * below);
        }
        if let Some(coat) = layers.coat.filter(|coat| coat.strength > 0.0) {
            let (added, below) = coat.light(&self.lighting, surface.to_viewer, occlusion);
            (light, passes) = (light * below + added, passes * below);
        }
        LayeredLight { light, passes }
    }

    fn adjoint(&self, surface: &Orientation, maps: &MapValues, gradient: Vec3) -> BrdfGradient<Orientation> {
        let mut out = BrdfGradient::default();
        for kind in MapKind::ALL {
            out.maps[kind] = self.jacobian(kind, surface, maps).1.pull(gradient.extend(0.0));
        }
        let pull = |place: &dyn Fn(&mut Inputs<Dual>) -> &mut Triple<Dual>| {
            let mut inputs = Inputs::constant(surface, maps);
            let triple = place(&mut inputs);
            *triple = Triple(std::array::from_fn(|k| Dual::variable(triple.0[k].value, k)));
            let slopes = Jacobian::Full(columns(self.shaded(&inputs, Dielectric::default()).0).1);
            slopes.pull(gradient.extend(0.0)).truncate()
        };
        let [tangent, bitangent, normal] = [0, 1, 2].map(|k| pull(&|inputs| &mut inputs.frame[k]));
        out.surface =
            Orientation { tangent, bitangent, normal, to_viewer: pull(&|inputs| &mut inputs.to_viewer) };
        out
    }

    fn jacobian(&self, kind: MapKind, surface: &Orientation, maps: &MapValues) -> (Vec4, Jacobian) {
        let (light, slopes) =
            columns(self.shaded(&Inputs::varying(surface, maps, kind), Dielectric::default()).0);
        (light, Jacobian::Full(slopes))
    }
}

/// The unit normal that the normal map asks for, flipped with the face.
fn mapped_normal(surface: &Orientation, maps: &MapValues) -> Vec3 {
    let m = maps[MapKind::Normal];
    let world = surface.tangent * m.x + surface.bitangent * m.y + surface.normal * m.z;
    world.normalize_or(surface.to_viewer)
}

#[cfg(test)]
#[path = "metallic_roughness_tests.rs"]
mod tests;

#[cfg(test)]
#[path = "material_layers_tests.rs"]
mod layers_tests;
