//! Packing: the gutter holds, nothing is mirrored, scales are as asked.

use parbake_atlas::predicates::{orientation, segments_meet};
use parbake_atlas::{AtlasError, ChartScale, Layout, PackOptions, pack};
use parbake_model::Mesh;
use parbake_model::glam::{DVec2, Vec2, Vec3, dvec2};
use proptest::prelude::*;

/// A mesh of separate polygons, each a fan around its first point.
fn fans(polygons: &[Vec<Vec2>]) -> Mesh {
    let mut mesh = Mesh::default();
    for (i, polygon) in polygons.iter().enumerate() {
        let first = mesh.positions.len() as u32;
        for p in polygon {
            mesh.uvs.push(*p);
            // Seen from the front and not mirrored: v runs down, y up.
            mesh.positions.push(Vec3::new(p.x, -p.y, i as f32));
        }
        for k in 1..polygon.len() as u32 - 1 {
            mesh.triangles.push([first, first + k + 1, first + k]);
            mesh.triangle_materials.push(0);
        }
    }
    mesh
}

fn rectangle(x: f32, y: f32, width: f32, height: f32) -> Vec<Vec2> {
    [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)].map(|(u, v)| Vec2::new(x + u, y + v)).to_vec()
}

fn area(layout: &Layout) -> f64 {
    (0..layout.triangles.len()).map(|t| 0.5 * layout.doubled_area(t)).sum()
}

fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-300)).clamp(0.0, 1.0);
    p.distance(a + (b - a) * t)
}

/// The least distance between triangles of different charts, in parts of the square, by
/// looking at all pairs.
fn least_distance(layout: &Layout) -> f64 {
    let mut least = f64::INFINITY;
    for s in 0..layout.triangles.len() {
        for t in 0..s {
            if layout.charts[s] == layout.charts[t] {
                continue;
            }
            let (p, q) = (layout.corners(s), layout.corners(t));
            let inside =
                |c: [DVec2; 3], x: DVec2| (0..3).all(|k| orientation(c[k], c[(k + 1) % 3], x) >= 0.0);
            if inside(p, q[0]) || inside(q, p[0]) {
                return 0.0;
            }
            for i in 0..3 {
                for k in 0..3 {
                    let (a, b, c, d) = (p[i], p[(i + 1) % 3], q[k], q[(k + 1) % 3]);
                    if segments_meet([a, b], [c, d]) {
                        return 0.0;
                    }
                    least = least.min(to_segment(a, c, d)).min(to_segment(c, a, b));
                }
            }
        }
    }
    least
}

/// All that packing promises of any layout whose triangles are not mirrored.
fn assert_packed(packed: &Layout, options: &PackOptions) {
    let size = options.texture_size as f64;
    let least = least_distance(packed) * size;
    assert!(least >= options.gutter_texels, "gutter {least} of {}", options.gutter_texels);
    let border = (0.5 * options.gutter_texels).max(0.5) - 1e-3;
    for p in &packed.points {
        assert_eq!(*p, p.as_vec2().as_dvec2());
        let inside = (*p * size).min((DVec2::ONE - *p) * size).min_element();
        assert!(inside >= border, "{inside} texels to the border");
    }
    for t in 0..packed.triangles.len() {
        let [a, b, c] = packed.corners(t);
        assert!(orientation(a, b, c) > 0.0, "triangle {t} turned over");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Protects the gutter, the border and every triangle's orientation for charts of any
    /// shape, size, number and place, lying on each other or not.
    #[test]
    fn charts_of_all_shapes_keep_their_distance(
        shapes in prop::collection::vec(
            (prop::collection::vec(0.2f32..1.0, 3..9), 1e-3f32..1.0, -3.0f32..3.0, -3.0f32..3.0), 1..14),
        gutter in 0.0f64..3.0,
        texture_size in 24usize..300,
        rotate: bool,
        equal: bool,
        effort in 0usize..2,
    ) {
        let polygons: Vec<Vec<Vec2>> = shapes
            .iter()
            .map(|(radii, size, x, y)| {
                let n = radii.len() as f32;
                let turn = |k: usize| Vec2::from_angle(k as f32 * std::f32::consts::TAU / (n + 1.0));
                // The fan's first point in the middle keeps its triangles upright.
                std::iter::once(Vec2::ZERO)
                    .chain(radii.iter().enumerate().map(|(k, r)| turn(k) * *r))
                    .map(|p| p * *size + Vec2::new(*x, *y))
                    .collect()
            })
            .collect();
        let layout = Layout::new(&fans(&polygons));
        let chart_scale = if equal { ChartScale::Equal } else { ChartScale::Keep };
        let options = PackOptions { texture_size, gutter_texels: gutter, rotate, chart_scale, effort };
        assert_packed(&pack(&layout, &options).unwrap(), &options);
    }
}

/// Protects textures of one picture: a square fills all but the border, turned or not.
#[test]
fn one_square_fills_the_texture() {
    let layout = Layout::new(&fans(&[rectangle(0.3, -7.0, 3.0, 3.0)]));
    for rotate in [false, true] {
        let options = PackOptions { texture_size: 100, gutter_texels: 2.0, rotate, ..PackOptions::default() };
        let packed = pack(&layout, &options).unwrap();
        assert_packed(&packed, &options);
        assert!((area(&packed) - 0.98f64.powi(2)).abs() < 1e-5, "{}", area(&packed));
    }
}

/// Protects utilisation: what fits without gaps is packed nearly without.
#[test]
fn equal_squares_tile_the_texture() {
    let squares: Vec<_> = (0..16).map(|i| rectangle(i as f32, 0.0, 0.5, 0.5)).collect();
    let layout = Layout::new(&fans(&squares));
    let options = PackOptions { texture_size: 512, gutter_texels: 1.0, ..PackOptions::default() };
    let packed = pack(&layout, &options).unwrap();
    assert_packed(&packed, &options);
    assert!(area(&packed) > 0.95, "{}", area(&packed));
}

/// Protects the use of holes: a frame holds what fits inside it.
#[test]
fn small_charts_lie_in_holes() {
    let frame = [
        rectangle(0.0, 0.0, 10.0, 1.0),
        rectangle(9.0, 1.0, 1.0, 8.0),
        rectangle(0.0, 9.0, 10.0, 1.0),
        rectangle(0.0, 1.0, 1.0, 8.0),
    ];
    // One piece: the four sides share points.
    let mut mesh = fans(&frame);
    mesh.positions.iter_mut().for_each(|p| p.z = 0.0);
    let inner = fans(&[rectangle(20.0, 0.0, 7.0, 7.0)]);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&inner.positions);
    mesh.uvs.extend(&inner.uvs);
    mesh.triangles.extend(inner.triangles.iter().map(|t| t.map(|v| v + first)));
    mesh.triangle_materials.resize(mesh.triangles.len(), 0);
    let packed =
        pack(&Layout::new(&mesh), &PackOptions { texture_size: 256, ..PackOptions::default() }).unwrap();
    assert!(area(&packed) > 0.75, "{}", area(&packed));
}

/// Protects the scales: kept, equal on the surface, or given.
#[test]
fn scales_are_as_asked() {
    let mut mesh = fans(&[rectangle(0.0, 0.0, 0.2, 0.2), rectangle(0.5, 0.0, 0.4, 0.4)]);
    mesh.positions[4..].iter_mut().for_each(|p| *p *= 0.25);
    let layout = Layout::new(&mesh);
    let ratio = |chart_scale| {
        let packed = pack(&layout, &PackOptions { chart_scale, ..PackOptions::default() }).unwrap();
        (packed.doubled_area(2) / packed.doubled_area(0)).sqrt()
    };
    assert!((ratio(ChartScale::Keep) - 2.0).abs() < 1e-4);
    assert!((ratio(ChartScale::Equal) - 0.5).abs() < 1e-4);
    assert!((ratio(ChartScale::Given(vec![2.0, 3.0])) - 3.0).abs() < 1e-4);
    let wrong = PackOptions { chart_scale: ChartScale::Given(vec![1.0]), ..PackOptions::default() };
    assert!(matches!(pack(&layout, &wrong), Err(AtlasError::InvalidOption { .. })));
}

/// Protects many charts, by boxes beyond some thousands, and says when there is no room.
#[test]
fn many_charts_are_packed() {
    for count in [300, 5000] {
        let charts: Vec<_> = (0..count)
            .map(|i| rectangle(i as f32, 0.0, 0.1 + (i % 7) as f32 * 0.1, 0.1 + (i % 5) as f32 * 0.1))
            .collect();
        let layout = Layout::new(&fans(&charts));
        let options = PackOptions { texture_size: 1024, gutter_texels: 1.0, ..PackOptions::default() };
        let packed = pack(&layout, &options).unwrap();
        let check = parbake_atlas::check(&packed, 1024);
        assert!(check.is_bijective() && check.gutter.unwrap().texels >= 1.0);
        assert!(check.utilisation > if count == 300 { 0.75 } else { 0.5 }, "{}", check.utilisation);
        let small = PackOptions { texture_size: 8, gutter_texels: 2.0, ..PackOptions::default() };
        assert!(matches!(pack(&layout, &small), Err(AtlasError::NoRoom { .. })));
    }
}

/// Protects results from the number of threads and from timing, on one grid and on several.
#[test]
fn the_same_for_any_number_of_threads() {
    let charts: Vec<_> = (0..30).map(|i| rectangle(i as f32, 0.0, 0.1 + (i % 7) as f32 * 0.1, 0.3)).collect();
    let layout = Layout::new(&fans(&charts));
    for texture_size in [128, 520] {
        let packed = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| pack(&layout, &PackOptions { texture_size, ..PackOptions::default() }).unwrap())
        };
        let one = packed(1);
        assert!([2, 5, 2, 5, 2, 5].into_iter().all(|threads| packed(threads) == one));
    }
}

/// Protects layouts of nothing, points and lines, and options that make no sense.
#[test]
fn odd_layouts_and_options() {
    assert_eq!(pack(&Layout::default(), &PackOptions::default()).unwrap(), Layout::default());
    let mut layout = Layout::new(&fans(&[rectangle(0.0, 0.0, 0.0, 0.0), rectangle(0.0, 0.0, 1.0, 0.0)]));
    assert!(pack(&layout, &PackOptions::default()).is_ok());
    layout.points.iter_mut().for_each(|p| *p = dvec2(1e30, -1e-30));
    assert!(pack(&layout, &PackOptions::default()).is_ok());
    for options in [
        PackOptions { texture_size: 0, ..PackOptions::default() },
        PackOptions { gutter_texels: f64::NAN, ..PackOptions::default() },
    ] {
        assert!(matches!(pack(&layout, &options), Err(AtlasError::InvalidOption { .. })));
    }
}
