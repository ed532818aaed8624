//! Tests of `projection.rs`.

use super::*;
use proptest::prelude::*;

/// The point of a triangle that has these weights of corners 1 and 2.
fn point_on(mesh: &Mesh, triangle: u32, barycentric: [f32; 2]) -> Vec3 {
    let [a, b, c] = mesh.corners(triangle as usize);
    a + (b - a) * barycentric[0] + (c - a) * barycentric[1]
}

/// A square with corners (±1, ±1) at height z, facing +z or −z.
fn add_square(m: &mut Mesh, z: f32, up: bool) {
    let v = m.positions.len() as u32;
    m.positions.extend([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z)));
    m.triangles.extend(if up {
        [[v, v + 1, v + 2], [v, v + 2, v + 3]]
    } else {
        [[v, v + 2, v + 1], [v, v + 3, v + 2]]
    });
}

/// Protects the two-sidedness and length unit of rays.
#[test]
fn rays_hit_either_side_at_their_distance() {
    let mut m = Mesh::default();
    add_square(&mut m, 0.0, true);
    add_square(&mut m, -0.5, false);
    let s = HighSurface::new(&m);
    for (z, direction, distance) in [(2.0, -3.0, 2.0), (-2.0, 0.1, 1.5), (-0.25, 1.0, 0.25)] {
        let from = Vec3::new(0.3, -0.4, z);
        let hit = s.cast(from, Vec3::Z * direction, 10.0).unwrap();
        assert!((hit.distance - distance).abs() < 1e-6);
        let p = point_on(&m, hit.triangle, hit.barycentric);
        assert!((p.x - 0.3).abs() < 1e-6 && (p.y + 0.4).abs() < 1e-6);
    }
    assert_eq!(s.cast(Vec3::Z * 2.0, Vec3::NEG_Z, 1.9), None);
    assert_eq!(s.cast(Vec3::Z * 2.0, Vec3::Z, 10.0), None);
    assert_eq!(s.cast(Vec3::Z * 2.0, Vec3::ZERO, 10.0), None);
}

/// Protects thin walls: the point projects to the side that it belongs to, from
/// above and from below the wall.
#[test]
fn thin_walls_keep_their_sides() {
    let mut m = Mesh::default();
    add_square(&mut m, 0.01, true);
    add_square(&mut m, -0.01, false);
    let s = HighSurface::new(&m);
    let outer = |z: f32| s.project(Vec3::new(0.1, 0.2, z), Vec3::Z, 0.2).unwrap().triangle / 2;
    // Even where the coarse surface has sunk below the whole wall.
    assert_eq!([outer(0.05), outer(0.0), outer(-0.015), outer(-0.05)], [0; 4]);
    let inner = s.project(Vec3::new(0.1, 0.2, 0.05), Vec3::NEG_Z, 0.2).unwrap();
    assert_eq!(inner.triangle / 2, 1);
}

/// Protects rims, where an interpolated normal looks along the wall and over it: the closest point is on the
/// side that the triangle faces, though the other one is nearer, unless that side is far away.
#[test]
fn rims_keep_their_sides() {
    let mut m = Mesh::default();
    add_square(&mut m, 0.01, true);
    add_square(&mut m, -0.01, false);
    let s = HighSurface::new(&m);
    let along = Vec3::new(1.0, 0.0, 0.2);
    let found =
        |side: Vec3| s.project_facing(Vec3::new(0.999, 0.0, -0.03), along, side, 0.1).unwrap().triangle / 2;
    assert_eq!([found(Vec3::Z), found(Vec3::NEG_Z)], [0, 1]);
    let mut m = Mesh::default();
    add_square(&mut m, -0.01, false);
    add_square(&mut m, 0.5, true);
    let far = HighSurface::new(&m).project_facing(Vec3::new(0.999, 0.0, -0.03), along, Vec3::Z, 0.1).unwrap();
    assert_eq!(far.triangle / 2, 0);
}

/// Protects against other parts of the model that reach into the cage.
#[test]
fn what_is_near_wins_over_what_is_outside() {
    let mut m = Mesh::default();
    add_square(&mut m, 0.01, true);
    add_square(&mut m, 0.15, true);
    let s = HighSurface::new(&m);
    assert_eq!(s.project(Vec3::ZERO, Vec3::Z, 0.2).unwrap().triangle / 2, 0);
}

/// Protects texels beyond the detailed surface's edge, and surfaces turned inside
/// out: they fall back to the closest point.
#[test]
fn what_the_cage_misses_takes_the_closest() {
    let mut m = Mesh::default();
    add_square(&mut m, 0.0, true);
    let s = HighSurface::new(&m);
    let beside = s.project(Vec3::new(3.0, 0.0, 0.0), Vec3::Z, 0.1).unwrap();
    assert!((beside.distance - 2.0).abs() < 1e-6);
    let inside_out = s.project(Vec3::new(0.2, 0.1, 0.05), Vec3::NEG_Z, 0.1).unwrap();
    assert!((inside_out.distance - 0.05).abs() < 1e-6);
    assert_eq!(s.closest(Vec3::new(3.0, 0.0, 0.0), 1.0), None);
    let no_normal = s.project(Vec3::Z, Vec3::ZERO, 0.1).unwrap();
    assert!((no_normal.distance - 1.0).abs() < 1e-6);
}

/// Protects axis-aligned models, whose boxes are flat and whose rays are parallel
/// to them: no ray through an edge or a corner slips through.
#[test]
fn rays_through_edges_and_corners_hit() {
    let mut m = Mesh::default();
    for y in 0..=8 {
        for x in 0..=8 {
            m.positions.push(Vec3::new(x as f32 / 4.0 - 1.0, y as f32 / 4.0 - 1.0, 0.0));
        }
    }
    for y in 0..8 {
        for x in 0..8 {
            let v = y * 9 + x;
            m.triangles.extend([[v, v + 1, v + 10], [v, v + 10, v + 9]]);
        }
    }
    let s = HighSurface::new(&m);
    for i in 0..=64 {
        for j in 0..=64 {
            let p = Vec3::new(i as f32 / 32.0 - 1.0, j as f32 / 32.0 - 1.0, 1.0);
            assert!(s.cast(p, Vec3::NEG_Z, 2.0).is_some(), "{p}");
            let q = Vec3::new(p.x, p.y, 0.02);
            assert!((s.project(q, Vec3::Z, 0.05).unwrap().distance - 0.02).abs() < 1e-6);
        }
    }
}

/// Protects meshes without any area, and the build's time where many triangles are
/// in one place.
#[test]
fn degenerate_meshes_are_queried_without_panic() {
    let empty = HighSurface::new(&Mesh::default());
    assert_eq!(empty.closest(Vec3::ZERO, f32::INFINITY), None);
    let flat =
        Mesh { positions: vec![Vec3::ONE; 3], triangles: vec![[0, 1, 2], [0, 0, 0]], ..Mesh::default() };
    assert_eq!(HighSurface::new(&flat).project(Vec3::ZERO, Vec3::Z, 1.0), None);
    let mut same = Mesh::default();
    add_square(&mut same, 0.0, true);
    same.triangles = vec![[0, 1, 2]; 100_000];
    let s = HighSurface::new(&same);
    assert_eq!(s.cast(Vec3::new(0.5, -0.5, 1.0), Vec3::NEG_Z, 2.0).unwrap().distance, 1.0);
    assert!(s.closest(Vec3::ONE, 9.0).is_some());
}

/// Triangles of all sizes, needles among them.
fn soup() -> impl Strategy<Value = Mesh> {
    let point = || (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0);
    prop::collection::vec((point(), point(), point(), 0u32..4), 1..60).prop_map(|triangles| {
        let mut m = Mesh::default();
        for (a, b, c, size) in triangles {
            let (a, b, c) = (Vec3::from(a), Vec3::from(b), Vec3::from(c));
            let v = m.positions.len() as u32;
            let (s, t) = [(1.0, 1.0), (0.2, 0.2), (0.01, 0.01), (1.0, 0.001)][size as usize];
            m.positions.extend([a, a + b * s, a + b * s * 0.5 + c * t]);
            m.triangles.push([v, v + 1, v + 2]);
        }
        m.triangle_materials = vec![0; m.triangles.len()];
        m
    })
}

/// Distance of a segment's sample points, as a bound that needs no cleverness.
fn sampled_distance(corners: [Vec3; 3], p: Vec3) -> f32 {
    let mut best = f32::INFINITY;
    for i in 0..=40 {
        for j in 0..=40 - i {
            let (u, v) = (i as f32 / 40.0, j as f32 / 40.0);
            let q = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
            best = best.min(p.distance(q));
        }
    }
    best
}

proptest! {
    /// Protects the closest point: no triangle has a nearer one, and the answer's
    /// weights and distance belong together.
    #[test]
    fn closest_agrees_with_brute_force(m in soup(), p in (-1.5f32..1.5, -1.5f32..1.5, -1.5f32..1.5)) {
        let p = Vec3::from(p);
        let near = HighSurface::new(&m).closest(p, f32::INFINITY).unwrap();
        let [u, v] = near.barycentric;
        prop_assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-6);
        let q = point_on(&m, near.triangle, near.barycentric);
        prop_assert!((q.distance(p) - near.distance).abs() < 1e-5);
        for t in 0..m.triangles.len() {
            prop_assert!(near.distance <= sampled_distance(m.corners(t), p) + 1e-4);
        }
    }

    /// Protects rays: the hit lies on the ray, and brute force finds no nearer one.
    #[test]
    fn cast_agrees_with_brute_force(
        m in soup(),
        from in (-1.5f32..1.5, -1.5f32..1.5, -1.5f32..1.5),
        target in (-0.9f32..0.9, -0.9f32..0.9, -0.9f32..0.9),
    ) {
        let (from, target) = (Vec3::from(from), Vec3::from(target));
        let direction = (target - from).normalize_or(Vec3::X);
        let hit = HighSurface::new(&m).cast(from, direction, 5.0);
        if let Some(hit) = hit {
            let q = point_on(&m, hit.triangle, hit.barycentric);
            prop_assert!(q.distance(from + direction * hit.distance) < 1e-3);
        }
        for t in 0..m.triangles.len() {
            // In double precision; near misses may fall either way.
            let [a, b, c] = m.corners(t).map(|p| p.as_dvec3());
            let (o, d) = (from.as_dvec3(), direction.as_dvec3());
            let n = (b - a).cross(c - a);
            let along = (a - o).dot(n) / d.dot(n);
            let q = o + d * along;
            let inside = |p: parbake_model::glam::DVec3, e: parbake_model::glam::DVec3| {
                (e - p).cross(q - p).dot(n) / n.length_squared()
            };
            let margin = inside(a, b).min(inside(b, c)).min(inside(c, a));
            let steep = (d.dot(n) / n.length()).abs() > 1e-2;
            if margin > 1e-4 && steep && along > 1e-4 && along < 4.99 {
                prop_assert!(hit.is_some_and(|h| f64::from(h.distance) < along + 1e-4));
            }
        }
    }

    /// Protects the projection rule: its answer is never farther than the reach
    /// unless it is the closest point, or the closest that faces as asked and hardly
    /// farther; and there always is one.
    #[test]
    fn project_always_answers(m in soup(), p in (-1.5f32..1.5, -1.5f32..1.5, -1.5f32..1.5)) {
        let surface = HighSurface::new(&m);
        let found = surface.project(Vec3::from(p), Vec3::new(0.6, 0.0, 0.8), 0.1).unwrap();
        let closest = surface.closest(Vec3::from(p), f32::INFINITY).unwrap();
        let near = found.distance <= closest.distance + 0.1 + 1e-5;
        let faces = m.area_normal(found.triangle as usize).dot(Vec3::new(0.6, 0.0, 0.8)) > 0.0;
        prop_assert!(found.distance <= 0.1 || found == closest || (near && faces));
        prop_assert!(found.distance >= closest.distance - 1e-5);
    }
}
