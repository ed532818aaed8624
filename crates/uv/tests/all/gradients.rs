//! Analytic derivatives against central differences, on the public objectives.
//!
//! Samples and texels are `f32`, and a bilinear fetch has kinks between texels. Steps of
//! 10⁻⁴ of the square keep rounding small; the few samples that cross a kink on such a step
//! are within the tolerance, which is relative to the longest derivative.

use crate::common::{Random, quarters, signal};
use glam::{DMat2, DVec2, Vec4, dvec2, vec4};
use parbake_atlas::Layout;
use parbake_image::FloatImage;
use parbake_uv::contact::{Contact, ContactOptions};
use parbake_uv::descent::Objective;
use parbake_uv::distortion::Distortion;
use parbake_uv::least_squares_texture::{ParameterizedSignal, Solve, least_squares_texture};
use parbake_uv::metric::{signal_specialised, structure_tensors};
use parbake_uv::residual::residual;
use parbake_uv::signal::{Pixels, Signal};
use parbake_uv::triangle_batches::TriangleBatches;
use parbake_uv::variable_projection::{Best, VariableProjection};

const SIZE: usize = 16;

/// As exact as `f32` allows.
const EXACT: Solve = Solve { tolerance: 1e-7, steps: 600, smoothness: 1e-7, least_gain: 0.0, box_passes: 6 };

/// A smooth picture that does not fit into the texture.
fn waves(place: DVec2) -> Vec4 {
    let p = (place * 23.0).as_vec2();
    vec4(p.x.sin(), p.y.cos(), (p.x + p.y).sin(), (0.7 * p.x - p.y).cos()) * 0.3 + 0.5
}

/// Two charts, shown at full size and smaller: mip levels between 0.4 and 1.7.
fn scene() -> (Layout, Vec<Signal>) {
    let layout = quarters(2, 2, 0.08, 5);
    let full = signal(&layout, 14, waves);
    let mut small = signal(&layout, 9, waves);
    let pixel = |t: usize| {
        // Never a power of two: the slope has a kink where a level begins.
        let texels = 1.33 + (0.2 * t as f64) % 1.9;
        let step = DMat2::from_diagonal(dvec2(texels, 0.6 * texels)) * (1.0 / SIZE as f64);
        layout.rest[t].inverse() * step
    };
    small.pixels = Pixels::Each((0..layout.triangles.len()).map(pixel).collect());
    (layout, vec![full, small])
}

/// Compares derivatives of all points' coordinates with central differences of `value`.
fn compare(points: &[DVec2], gradient: &[DVec2], tolerance: f64, mut value: impl FnMut(&[DVec2]) -> f64) {
    let longest = gradient.iter().map(|g| g.length()).fold(0.0, f64::max);
    assert!(longest > 0.0);
    let h = 1e-4;
    for i in 0..points.len() {
        for axis in 0..2 {
            let mut at = |by: f64| {
                let mut moved = points.to_vec();
                moved[i][axis] += by;
                value(&moved)
            };
            let slope = (at(h) - at(-h)) / (2.0 * h);
            let miss = (slope - gradient[i][axis]).abs() / longest;
            assert!(miss < tolerance, "point {i}, axis {axis}: {slope} against {}", gradient[i][axis]);
        }
    }
}

fn sum(mapped: &ParameterizedSignal, texture: &FloatImage<Vec4>) -> f64 {
    let mut unused = vec![DVec2::ZERO; mapped.points.len()];
    residual(mapped, texture, &mut unused).iter().sum()
}

/// Protects the explicit derivative for a given texture, by place and by mip level.
#[test]
fn residual_for_a_fixed_texture() {
    let (layout, signal_scales) = scene();
    let runs = TriangleBatches::new(&layout.points, &layout.triangles, &signal_scales[0]);
    let mapped = ParameterizedSignal {
        points: &layout.points,
        triangles: &layout.triangles,
        signal_scales: &signal_scales,
        runs: &runs,
    };
    let mut random = Random(3);
    let mut texture = FloatImage::solid(SIZE, Vec4::ZERO);
    texture.texels.fill_with(|| (Vec4::splat(random.next() as f32) + random.next() as f32) * 0.5);
    for only in [&signal_scales[..1], &signal_scales[1..], &signal_scales[..]] {
        let mapped = ParameterizedSignal { signal_scales: only, ..mapped };
        let mut gradient = vec![DVec2::ZERO; layout.points.len()];
        residual(&mapped, &texture, &mut gradient);
        compare(&layout.points, &gradient, 0.02, |points| {
            sum(&ParameterizedSignal { points, ..mapped }, &texture)
        });
    }
}

/// Protects variable projection: at the best texture the explicit derivative is the whole
/// one, mip levels included.
#[test]
fn residual_of_the_best_texture() {
    let (layout, signal_scales) = scene();
    let runs = TriangleBatches::new(&layout.points, &layout.triangles, &signal_scales[0]);
    let mapped = ParameterizedSignal {
        points: &layout.points,
        triangles: &layout.triangles,
        signal_scales: &signal_scales,
        runs: &runs,
    };
    let texture = least_squares_texture(&mapped, FloatImage::solid(SIZE, Vec4::splat(0.5)), &EXACT);
    let mut gradient = vec![DVec2::ZERO; layout.points.len()];
    residual(&mapped, &texture, &mut gradient);
    compare(&layout.points, &gradient, 0.03, |points| {
        let mapped = ParameterizedSignal { points, ..mapped };
        sum(&mapped, &least_squares_texture(&mapped, texture.clone(), &EXACT))
    });
}

/// Protects the sum of all terms: error, signal-specialised distortion, and charts that are
/// near enough to repel each other. Each of the latter two is also looked at alone.
#[test]
fn the_whole_objective() {
    let (layout, signal_scales) = scene();
    let runs = TriangleBatches::new(&layout.points, &layout.triangles, &signal_scales[0]);
    let mapped = ParameterizedSignal {
        points: &layout.points,
        triangles: &layout.triangles,
        signal_scales: &signal_scales,
        runs: &runs,
    };
    let start = least_squares_texture(&mapped, FloatImage::solid(SIZE, Vec4::splat(0.5)), &EXACT);
    let distortion =
        signal_specialised(&structure_tensors(&mapped, &start, &layout.rest), &layout.rest, 1e-3);
    let options =
        ContactOptions { texture_size: SIZE as u32, gutter_texels: 0.5, ..ContactOptions::default() };
    let contact = Contact::new(&layout, &options);
    let scale = 1.0 / sum(&mapped, &start);
    for (scale, distortion_weight, contact_weight) in [(0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (scale, 1e-2, 1e-2)]
    {
        let mut objective = VariableProjection {
            mapped,
            texture: start.clone(),
            distortion: &distortion,
            distortion_weight,
            contact: Some(&contact),
            contact_weight,
            solve: EXACT,
            scale,
            best: Best::default(),
        };
        let mut gradient = vec![DVec2::ZERO; layout.points.len()];
        objective.evaluate(&layout.points, &mut gradient);
        let tolerance = if scale == 0.0 { 1e-3 } else { 0.03 };
        let mut unused = gradient.clone();
        compare(&layout.points, &gradient, tolerance, |points| objective.evaluate(points, &mut unused));
    }
}

/// Protects line searches: after a look at a place that is much worse, a short step down the
/// gradient still looks better than the place it starts from, though textures are not exact.
#[test]
fn a_short_step_looks_better_after_a_bad_one() {
    let (layout, signal_scales) = scene();
    let runs = TriangleBatches::new(&layout.points, &layout.triangles, &signal_scales[0]);
    let mapped = ParameterizedSignal {
        points: &layout.points,
        triangles: &layout.triangles,
        signal_scales: &signal_scales,
        runs: &runs,
    };
    let distortion = Distortion::symmetric_dirichlet(&layout.rest, 1.0, |_| 1.0);
    let mut objective = VariableProjection {
        mapped,
        texture: FloatImage::solid(SIZE, Vec4::splat(0.5)),
        distortion: &distortion,
        distortion_weight: 1e-4,
        contact: None,
        contact_weight: 0.0,
        solve: Solve::MOVING,
        scale: 1.0,
        best: Best::default(),
    };
    let mut gradient = vec![DVec2::ZERO; layout.points.len()];
    let start = objective.evaluate(&layout.points, &mut gradient);
    let longest = gradient.iter().map(|g| g.length()).fold(0.0, f64::max);
    let mut unused = gradient.clone();
    let mut at = |length: f64| {
        let moved = layout.points.iter().zip(&gradient).map(|(p, g)| *p - *g * (length / longest));
        objective.evaluate(&moved.collect::<Vec<_>>(), &mut unused)
    };
    let (far, near) = (at(-0.05), at(1e-6));
    assert!(far > start && near < start, "{far} {start} {near}");
}
