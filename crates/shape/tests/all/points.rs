//! Vertices that are split for their normals or texture coordinates: they move as one,
//! whatever their gradients say, so that seams stay closed.

use glam::Vec3;
use parbake_shape::moving_points::MovingPoints;
use parbake_shape::points::{Motion, Points};

/// A cube of six sides of four vertices each, with the sides' normals: three vertices
/// at each of eight corners.
fn cube() -> (Vec<Vec3>, Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let (mut n, mut u) = (Vec3::ZERO, Vec3::ZERO);
            n[axis] = sign;
            u[(axis + 1) % 3] = 1.0;
            let v = n.cross(u);
            let first = positions.len() as u32;
            positions.extend([n - u - v, n + u - v, n + u + v, n - u + v]);
            normals.extend([n; 4]);
            triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i| first + i)));
        }
    }
    (positions, normals, triangles)
}

/// Pairs of vertices at one place.
fn pairs(positions: &[Vec3]) -> Vec<(usize, usize)> {
    let all = (0..positions.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
    all.filter(|&(i, j)| positions[i] == positions[j]).collect()
}

/// Protects seams from gradients that differ between vertices of one corner: these stay
/// at one place, to the bit, however often they move.
#[test]
fn split_vertices_stay_together() {
    let (positions, normals, triangles) = cube();
    let points = Points::new(&positions, &normals, &triangles);
    assert_eq!((points.rest.len(), points.of_vertex.len()), (8, 24));
    let pairs = pairs(&positions);
    assert_eq!(pairs.len(), 24);
    for motion in [Motion::Normal, Motion::Free] {
        let mut moving = MovingPoints::new(&points, motion, 0.05);
        for step in 0..50 {
            let gradient = |i: usize| Vec3::from([3, 5, 7].map(|k| ((step + i * k) % 13) as f32 - 6.0));
            moving.step(&(0..24).map(gradient).collect::<Vec<_>>(), &[], 0.1, 1.0);
            let vertices = points.vertices(moving.at());
            for &(i, j) in &pairs {
                assert_eq!(vertices[i], vertices[j], "{motion:?}, step {step}");
            }
        }
        assert!(moving.moved()[0] > 0.01, "nothing moved");
    }
}

/// Protects motion along normals: a corner of a cube goes along its diagonal, the mean
/// of its sides' normals, and nowhere else.
#[test]
fn a_corner_moves_along_the_mean_of_its_normals() {
    let (positions, normals, triangles) = cube();
    let points = Points::new(&positions, &normals, &triangles);
    for (rest, normal) in points.rest.iter().zip(&points.normals) {
        assert!(normal.distance(rest.normalize()) < 1e-6, "{rest} {normal}");
    }
    let mut moving = MovingPoints::new(&points, Motion::Normal, 0.01);
    for _ in 0..10 {
        moving.step(&[-Vec3::X; 24], &[], 0.0, 1.0);
    }
    for (at, rest) in moving.at().iter().zip(&points.rest) {
        // Against the gradient: corners at +x go out, those at -x go in.
        let way = *at - *rest;
        assert!(way.x > 0.01 && way.cross(*rest).length() < 1e-6, "{rest} {at}");
    }
}

/// Protects meshes as they come: no vertices, and normals that cancel each other.
#[test]
fn odd_meshes_have_points() {
    let none = Points::new(&[], &[], &[]);
    assert!(none.rest.is_empty());
    let mut moving = MovingPoints::new(&none, Motion::Free, 0.1);
    moving.step(&[], &[], 1.0, 1.0);
    assert_eq!(moving.moved(), [0.0, 0.0]);
    // The two sides of a sheet: the first vertex's normal has to do.
    let sheet = Points::new(&[Vec3::ONE; 2], &[Vec3::Z, -Vec3::Z], &[]);
    assert_eq!((sheet.rest.len(), sheet.normals[0]), (1, Vec3::Z));
}
