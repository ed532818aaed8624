//! What must never break: whatever the layout, the signal and the settings, a sound layout
//! stays sound, and numbers stay numbers.

use crate::common::{Random, assert_sound, quarters, signal};
use glam::{DVec2, Vec4};
use parbake_atlas::Layout;
use parbake_image::FloatImage;
use parbake_uv::contact::{Border, ContactOptions};
use parbake_uv::descent::{DescentOptions, Reach, descend};
use parbake_uv::distortion::Distortion;
use parbake_uv::laplacian::Laplacian;
use parbake_uv::least_squares_texture::{ParameterizedSignal, Solve};
use parbake_uv::optimise::{Balance, Problem, RefineBy, UvOptions, refine, shape, tensors};
use parbake_uv::region::Feasible;
use parbake_uv::signal::Signal;
use parbake_uv::triangle_batches::TriangleBatches;
use parbake_uv::variable_projection::{Best, VariableProjection};
use proptest::prelude::*;

/// Texels a side.
const SIZE: usize = 16;

/// Steps at the most.
const STEPS: usize = 200;

/// What a case asks for besides a layout.
#[derive(Clone, Copy, Debug)]
struct Settings {
    distortion_weight: f64,
    contact_weight: f64,
    slide: bool,
    noise: f32,
    /// Steps scaled by stiffness, with points slowed down, instead of by the Laplacian.
    stiff: bool,
}

fn settings() -> impl Strategy<Value = Settings> {
    let weight = || prop_oneof![Just(0.0), Just(1e-4), Just(1e3)];
    let noise = prop_oneof![Just(0.0f32), Just(1.0), Just(1e4)];
    (weight(), weight(), any::<bool>(), noise, any::<bool>()).prop_map(
        |(distortion_weight, contact_weight, slide, noise, stiff)| Settings {
            distortion_weight,
            contact_weight,
            slide,
            noise,
            stiff,
        },
    )
}

fn layouts() -> impl Strategy<Value = Layout> {
    (1..5u32, 1..4u32, 0.08..0.2f64, any::<u64>())
        .prop_map(|(charts, quads, gap, seed)| quarters(charts, quads, gap, seed))
}

/// Noise, and weights between 0 and 1.
fn noisy(layout: &Layout, noise: f32) -> Signal {
    let mut random = Random(11);
    let mut signal = signal(layout, 5, |_| Vec4::splat(0.5));
    for sample in &mut signal.samples {
        sample.target += Vec4::new(random.next() as f32, random.next() as f32, 0.0, -0.5) * noise;
        sample.weight = if random.next() < 0.2 { 0.0 } else { random.next() as f32 };
    }
    signal
}

fn contact(settings: Settings) -> ContactOptions {
    let margin = Border::Margin { margin_texels: 0.5 };
    ContactOptions {
        texture_size: SIZE as u32,
        gutter_texels: 1.0,
        border: if settings.slide { Border::Slide } else { margin },
        ..ContactOptions::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Protects the default way under settings that nobody should choose.
    #[test]
    fn the_default_way_stays_sound(start in layouts(), settings in settings()) {
        let signal_scales = [noisy(&start, settings.noise)];
        let contact = contact(settings);
        let problem = Problem { rest: &start.rest, signal_scales: &signal_scales, texture_size: SIZE, contact: &contact };
        let options = UvOptions {
            shape_steps: 20,
            refine_steps: STEPS,
            distortion_weight: settings.distortion_weight,
            contact_weight: settings.contact_weight,
            refine_by: if settings.stiff { RefineBy::Stiffness } else { RefineBy::Laplacian },
            ..UvOptions::default()
        };
        let (balance, texture) = Balance::new(&problem, &start);
        let mut layout = start.clone();
        let found = tensors(&problem, &layout);
        shape(&problem, &mut layout, &found, &options, |_, _| true);
        assert_sound(&layout, SIZE, contact.gutter_texels);
        let refined = refine(&problem, &balance, &mut layout, texture, &options, |_, _| true);
        assert_sound(&layout, SIZE, contact.gutter_texels);
        prop_assert!(refined.texture.texels.iter().all(|t| t.is_finite()));
        prop_assert!(refined.relative.iter().all(|r| r.is_finite()));
    }

    /// Protects the feasible set alone: nothing but it bounds a step here.
    #[test]
    fn steps_of_any_length_stay_sound(start in layouts(), settings in settings()) {
        let signal_scales = [noisy(&start, settings.noise)];
        let contact = contact(settings);
        let region = Feasible::new(&start, &contact);
        let runs = TriangleBatches::new(&start.points, &start.triangles, &signal_scales[0]);
        let distortion = Distortion::symmetric_dirichlet(&start.rest, 1.0, |_| 1.0);
        let triangles = &start.triangles;
        let mut objective = VariableProjection {
            mapped: ParameterizedSignal { points: &start.points, triangles, signal_scales: &signal_scales, runs: &runs },
            texture: FloatImage::solid(SIZE, Vec4::ZERO),
            distortion: &distortion,
            distortion_weight: settings.distortion_weight,
            contact: None,
            contact_weight: 0.0,
            solve: Solve::MOVING,
            scale: 1e6,
            best: Best::default(),
        };
        let reach = Reach { longest_move: 1e6, share_by_point: settings.stiff.then_some(0.9) };
        let options = DescentOptions { steps: STEPS, reach, tolerance: 0.0, ..DescentOptions::default() };
        let laplacian = |at: &[DVec2]| Laplacian::new(at.len(), triangles, 0.05);
        let mut points: Vec<DVec2> = start.points.clone();
        let descent = descend(&mut points, &mut objective, &region, laplacian, &options, |_, _| true);
        assert_sound(&Layout { points, ..start.clone() }, SIZE, contact.gutter_texels);
        prop_assert!(descent.values.iter().all(|v| v.is_finite()));
    }
}
