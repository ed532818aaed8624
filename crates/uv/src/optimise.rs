//! The default way of moving texture coordinates.
//!
//! 1. [`Balance::new`]: what the start's coordinates leave with their best texture, for each
//!    size at which the surface is shown.
//! 2. [`shape`]: the signal-specialised start (`metric.rs`): triangles grow with their
//!    signal, along its direction, and charts into what is free. No texture is solved for.
//! 3. [`refine`]: variable projection (`variable_projection.rs`): what the best texture
//!    leaves is reduced itself.
//!
//! Contract: from a sound layout to a sound layout (`region.rs`); deterministic.

use crate::contact::ContactOptions;
use crate::curvature::Curvature;
use crate::descent::{Descent, DescentOptions, Objective, Reach, Region, descend};
use crate::distortion::{Distortion, total_area};
use crate::laplacian::Laplacian;
use crate::least_squares_texture::{ParameterizedSignal, Solve, least_squares_texture};
use crate::metric::{signal_specialised, structure_tensors};
use crate::region::Feasible;
use crate::residual::residual;
use crate::signal::Signal;
use crate::stiffness::Stiffness;
use crate::triangle_batches::TriangleBatches;
use crate::variable_projection::{Best, VariableProjection};
use glam::{DMat2, DVec2, Vec4};
use parbake_atlas::Layout;
use parbake_image::FloatImage;

/// What the optimisation works on.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// F rest shapes: what a triangle's distortion is measured against.
    pub rest: &'a [DMat2],
    /// The surface's signal at full size, then minified; samples lie on the same triangles.
    pub signal_scales: &'a [Signal],
    /// Texels along a side.
    pub texture_size: usize,
    /// How near charts may come.
    pub contact: &'a ContactOptions,
}

/// How far to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvOptions {
    /// Steps of the signal-specialised start.
    pub shape_steps: usize,
    /// How they are taken.
    pub shape_by: ShapeBy,
    /// What a triangle weighs in the start that shows no signal at all, relative to the mean, > 0. More
    /// keeps plain regions larger and rounder, which their looks from afar ask for: trilinear fetches
    /// blur what is drawn out.
    pub flat: f64,
    /// Steps of variable projection.
    pub refine_steps: usize,
    /// How they are scaled.
    pub refine_by: RefineBy,
    /// μ: weight of the symmetric Dirichlet energy against the error. Less lets triangles close
    /// nearly, and with [`RefineBy::Laplacian`] one of those shortens every step for all.
    pub distortion_weight: f64,
    /// Weight of the barrier between charts.
    pub contact_weight: f64,
    /// How exactly refinement solves for textures, at most.
    pub solve: Solve,
    /// A refinement ends when three steps in a row each gain less than this share.
    pub tolerance: f64,
}

/// How the start takes its steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeBy {
    /// Newton's: charts push each other out of the way until nearly all of the square is used
    /// (lemon at 512²: 96 % instead of 71 %).
    Newton,
    /// L-BFGS, as far as it comes: for a picture that fills the square anyway, where nothing is
    /// pushed, it takes a tenth of the time and refinement ends up to 0.2 dB better.
    QuasiNewton,
}

/// How the steps of variable projection are scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefineBy {
    /// By the graph's Laplacian, factorised once; the first triangle that would turn over bounds the
    /// step of all.
    Laplacian,
    /// By what moving a point costs (`stiffness.rs`), with a triangle's points slowed down before it
    /// turns over: for the many small cells of a picture, and for a model's own texture, which gains up
    /// to 0.3 dB in no more time. Coordinates of low-polys gain 0.05 dB by it.
    Stiffness,
}

/// How far a triangle may go towards turning over in a step; with 0.8, what the line search allows
/// when it bounds all, half of the steps turn out too long.
const SHARE_BY_POINT: f64 = 0.2;

impl Default for UvOptions {
    fn default() -> Self {
        Self {
            shape_steps: 100,
            shape_by: ShapeBy::Newton,
            flat: 0.1,
            refine_steps: 80,
            refine_by: RefineBy::Laplacian,
            distortion_weight: 3e-3,
            contact_weight: 1e-4,
            solve: Solve::MOVING,
            tolerance: 1e-4,
        }
    }
}

/// How much each scale counts.
///
/// Minified pictures of moved texture coordinates may look worse than of those at the
/// start; each counts just so much that it does not.
#[derive(Clone, Debug, PartialEq)]
pub struct Balance {
    /// What the start left of each scale with the best texture for the first one.
    pub baseline: Vec<f64>,
    /// Weights relative to the baseline; that of the first stays 1.
    pub weights: Vec<f64>,
}

/// What minified scales weigh before anything is known.
const FIRST_WEIGHT: f64 = 0.1;

impl Balance {
    /// Baselines of a start's layout; also returns its best texture.
    pub fn new(problem: &Problem, layout: &Layout) -> (Self, FloatImage<Vec4>) {
        let runs = TriangleBatches::new(&layout.points, &layout.triangles, &problem.signal_scales[0]);
        let whole = ParameterizedSignal {
            points: &layout.points,
            triangles: &layout.triangles,
            signal_scales: problem.signal_scales,
            runs: &runs,
        };
        let first = ParameterizedSignal { signal_scales: &problem.signal_scales[..1], ..whole };
        let start = FloatImage::solid(problem.texture_size, Vec4::splat(0.5));
        let texture =
            least_squares_texture(&first, start, &Solve { steps: 60, tolerance: 1e-4, ..Solve::ROUGH });
        let mut unused = vec![DVec2::ZERO; layout.points.len()];
        let left = residual(&whole, &texture, &mut unused);
        // A picture that fits perfectly leaves nothing to gain; 8 bits leave more than this.
        let least: f64 = 1e-7;
        let baseline: Vec<f64> =
            left.iter().zip(problem.signal_scales).map(|(r, s)| r.max(least * s.weight())).collect();
        let mut weights = vec![FIRST_WEIGHT; baseline.len()];
        weights[0] = 1.0;
        (Self { baseline, weights }, texture)
    }

    /// Showings whose samples count as this balance says.
    pub fn weighted(&self, signal_scales: &[Signal]) -> Vec<Signal> {
        let mut weighted = signal_scales.to_vec();
        for ((signal, weight), baseline) in weighted.iter_mut().zip(&self.weights).zip(&self.baseline) {
            let factor = (weight / baseline) as f32;
            signal.samples.iter_mut().for_each(|s| s.weight *= factor);
        }
        weighted
    }

    /// Learns from what is left now, relative to the baseline: scales that are about to
    /// become worse than it count more, those far below less.
    pub fn update(&mut self, relative: &[f64]) {
        const AIM: f64 = 0.85;
        for (weight, relative) in self.weights.iter_mut().zip(relative).skip(1) {
            *weight *= (relative / AIM).powf(1.5).clamp(0.3, 6.0);
            *weight = weight.clamp(0.01, 50.0);
        }
    }
}

/// The distortion alone, with the barrier.
struct Shaping<'a> {
    distortion: &'a Distortion,
    triangles: &'a [[u32; 3]],
    region: &'a Feasible,
    contact_weight: f64,
}

impl Objective for Shaping<'_> {
    fn evaluate(&mut self, points: &[DVec2], gradient: &mut [DVec2]) -> f64 {
        // The barrier adds its gradient with weight 1.
        gradient.fill(DVec2::ZERO);
        let contact = self.region.contact().energy_and_gradient(points, gradient);
        gradient.iter_mut().for_each(|g| *g *= self.contact_weight);
        contact * self.contact_weight + self.distortion.add(points, self.triangles, 1.0, gradient)
    }
}

/// Texels along a side of the texture that structure tensors are read from: as fine as
/// the samples settle.
fn tensor_texture_size(signal: &Signal, texture_size: usize) -> usize {
    let fine = (signal.samples.len() as f64 / 2.0).sqrt() as usize;
    fine.clamp(texture_size.min(64), 4 * texture_size).max(4)
}

/// How fast the first scale changes on each triangle of a layout.
pub fn tensors(problem: &Problem, layout: &Layout) -> Vec<DMat2> {
    let signal = &problem.signal_scales[..1];
    let size = tensor_texture_size(&signal[0], problem.texture_size);
    let runs = TriangleBatches::new(&layout.points, &layout.triangles, &signal[0]);
    let mapped = ParameterizedSignal {
        points: &layout.points,
        triangles: &layout.triangles,
        signal_scales: signal,
        runs: &runs,
    };
    let start = FloatImage::solid(size, Vec4::splat(0.5));
    let texture = least_squares_texture(&mapped, start, &Solve { smoothness: 1e-3, ..Solve::ROUGH });
    structure_tensors(&mapped, &texture, problem.rest)
}

/// Moves a layout to the signal-specialised start.
pub fn shape(
    problem: &Problem,
    layout: &mut Layout,
    tensors: &[DMat2],
    options: &UvOptions,
    step: impl FnMut(&[DVec2], f64) -> bool,
) -> Descent {
    let region = Feasible::new(layout, problem.contact);
    let distortion = signal_specialised(tensors, problem.rest, options.flat);
    let triangles = &layout.triangles;
    let contact_weight = options.contact_weight;
    let mut objective = Shaping { distortion: &distortion, triangles, region: &region, contact_weight };
    let quasi = DescentOptions { steps: options.shape_steps, ..DescentOptions::default() };
    let points = &mut layout.points;
    match options.shape_by {
        ShapeBy::Newton => {
            let newton = DescentOptions { memory: 0, renewal: 1, ..quasi };
            let contact = (region.contact(), contact_weight);
            let curvature = |at: &[DVec2]| Curvature::new(&distortion, triangles, contact, at, region.free());
            descend(points, &mut objective, &region, curvature, &newton, step)
        }
        ShapeBy::QuasiNewton => {
            let laplacian = |at: &[DVec2]| Laplacian::new(at.len(), triangles, 0.01);
            descend(points, &mut objective, &region, laplacian, &quasi, step)
        }
    }
}

/// What a refinement found.
#[derive(Clone, Debug)]
pub struct Refined {
    /// The best texture for the layout and the balance, not clamped.
    pub texture: FloatImage<Vec4>,
    /// What is left of each scale, relative to its baseline.
    pub relative: Vec<f64>,
    /// The descent.
    pub descent: Descent,
}

/// Reduces what the best texture leaves of all scales. `texture` is where the first solve
/// begins.
pub fn refine(
    problem: &Problem,
    balance: &Balance,
    layout: &mut Layout,
    texture: FloatImage<Vec4>,
    options: &UvOptions,
    step: impl FnMut(&[DVec2], f64) -> bool,
) -> Refined {
    let region = Feasible::new(layout, problem.contact);
    // No distortion is a copy of the rest shapes at the layout's mean scale.
    let scale = (total_area(problem.rest) / layout_area(layout)).sqrt();
    let distortion = Distortion::symmetric_dirichlet(problem.rest, scale, |_| 1.0);
    let signal_scales = balance.weighted(problem.signal_scales);
    let start = layout.points.clone();
    let runs = TriangleBatches::new(&start, &layout.triangles, &signal_scales[0]);
    let mapped = ParameterizedSignal {
        points: &start,
        triangles: &layout.triangles,
        signal_scales: &signal_scales,
        runs: &runs,
    };
    let mut objective = VariableProjection {
        mapped,
        texture,
        distortion: &distortion,
        distortion_weight: options.distortion_weight,
        contact: Some(region.contact()),
        contact_weight: options.contact_weight,
        solve: options.solve,
        scale: 1.0 / balance.weights.iter().sum::<f64>(),
        best: Best::default(),
    };
    let descent = DescentOptions {
        steps: options.refine_steps,
        tolerance: options.tolerance,
        ..DescentOptions::default()
    };
    let points = &mut layout.points;
    let triangles = &layout.triangles;
    let descent = match options.refine_by {
        RefineBy::Laplacian => {
            let laplacian = |at: &[DVec2]| Laplacian::new(at.len(), triangles, 0.05);
            descend(points, &mut objective, &region, laplacian, &descent, step)
        }
        RefineBy::Stiffness => {
            let energy = (&distortion, 0.25 * options.distortion_weight);
            let stiffness = Stiffness::new(&mapped, &objective.texture, objective.scale, energy);
            let stiffness = |at: &[DVec2]| stiffness.at(at, region.free());
            let reach = Reach { share_by_point: Some(SHARE_BY_POINT), ..Reach::default() };
            let descent = DescentOptions { renewal: 1, reach, ..descent };
            descend(points, &mut objective, &region, stiffness, &descent, step)
        }
    };
    let texture = objective.texture;
    let mapped = ParameterizedSignal { points, ..mapped };
    let mut unused = vec![DVec2::ZERO; points.len()];
    let left = residual(&mapped, &texture, &mut unused);
    let relative = left.iter().zip(&balance.weights).map(|(r, weight)| r / weight).collect();
    Refined { texture, relative, descent }
}

/// Sum of the triangles' areas in the texture.
fn layout_area(layout: &Layout) -> f64 {
    (0..layout.triangles.len()).map(|t| 0.5 * layout.doubled_area(t)).sum::<f64>().max(f64::MIN_POSITIVE)
}
