//! What must never break: from a bijective start, whatever the directions, every
//! iterate stays bijective, keeps the gutter, and stays in the square.

use glam::{DMat2, DVec2, dvec2};
use parbake_atlas::Layout;
use parbake_uv::contact::{Border, Contact, ContactOptions};
use parbake_uv::inversion;
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng};
use robust::{Coord, orient2d};

/// Texels a side.
const SIZE: f64 = 256.0;

/// Steps of each case.
const STEPS: usize = 1500;

fn random(rng: &mut TestRng, low: f64, high: f64) -> f64 {
    low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX)
}

/// How far jitter moves a corner, in quads: two ends and the point between them come no
/// nearer to each other than √½ − 2 √2 · 0.24 of a quad, so that no triangle starts flipped.
const JITTER: f64 = 0.24;

/// The numbers that a case's seed stands for: a failure prints the seed, and that repeats it.
fn numbers(seed: u64) -> TestRng {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    TestRng::from_seed(RngAlgorithm::ChaCha, &bytes)
}

/// Adds a chart: jittered quads in a square of this corner and size, some of them
/// missing, so that there are holes, bays and bow ties.
fn add_chart(layout: &mut Layout, rng: &mut TestRng, corner: DVec2, size: f64, quads: u32, jitter: f64) {
    let first = layout.points.len() as u32;
    for row in 0..=quads {
        for column in 0..=quads {
            let offset = jitter * dvec2(random(rng, -JITTER, JITTER), random(rng, -JITTER, JITTER));
            let at = (dvec2(f64::from(column), f64::from(row)) + offset) / f64::from(quads);
            layout.points.push(corner + size * at);
        }
    }
    let chart = layout.charts.last().map_or(0, |c| c + 1);
    for row in 0..quads {
        for column in 0..quads {
            // The first row and column hold the chart together.
            if jitter > 0.0 && row > 0 && column > 0 && random(rng, 0.0, 1.0) < 0.15 {
                continue;
            }
            let a = first + row * (quads + 1) + column;
            layout.triangles.push([a, a + 1, a + quads + 2]);
            layout.triangles.push([a, a + quads + 2, a + quads + 1]);
            layout.charts.extend([chart; 2]);
        }
    }
}

fn finished(mut layout: Layout) -> Layout {
    layout.rest = vec![DMat2::IDENTITY; layout.triangles.len()];
    layout.point_of_vertex = (0..layout.points.len() as u32).collect();
    layout.round();
    layout
}

/// Charts of random sizes in the fields of a board.
fn board(rng: &mut TestRng) -> Layout {
    let mut layout = Layout::default();
    let fields = 3;
    for field in 0..fields * fields {
        let corner = dvec2(f64::from(field % fields), f64::from(field / fields)) / f64::from(fields);
        let size = random(rng, 0.3, 0.55) / f64::from(fields);
        let quads = 1 + rng.next_u32() % 4;
        add_chart(&mut layout, rng, corner + 0.08, size, quads, 1.0);
    }
    finished(layout)
}

/// Charts that touch, nearly touch and overlap, with T-junctions where they do.
fn crowd(rng: &mut TestRng) -> Layout {
    let mut layout = Layout::default();
    for field in 0..16 {
        let corner = dvec2(f64::from(field % 4), f64::from(field / 4)) / 4.0;
        let gap = match rng.next_u32() % 4 {
            0 => -0.01,
            1 => 0.0,
            _ => 10f64.powf(random(rng, -8.0, -2.0)),
        };
        let quads = 1 + rng.next_u32() % 4;
        add_chart(&mut layout, rng, corner, 0.25 - gap, quads, 0.0);
    }
    finished(layout)
}

/// One chart that fills the square.
fn sheet(rng: &mut TestRng) -> Layout {
    let mut layout = Layout::default();
    add_chart(&mut layout, rng, DVec2::ZERO, 1.0, 7, 0.0);
    finished(layout)
}

/// A direction that means harm, or one that makes room for the next.
fn direction(rng: &mut TestRng, layout: &Layout, points: &[DVec2], contact: &Contact) -> Vec<DVec2> {
    let size = 10f64.powf(random(rng, -5.0, 6.0));
    let any = |rng: &mut TestRng| dvec2(random(rng, -1.0, 1.0), random(rng, -1.0, 1.0));
    let focus = dvec2(random(rng, 0.0, 1.0), random(rng, 0.0, 1.0));
    let mut direction: Vec<DVec2> = match rng.next_u32() % 7 {
        0 => points.iter().map(|_| any(rng)).collect(),
        1 => points.iter().map(|p| focus - p).collect(),
        2 => points.iter().map(|p| (p - focus).perp()).collect(),
        3 => {
            let mut one = vec![DVec2::ZERO; points.len()];
            one[rng.next_u32() as usize % points.len()] = any(rng);
            one
        }
        4 => {
            // Each chart a way of its own.
            let mut ways = vec![DVec2::ZERO; points.len()];
            let charts: Vec<DVec2> = layout.charts.iter().map(|_| any(rng)).collect();
            for (corners, &chart) in layout.triangles.iter().zip(&layout.charts) {
                corners.iter().for_each(|&c| ways[c as usize] = charts[chart as usize]);
            }
            ways
        }
        5 => vec![any(rng); points.len()],
        _ => {
            // Down the barrier: apart.
            let mut gradient = vec![DVec2::ZERO; points.len()];
            let energy = contact.energy_and_gradient(points, &mut gradient);
            assert!(energy.is_finite() && gradient.iter().all(|g| g.is_finite()));
            return gradient.iter().map(|g| -g / SIZE / SIZE).collect();
        }
    };
    direction.iter_mut().for_each(|d| *d *= size);
    direction
}

/// Takes the steps; how many of them moved something.
fn run(layout: &Layout, contact: &Contact, rng: &mut TestRng) -> (Vec<DVec2>, usize) {
    let upright = inversion::upright(layout);
    assert_eq!(upright.len(), layout.triangles.len());
    let mut points = layout.points.clone();
    let mut moves = 0;
    for _ in 0..STEPS {
        let mut direction = direction(rng, layout, &points, contact);
        contact.constraints().apply(&mut direction);
        let limit = inversion::max_step(&upright, &points, &direction, 1.0);
        let mut step = 0.9 * contact.max_step(&points, &direction, limit);
        assert!(step.is_finite() && step >= 0.0);
        for attempt in 0..6 {
            let moved: Vec<DVec2> = points.iter().zip(&direction).map(|(p, d)| p + step * d).collect();
            // Without rounding the first attempt is always right.
            assert!(attempt > 0 || contact.is_feasible(&moved));
            let rounded = contact.feasible_after_rounding(&moved);
            if let Some(rounded) = rounded.filter(|r| inversion::all_upright(&upright, r)) {
                moves += usize::from(rounded != points);
                points = rounded;
                break;
            }
            step *= 0.5;
        }
    }
    (points, moves)
}

/// −1, 0 or 1, exactly.
fn side(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p.x, y: p.y });
    let area = orient2d(a, b, c);
    if area == 0.0 { 0.0 } else { area.signum() }
}

/// Whether two segments cross, exactly.
fn cross([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Whether two segments have a point in common, exactly.
fn meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let boxes = a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all();
    boxes && side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
}

fn distance(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let edge = b - a;
    let along = ((p - a).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
    p.distance(a + along * edge)
}

/// Everything again with brute force, and nothing of the code under test but the list
/// of boundary edges.
fn assert_bijective(layout: &Layout, points: &[DVec2], gutter: f64) {
    for t in &layout.triangles {
        let [a, b, c] = t.map(|i| points[i as usize]);
        assert!([a, b, c].iter().all(|p| p.is_finite() && *p == p.clamp(DVec2::ZERO, DVec2::ONE)));
        assert!(side(a, b, c) > 0.0, "flipped");
    }
    let boundary = layout.boundary();
    for (i, first) in boundary.iter().enumerate() {
        for second in &boundary[..i] {
            let ends = [first, second].map(|e| e.points.map(|v| points[v as usize]));
            if !first.points.iter().any(|v| second.points.contains(v)) {
                assert!(!meet(ends[0], ends[1]), "crossing");
            }
            if layout.charts[first.triangle as usize] != layout.charts[second.triangle as usize] {
                for (v, edge) in [(0, 1), (1, 0)] {
                    for p in ends[v] {
                        assert!(distance(p, ends[edge]) >= gutter - 1e-6 / SIZE, "gutter");
                    }
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, max_shrink_iters: 0, failure_persistence: None, ..ProptestConfig::default() })]

    /// Protects bijectivity and the gutter of several charts.
    #[test]
    fn charts_never_meet(seed in any::<u64>()) {
        let mut rng = numbers(seed);
        let layout = board(&mut rng);
        let options = ContactOptions {
            texture_size: SIZE as u32,
            border: Border::Margin { margin_texels: 0.5 },
            ..ContactOptions::default()
        };
        let contact = Contact::new(&layout, &options);
        assert_eq!((contact.crossings(), contact.touching()), (0, 0));
        assert_bijective(&layout, &layout.points, 2.0 / SIZE);
        let (points, moves) = run(&layout, &contact, &mut rng);
        assert_bijective(&layout, &points, 2.0 / SIZE);
        prop_assert!(moves > STEPS / 10, "{moves}");
    }

    /// Protects what can be kept of starts that are not bijective: nothing crosses that
    /// did not, and what has room moves.
    #[test]
    fn crowds_get_no_worse(seed in any::<u64>()) {
        let mut rng = numbers(seed);
        let layout = crowd(&mut rng);
        let contact = Contact::new(&layout, &ContactOptions { texture_size: 256, ..ContactOptions::default() });
        prop_assert!(contact.is_feasible(&layout.points));
        let boundary = layout.boundary();
        let crossings = |points: &[DVec2]| {
            let ends: Vec<_> = boundary.iter().map(|e| e.points.map(|v| points[v as usize])).collect();
            let pairs = (0..ends.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            pairs.filter(|&(i, j)| cross(ends[i], ends[j])).collect::<Vec<_>>()
        };
        let before = crossings(&layout.points);
        prop_assert_eq!(before.len(), contact.crossings());
        let (points, moves) = run(&layout, &contact, &mut rng);
        prop_assert!(crossings(&points).iter().all(|pair| before.contains(pair)));
        prop_assert!(moves > 0);
    }

    /// Protects the sheet whose border slides: it fills the square to the end.
    #[test]
    fn a_sheet_stays_a_sheet(seed in any::<u64>()) {
        let mut rng = numbers(seed);
        let layout = sheet(&mut rng);
        let options =
            ContactOptions { texture_size: SIZE as u32, border: Border::Slide, ..ContactOptions::default() };
        let contact = Contact::new(&layout, &options);
        prop_assert_eq!(contact.constraints().fixed(), 4 * 2 + 4 * 6);
        let (points, moves) = run(&layout, &contact, &mut rng);
        assert_bijective(&layout, &points, 2.0 / SIZE);
        let moved = Layout { points, ..layout };
        let area: f64 = (0..moved.triangles.len()).map(|t| 0.5 * moved.doubled_area(t)).sum();
        prop_assert!((area - 1.0).abs() < 1e-12);
        prop_assert!(moves > STEPS / 10, "{moves}");
    }

    /// Protects the promise that results do not depend on the number of threads.
    #[test]
    fn threads_do_not_matter(seed in any::<u64>()) {
        let mut rng = numbers(seed);
        let layout = board(&mut rng);
        let options = ContactOptions { texture_size: 64, activation_texels: 9.0, ..ContactOptions::default() };
        let ways: Vec<DVec2> = layout.points.iter().map(|_| dvec2(random(&mut rng, -1.0, 1.0), 0.5)).collect();
        let answers = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let contact = Contact::new(&layout, &options);
                let mut gradient = vec![DVec2::ZERO; layout.points.len()];
                let energy = contact.energy_and_gradient(&layout.points, &mut gradient);
                (energy, gradient, contact.max_step(&layout.points, &ways, 1.0))
            })
        });
        prop_assert!(answers[0].0 > 0.0);
        prop_assert_eq!(&answers[0], &answers[1]);
        prop_assert_eq!(&answers[0], &answers[2]);
    }
}
