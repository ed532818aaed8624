//! Layers over a flat surface that looks up the z axis.

use super::*;
use crate::camera::fibonacci_sphere;
use crate::material_layers::{CoatLayer, SheenLayer};
use parbake_image::material_maps::sheen_albedo_at;

fn flat(to_viewer: Vec3) -> Orientation {
    Orientation { tangent: Vec3::X, bitangent: Vec3::Y, normal: Vec3::Z, to_viewer }
}

fn tilted(cosine: f32) -> Vec3 {
    Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
}

fn maps(color: Vec3, roughness: f32, metallic: f32) -> MapValues {
    let mut maps = MapValues::of(color, Vec3::Z);
    maps[MapKind::MetallicRoughness] = glam::Vec4::new(0.0, roughness, metallic, 0.0);
    maps
}

/// As bright from everywhere as a white surface.
fn even() -> MetallicRoughness {
    MetallicRoughness { lighting: Lighting { ambient: Vec3::ONE, ..Lighting::default() } }
}

fn one_lamp(direction: Vec3) -> MetallicRoughness {
    let lamp = DirectionalLight { direction, color: Vec3::ONE };
    MetallicRoughness { lighting: Lighting { directional: vec![lamp], ..Lighting::default() } }
}

fn varnish(roughness: f32) -> MaterialLayers {
    let coat = CoatLayer { strength: 1.0, roughness, normal: Vec3::Z };
    MaterialLayers { coat: Some(coat), ..MaterialLayers::default() }
}

/// Lets all light pass that it does not reflect.
fn glass() -> MaterialLayers {
    let dielectric = Dielectric { scatters: 0.0, ..Dielectric::default() };
    MaterialLayers { dielectric, ..MaterialLayers::default() }
}

/// Protects all materials without extensions: the same light, to the bit.
#[test]
fn without_layers_nothing_changes() {
    let brdf = MetallicRoughness::in_studio();
    for cosine in [0.1, 0.5, 0.95] {
        let (surface, maps) = (flat(tilted(cosine)), maps(Vec3::new(0.8, 0.4, 0.1), 0.3, 0.4));
        let layered = brdf.light_in_layers(&surface, &maps, &MaterialLayers::default());
        assert_eq!(layered.light, crate::shade::Brdf::light(&brdf, &surface, &maps));
        assert_eq!(layered.passes, Vec3::ZERO);
    }
}

/// Protects the balance of light: in even light, nothing with a sheen, a coat or light that passes is brighter than
/// that light; rough coats seen edge-on take most of it, since what bounces twice inside is not counted.
#[test]
fn layers_neither_make_nor_swallow_light() {
    let sheen = |roughness| Some(SheenLayer { color: Vec3::ONE, roughness });
    for cosine in [0.05, 0.3, 0.7, 1.0] {
        for roughness in [0.1, 0.4, 1.0] {
            let both = MaterialLayers { sheen: sheen(roughness), ..varnish(roughness) };
            let passing = glass();
            for layers in [varnish(roughness), both, passing] {
                let out = even().light_in_layers(&flat(tilted(cosine)), &maps(Vec3::ONE, 0.5, 0.0), &layers);
                let whole = (out.light + out.passes).max_element();
                assert!((0.25..1.03).contains(&whole), "{cosine} {roughness} {layers:?}: {whole}");
            }
        }
    }
}

/// Protects car paint: a smooth coat over a matte black surface shows the lamp where it is mirrored, and nothing
/// beside that; its own normal decides where.
#[test]
fn a_coat_mirrors_lamps_about_its_own_normal() {
    let (brdf, black) = (one_lamp(Vec3::Z), maps(Vec3::ZERO, 1.0, 1.0));
    let straight = brdf.light_in_layers(&flat(Vec3::Z), &black, &varnish(0.1)).light.x;
    let beside = brdf.light_in_layers(&flat(tilted(0.8)), &black, &varnish(0.1)).light.x;
    assert!(straight > 10.0 && beside < 0.01, "{straight} {beside}");
    let mut turned = varnish(0.1);
    let to_viewer = tilted(0.8);
    turned.coat.as_mut().expect("it has one").normal = (to_viewer + Vec3::Z).normalize();
    assert!(brdf.light_in_layers(&flat(to_viewer), &black, &turned).light.x > 10.0);
}

/// Protects cloth: what lamps from all sides add is about the albedo that even light is multiplied by. The fit of the albedo is
/// lower than the integral at small roughnesses (by 2.3 times at 0.3), in three.js as here.
#[test]
fn sheen_of_lamps_adds_up_to_its_albedo() {
    let black = maps(Vec3::ZERO, 1.0, 1.0);
    let lamps = fibonacci_sphere(4000, 0.2);
    let share = 4.0 * PI / lamps.len() as f32;
    for (roughness, cosine, most) in [(0.3, 0.3, 2.4), (0.5, 0.6, 1.8), (0.8, 0.8, 1.3), (1.0, 0.4, 1.1)] {
        let sheen = Some(SheenLayer { color: Vec3::ONE, roughness });
        let layers = MaterialLayers { sheen, ..MaterialLayers::default() };
        let of = |layers: &MaterialLayers, lamp: Vec3| {
            one_lamp(lamp).light_in_layers(&flat(tilted(cosine)), &black, layers).light.x
        };
        let (plain, albedo) = (MaterialLayers::default(), sheen_albedo_at(cosine, roughness));
        let added = |&lamp: &Vec3| of(&layers, lamp) - (1.0 - albedo) * of(&plain, lamp);
        let sum: f32 = lamps.iter().map(|lamp| added(lamp) * share).sum();
        assert!((0.9..most).contains(&(sum / albedo)), "{roughness} {cosine}: {sum} {albedo}");
    }
}

/// Protects glass: what does not pass is reflected, metal lets nothing through, and the base colour tints.
#[test]
fn light_passes_dielectrics_only() {
    let glass = glass();
    let red = Vec3::new(1.0, 0.25, 0.0);
    let out = even().light_in_layers(&flat(Vec3::Z), &maps(red, 0.0, 0.0), &glass);
    assert!((out.passes - 0.96 * red).length() < 0.02, "{}", out.passes);
    assert!((out.light - Vec3::splat(0.04)).length() < 0.02, "{}", out.light);
    assert_eq!(even().light_in_layers(&flat(Vec3::Z), &maps(red, 0.0, 1.0), &glass).passes, Vec3::ZERO);
    // What the inside swallows does not come back as scattered light.
    let dark = MaterialLayers { attenuation: Vec3::splat(0.25), ..glass };
    let swallowed = even().light_in_layers(&flat(Vec3::Z), &maps(red, 0.0, 0.0), &dark);
    assert!(swallowed.light == out.light && (swallowed.passes - 0.25 * out.passes).length() < 1e-6);
}

/// Protects surfaces whose reflections are switched off, and those with stronger ones.
#[test]
fn the_dielectric_decides_what_is_reflected() {
    let black = maps(Vec3::ZERO, 0.2, 0.0);
    let with = |f0: f32, f90: f32| {
        let dielectric = Dielectric { f0: Vec3::splat(f0), f90, ..Dielectric::default() };
        let layers = MaterialLayers { dielectric, ..MaterialLayers::default() };
        let lit =
            |brdf: &MetallicRoughness| brdf.light_in_layers(&flat(tilted(0.9)), &black, &layers).light.x;
        (lit(&even()), lit(&one_lamp(Vec3::new(-tilted(0.9).x, 0.0, 0.9))))
    };
    assert_eq!(with(0.0, 0.0), (0.0, 0.0));
    let (normal, strong) = (with(0.04, 1.0), with(0.16, 1.0));
    assert!(strong.0 > 3.0 * normal.0 && strong.1 > 3.0 * normal.1, "{normal:?} {strong:?}");
}
