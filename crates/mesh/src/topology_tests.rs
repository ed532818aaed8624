//! Surfaces whose topology is known from books.

use super::*;
use parbake_model::glam::Vec3;

fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let triangle_materials = vec![0; triangles.len()];
    Mesh { positions, triangles, triangle_materials, ..Mesh::default() }
}

/// A tetrahedron with its corner at `at`, wound outwards, of volume 1/6.
fn tetrahedron(at: Vec3) -> Mesh {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|p| p + at);
    mesh(positions.to_vec(), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
}

fn joined(parts: &[Mesh]) -> Mesh {
    let mut all = Mesh::default();
    for part in parts {
        let first = all.positions.len() as u32;
        all.positions.extend(&part.positions);
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all.triangle_materials = vec![0; all.triangles.len()];
    all
}

/// A band of `n` × `m` squares, closed in both directions where asked: a torus, a tube, a sheet. `twist` turns the
/// second direction over where the first closes.
fn grid(n: u32, m: u32, close: [bool; 2], twist: bool) -> Mesh {
    let (rows, columns) = (n + u32::from(!close[0]), m + u32::from(!close[1]));
    // Positions only need to differ.
    let position = |i: u32| Vec3::new((i % columns) as f32, (i / columns) as f32, (i * i % 7) as f32);
    let at = |i: u32, j: u32| {
        let j = if twist && i >= rows { columns - 1 - j } else { j };
        (i % rows) * columns + j % columns
    };
    let cells = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    mesh((0..rows * columns).map(position).collect(), triangles.collect())
}

/// Protects the figures of the simplest closed surface, and welding: a copy in which no two triangles share a
/// vertex is the same surface.
#[test]
fn a_tetrahedron_is_a_sphere() {
    let whole = tetrahedron(Vec3::ZERO);
    let corners: Vec<Vec3> = (0..4).flat_map(|t| whole.corners(t)).collect();
    let apart = mesh(corners, (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect());
    for (mesh, split_vertices) in [(whole, 4), (apart, 4)] {
        let found = topology(&mesh);
        assert_eq!((found.vertices, found.edges, found.triangles), (4, 6, 4));
        assert_eq!((found.components, found.closed_components, found.boundary_loops), (1, 1, 0));
        assert_eq!((found.euler_characteristic, found.genus), (2, Some(0)));
        assert!(found.manifold && found.inconsistent_edges == 0 && found.duplicate_triangles == 0);
        assert!((found.volume.unwrap() - 1.0 / 6.0).abs() < 1e-12);
        assert!((found.area - (1.5 + 0.5 * 3f64.sqrt())).abs() < 1e-12);
        assert_eq!((found.split_vertices, found.split_components), (split_vertices, 1));
    }
}

/// Protects handles and holes: a torus, a torus with two holes, a tube, a sheet.
#[test]
fn handles_and_holes_are_told_apart() {
    let torus = grid(4, 5, [true; 2], false);
    let found = topology(&torus);
    assert_eq!((found.euler_characteristic, found.genus, found.boundary_loops), (0, Some(1), 0));
    let mut pierced = torus.clone();
    // Two triangles that do not touch.
    pierced.triangles.remove(20);
    pierced.triangles.remove(0);
    let found = topology(&pierced);
    assert_eq!((found.genus, found.boundary_loops, found.boundary_edges), (Some(1), 2, 6));
    assert_eq!((found.volume, found.closed_components), (None, 0));
    let tube = topology(&grid(4, 3, [true, false], false));
    assert_eq!((tube.genus, tube.boundary_loops, tube.manifold), (Some(0), 2, true));
    let sheet = topology(&grid(2, 3, [false; 2], false));
    assert_eq!((sheet.genus, sheet.boundary_loops, sheet.euler_characteristic), (Some(0), 1, 1));
}

/// Protects surfaces with one side, which have no volume and no genus here, from those with a triangle turned over,
/// which have a genus.
#[test]
fn one_sided_and_turned_over_are_different() {
    let strip = topology(&grid(5, 1, [true, false], true));
    assert_eq!((strip.non_orientable_components, strip.boundary_loops, strip.genus), (1, 1, None));
    let mut turned = tetrahedron(Vec3::ZERO);
    turned.triangles[3].swap(0, 1);
    let found = topology(&turned);
    assert_eq!((found.inconsistent_edges, found.non_orientable_components), (3, 0));
    assert_eq!((found.genus, found.volume), (Some(0), None));
    assert!(!found.largest[0].wound_alike);
}

/// Protects what is no surface: two solids that touch in a point are two, three triangles on an edge are none.
#[test]
fn where_a_surface_is_none() {
    let touching = joined(&[tetrahedron(Vec3::ZERO), tetrahedron(Vec3::X)]);
    let found = topology(&touching);
    assert_eq!((found.components, found.non_manifold_vertices, found.vertices), (2, 1, 7));
    assert_eq!((found.genus, found.manifold, found.split_components), (Some(0), false, 1));
    assert_eq!(found.largest.len(), 2);
    let fin =
        mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_Y], vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    let found = topology(&fin);
    assert_eq!((found.non_manifold_edges, found.genus, found.components_without_genus), (1, None, 1));
}

/// Protects counts of triangles that are not there to be seen, or twice.
#[test]
fn odd_triangles_are_counted() {
    let mut mesh = tetrahedron(Vec3::ZERO);
    mesh.triangles.extend([[0, 0, 1], [1, 2, 0], [0, 2, 1]]);
    mesh.triangle_materials = vec![0; 7];
    let found = topology(&mesh);
    assert_eq!((found.degenerate_triangles, found.duplicate_triangles, found.triangles), (1, 2, 6));
    assert_eq!(found.non_manifold_edges, 3);
    let line = topology(&self::mesh(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0], vec![[0, 1, 2]]));
    assert_eq!((line.degenerate_triangles, line.triangles, line.area), (1, 1, 0.0));
    assert_eq!(topology(&Mesh::default()), Topology { manifold: true, ..Topology::default() });
}
