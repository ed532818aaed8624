//! Each map of shape on a scene that one can work out.

use crate::scenes::{Solid, WHOLE, add_sheet, ball, cube, sample_at, square};
use parbake_model::Mesh;
use parbake_model::glam::{Vec3, vec3};
use parbake_raycast::ambient::ambient;
use parbake_raycast::curvature::curvature;
use parbake_raycast::thickness::thickness;

/// A floor at z = 0, and at x = 0 a wall as high as that on it, both 2 long.
fn corner(height: f32) -> Solid {
    let mut mesh = square(1.0, 0.0);
    add_sheet(&mut mesh, vec3(0.0, -1.0, 0.0), [Vec3::Y * 2.0, Vec3::Z * height], 0, WHOLE);
    Solid::new(&mesh)
}

/// Protects the scale of ambient occlusion: all is open over a plane, and half of it in a right-angled corner;
/// a wall of height h at distance d leaves ½ (1 + d / √(d² + h²)) (the form factor of a long wall).
#[test]
fn occlusion_in_a_corner() {
    let floor = |height: f32, x: f32| {
        let surface = corner(height);
        ambient(&sample_at(&surface, vec3(x, 0.0, 0.0), Vec3::Z, 4096), 10.0).w
    };
    let plane = Solid::new(&square(1.0, 0.0));
    assert_eq!(ambient(&sample_at(&plane, Vec3::ZERO, Vec3::Z, 64), 10.0).w, 1.0);
    assert!((floor(1.0, 0.001) - 0.5).abs() < 0.01, "{}", floor(1.0, 0.001));
    let wanted = 0.5 * (1.0 + 0.5f32.sqrt());
    assert!((floor(0.02, 0.02) - wanted).abs() < 0.01, "{}", floor(0.02, 0.02));
}

/// Protects dark rooms: what is farther away than the occlusion distance does not occlude.
#[test]
fn occlusion_ends_at_its_distance() {
    let mut mesh = square(1.0, 0.0);
    let ceiling = Vec3::new(-1.0, -1.0, 0.2);
    add_sheet(&mut mesh, ceiling, [Vec3::Y * 2.0, Vec3::X * 2.0], 0, WHOLE);
    let surface = Solid::new(&mesh);
    let open = |distance| ambient(&sample_at(&surface, Vec3::ZERO, Vec3::Z, 1024), distance).w;
    assert!(open(10.0) < 0.05 && open(0.19) == 1.0);
    // The cone of half-angle 45° reaches it: sin² 45°.
    assert!((open(0.2 * 2f32.sqrt()) - 0.5).abs() < 0.01);
}

/// Protects bent normals: in a corner they lean away from the wall by atan(2 / π), on a plane they are the
/// normal, and where nothing is open they are the normal still.
#[test]
fn bent_normals_lean_away() {
    let bent = |surface: &Solid, x: f32| {
        let sample = sample_at(surface, vec3(x, 0.0, 0.0), Vec3::Z, 4096);
        let sum = ambient(&sample, 10.0).truncate();
        (sample.frame * sum).normalize()
    };
    let leaning = bent(&corner(1.0), 0.001);
    let wanted = vec3(2.0, 0.0, std::f32::consts::PI).normalize();
    assert!((leaning - wanted).length() < 0.02, "{leaning}");
    assert!((bent(&Solid::new(&square(1.0, 0.0)), 0.0) - Vec3::Z).length() < 0.01);
    let mut inside = cube(1.0);
    inside.positions.iter_mut().for_each(|p| p.z *= 0.001);
    assert_eq!(bent(&Solid::new(&inside), 0.0).z, 1.0);
}

/// Protects the unit of thickness: a slab is as thick as it is, a ball as its radius, a sheet not at all.
#[test]
fn thickness_of_a_slab_and_a_ball() {
    let mut slab = square(1.0, 0.1);
    add_sheet(&mut slab, vec3(-1.0, -1.0, 0.0), [Vec3::Y * 2.0, Vec3::X * 2.0], 0, WHOLE);
    let slab = Solid::new(&slab);
    let found = thickness(&sample_at(&slab, vec3(0.2, 0.1, 0.1), Vec3::Z, 256));
    assert!((found - 0.1).abs() < 1e-3, "{found}");
    let ball = Solid::new(&ball(0.8));
    let found = thickness(&sample_at(&ball, Vec3::X * 0.8, Vec3::X, 1024));
    assert!((found - 0.8).abs() < 0.01, "{found}");
    let sheet = Solid::new(&square(1.0, 0.0));
    assert_eq!(thickness(&sample_at(&sheet, Vec3::ZERO, Vec3::Z, 64)), 0.0);
}

/// Protects the scale of curvature: ρ / r on a ball of radius r, the opposite inside of it, none on a plane.
#[test]
fn curvature_of_a_ball() {
    let found = |mesh: &Mesh, normal: Vec3, radius: f32| {
        let surface = Solid::new(mesh);
        curvature(&sample_at(&surface, Vec3::X * 0.5, normal, 32), radius)
    };
    for radius in [0.05, 0.1, 0.2] {
        let out = found(&ball(0.5), Vec3::X, radius);
        assert!((out - radius / 0.5).abs() < 0.02, "{radius}: {out}");
        let within = found(&ball(0.5), Vec3::NEG_X, radius);
        assert!((within + radius / 0.5).abs() < 0.02, "{radius}: {within}");
    }
    let plane = Solid::new(&square(1.0, 0.0));
    assert!(curvature(&sample_at(&plane, Vec3::ZERO, Vec3::Z, 32), 0.1).abs() < 2e-3);
}

/// Protects edges of hard surfaces: at a box's edge half of the directions pass it, in a corner half of them
/// meet the wall, and a radius away there is nothing of either.
#[test]
fn curvature_marks_edges_and_corners() {
    let surface = Solid::new(&cube(1.0));
    let at = |x: f32| curvature(&sample_at(&surface, vec3(x, 0.0, 1.0), Vec3::Z, 32), 0.1);
    assert!((at(0.999) - 0.5).abs() < 0.05 && at(0.95) > 0.2 && at(0.89).abs() < 2e-3, "{}", at(0.999));
    let surface = corner(1.0);
    let at = |x: f32| curvature(&sample_at(&surface, vec3(x, 0.0, 0.0), Vec3::Z, 32), 0.1);
    assert!((at(0.001) + 0.5).abs() < 0.05 && at(0.05) < -0.2 && at(0.11).abs() < 2e-3, "{}", at(0.001));
}
