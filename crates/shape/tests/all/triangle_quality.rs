//! What keeps moving triangles sane, on a few triangles, to the boundary of each limit:
//! how far a triangle turns, its area, its least altitude.

use glam::Vec3;
use parbake_shape::moving_points::MovingPoints;
use parbake_shape::points::{Motion, Points};
use parbake_shape::triangle_quality::TriangleQuality;

/// A right triangle in the xy plane, as wide as it is high.
const REST: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

fn is_spoilt(rest: [Vec3; 3], points: [Vec3; 3]) -> bool {
    TriangleQuality::new(&rest, &[[0, 1, 2]]).invalid(&points).count() > 0
}

/// Protects the angle: a triangle turns up to the limit, whichever way, and never over.
#[test]
fn triangles_turn_up_to_the_limit() {
    let limit = TriangleQuality::LEAST_COSINE.acos();
    let turned = |angle: f32| {
        let (sin, cos) = angle.sin_cos();
        REST.map(|p| Vec3::new(p.x, cos * p.y, sin * p.y))
    };
    for sign in [1.0, -1.0] {
        assert!(!is_spoilt(REST, turned(sign * (limit - 1e-3))));
        assert!(is_spoilt(REST, turned(sign * (limit + 1e-3))));
    }
    assert!(is_spoilt(REST, turned(std::f32::consts::PI)));
    assert!(is_spoilt(REST, [REST[0], REST[2], REST[1]]), "turned over in its own plane");
}

/// Protects size: a triangle may shrink to a quarter of its area, and to that alone if
/// it keeps its shape; growing is free.
#[test]
fn triangles_shrink_down_to_the_limit() {
    let scaled = |by: f32| REST.map(|p| p * by);
    let limit = TriangleQuality::LEAST_SHARE.sqrt();
    assert!(!is_spoilt(REST, scaled(limit + 1e-3)));
    assert!(is_spoilt(REST, scaled(limit - 1e-3)));
    assert!(is_spoilt(REST, scaled(0.0)));
    assert!(!is_spoilt(REST, scaled(100.0)));
}

/// Protects shape: a triangle that is drawn long and keeps its area is a needle once its
/// least altitude is below a quarter of what it was.
#[test]
fn triangles_do_not_become_needles() {
    let drawn = |by: f32| REST.map(|p| Vec3::new(p.x * by, p.y / by, 0.0));
    let altitude = |[_, b, c]: [Vec3; 3]| b.cross(c).length() / b.distance(c).max(b.length()).max(c.length());
    let share = |by: f32| altitude(drawn(by)) / altitude(REST);
    // 1 × 1 has an altitude of √½, 2.8 × 1/2.8 one of 0.354.
    assert!(share(2.7) > TriangleQuality::LEAST_SHARE && !is_spoilt(REST, drawn(2.7)));
    let needle =
        (1..100).map(|i| 2.7 + 0.1 * i as f32).find(|&by| share(by) < TriangleQuality::LEAST_SHARE).unwrap();
    assert!(!is_spoilt(REST, drawn(needle - 0.1)));
    assert!(is_spoilt(REST, drawn(needle)));
}

/// Protects meshes with triangles that had no area at rest: these hold nothing back.
#[test]
fn triangles_without_area_are_not_looked_at() {
    let line = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X];
    assert!(!is_spoilt(line, REST) && !is_spoilt(line, [Vec3::ZERO; 3]));
    let quality = TriangleQuality::new(&line, &[[0, 1, 2]]);
    let mut after = REST;
    assert_eq!(quality.revert(&line, &mut after), 0);
    assert_eq!(after, REST);
}

/// Protects neighbours: a point that stays behind can spoil the next triangle, whose
/// points then stay too; what is not concerned moves on.
#[test]
fn staying_spreads_to_neighbours_that_need_it() {
    // A strip of five triangles, and one apart.
    let mut rest: Vec<Vec3> = (0..7).map(|i| Vec3::new(0.5 * i as f32, (i % 2) as f32, 0.0)).collect();
    rest.extend([9.0, 10.0, 9.5].map(|x| Vec3::new(x, if x == 9.5 { 1.0 } else { 0.0 }, 0.0)));
    let mut triangles: Vec<[u32; 3]> = (0..5).map(|i| [i, i + 1, i + 2]).collect();
    triangles.push([7, 8, 9]);
    let quality = TriangleQuality::new(&rest, &triangles);
    // All go far back but the first point, which turns its triangle over; each that stays
    // would be overtaken by the next one.
    let mut after: Vec<Vec3> = rest.iter().map(|p| *p - 5.0 * Vec3::X).collect();
    after[0] = rest[0] + 20.0 * Vec3::X;
    let held = quality.revert(&rest, &mut after);
    assert_eq!(quality.invalid(&after).count(), 0);
    assert_eq!(held, 7, "{after:?}");
    assert_eq!(after[..7], rest[..7]);
    assert!(after[7..].iter().zip(&rest[7..]).all(|(a, h)| *a == *h - 5.0 * Vec3::X));
}

/// Protects a closed mesh from gradients that pull each point another way, with and
/// without a seam's doubled vertices, for either motion: after each step each triangle
/// looks the way it did, and points do move.
#[test]
fn a_pulled_octahedron_keeps_its_triangles() {
    let positions = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    let triangles = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    let points = Points::new(&positions, &positions, &triangles);
    let normal = |at: &[Vec3], t: [u32; 3]| {
        let [a, b, c] = t.map(|i| at[i as usize]);
        (b - a).cross(c - a).normalize()
    };
    for motion in [Motion::Normal, Motion::Free] {
        let mut moving = MovingPoints::new(&points, motion, 0.2);
        for step in 0..200u32 {
            let pull = |i: u32, k: u32| ((step / 20 * 13 + i * 7 + k * 5) % 11) as f32 / 5.0 - 1.0;
            let gradients: Vec<Vec3> =
                (0..6).map(|i| Vec3::new(pull(i, 0), pull(i, 1), pull(i, 2))).collect();
            moving.step(&gradients, &[], 0.0, 1.0);
            for t in triangles {
                let cosine = normal(moving.at(), t).dot(normal(&positions, t));
                assert!(cosine >= TriangleQuality::LEAST_COSINE - 1e-5, "step {step}, {t:?}: {cosine}");
            }
        }
        assert!(moving.moved()[1] > 0.2, "{motion:?}: {:?}", moving.moved());
    }
}
