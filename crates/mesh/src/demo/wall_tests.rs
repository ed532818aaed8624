//! Tests of `wall.rs`.

use super::*;
use crate::{compute_tangents, texel_map, weld_by_position};
use parbake_model::glam::DVec3;

/// Protects the wall's promise of size, place and reproducibility.
#[test]
fn sizes_are_as_promised_and_runs_agree() {
    let (high, low) = (wall_model(), wall_low());
    assert_eq!((high.mesh.triangles.len(), low.triangles.len()), (76_800, 12));
    assert!(high.mesh.positions.iter().chain(&low.positions).all(|p| p.abs().max_element() <= HALF));
    assert_eq!(high, wall_model());
}

/// Protects the relief: it is closed where faces meet, turned outwards and deep, and folds
/// over nowhere.
#[test]
fn the_relief_is_closed_and_deep() {
    let mesh = wall_model().mesh;
    let welded = weld_by_position(&mesh.positions);
    let mut edges: Vec<[u32; 2]> = (mesh.triangles.iter())
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [welded[a as usize], welded[b as usize]])
        .collect();
    edges.sort_unstable();
    assert!(edges.windows(2).all(|e| e[0] != e[1]));
    assert!(edges.iter().all(|[a, b]| edges.binary_search(&[*b, *a]).is_ok()));
    let volume: f64 = (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c]: [DVec3; 3] = mesh.corners(t).map(Vec3::as_dvec3);
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    assert!((4.5..5.6).contains(&volume), "{volume}");
    let faces = mesh.triangles.len() / 6;
    for t in 0..mesh.triangles.len() {
        assert!(mesh.area_normal(t).dot(Face(t / faces).axes()[0]) > 0.0, "{t}");
    }
}

/// Protects the layout: no overlap, nothing mirrored, and tangents along the rows of the
/// texture with bitangents up its columns.
#[test]
fn the_layout_is_fit_for_baking() {
    let mut low = wall_low();
    assert_eq!(texel_map(&low, 512).overlaps, 0);
    compute_tangents(&mut low);
    for (vertex, tangent) in low.tangents.iter().enumerate() {
        let [out, right, up] = Face(vertex / 4).axes();
        assert!(tangent.truncate().dot(right) > 0.999 && tangent.w == 1.0 && out.cross(right) == up);
    }
}
