//! Tests of `simplify.rs`.

use super::*;
use crate::smooth_normals;
use proptest::prelude::*;

/// A gently curved grid of n × n squares with texture coordinates, left half
/// material 0, right half material 1, and a texture seam between the halves.
fn grid(n: u32) -> Mesh {
    let mut m = Mesh::default();
    for half in 0..2 {
        let first = m.positions.len() as u32;
        for y in 0..=n {
            for x in 0..=n / 2 {
                let p = Vec2::new((x + half * (n / 2)) as f32, y as f32) / n as f32;
                m.positions.push(p.extend(0.1 * (p.x * 3.0).sin() * p.y));
                m.uvs.push(p * 0.5 + Vec2::new(0.4 * half as f32, 0.0));
            }
        }
        let row = n / 2 + 1;
        for y in 0..n {
            for x in 0..n / 2 {
                let v = first + y * row + x;
                m.triangles.extend([[v, v + 1, v + row + 1], [v, v + row + 1, v + row]]);
                m.triangle_materials.extend([half; 2]);
            }
        }
    }
    m.normals = smooth_normals(&m);
    m
}

fn area(m: &Mesh) -> f32 {
    (0..m.triangles.len()).map(|t| m.area_normal(t).length() * 0.5).sum()
}

/// Protects the common case: target met, shape, materials and layout kept.
#[test]
fn a_smooth_grid_reaches_its_target() {
    let m = grid(40);
    let coarse = simplify(&m, SimplifyOptions { target_triangles: 100, ..Default::default() });
    assert!((50..=150).contains(&coarse.triangles.len()), "{}", coarse.triangles.len());
    assert!((area(&coarse) - area(&m)).abs() < 0.02 * area(&m));
    for (index, &material) in coarse.triangle_materials.iter().enumerate() {
        for p in coarse.corners(index) {
            assert!(if material == 0 { p.x <= 0.5 } else { p.x >= 0.5 });
        }
        let [a, b, c] = coarse.corner_uvs(index);
        assert!((b - a).perp_dot(c - a) > 0.0, "a flipped texture");
    }
    assert_eq!(coarse.normals.len(), coarse.positions.len());
    assert!(coarse.tangents.is_empty());
}

/// Protects faceted models, whose every vertex is a seam of normals.
#[test]
fn faceted_models_are_simplified_too() {
    let m = grid(24);
    let mut faceted = Mesh::default();
    for (index, &material) in m.triangle_materials.iter().enumerate() {
        let v = faceted.positions.len() as u32;
        faceted.positions.extend(m.corners(index));
        faceted.uvs.extend(m.corner_uvs(index));
        faceted.normals.extend([m.area_normal(index).normalize(); 3]);
        faceted.triangles.push([v, v + 1, v + 2]);
        faceted.triangle_materials.push(material);
    }
    let coarse = simplify(&faceted, SimplifyOptions { target_triangles: 60, ..Default::default() });
    assert!(coarse.triangles.len() <= 90, "{}", coarse.triangles.len());
    assert!(coarse.normals.iter().all(|n| n.z > 0.5));
    // Facets stay facets: each normal is one that the model has at that place.
    for (position, normal) in coarse.positions.iter().zip(&coarse.normals) {
        let mut own = faceted.positions.iter().zip(&faceted.normals).filter(|(p, _)| *p == position);
        assert!(own.any(|(_, own)| (*own - *normal).length() < 1e-4), "{normal} at {position}");
    }
}

/// Protects topology-bound models: loose triangles cannot be collapsed, only
/// pruned or clustered.
#[test]
fn loose_triangles_are_reduced() {
    let m = grid(40);
    let mut loose = Mesh::default();
    for index in 0..m.triangles.len() {
        let v = loose.positions.len() as u32;
        let centre = m.corners(index).into_iter().sum::<Vec3>() / 3.0;
        loose.positions.extend(m.corners(index).map(|p| p.lerp(centre, 0.1)));
        loose.triangles.push([v, v + 1, v + 2]);
    }
    loose.triangle_materials = vec![0; loose.triangles.len()];
    let coarse = simplify(&loose, SimplifyOptions { target_triangles: 300, ..Default::default() });
    assert!(!coarse.triangles.is_empty() && coarse.triangles.len() <= 450, "{}", coarse.triangles.len());
}

/// Protects small and odd inputs: never empty, never more.
#[test]
fn what_is_small_or_degenerate_survives() {
    let tiny = grid(2);
    let options = SimplifyOptions { target_triangles: 1000, ..Default::default() };
    assert_eq!(simplify(&tiny, options).triangles.len(), 8);
    assert!(simplify(&Mesh::default(), options).triangles.is_empty());
    let zero = SimplifyOptions { target_triangles: 0, ..Default::default() };
    assert!(!simplify(&tiny, zero).triangles.is_empty());
    for scale in [0.0, 1e-40, 3e38] {
        let positions = tiny.positions.iter().map(|p| *p * scale).collect();
        let coarse = simplify(&Mesh { positions, ..tiny.clone() }, zero);
        assert!(!coarse.triangles.is_empty() && coarse.positions.iter().all(|p| p.is_finite()));
    }
    let nothing_moves = SimplifyOptions { target_triangles: 4, max_error: 0.0, ..Default::default() };
    assert!(area(&simplify(&grid(8), nothing_moves)) > 0.9);
}

proptest! {
    /// Protects every mesh: indices in range, materials of the input, all vertices
    /// used, not empty, not larger.
    #[test]
    fn results_keep_the_mesh_contract(
        points in prop::collection::vec((-2i8..3, -2i8..3, -2i8..3, -2i8..3, -2i8..3), 1..30),
        corners in prop::collection::vec((0usize..30, 0usize..30, 0usize..30, 0u32..3), 1..80),
        target in 0usize..20,
    ) {
        let n = points.len();
        let mut m = Mesh {
            positions: points.iter().map(|p| Vec3::new(p.0.into(), p.1.into(), p.2.into())).collect(),
            uvs: points.iter().map(|p| Vec2::new(p.3.into(), p.4.into())).collect(),
            triangles: corners.iter().map(|c| [c.0 % n, c.1 % n, c.2 % n].map(|v| v as u32)).collect(),
            triangle_materials: corners.iter().map(|c| c.3).collect(),
            ..Mesh::default()
        };
        m.normals = smooth_normals(&m);
        let coarse = simplify(&m, SimplifyOptions { target_triangles: target, ..Default::default() });
        prop_assert!(!coarse.triangles.is_empty() && coarse.triangles.len() <= m.triangles.len());
        prop_assert_eq!(coarse.triangles.len(), coarse.triangle_materials.len());
        prop_assert!(coarse.triangle_materials.iter().all(|&k| k < 3));
        let mut used = vec![false; coarse.positions.len()];
        for &v in coarse.triangles.iter().flatten() {
            used[v as usize] = true;
        }
        prop_assert!(used.iter().all(|&u| u));
        prop_assert_eq!(coarse.uvs.len(), coarse.positions.len());
        prop_assert!(coarse.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
    }
}
