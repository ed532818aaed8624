//! What must hold of the check on random layouts.

use glam::{DMat2, DVec2, dvec2};
use parbake_atlas::predicates::{orientation, triangles_overlap};
use parbake_atlas::{Layout, check};
use proptest::prelude::*;

const SIDE: usize = 8;

/// A grid of squares whose inner points are moved by less than what could flip a
/// triangle, squeezed by `scale`, with coordinates of `f32`. Random diagonals.
fn jittered(moves: &[(f64, f64)], diagonals: u64, low: DVec2, scale: DVec2) -> Layout {
    let mut layout = Layout::default();
    for y in 0..=SIDE {
        for x in 0..=SIDE {
            let (dx, dy) = moves[y * (SIDE + 1) + x];
            let inner = |i: usize| f64::from(u8::from(i > 0 && i < SIDE));
            let p = dvec2(x as f64 + dx * inner(x), y as f64 + dy * inner(y)) / SIDE as f64;
            layout.points.push(low + p * scale);
        }
    }
    for y in 0..SIDE {
        for x in 0..SIDE {
            let a = (y * (SIDE + 1) + x) as u32;
            let [b, d] = [a + 1, a + SIDE as u32 + 1];
            let c = d + 1;
            let pair = if diagonals >> (y * SIDE + x) & 1 == 0 {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [b, c, d]]
            };
            layout.triangles.extend(pair);
        }
    }
    layout.rest = vec![DMat2::IDENTITY; layout.triangles.len()];
    layout.charts = vec![0; layout.triangles.len()];
    layout.round();
    layout
}

fn moves() -> impl Strategy<Value = Vec<(f64, f64)>> {
    prop::collection::vec((-0.2..0.2f64, -0.2..0.2f64), (SIDE + 1) * (SIDE + 1))
}

/// A layout of triangles that share no points.
fn soup(corners: &[[DVec2; 3]]) -> Layout {
    let count = corners.len();
    Layout {
        points: corners.concat(),
        triangles: (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        rest: vec![DMat2::IDENTITY; count],
        charts: (0..count as u32).collect(),
        point_of_vertex: Vec::new(),
    }
}

/// Coordinates on a coarse lattice, so that edges and corners often coincide.
fn lattice_point() -> impl Strategy<Value = DVec2> {
    (0..9u8, 0..9u8).prop_map(|(x, y)| dvec2(f64::from(x), f64::from(y)) / 8.0)
}

fn fine_point() -> impl Strategy<Value = DVec2> {
    (0.0..1.0f32, 0.0..1.0f32).prop_map(|(x, y)| dvec2(x.into(), y.into()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Protects sound layouts from false alarms: neighbours share edges, never areas.
    #[test]
    fn planar_meshes_are_sound(m in moves(), diagonals: u64) {
        let report = check(&jittered(&m, diagonals, DVec2::ZERO, DVec2::ONE), 256);
        prop_assert!(report.is_bijective(), "{:?}", report.problems());
        prop_assert!((report.utilisation - 1.0).abs() < 1e-6);
        prop_assert!(report.gutter.is_none());
    }

    /// Protects slivers: squeezed until f32 hardly tells the rows apart, triangles may
    /// flip by rounding, but two that keep a positive area and lie in neighbouring
    /// columns or rows of a sound mesh overlap only if another one is not sound.
    #[test]
    fn slivers_give_no_false_alarm(m in moves(), diagonals: u64, exponent in 8..22i32) {
        let thin = dvec2(0.5, 0.5f64.powi(exponent));
        let layout = jittered(&m, diagonals, dvec2(0.3, 0.3), thin);
        let report = check(&layout, 256);
        let o = &report.orientations;
        let moved = o.flipped.count + o.mirrored_charts.count + o.degenerate.count;
        prop_assert!(report.overlaps.pairs == 0 || moved > 0, "{:?}", report.problems());
    }

    /// Protects the detection of flips: a point that crosses an opposite edge gives one.
    #[test]
    fn a_point_across_its_opposite_edge_flips(
        m in moves(), diagonals: u64, x in 1..SIDE, y in 1..SIDE, beyond in 0.01..0.5f64,
    ) {
        let mut layout = jittered(&m, diagonals, DVec2::ZERO, DVec2::ONE);
        let point = (y * (SIDE + 1) + x) as u32;
        let t = layout.triangles.iter().position(|t| t.contains(&point)).unwrap();
        let [a, b] = {
            let k = layout.triangles[t].iter().position(|&p| p == point).unwrap();
            [1, 2].map(|i| layout.points[layout.triangles[t][(k + i) % 3] as usize])
        };
        let opposite = a.midpoint(b);
        let p = &mut layout.points[point as usize];
        *p = opposite + (opposite - *p) * beyond;
        layout.round();
        let report = check(&layout, 256);
        prop_assert!(report.orientations.flipped.first.contains(&(t as u32)));
        prop_assert!(report.overlaps.pairs > 0);
        prop_assert!(!report.is_bijective());
    }

    /// Protects areas: two jittered rectangles that share a known rectangle.
    #[test]
    fn pushed_charts_overlap_by_the_known_area(
        m in moves(), diagonals: u64, dx in 0.0..0.6f32, dy in 0.0..0.6f32,
    ) {
        let one = jittered(&m, diagonals, DVec2::ZERO, DVec2::splat(0.5));
        let shift = dvec2(dx.into(), dy.into());
        let mut both = one.clone();
        both.points.extend(one.points.iter().map(|&p| p + shift));
        let offset = one.points.len() as u32;
        both.triangles.extend(one.triangles.iter().map(|t| t.map(|p| p + offset)));
        both.rest.extend(&one.rest);
        both.charts.extend(vec![1; one.charts.len()]);
        let report = check(&both, 256);
        let gap = DVec2::splat(0.5) - shift;
        let want = if gap.min_element() > 0.0 { gap.x * gap.y } else { 0.0 };
        prop_assert!((report.overlaps.area - want).abs() < 1e-7, "{} {want}", report.overlaps.area);
        prop_assert_eq!(report.overlaps.pairs > 0, want > 0.0);
        let apart = (-gap).max(DVec2::ZERO).length() * 256.0;
        let gutter = report.gutter.unwrap();
        prop_assert!((gutter.texels - apart).abs() < 1e-4, "{} {apart}", gutter.texels);
    }

    /// Protects the search: it finds what looking at all pairs finds.
    #[test]
    fn search_agrees_with_all_pairs(
        coarse in prop::collection::vec([lattice_point(), lattice_point(), lattice_point()], 0..40),
        fine in prop::collection::vec([fine_point(), fine_point(), fine_point()], 0..20),
    ) {
        let corners = [coarse, fine].concat();
        let report = check(&soup(&corners), 64);
        let pairs: Vec<[u32; 2]> = (0..corners.len())
            .flat_map(|i| (i + 1..corners.len()).map(move |j| (i, j)))
            .filter(|&(i, j)| triangles_overlap(corners[i], corners[j]))
            .map(|(i, j)| [i as u32, j as u32])
            .collect();
        prop_assert_eq!(report.overlaps.pairs, pairs.len());
        prop_assert!(report.overlaps.complete);
        let first: Vec<[u32; 2]> = report.overlaps.first.iter().map(|o| o.triangles).collect();
        prop_assert_eq!(&first[..], &pairs[..first.len()]);
        let negative = corners.iter().filter(|c| orientation(c[0], c[1], c[2]) < 0.0).count();
        prop_assert_eq!(report.orientations.mirrored_charts.count, negative);
    }

    /// Protects the predicate itself: triangles on a lattice overlap exactly if some
    /// point strictly inside both is left by clipping one with the other, which on a
    /// lattice rounds by far less than the smallest area; and order and winding are
    /// of no matter.
    #[test]
    fn the_predicate_agrees_with_clipping(
        a in [lattice_point(), lattice_point(), lattice_point()],
        b in [lattice_point(), lattice_point(), lattice_point()],
    ) {
        use parbake_atlas::predicates::{counter_clockwise, intersection};
        let clipped = match (counter_clockwise(a), counter_clockwise(b)) {
            (Some(a), Some(b)) => intersection(a, b).is_some_and(|(area, _)| area > 1e-12),
            _ => false,
        };
        prop_assert_eq!(triangles_overlap(a, b), clipped);
        prop_assert_eq!(triangles_overlap(b, [a[1], a[0], a[2]]), clipped);
    }
}
