//! What the check says of small layouts whose faults are known.

use glam::{DMat2, DVec2, dvec2};
use parbake_atlas::{Layout, UvCheck, check};

/// A layout of charts, each a list of triangles that share points where these are
/// equal; every triangle's shape in space is that in the texture, four times as large.
fn layout(charts: &[&[[DVec2; 3]]]) -> Layout {
    let mut layout = Layout::default();
    for (index, chart) in charts.iter().enumerate() {
        let first = layout.points.len();
        for corners in *chart {
            let triangle = corners.map(|p| {
                let known = layout.points[first..].iter().position(|&q| q == p);
                first as u32
                    + known.unwrap_or_else(|| {
                        layout.points.push(p);
                        layout.points.len() - 1 - first
                    }) as u32
            });
            layout.triangles.push(triangle);
            let [a, b, c] = corners;
            let (u, v) = (4.0 * (*b - *a), 4.0 * (*c - *a));
            let length = u.length();
            let height = u.perp_dot(v).abs() / length;
            layout.rest.push(DMat2::from_cols(dvec2(length, 0.0), dvec2(u.dot(v) / length, height)));
            layout.charts.push(index as u32);
        }
    }
    layout
}

/// A rectangle of two triangles.
fn rectangle(low: DVec2, size: DVec2) -> [[DVec2; 3]; 2] {
    let [a, b, c, d] = [low, low + dvec2(size.x, 0.0), low + size, low + dvec2(0.0, size.y)];
    [[a, b, c], [a, c, d]]
}

fn assert_close(value: f64, want: f64) {
    assert!((value - want).abs() < 1e-9 * want.abs().max(1.0), "{value}, not {want}");
}

/// No fault means no sentence, and the other way around.
fn assert_consistent(report: &UvCheck) {
    assert_eq!(report.is_bijective(), report.problems().is_empty(), "{:?}", report.problems());
}

/// Protects the clean case: all figures of one square are known.
#[test]
fn a_square_is_sound() {
    let report = check(&layout(&[&rectangle(dvec2(0.25, 0.25), dvec2(0.5, 0.5))]), 64);
    assert!(report.is_bijective());
    assert_consistent(&report);
    assert_eq!((report.triangles, report.charts), (2, 1));
    assert!(report.gutter.is_none());
    assert_eq!(report.border, Some(16.0));
    assert_eq!(report.utilisation, 0.25);
    let distortion = report.distortion.unwrap();
    assert_close(distortion.stretch_l2, 1.0);
    assert_close(distortion.stretch_max, 1.0);
    assert_close(distortion.texels_per_unit, 16.0);
    assert_close(distortion.anisotropy.q99, 1.0);
    assert_close(distortion.area_scale.q50, 1.0);
}

/// Protects layouts without triangles, and without area.
#[test]
fn nothing_is_sound_and_has_no_figures() {
    let report = check(&Layout::default(), 64);
    assert!(report.is_bijective() && report.problems().is_empty());
    assert_eq!((report.border, report.utilisation, report.charts), (None, 0.0, 0));
    let mut point = layout(&[&rectangle(DVec2::ZERO, DVec2::ONE)]);
    point.points.fill(DVec2::ZERO);
    let report = check(&point, 64);
    assert_eq!(report.orientations.degenerate.count, 2);
    assert!(!report.is_bijective() && report.distortion.is_none());
    assert_consistent(&report);
}

/// Protects the difference between a flip and a mirrored chart.
#[test]
fn flips_and_mirrored_charts_are_told_apart() {
    let [a, b] = rectangle(dvec2(0.1, 0.1), dvec2(0.2, 0.2));
    let other = rectangle(dvec2(0.6, 0.6), dvec2(0.2, 0.2));
    let mirrored = other.map(|[a, b, c]| [a, c, b]);
    let flipped = [a[0], a[2], a[1]];
    let report = check(&layout(&[&[flipped, b], &mirrored]), 128);
    let o = &report.orientations;
    assert_eq!((o.flipped.count, o.flipped.first.as_slice()), (1, [0].as_slice()));
    assert_eq!((o.mirrored_charts.first.as_slice(), o.mirrored_triangles), ([1].as_slice(), 2));
    assert_eq!(
        report.problems(),
        ["1 triangle is flipped within its chart (0).", "1 chart is mirrored as a whole (1)."]
    );
    assert_consistent(&report);
    assert!(!check(&layout(&[&mirrored]), 128).is_bijective());
}

/// Protects the kinds of triangles without area.
#[test]
fn triangles_without_area_are_told_apart() {
    let line = [dvec2(0.1, 0.1), dvec2(0.3, 0.3), dvec2(0.2, 0.2)];
    let mut flat = layout(&[&rectangle(dvec2(0.5, 0.5), dvec2(0.2, 0.2)), &[line], &[line]]);
    flat.rest[2] = DMat2::from_diagonal(DVec2::ONE);
    flat.rest[3] = DMat2::ZERO;
    let report = check(&flat, 64);
    assert_eq!(report.orientations.degenerate.first, [2]);
    assert_eq!(report.orientations.without_surface.first, [3]);
    assert_eq!(report.overlaps.pairs, 0);
    assert_consistent(&report);
    assert_eq!(report.distortion.unwrap().area_scale.q5, 0.0);
}

/// Protects the border: on it is inside, beyond it is not; and coordinates that are
/// no numbers, which the layout's contract excludes, do no harm.
#[test]
fn what_leaves_the_square_is_found() {
    let whole = layout(&[&rectangle(DVec2::ZERO, DVec2::ONE)]);
    let report = check(&whole, 64);
    assert!(report.is_bijective());
    assert_eq!((report.border, report.utilisation), (Some(0.0), 1.0));
    let beyond = layout(&[&rectangle(dvec2(0.5, 0.5), dvec2(0.625, 0.25))]);
    let report = check(&beyond, 64);
    assert_eq!((report.orientations.outside.count, report.border), (2, Some(-8.0)));
    assert_eq!(report.utilisation, 0.125);
    assert_consistent(&report);
    let mut broken = whole;
    broken.points[3] = dvec2(f64::NAN, f64::INFINITY);
    let report = check(&broken, 64);
    assert_eq!(report.orientations.not_finite.count, 1);
    assert_consistent(&report);
}

/// Protects the number, the area, the place and the words of an overlap.
#[test]
fn charts_pushed_into_each_other_overlap_by_a_known_area() {
    let one = rectangle(dvec2(0.25, 0.25), dvec2(0.25, 0.25));
    let two = rectangle(dvec2(0.375, 0.4375), dvec2(0.25, 0.25));
    let report = check(&layout(&[&one, &two]), 64);
    assert_close(report.overlaps.area, 0.125 * 0.0625);
    assert_close(report.overlaps.texels, 32.0);
    assert_eq!(report.gutter.as_ref().unwrap().texels, 0.0);
    assert!((report.utilisation - (0.125 - 0.125 * 0.0625)).abs() < 1e-3);
    assert_consistent(&report);
    // One chart within another one is an overlap as well, though no boundaries cross.
    let small = [[dvec2(0.3, 0.26), dvec2(0.31, 0.26), dvec2(0.31, 0.27)]];
    let report = check(&layout(&[&one, &small]), 1000);
    assert_eq!(report.overlaps.pairs, 1);
    assert_eq!(report.overlaps.first[0].triangles, [0, 2]);
    assert_eq!(
        report.problems(),
        ["1 pair of triangles overlaps, 50.0 texels in all; they are 0 and 2 near (0.3067, 0.2633)."]
    );
}

/// Protects the gutter: the nearest pair, its distance in texels and the quantile.
#[test]
fn gutters_are_measured_between_charts() {
    let one = rectangle(dvec2(0.125, 0.125), dvec2(0.25, 0.25));
    let two = rectangle(dvec2(0.40625, 0.4375), dvec2(0.25, 0.25));
    let far = rectangle(dvec2(0.75, 0.125), dvec2(0.125, 0.125));
    let report = check(&layout(&[&far, &two, &one]), 256);
    let gutter = report.gutter.as_ref().unwrap();
    assert_close(gutter.texels, 256.0 * (0.03125f64.powi(2) + 0.0625f64.powi(2)).sqrt());
    assert!(gutter.complete);
    assert_eq!(gutter.charts, [1, 2]);
    assert_eq!(gutter.place, [0.390625, 0.40625]);
    assert!(gutter.quantile_5 >= gutter.texels);
    assert_eq!(report.border, Some(32.0));
    assert!(report.is_bijective());
    // Charts may touch: sound, with no gutter.
    let beside = rectangle(dvec2(0.375, 0.0), dvec2(0.25, 0.25));
    let report = check(&layout(&[&one, &beside]), 256);
    assert!(report.is_bijective());
    assert_eq!(report.gutter.unwrap().texels, 0.0);
}

/// Protects stretch, scale and anisotropy against values worked out by hand: half the
/// surface at scale 1 × 1, half at 1/2 × 1/4.
#[test]
fn distortion_of_a_known_layout() {
    let one = rectangle(DVec2::ZERO, dvec2(0.25, 0.25));
    let two = rectangle(dvec2(0.5, 0.5), dvec2(0.125, 0.0625));
    let mut uneven = layout(&[&one, &two]);
    let mut even = layout(&[&one]).rest;
    even.iter_mut().for_each(|m| *m *= 0.25);
    uneven.rest = [even.clone(), even].concat();
    let distortion = check(&uneven, 512).distortion.unwrap();
    let mean: f64 = (1.0 + 0.125) / 2.0;
    assert_close(distortion.texels_per_unit, 512.0 * mean.sqrt());
    assert_close(distortion.stretch_l2, (mean * (1.0 + 0.5 * (4.0 + 16.0)) / 2.0).sqrt());
    assert_close(distortion.stretch_max, 4.0 * mean.sqrt());
    assert_close(distortion.area_scale.q5, 0.125 / mean);
    assert_close(distortion.area_scale.q95, 1.0 / mean);
    assert_close(distortion.anisotropy.q1, 1.0);
    assert_close(distortion.anisotropy.q99, 2.0);
}

/// Protects the end of the search: all triangles in one place must neither take long
/// nor go unnoticed, and threads must not change what is said.
#[test]
fn everything_on_everything_ends_soon() {
    let one = [dvec2(0.25, 0.25), dvec2(0.5, 0.25), dvec2(0.25, 0.5)];
    let single = layout(&[&[one]]);
    let count = 100_000;
    let heap = Layout {
        points: single.points,
        triangles: vec![single.triangles[0]; count],
        rest: vec![single.rest[0]; count],
        charts: (0..count as u32).collect(),
        point_of_vertex: Vec::new(),
    };
    let start = std::time::Instant::now();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| check(&heap, 512))
    };
    let report = run(1);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    assert!(!report.overlaps.complete && report.overlaps.pairs > 1_000_000);
    assert_eq!(report.overlaps.first[4].triangles, [0, 5]);
    assert!((report.utilisation - 0.03125).abs() < 2e-3);
    assert!(report.problems()[0].starts_with("At least "));
    assert_eq!(run(3), report);
}

/// Protects the gutter from triangles that show nothing: isolated ones that lie on a
/// chart, and slivers along one, whose boundary stays.
#[test]
fn triangles_without_any_area_have_no_gutter() {
    let two = [rectangle(dvec2(0.1, 0.1), dvec2(0.2, 0.2)), rectangle(dvec2(0.4, 0.1), dvec2(0.2, 0.2))];
    let mut layout = layout(&[&two[0], &two[1]]);
    let clean = check(&layout, 100);
    let mut add = |points: [u32; 3], chart: u32| {
        layout.triangles.push(points);
        layout.rest.push(DMat2::ZERO);
        layout.charts.push(chart);
    };
    let count = 8;
    // A chart by itself, collapsed onto a corner; one with a length on another chart.
    add([count, count + 1, count + 2], 2);
    add([count + 3, count + 3, count + 4], 3);
    // A sliver on the first rectangle's side that faces the other one.
    add([2, 1, count + 5], 0);
    let corner = dvec2(0.4, 0.1);
    layout.points.extend([corner, corner, corner, corner, dvec2(0.6, 0.3), dvec2(0.3, 0.2)]);
    let report = check(&layout, 100);
    assert_eq!(report.gutter, clean.gutter);
    assert_close(report.gutter.unwrap().texels, 10.0);
}

/// Protects the square's border on every side: a coordinate on it is inside, the next
/// number that a file can hold is outside.
#[test]
fn the_border_belongs_to_the_square() {
    let (low, high) = (DVec2::ZERO, DVec2::ONE);
    let tiny = f64::from(f32::from_bits(1));
    let step = f64::from(f32::EPSILON);
    let outside = |low: DVec2, high: DVec2| {
        let report = check(&layout(&[&rectangle(low, high - low)]), 64);
        assert_consistent(&report);
        report.orientations.outside.count
    };
    assert_eq!(outside(low, high), 0);
    for (x, y) in [(1.0, 0.0), (0.0, 1.0)] {
        let by = dvec2(x, y);
        assert_eq!(outside(low - tiny * by, high), 2);
        assert_eq!(outside(low, high + step * by), 2);
    }
}

/// Protects the covered share of layouts that leave the square: it is counted within
/// the square, though nothing overlaps; and of those that overlap within it.
#[test]
fn what_is_outside_or_doubled_covers_once() {
    let report = check(&layout(&[&rectangle(DVec2::ZERO, dvec2(2.0, 0.5))]), 64);
    assert_eq!((report.overlaps.pairs, report.orientations.outside.count), (0, 2));
    assert_eq!(report.utilisation, 0.5);
    let one = rectangle(DVec2::ZERO, dvec2(0.5, 0.5));
    let report = check(&layout(&[&one, &one]), 64);
    assert_eq!((report.overlaps.pairs, report.orientations.outside.count), (2, 0));
    assert_eq!(report.utilisation, 0.25);
}

/// Protects the quantile of gutters, by length, and the number of charts.
#[test]
fn a_twentieth_of_the_boundary_comes_as_near_as_the_quantile() {
    // A chart of a boundary 4 long, of which a notch of 1 / 64 is one texel nearer to
    // the other chart: less than a twentieth.
    let one = rectangle(dvec2(0.25, 0.25), dvec2(0.25, 0.5));
    let notch = [dvec2(0.5, 0.75), dvec2(0.5, 0.75 - 1.0 / 64.0), dvec2(0.5 + 1.0 / 64.0, 0.75)];
    let two = rectangle(dvec2(0.625, 0.0), dvec2(0.25, 1.0));
    let report = check(&layout(&[&one, &two, &[notch]]), 64);
    assert_eq!(report.charts, 3);
    let gutter = report.gutter.unwrap();
    assert_eq!((gutter.texels, gutter.charts), (0.0, [0, 2]));
    let apart = check(&layout(&[&one, &two]), 64).gutter.unwrap();
    assert_eq!((apart.texels, apart.quantile_5, apart.charts), (8.0, 8.0, [0, 1]));
}

/// Protects the gutter from points that are not finite: their edges say nothing.
#[test]
fn broken_points_have_no_gutter() {
    let two = [rectangle(dvec2(0.1, 0.1), dvec2(0.2, 0.2)), rectangle(dvec2(0.4, 0.1), dvec2(0.2, 0.2))];
    let clean = check(&layout(&[&two[0], &two[1]]), 100).gutter;
    for broken in [dvec2(f64::NAN, 0.2), dvec2(f64::INFINITY, 0.2), dvec2(0.35, f64::NEG_INFINITY)] {
        for turn in 0..3 {
            // Its other two corners lie between the charts, the edge between them on one.
            let mut corners = [dvec2(0.55, 0.3), dvec2(0.6, 0.3), broken];
            corners.rotate_right(turn);
            let mut with = layout(&[&two[0], &two[1]]);
            let first = with.points.len() as u32;
            with.points.extend(corners);
            with.triangles.push([first, first + 1, first + 2]);
            with.rest.push(DMat2::IDENTITY);
            with.charts.push(1);
            assert_eq!(check(&with, 100).gutter, clean, "{corners:?}");
        }
    }
}
