//! Tests of `demo.rs`.

use super::*;
use crate::{HighSurface, charts, texel_charts, texel_map};
use parbake_model::glam::{DVec3, Vec2, Vec3};

/// Protects the demo's promise of size, place and reproducibility.
#[test]
fn sizes_are_as_promised_and_runs_agree() {
    let high = demo_model();
    let low = demo_low(&high);
    assert!((40_000..60_000).contains(&high.mesh.triangles.len()), "{}", high.mesh.triangles.len());
    assert!((600..1000).contains(&low.triangles.len()), "{}", low.triangles.len());
    assert!(high.mesh.positions.iter().chain(&low.positions).all(|p| p.abs().max_element() < 1.02));
    assert_eq!((high.images[0].width, high.images[0].pixels.len()), (1024, 1024 * 1024));
    assert_eq!(high, demo_model());
    assert_eq!(low, demo_low(&high));
}

/// Protects the layouts: no overlap, nothing mirrored, little stretch, and charts
/// so far apart that a bake of 512² keeps 4 texels of gutter everywhere.
#[test]
fn layouts_are_fit_for_baking() {
    let high = demo_model();
    let low = demo_low(&high);
    for (mesh, gutter) in [(&high.mesh, 1), (&low, 4)] {
        assert!(mesh.uvs.iter().all(|uv| uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all()));
        let map = texel_map(mesh, 512);
        assert_eq!(map.overlaps, 0);
        let of_texel = texel_charts(&map, &charts(mesh));
        for (i, &chart) in of_texel.iter().enumerate().filter(|(_, c)| **c != u32::MAX) {
            let (x, y) = (i % 512, i / 512);
            assert!((gutter..512 - gutter).contains(&x) && (gutter..512 - gutter).contains(&y));
            for other in [x + gutter, x + gutter * 512, x + gutter * 513].map(|d| y * 512 + d) {
                assert!(of_texel[other] == chart || of_texel[other] == u32::MAX);
            }
        }
    }
    let (mut sparsest, mut densest) = (f32::INFINITY, 0.0f32);
    for t in 0..low.triangles.len() {
        let [a, b, c] = low.corner_uvs(t);
        let area = (b - a).perp_dot(c - a);
        // v grows downwards: seen from the front, the texture is not mirrored.
        assert!(area < 0.0);
        let density = (-area / low.area_normal(t).length()).sqrt();
        (sparsest, densest) = (sparsest.min(density), densest.max(density));
    }
    assert!(densest < 2.0 * sparsest, "{sparsest} {densest}");
}

/// Protects the surface's sense: normals and triangles face outwards.
#[test]
fn normals_face_outwards() {
    let high = demo_model();
    for mesh in [&high.mesh, &demo_low(&high)] {
        let volume: f64 = (0..mesh.triangles.len())
            .map(|t| {
                let [a, b, c]: [DVec3; 3] = mesh.corners(t).map(Vec3::as_dvec3);
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        assert!(volume > 0.5, "{volume}");
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let sum: Vec3 = triangle.iter().map(|&v| mesh.normals[v as usize]).sum();
            assert!(sum.dot(mesh.area_normal(t)) > 0.0, "{t}");
        }
    }
}

/// Protects the likeness: the coarse surface runs close to the detailed one, also
/// after the detailed one was moved.
#[test]
fn the_coarse_mesh_follows_the_detailed_one() {
    let mut high = demo_model();
    let placement = parbake_model::Placement { centre: Vec3::new(3.0, -1.0, 2.0), scale: 0.5 };
    placement.apply(&mut high.mesh);
    let low = demo_low(&high);
    let surface = HighSurface::new(&high.mesh);
    for p in &low.positions {
        let distance = surface.closest(*p, f32::INFINITY).unwrap().distance;
        assert!(distance < 0.03, "{p} {distance}");
    }
}
