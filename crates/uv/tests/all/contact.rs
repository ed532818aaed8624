//! What contact does in small layouts that can be followed by hand.

use glam::{DMat2, DVec2, dvec2};
use parbake_atlas::Layout;
use parbake_uv::contact::{Border, Contact, ContactOptions};
use proptest::prelude::*;

/// Each triangle a chart by itself.
fn triangles(corners: &[[DVec2; 3]]) -> Layout {
    Layout {
        points: corners.iter().flatten().copied().collect(),
        triangles: (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        rest: vec![DMat2::IDENTITY; corners.len()],
        charts: (0..corners.len() as u32).collect(),
        point_of_vertex: (0..3 * corners.len() as u32).collect(),
    }
}

/// A triangle with a base of 0.25, as high.
fn triangle_at(x: f64, y: f64) -> [DVec2; 3] {
    [dvec2(x, y), dvec2(x + 0.25, y), dvec2(x, y + 0.25)]
}

/// Ten texels a side, so that a texel is 0.1.
fn ten_texels() -> ContactOptions {
    ContactOptions {
        texture_size: 10,
        gutter_texels: 1.0,
        activation_texels: 2.0,
        own_activation_texels: 0.5,
        border: Border::Margin { margin_texels: 0.5 },
    }
}

fn moved(layout: &Layout, direction: &[DVec2], step: f64) -> Vec<DVec2> {
    layout.points.iter().zip(direction).map(|(p, d)| p + step * d).collect()
}

/// Protects the limits that a start sets: the gutter, what is nearer, what touches,
/// what crosses.
#[test]
fn a_start_sets_the_limits() {
    let towards = |distance: f64| {
        let layout = triangles(&[triangle_at(0.125, 0.25), triangle_at(0.375 + distance, 0.25)]);
        let contact = Contact::new(&layout, &ten_texels());
        let mut direction = vec![DVec2::ZERO; 6];
        direction[..3].fill(dvec2(1.0, 0.0));
        contact.constraints().clone().apply(&mut direction);
        let step = contact.max_step(&layout.points, &direction, 1.0);
        assert!(contact.is_feasible(&layout.points));
        assert_eq!(contact.is_feasible(&moved(&layout, &direction, 1.2 * step)), step == 1.0);
        (step, contact.touching(), contact.constraints().fixed())
    };
    // A tenth of the gap above the gutter is left.
    let (step, touching, fixed) = towards(0.2);
    assert!((step - 0.9 * 0.1).abs() < 1e-9);
    assert_eq!((touching, fixed), (0, 0));
    // Nearer than the gutter: nine tenths of the distance, and a tenth of that gap.
    assert!((towards(0.05).0 - 0.9 * 0.005).abs() < 1e-9);
    // Corner on corner: either one touches both edges of the other, and all stay.
    assert_eq!(towards(0.0), (1.0, 4, 12));

    let crossing = triangles(&[triangle_at(0.25, 0.25), triangle_at(0.3125, 0.3125)]);
    let contact = Contact::new(&crossing, &ten_texels());
    assert_eq!(contact.crossings(), 2);
    assert!(contact.is_feasible(&crossing.points));
    assert_eq!(Contact::new(&triangles(&[]), &ten_texels()).crossings(), 0);
}

/// Protects the border: margins are kept, and what lies on it slides.
#[test]
fn the_border_is_kept() {
    let layout = triangles(&[triangle_at(0.25, 0.125)]);
    let contact = Contact::new(&layout, &ten_texels());
    let up = vec![dvec2(0.0, -1.0); 3];
    let step = contact.max_step(&layout.points, &up, 1.0);
    assert!((step - 0.9 * 0.075).abs() < 1e-12);
    assert!(contact.is_feasible(&moved(&layout, &up, step)));
    assert!(!contact.is_feasible(&moved(&layout, &up, 0.076)));
    let mut gradient = vec![DVec2::ZERO; 3];
    assert!(contact.energy_and_gradient(&layout.points, &mut gradient) > 0.0);
    assert!(gradient[0].y < 0.0 && gradient[0].x == 0.0);

    let corner = triangles(&[triangle_at(0.0, 0.0)]);
    let contact = Contact::new(&corner, &ContactOptions { border: Border::Slide, ..ten_texels() });
    assert_eq!(contact.constraints().masks, [DVec2::ZERO, dvec2(1.0, 0.0), dvec2(0.0, 1.0)]);
    let mut slide = vec![dvec2(0.125, 0.125); 3];
    contact.constraints().apply(&mut slide);
    assert_eq!(contact.max_step(&corner.points, &slide, 1.0), 1.0);
    assert!(contact.is_feasible(&moved(&corner, &slide, 1.0)));
    // A fixed coordinate that moved, and a point that left the square.
    assert!(!contact.is_feasible(&moved(&corner, &[dvec2(0.125, 0.125); 3], 1.0)));
    assert!(!contact.is_feasible(&moved(&corner, &slide, 7.0)));
    assert!(contact.max_step(&corner.points, &slide, 10.0) < 6.0);
}

/// Protects charts that share a point (a bow tie): they are one, and stay movable.
#[test]
fn bow_ties_move() {
    let mut layout = triangles(&[
        [dvec2(0.25, 0.25), dvec2(0.5, 0.5), dvec2(0.25, 0.75)],
        [dvec2(0.75, 0.25), dvec2(0.75, 0.75), dvec2(0.5, 0.5)],
    ]);
    layout.triangles[1][2] = 1;
    let contact = Contact::new(&layout, &ten_texels());
    assert_eq!((contact.touching(), contact.constraints().fixed()), (0, 0));
    let mut direction = vec![DVec2::ZERO; 6];
    direction[1] = dvec2(0.0, 0.1);
    assert_eq!(contact.max_step(&layout.points, &direction, 1.0), 1.0);
    assert!(contact.is_feasible(&moved(&layout, &direction, 1.0)));
}

/// Protects against what is not a number: no step, no energy to trust, not feasible.
#[test]
fn broken_numbers_stop() {
    let layout = triangles(&[triangle_at(0.25, 0.25)]);
    let contact = Contact::new(&layout, &ten_texels());
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        assert_eq!(contact.max_step(&layout.points, &[dvec2(bad, 0.0); 3], 1.0), 0.0);
    }
    assert_eq!(contact.max_step(&layout.points, &[DVec2::ONE; 3], f64::NAN), 0.0);
    let broken = [DVec2::NAN; 3];
    assert!(!contact.is_feasible(&broken));
    assert_eq!(contact.max_step(&broken, &[DVec2::ONE; 3], 1.0), 0.0);
    assert_eq!(contact.energy_and_gradient(&broken, &mut [DVec2::ZERO; 3]), f64::INFINITY);
    let options = ContactOptions {
        texture_size: 0,
        gutter_texels: f64::NAN,
        activation_texels: -1.0,
        own_activation_texels: f64::NAN,
        border: Border::Margin { margin_texels: f64::NAN },
    };
    let contact = Contact::new(&layout, &options);
    assert!(contact.is_feasible(&layout.points));
    assert_eq!(contact.energy_and_gradient(&layout.points, &mut [DVec2::ZERO; 3]), 0.0);
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Protects the gradient against central differences: beside edges and beyond their
    /// ends, between charts, inside of one, and at the border.
    #[test]
    fn the_gradient_is_the_energys(places in proptest::collection::vec(0.0f64..1.0, 12)) {
        let start = triangles(&[triangle_at(0.0625, 0.0625), triangle_at(0.625, 0.625)]);
        let contact = Contact::new(&start, &ten_texels());
        let halves = [0.05, 0.05, 0.05, 0.5, 0.5, 0.5];
        let points: Vec<DVec2> =
            places.chunks(2).zip(halves).map(|(p, x)| dvec2(x + 0.45 * p[0], 0.05 + 0.9 * p[1])).collect();
        let energy = |points: &[DVec2]| contact.energy_and_gradient(points, &mut [DVec2::ZERO; 6]);
        let mut gradient = vec![DVec2::ZERO; 6];
        let here = contact.energy_and_gradient(&points, &mut gradient);
        // Far from the pole, so that the differences are exact enough.
        prop_assume!(here < 20.0);
        for point in 0..6 {
            for axis in 0..2 {
                let at = |h: f64| {
                    let mut points = points.clone();
                    points[point][axis] += h;
                    energy(&points)
                };
                let h = 1e-7;
                let difference = (at(h) - at(-h)) / (2.0 * h);
                prop_assume!(difference.is_finite());
                let error = (gradient[point][axis] - difference).abs();
                prop_assert!(error <= 1e-3 * (1.0 + difference.abs()), "{error} of {difference}");
            }
        }
    }
}
