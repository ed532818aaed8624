//! Tutte's embedding: sound for disks, for what is cut into disks, and refused by name.

use parbake_atlas::{
    AtlasError, Layout, PackOptions, TutteBoundary, TutteOptions, TutteWeights, check, tutte,
};
use parbake_model::Mesh;
use parbake_model::glam::Vec3;

/// A grid of `n` × `m` squares, optionally closed to a ring along x and along y.
fn grid(n: u32, m: u32, ring_x: bool, ring_y: bool) -> Mesh {
    let mut mesh = Mesh::default();
    let turn = |k: u32, n: u32| (k as f32 / n as f32 * std::f32::consts::TAU).sin_cos();
    let (columns, rows) = (n + u32::from(!ring_x), m + u32::from(!ring_y));
    for y in 0..rows {
        for x in 0..columns {
            let ((sx, cx), (sy, cy)) = (turn(x, n), turn(y, m));
            let radius = if ring_y { 2.0 + cy } else { 2.0 };
            let height = if ring_y { sy } else { y as f32 };
            let flat = Vec3::new(x as f32, y as f32, (x * y % 3) as f32 * 0.3);
            mesh.positions.push(if ring_x { Vec3::new(radius * cx, radius * sx, height) } else { flat });
        }
    }
    for y in 0..m {
        for x in 0..n {
            let v = |x: u32, y: u32| y % rows * columns + x % columns;
            let [a, b, c, d] = [v(x, y), v(x + 1, y), v(x + 1, y + 1), v(x, y + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.triangle_materials = vec![0; mesh.triangles.len()];
    mesh
}

fn tetrahedron() -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        triangle_materials: vec![0; 4],
        ..Mesh::default()
    }
}

fn options() -> TutteOptions {
    TutteOptions {
        pack: PackOptions { texture_size: 256, effort: 0, ..PackOptions::default() },
        ..Default::default()
    }
}

/// Protects the theorem's promise for disks, rings, tori and spheres: one sound chart.
#[test]
fn every_piece_becomes_one_sound_chart() {
    for mesh in [grid(9, 7, false, false), grid(9, 4, true, false), grid(9, 8, true, true), tetrahedron()] {
        for boundary in [TutteBoundary::Circle, TutteBoundary::Square] {
            for weights in [TutteWeights::Uniform, TutteWeights::InverseLength] {
                for in_the_middle in [false, true] {
                    let options = TutteOptions { boundary, weights, in_the_middle, ..options() };
                    let layout = Layout::new(&tutte(&mesh, &options).unwrap().mesh);
                    let check = check(&layout, 256);
                    assert!(check.is_bijective(), "{:?}", check.problems());
                    assert_eq!(check.charts, 1);
                    let wanted = if boundary == TutteBoundary::Circle { 0.6 } else { 0.9 };
                    let share = check.utilisation * if in_the_middle { 4.0 } else { 1.0 };
                    assert!(share > wanted || mesh.triangles.len() < 40, "{share}");
                }
            }
        }
    }
}

/// Protects the error for what is no disk when cuts are not allowed.
#[test]
fn what_is_no_disk_is_named() {
    let options = TutteOptions { cut: false, ..options() };
    assert!(tutte(&grid(5, 5, false, false), &options).is_ok());
    for mesh in [grid(9, 4, true, false), tetrahedron()] {
        assert!(matches!(tutte(&mesh, &options), Err(AtlasError::NotADisk { .. })));
    }
}

/// Protects meshes with several pieces and with edges that three triangles share.
#[test]
fn several_pieces_and_non_manifold_edges() {
    let mut mesh = grid(4, 4, false, false);
    mesh.positions.push(Vec3::new(0.5, 0.5, 9.0));
    let apex = mesh.positions.len() as u32 - 1;
    mesh.triangles.extend([[0, 1, apex], [apex, apex, 3]]);
    mesh.triangle_materials.resize(mesh.triangles.len(), 0);
    let layout = Layout::new(&tutte(&mesh, &options()).unwrap().mesh);
    assert!(check(&layout, 256).is_bijective());
    assert!(tutte(&Mesh::default(), &options()).is_ok());
}
