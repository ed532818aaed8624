//! Tests of `tangents.rs`.

use super::*;
use proptest::prelude::*;

/// A square in the xy plane, seen from +z, with its texture upright: v grows
/// downwards.
fn square() -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
        uvs: vec![Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0), Vec2::new(0.0, 0.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        triangle_materials: vec![0; 2],
        ..Mesh::default()
    }
}

/// Protects the sign that every glTF viewer expects: an upright texture has
/// w = +1, and the bitangent points up in the picture, against v.
#[test]
fn upright_textures_have_positive_handedness() {
    let mut m = square();
    compute_tangents(&mut m);
    assert_eq!(m.positions.len(), 4);
    for (t, n) in m.tangents.iter().zip(&m.normals) {
        assert_eq!(*t, Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(n.cross(t.truncate()) * t.w, Vec3::Y);
    }
}

/// Protects mirrored halves of a symmetric layout: the handedness flips and the
/// vertices on the mirror line are split, all attributes with them.
#[test]
fn mirrored_textures_flip_and_split() {
    let mut m = square();
    m.positions.extend([Vec3::new(2.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 0.0)]);
    m.uvs.extend([Vec2::new(0.0, 1.0), Vec2::new(0.0, 0.0)]);
    m.colors = (0..6).map(|i| Vec4::splat(i as f32)).collect();
    m.triangles.extend([[1, 4, 5], [1, 5, 2]]);
    let before = m.clone();
    compute_tangents(&mut m);
    assert_eq!((m.positions.len(), m.tangents.len(), m.colors.len()), (8, 8, 8));
    for (index, triangle) in m.triangles.iter().enumerate() {
        assert_eq!(m.corners(index), before.corners(index));
        assert_eq!(m.corner_uvs(index), before.corner_uvs(index));
        for &v in triangle {
            let t = m.tangents[v as usize];
            assert_eq!((t.x, t.w), if index < 2 { (1.0, 1.0) } else { (-1.0, -1.0) });
        }
    }
}

/// Protects meshes that MikkTSpace cannot treat.
#[test]
fn nothing_to_go_by_still_gives_unit_tangents() {
    let check = |mut m: Mesh| {
        compute_tangents(&mut m);
        assert_eq!(m.tangents.len(), m.positions.len());
        for (t, n) in m.tangents.iter().zip(&m.normals) {
            assert!((t.truncate().length() - 1.0).abs() < 1e-5 && t.w.abs() == 1.0);
            assert!(t.truncate().dot(*n).abs() < 1e-5);
        }
    };
    check(Mesh { uvs: Vec::new(), ..square() });
    check(Mesh { uvs: vec![Vec2::ONE; 4], ..square() });
    check(Mesh { triangles: vec![[0, 0, 1], [1, 1, 1]], ..square() });
    check(Mesh { triangles: Vec::new(), triangle_materials: Vec::new(), ..square() });
    check(Mesh { positions: vec![Vec3::ONE; 4], ..square() });
    check(Mesh::default());
    let scaled = |s: f32| square().positions.iter().map(|p| *p * s).collect::<Vec<_>>();
    check(Mesh { positions: scaled(3e38), ..square() });
    check(Mesh { positions: scaled(1e-30), ..square() });
    check(Mesh { uvs: square().uvs.iter().map(|p| *p * 3e38).collect(), ..square() });
}

/// Protects corners without texture area: they join their vertex's tangent
/// instead of splitting it.
#[test]
fn degenerate_corners_do_not_split() {
    let mut m = square();
    m.triangles.push([0, 1, 1]);
    m.triangles.push([2, 1, 2]);
    compute_tangents(&mut m);
    assert_eq!(m.positions.len(), 4);
    assert!(m.tangents.iter().all(|t| *t == Vec4::new(1.0, 0.0, 0.0, 1.0)));
}

/// Protects the stack: MikkTSpace walks recursively round a vertex.
#[test]
fn a_vertex_of_very_many_triangles() {
    let count = 3_000;
    let mut m = Mesh { positions: vec![Vec3::ZERO], uvs: vec![Vec2::splat(0.5)], ..Mesh::default() };
    for i in 0..count {
        let angle = i as f32 / count as f32 * std::f32::consts::TAU;
        let p = Vec2::from_angle(angle);
        m.positions.push(p.extend(0.0));
        m.uvs.push(Vec2::new(0.5 + 0.5 * p.x, 0.5 - 0.5 * p.y));
        m.triangles.push([0, 1 + i, 1 + (i + 1) % count]);
    }
    m.triangle_materials = vec![0; count as usize];
    compute_tangents(&mut m);
    assert!(m.tangents.iter().all(|t| t.distance(Vec4::new(1.0, 0.0, 0.0, 1.0)) < 1e-3));
}

proptest! {
    /// Protects every finite mesh: unit tangents, handedness ±1, and the same
    /// triangles as before.
    #[test]
    fn always_unit(
        points in prop::collection::vec((-2i8..3, -2i8..3, -2i8..3, -2i8..3, -2i8..3), 1..12),
        corners in prop::collection::vec((0usize..12, 0usize..12, 0usize..12), 0..20),
    ) {
        let n = points.len();
        let mut m = Mesh {
            positions: points.iter().map(|p| Vec3::new(p.0.into(), p.1.into(), p.2.into())).collect(),
            uvs: points.iter().map(|p| Vec2::new(p.3.into(), p.4.into())).collect(),
            triangles: corners.iter().map(|c| [c.0 % n, c.1 % n, c.2 % n].map(|v| v as u32)).collect(),
            triangle_materials: vec![0; corners.len()],
            ..Mesh::default()
        };
        let before = m.clone();
        compute_tangents(&mut m);
        for index in 0..m.triangles.len() {
            prop_assert_eq!(m.corners(index), before.corners(index));
            prop_assert_eq!(m.corner_uvs(index), before.corner_uvs(index));
        }
        prop_assert_eq!(m.tangents.len(), m.positions.len());
        for t in &m.tangents {
            prop_assert!((t.truncate().length() - 1.0).abs() < 1e-5 && t.w.abs() == 1.0);
        }
    }
}

/// Protects large models, whose parts are worked on at the same time: tangents are those of all triangles at once, also where
/// triangles meet only at vertices that are written twice.
#[test]
fn parts_have_the_tangents_of_the_whole() {
    let mut m = Mesh::default();
    let bump = |x: u32, y: u32, seed: u32| ((x * 7 + y * 13 + seed * 5) % 11) as f32 / 11.0;
    for island in 0..6u32 {
        for (row, column) in (0..4u32).flat_map(|row| (0..4u32).map(move |column| (row, column))) {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| (column + x, row + y));
            let first = m.positions.len() as u32;
            for (x, y) in corners {
                let at = Vec3::new(x as f32 + 6.0 * island as f32, y as f32, bump(x, y, island));
                m.positions.push(at);
                m.normals.push(Vec3::new(bump(y, x, island) - 0.5, 0.3 * bump(x, y, 3), 1.0).normalize());
                m.uvs.push(Vec2::new(x as f32 + bump(x, y, 1), y as f32 + bump(y, x, 2)));
            }
            m.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    m.triangle_materials = vec![0; m.triangles.len()];
    let solid: Vec<u32> = (0..m.triangles.len() as u32).collect();
    let parts = independent_parts(&Scaled::new(&m), &solid, 40);
    assert_eq!(parts.iter().map(Vec::len).collect::<Vec<_>>(), [64, 64, 64]);
    assert_eq!(corner_tangents(&m, 40), corner_tangents(&m, usize::MAX / 2));
}
