//! The default way of moving texture coordinates, from start to end.

use crate::common::{assert_sound, checkered_corner, plane, quarters, signal};
use glam::DVec2;
use parbake_atlas::Layout;
use parbake_uv::contact::{Border, ContactOptions};
use parbake_uv::optimise::{Balance, Problem, Refined, UvOptions, refine, shape, tensors};

/// Texels a side: too few for the checker of the start's layout.
const SIZE: usize = 32;

/// Moves a layout; `see` gets every layout on the way.
fn moved(start: &Layout, contact: &ContactOptions, mut see: impl FnMut(&[DVec2])) -> (Layout, Refined) {
    let signal_scales = [signal(start, 12, checkered_corner)];
    let problem = Problem { rest: &start.rest, signal_scales: &signal_scales, texture_size: SIZE, contact };
    let options = UvOptions { shape_steps: 12, refine_steps: 12, ..UvOptions::default() };
    let (balance, texture) = Balance::new(&problem, start);
    let mut layout = start.clone();
    let found = tensors(&problem, &layout);
    let mut step = |points: &[DVec2], _: f64| {
        see(points);
        true
    };
    shape(&problem, &mut layout, &found, &options, &mut step);
    let refined = refine(&problem, &balance, &mut layout, texture, &options, &mut step);
    (layout, refined)
}

/// A plane that slides along the border, and four charts that keep their margin.
fn cases() -> [(Layout, ContactOptions); 2] {
    let contact =
        ContactOptions { texture_size: SIZE as u32, gutter_texels: 2.0, ..ContactOptions::default() };
    let margin = Border::Margin { margin_texels: 1.0 };
    [
        (plane(8, 1), ContactOptions { border: Border::Slide, ..contact }),
        (quarters(4, 4, 3.0 / SIZE as f64, 2), ContactOptions { border: margin, ..contact }),
    ]
}

/// Protects the promise: every accepted layout is sound and keeps the gutter, and the error
/// falls well below the start's.
#[test]
fn every_layout_is_sound_and_the_error_falls() {
    for (start, contact) in cases() {
        assert_sound(&start, SIZE, contact.gutter_texels);
        let mut seen = 0;
        let (layout, refined) = moved(&start, &contact, |points| {
            seen += 1;
            let now = Layout { points: points.to_vec(), ..start.clone() };
            assert_sound(&now, SIZE, contact.gutter_texels);
        });
        assert!(seen > 5, "{seen} steps");
        assert_sound(&layout, SIZE, contact.gutter_texels);
        assert!(refined.descent.values.is_sorted_by(|a, b| a >= b), "{:?}", refined.descent.values);
        assert!(refined.relative[0] < 0.8, "{} of the start's error", refined.relative[0]);
    }
}

/// Protects a plane that fills its texture: it still does.
#[test]
fn a_sliding_plane_fills_the_square() {
    let [(start, contact), _] = cases();
    let (layout, _) = moved(&start, &contact, |_| ());
    let area: f64 = (0..layout.triangles.len()).map(|t| 0.5 * layout.doubled_area(t)).sum();
    assert!((area - 1.0).abs() < 1e-6, "{area}");
}

/// Protects reproducible results: the same points, to the bit, for any number of threads.
#[test]
fn the_same_for_any_number_of_threads() {
    for (start, contact) in cases() {
        let bits = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let (layout, _) = pool.install(|| moved(&start, &contact, |_| ()));
            layout.points.iter().flat_map(|p| p.to_array().map(f64::to_bits)).collect::<Vec<u64>>()
        };
        assert!(bits(1) == bits(3));
    }
}

/// Protects growth: four charts that take less than half of what gutter and margin leave, 28 of 32
/// texels along each side, take nearly all of it in the end.
#[test]
fn charts_grow_into_what_is_free() {
    let contact =
        ContactOptions { texture_size: SIZE as u32, gutter_texels: 2.0, ..ContactOptions::default() };
    let mut start = quarters(4, 4, 3.0 / SIZE as f64, 2);
    let area =
        |layout: &Layout| -> f64 { (0..layout.triangles.len()).map(|t| 0.5 * layout.doubled_area(t)).sum() };
    // Smaller, and not in the middle.
    start.points.iter_mut().for_each(|p| *p = (*p * 0.7 + 0.02).as_vec2().as_dvec2());
    assert_sound(&start, SIZE, contact.gutter_texels);
    let signal_scales = [signal(&start, 12, checkered_corner)];
    let problem =
        Problem { rest: &start.rest, signal_scales: &signal_scales, texture_size: SIZE, contact: &contact };
    let found = tensors(&problem, &start);
    let mut layout = start.clone();
    shape(&problem, &mut layout, &found, &UvOptions::default(), |_, _| true);
    assert_sound(&layout, SIZE, contact.gutter_texels);
    let most = (28.0 / SIZE as f64).powi(2);
    assert!(area(&start) < 0.5 * most && area(&layout) > 0.95 * most, "{} of {most}", area(&layout));
}
