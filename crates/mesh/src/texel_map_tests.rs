//! Tests of `texel_map.rs`.

use super::*;
use parbake_model::glam::{Vec2, Vec3};
use proptest::prelude::*;

fn mesh(uvs: Vec<Vec2>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh {
        positions: uvs.iter().map(|uv| uv.extend(0.0)).collect(),
        triangle_materials: vec![0; triangles.len()],
        uvs,
        triangles,
        ..Mesh::default()
    }
}

fn interpolated(m: &Mesh, map: &TexelMap, texel: usize) -> Vec2 {
    let [a, b, c] = m.corner_uvs(map.triangle[texel] as usize);
    let [u, v] = map.barycentric[texel];
    a * (1.0 - u - v) + b * u + c * v
}

/// Protects the meaning of the weights, on front-facing and mirrored triangles:
/// they give back the texel's own centre.
#[test]
fn weights_reproduce_the_centre() {
    let corners = vec![Vec2::new(0.1, 0.2), Vec2::new(0.9, 0.3), Vec2::new(0.4, 0.95)];
    for triangle in [[0, 1, 2], [0, 2, 1]] {
        let m = mesh(corners.clone(), vec![triangle]);
        let map = texel_map(&m, 33);
        let covered: Vec<usize> = (0..33 * 33).filter(|&i| map.triangle[i] == 0).collect();
        // Area 0.285 of 1089 texels.
        assert!((290..330).contains(&covered.len()), "{}", covered.len());
        for i in covered {
            let centre = Vec2::new((i % 33) as f32 + 0.5, (i / 33) as f32 + 0.5) / 33.0;
            assert!(interpolated(&m, &map, i).distance(centre) < 1e-5);
        }
        assert_eq!(map.overlaps, 0);
    }
}

/// Protects tiling textures: what leaves the unit square comes in again opposite.
#[test]
fn outside_coordinates_repeat() {
    let square = |x: f32, y: f32, side: f32| {
        let uvs = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        mesh(uvs.map(|(u, v)| Vec2::new(x + side * u, y + side * v)).to_vec(), vec![[0, 1, 2], [0, 2, 3]])
    };
    let count = |m: &Mesh| texel_map(m, 16).triangle.iter().filter(|&&t| t != u32::MAX).count();
    assert_eq!(count(&square(0.75, -0.25, 0.5)), 64);
    assert_eq!(count(&square(-7.5, 123.0, 1.0)), 256);
    let map = texel_map(&square(0.75, 0.0, 0.5), 16);
    assert!(map.triangle[0] != u32::MAX && map.triangle[8] == u32::MAX && map.triangle[15] != u32::MAX);
}

/// Protects the warning about overlapping layouts from false alarms and misses.
#[test]
fn overlaps_count_texels_with_two_owners() {
    let uvs = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let tiled = texel_map(&mesh(uvs.clone(), vec![[0, 1, 2], [0, 2, 3]]), 16);
    assert_eq!(tiled.overlaps, 0);
    let twice = texel_map(&mesh(uvs, vec![[0, 1, 2], [0, 2, 3], [0, 1, 2], [1, 2, 0]]), 16);
    assert_eq!(twice.overlaps, tiled.triangle.iter().filter(|&&t| t == 0).count());
    assert_eq!(twice.triangle, tiled.triangle);
}

/// Protects against hanging or panicking on absurd and degenerate layouts.
#[test]
fn absurd_layouts_end() {
    let huge = [0.0, 1.0, 1e3, -1e9, 3e38, -3e38, 1e-40, f32::MIN_POSITIVE];
    let mut uvs = Vec::new();
    let mut triangles = Vec::new();
    for (i, &a) in huge.iter().enumerate() {
        for &b in &huge[i..] {
            let first = uvs.len() as u32;
            uvs.extend([Vec2::new(a, b), Vec2::new(b, a), Vec2::new(a * 0.5, b * 0.25)]);
            triangles.extend([[first, first + 1, first + 2], [first, first, first + 1]]);
        }
    }
    let map = texel_map(&mesh(uvs, triangles), 64);
    assert!(map.barycentric.iter().flatten().all(|w| (0.0..=1.0).contains(w)));
    assert_eq!(texel_map(&Mesh::default(), 8).triangle, [u32::MAX; 64]);
    assert_eq!(texel_map(&Mesh { positions: vec![Vec3::ZERO], ..Mesh::default() }, 0).size, 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Protects seams within a chart: triangles that tile the square claim every
    /// texel exactly once, even where vertices and edges hit texel centres.
    #[test]
    fn a_tiled_square_is_claimed_once(
        cells in 1usize..9,
        size in 1usize..70,
        jitter in prop::collection::vec((-0.45f32..0.45, -0.45f32..0.45), 100),
        on_grid in any::<bool>(),
        flips in any::<u64>(),
    ) {
        let mut uvs = Vec::new();
        for y in 0..=cells {
            for x in 0..=cells {
                let (mut u, mut v) = (x as f32, y as f32);
                if !on_grid {
                    let (dx, dy) = jitter[y * (cells + 1) + x];
                    if x > 0 && x < cells { u += dx; }
                    if y > 0 && y < cells { v += dy; }
                }
                uvs.push(Vec2::new(u, v) / cells as f32);
            }
        }
        let mut triangles = Vec::new();
        for y in 0..cells {
            for x in 0..cells {
                let a = (y * (cells + 1) + x) as u32;
                let (b, c, d) = (a + 1, a + cells as u32 + 2, a + cells as u32 + 1);
                // Jittered cells may be concave: the diagonal must split them.
                let at = |i: u32| uvs[i as usize];
                let splits = |p: u32, q: u32, r: u32, s: u32| {
                    let e = at(q) - at(p);
                    e.perp_dot(at(r) - at(p)) * e.perp_dot(at(s) - at(p)) < 0.0
                };
                let other = if on_grid { flips >> (y * 8 + x) & 1 == 1 } else { !splits(a, c, b, d) };
                if other {
                    triangles.extend([[a, b, d], [d, c, b]]);
                } else {
                    triangles.extend([[a, b, c], [d, a, c]]);
                }
            }
        }
        let map = texel_map(&mesh(uvs, triangles), size);
        prop_assert_eq!(map.overlaps, 0);
        prop_assert!(map.triangle.iter().all(|&t| t != u32::MAX));
    }
}
