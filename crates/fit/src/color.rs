//! One Gauss–Newton step of the albedo, normals held.
//!
//! A sample shows `e = curve(gain · k · C)`, C the bilinear blend of four texels and
//! k the cosine at the headlight: linear in C but for the display curve, so each
//! step is a linear least-squares problem with a nine-point matrix a channel
//! (`stencil.rs`), solved by conjugate gradients and kept inside [0, 1] by an
//! active set: lanes that leave the box are put on its face and held, and the rest
//! is corrected (Moré and Toraldo 1991, simplified).
//!
//! Clipping at 1: a texel that is too bright is pulled down although the clipped
//! picture no longer moves with it; where both saturate nothing is asked.

use crate::atlas::Atlas;
use crate::canvas::{Canvas, block, gather, weights};
use crate::conjugate_gradient::{Effort, Outcome, solve};
use crate::membrane::{Membrane, add_membrane};
use crate::outliers::{Cauchy, Loss};
use crate::samples::{Sample, SampleSet};
use crate::stencil::{Diagonal, Row, Stencil, add_diagonal};
use parbake_model::glam::Vec4;
use parbake_render::display_table::DisplayTable;
use parbake_render::shade::cosine;
use rayon::prelude::*;

/// What all steps of a fit share.
pub struct Problem<'a> {
    /// What the views ask.
    pub samples: &'a SampleSet,
    /// Chart labels.
    pub atlas: &'a Atlas,
    /// Gain and curve of the comparison.
    pub display: &'a DisplayTable,
    /// What holds unseen texels.
    pub membrane: Membrane,
    /// Limits of the linear solver.
    pub effort: Effort,
    /// How much large differences count.
    pub outliers: Cauchy,
}

impl Problem<'_> {
    /// Compares the light at a sample with what it wants: the answer, how much each channel of it
    /// counts in a step of least squares, and its part of the loss.
    #[inline]
    pub fn respond(&self, light: Vec4, sample: &Sample) -> (Response, Vec4, Loss) {
        let response = respond(self.display, light, sample.target());
        let ((judged, weights), weight) = (self.outliers.judge(response.residual), sample.weight());
        let loss = Loss {
            minimised: f64::from(judged * weight),
            square: f64::from(response.residual.length_squared() * weight),
        };
        (response, weights * weight, loss)
    }
}

/// Residual and slope of each channel's display value.
#[derive(Clone, Copy, Debug, Default)]
pub struct Response {
    /// Shown minus wanted, both clipped at 1.
    pub residual: Vec4,
    /// Change of the shown value with linear light; 0 where nothing is asked.
    pub slope: Vec4,
}

/// Below this much light the curve's slope is taken as here: the true one, up to
/// 13 times the gain, would let a few dark samples outweigh all others.
const DARK: f32 = 0.01;

/// Compares what linear `light` shows with what was wanted.
#[inline]
pub(crate) fn respond(display: &DisplayTable, light: Vec4, target: Vec4) -> Response {
    let mut out = Response::default();
    for lane in 0..3 {
        let (mut shown, slope) = display.encode_with_derivative(light[lane].max(DARK));
        if light[lane] < DARK {
            shown = display.encode_with_derivative(light[lane]).0;
        }
        if shown < 1.0 || target[lane] < 1.0 {
            out.residual[lane] = shown.min(1.0) - target[lane];
            out.slope[lane] = slope;
        }
    }
    out
}

/// A sample's bilinear blend weights and texels.
#[inline]
pub fn footprint(sample: &Sample, size: usize) -> ([usize; 4], [f32; 4]) {
    let (fx, fy) = sample.fractions();
    (block(sample.texel as usize, size), weights(fx, fy))
}

/// The four places of a sample in a band's local rows (see [`gather`]).
#[inline]
pub fn local_places(texels: [usize; 4], first: usize, size: usize) -> [usize; 4] {
    let (a, b) = (texels[0] - first, texels[1] - first);
    [a, b, a + size, b + size]
}

/// The loss of all samples, three channels each.
pub fn loss(problem: &Problem, color: &Canvas, normal: &Canvas) -> Loss {
    let size = problem.samples.size;
    let bands: Vec<Loss> = problem
        .samples
        .bands
        .par_iter()
        .map(|band| {
            band.iter()
                .map(|s| {
                    let (texels, w) = footprint(s, size);
                    let k = cosine(&s.light(), normal.fetch(texels, w).truncate()).max(0.0);
                    problem.respond(color.fetch(texels, w) * k, s).2
                })
                .sum()
        })
        .collect();
    bands.into_iter().sum()
}

/// One step; returns the loss before it and what the linear solver did.
pub fn color_step(
    problem: &Problem,
    color: &mut Canvas,
    normal: &Canvas,
    start: &Canvas,
    rows: &mut Vec<Row<Diagonal>>,
) -> (Loss, Outcome) {
    let size = problem.samples.size;
    let losses = gather(
        size,
        rows,
        |band, first, local| {
            let mut loss = Loss::default();
            for s in &problem.samples.bands[band] {
                let (texels, w) = footprint(s, size);
                let k = cosine(&s.light(), normal.fetch(texels, w).truncate()).max(0.0);
                let (response, weights, share) = problem.respond(color.fetch(texels, w) * k, s);
                loss += share;
                let j = response.slope * k;
                let right = j * response.residual * -weights;
                add_diagonal(local, local_places(texels, first, size), w, j * j * weights, right);
            }
            loss
        },
        Row::add,
    );
    add_membrane(rows, problem.atlas, color, start, &problem.membrane);
    let matrix = Stencil { size, rows: std::mem::take(rows) };
    let outcome = boxed_update(&matrix, color, &problem.effort);
    *rows = matrix.rows;
    (losses.into_iter().sum(), outcome)
}

/// Rounds of the active set: more change nothing that eight bits would show.
const ROUNDS: usize = 3;

fn boxed_update(matrix: &Stencil<Diagonal>, color: &mut Canvas, effort: &Effort) -> Outcome {
    let right = matrix.right();
    // A lane on a face that is pushed outwards is held from the beginning.
    let mut free: Vec<Vec4> = color
        .texels
        .par_iter()
        .zip(&right)
        .map(|(x, b)| {
            Vec4::from(std::array::from_fn::<f32, 4, _>(|k| {
                f32::from(!(x[k] <= 0.0 && b[k] < 0.0 || x[k] >= 1.0 && b[k] > 0.0))
            }))
        })
        .collect();
    let begin = color.texels.clone();
    let mut total = Outcome { steps: 0, reduction: 1.0 };
    let mut residual = right.clone();
    for round in 0..ROUNDS {
        let (step, outcome) = solve(matrix, &residual, Some(&free), effort);
        total.steps += outcome.steps;
        total.reduction = outcome.reduction;
        let hits: usize = color
            .texels
            .par_iter_mut()
            .zip(&step)
            .zip(&mut free)
            .map(|((x, step), free)| {
                let moved = *x + *step;
                *x = moved.clamp(Vec4::ZERO, Vec4::ONE);
                let mut hits = 0;
                for k in 0..3 {
                    if moved[k] != x[k] {
                        free[k] = 0.0;
                        hits += 1;
                    }
                }
                hits
            })
            .sum();
        if hits == 0 || round + 1 == ROUNDS {
            break;
        }
        let change: Vec<Vec4> = color.texels.par_iter().zip(&begin).map(|(x, b)| *x - *b).collect();
        matrix.product(&change, &mut residual);
        residual.par_iter_mut().zip(&right).for_each(|(r, b)| *r = *b - *r);
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_render::display::{Curve, Display};

    /// Protects clean surfaces: where one view of ten shows something else, squares settle on the
    /// mean, and Cauchy's loss on what nine of them show.
    #[test]
    fn a_stray_pixel_hardly_counts() {
        let size = 8;
        let mut band = vec![Sample::facing(0, 0.8); 9];
        band.push(Sample::facing(0, 0.0));
        let samples = SampleSet { size, bands: vec![band] };
        let atlas = Atlas { size, label: vec![0; 64], covered: vec![true; 64] };
        let display = DisplayTable::new(&Display { gain: 1.0, curve: Curve::Linear });
        let start = Canvas::solid(size, Vec4::splat(0.5));
        let normal = Canvas::solid(size, Vec4::Z);
        for (scale, wanted) in [(f32::INFINITY, 0.72), (0.1, 0.8)] {
            let problem = Problem {
                samples: &samples,
                atlas: &atlas,
                display: &display,
                membrane: Membrane { stiffness: 1e-6, tether: 1e-6 },
                effort: Effort { steps: 50, tolerance: 1e-6 },
                outliers: Cauchy::new(scale),
            };
            let (mut color, mut rows) = (start.clone(), Vec::new());
            let before = loss(&problem, &color, &normal);
            for _ in 0..20 {
                color_step(&problem, &mut color, &normal, &start, &mut rows);
            }
            assert!((color.texels[0].x - wanted).abs() < 3e-3, "{scale}: {}", color.texels[0]);
            assert!(loss(&problem, &color, &normal).minimised < before.minimised);
        }
    }
}
