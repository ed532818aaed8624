//! The metallic-roughness BRDF against central differences and against what is known of it.

use super::*;
use crate::camera::fibonacci_sphere;
use crate::lighting::SoftLight;

fn surface() -> Orientation {
    // As between vertices: neither unit vectors nor at right angles.
    Orientation {
        tangent: Vec3::new(0.9, 0.1, -0.2),
        bitangent: Vec3::new(-0.15, 0.85, 0.1),
        normal: Vec3::new(0.2, -0.1, 0.92),
        to_viewer: Vec3::new(0.3, 0.2, 0.93).normalize(),
    }
}

fn material(roughness: f32, metallic: f32) -> MapValues {
    let mut values = MapValues::of(Vec3::new(0.7, 0.4, 0.2), Vec3::new(0.2, 0.1, 0.95));
    values[MapKind::MetallicRoughness] = Vec4::new(0.0, roughness, metallic, 0.0);
    values[MapKind::Emissive] = Vec4::new(0.1, 0.4, 0.2, 0.0);
    values[MapKind::Occlusion] = Vec4::splat(0.8);
    values
}

/// Protects every solve through this BRDF: its Jacobian is the light's derivative by each map, and its adjoint is
/// the transpose, for maps and for the surface's orientation.
#[test]
fn derivatives_match_central_differences() {
    let brdf = MetallicRoughness::in_studio();
    let (g, h) = (Vec3::new(1.0, -0.4, 0.7), 4e-3);
    for (roughness, metallic) in [(0.31, 0.4), (0.62, 1.0), (0.9, 0.0)] {
        let (s, values) = (surface(), material(roughness, metallic));
        let adjoint = brdf.adjoint(&s, &values, g);
        for kind in MapKind::ALL {
            let (light, jacobian) = brdf.jacobian(kind, &s, &values);
            assert!((light.truncate() - brdf.light(&s, &values)).length() < 1e-5);
            let pulled = jacobian.pull(g.extend(0.0));
            assert_eq!(pulled, adjoint.maps[kind]);
            for axis in 0..3 {
                let at = |step: f32| {
                    let mut moved = values;
                    moved[kind][axis] += step;
                    brdf.light(&s, &moved).dot(g)
                };
                let difference = (at(h) - at(-h)) / (2.0 * h);
                let close = 4e-3 * (1.0 + difference.abs());
                assert!((difference - pulled[axis]).abs() < close, "{kind:?} {axis}: {difference} {pulled}");
            }
        }
        let places: [fn(&mut Orientation) -> &mut Vec3; 4] =
            [|s| &mut s.tangent, |s| &mut s.bitangent, |s| &mut s.normal, |s| &mut s.to_viewer];
        let mut gradient = adjoint.surface;
        for place in places {
            for axis in 0..3 {
                let at = |step: f32| {
                    let mut moved = s;
                    place(&mut moved)[axis] += step;
                    brdf.light(&moved, &values).dot(g)
                };
                let difference = (at(h) - at(-h)) / (2.0 * h);
                let found = place(&mut gradient)[axis];
                assert!((difference - found).abs() < 6e-3 * (1.0 + difference.abs()), "{difference} {found}");
            }
        }
    }
}

fn facing() -> Orientation {
    Orientation { tangent: Vec3::X, bitangent: Vec3::Y, normal: Vec3::Z, to_viewer: Vec3::Z }
}

fn plain(color: Vec3, roughness: f32, metallic: f32) -> MapValues {
    let mut values = MapValues::of(color, Vec3::Z);
    values[MapKind::MetallicRoughness] = Vec4::new(0.0, roughness, metallic, 0.0);
    values
}

/// Protects conservation of energy, as a furnace does: under even light white metal of any roughness is as bright
/// as the light, and white plastic no brighter.
#[test]
fn nothing_sends_out_more_than_it_gets() {
    let lighting = Lighting { ambient: Vec3::ONE, ..Lighting::default() };
    let brdf = MetallicRoughness { lighting };
    for roughness in [0.05, 0.3, 0.6, 1.0] {
        for angle in [0.0f32, 0.6, 1.1] {
            let s = Orientation { to_viewer: Vec3::new(angle.sin(), 0.0, angle.cos()), ..facing() };
            let metal = brdf.light(&s, &plain(Vec3::ONE, roughness, 1.0)).x;
            assert!((metal - 1.0).abs() < 0.03, "{roughness} {angle} {metal}");
            let plastic = brdf.light(&s, &plain(Vec3::ONE, roughness, 0.0)).x;
            assert!((0.9..1.02).contains(&plastic), "{roughness} {angle} {plastic}");
        }
    }
}

/// Protects the direct term: over all directions of light, GGX's lobe with V and F sends out what its table says.
#[test]
fn direct_light_and_the_table_agree() {
    let roughness = 0.5;
    let directions = fibonacci_sphere(20_000, 0.2);
    let mut sum = 0.0;
    for direction in directions.iter().filter(|d| d.z > 0.0) {
        let light = DirectionalLight { direction: *direction, color: Vec3::ONE };
        let lighting = Lighting { directional: vec![light], ..Lighting::default() };
        sum += MetallicRoughness { lighting }.light(&facing(), &plain(Vec3::ONE, roughness, 1.0)).x;
    }
    let found = sum * 4.0 * PI / directions.len() as f32;
    let [a, b] = scale_and_bias(1.0f32, roughness);
    assert!((found - a - b).abs() < 0.01, "{found} {a} {b}");
}

/// Protects what materials look like: a gold mirror shows the lamp in gold, plastic in the lamp's own colour;
/// roughness spreads it; occlusion hides it; emission shines in the dark.
#[test]
fn materials_look_like_themselves() {
    let lamp = SoftLight::new(Vec3::Z, 200.0, Vec3::splat(10.0));
    let brdf = MetallicRoughness { lighting: Lighting { soft: vec![lamp], ..Lighting::default() } };
    let gold = Vec3::new(1.0, 0.7, 0.3);
    let mirror = brdf.light(&facing(), &plain(gold, 0.05, 1.0));
    assert!((mirror / mirror.x - gold).length() < 0.02, "{mirror}");
    let black_plastic = brdf.light(&facing(), &plain(Vec3::ZERO, 0.05, 0.0));
    assert!((black_plastic / mirror.x - Vec3::splat(0.04)).length() < 0.01, "{black_plastic}");
    assert!(brdf.light(&facing(), &plain(gold, 0.6, 1.0)).x < 0.2 * mirror.x);
    let mut hidden = plain(gold, 0.05, 1.0);
    hidden[MapKind::Occlusion] = Vec4::ZERO;
    assert_eq!(brdf.light(&facing(), &hidden), Vec3::ZERO);
    hidden[MapKind::Emissive] = Vec4::new(0.0, 2.0, 0.0, 0.0);
    assert_eq!(brdf.light(&facing(), &hidden), Vec3::new(0.0, 2.0, 0.0));
}

/// Protects pictures from NaN: any frame, any value.
#[test]
fn degenerate_inputs_stay_finite() {
    let brdf = MetallicRoughness::in_studio();
    for normal in [Vec3::ZERO, Vec3::Z, -Vec3::Z, Vec3::splat(1e-6)] {
        for roughness in [0.0, 1.0] {
            for to_viewer in [Vec3::Z, -brdf.lighting.directional[0].direction] {
                let s = Orientation { normal, to_viewer, ..Orientation::default() };
                let light = brdf.light(&s, &plain(Vec3::ONE, roughness, 1.0));
                assert!(light.is_finite() && light.min_element() >= 0.0, "{light}");
                assert!(
                    brdf.adjoint(&s, &plain(Vec3::ONE, roughness, 1.0), Vec3::ONE).surface.normal.is_finite()
                );
            }
        }
    }
}
