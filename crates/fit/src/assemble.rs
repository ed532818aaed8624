//! The normal equations of one map: what every sample adds to its four texels.
//!
//! With J the BRDF's Jacobian, s the slope of the display curve, ω the robust weights and r what is
//! shown minus what is wanted, a sample adds `Jᵀ s ω s J` to each pair of its texels, times their
//! bilinear weights, and `−Jᵀ s ω r` to their right-hand sides.
//!
//! Contract: bands of rows are summed by themselves and joined in order (`parbake_solve::grid`), so the
//! result does not depend on the number of threads.

use crate::problem::{Problem, Response, footprint, local_places};
use crate::robust_loss::Loss;
use parbake_image::{MapKind, MapSet};
use parbake_model::glam::{Vec3, Vec4};
use parbake_render::shade::Jacobian;
use parbake_solve::grid::gather;
use parbake_solve::stencil::{Block, Diagonal, Row, Symmetric, add_diagonal, add_symmetric};

/// The normal equations of one map over all samples; returns the loss.
pub(crate) fn assemble_on_cpu<P: Problem, S: SampleBlock>(
    kind: MapKind,
    problem: &P,
    maps: &MapSet,
    rows: &mut Vec<Row<S>>,
) -> Loss {
    let samples = problem.samples();
    let size = samples.size;
    let losses = gather(
        size,
        rows,
        |band, first, local| {
            let mut loss = Loss::default();
            for s in samples.band(band) {
                let (texels, w) = footprint(s, size);
                let (jacobian, response, weights, share) = problem.linearise(kind, s, &maps.blend(texels, w));
                loss += share;
                if let Some((block, right)) = S::of(&jacobian, &response, weights) {
                    S::add_sample(local, local_places(texels, first, size), w, &block, right);
                }
            }
            loss
        },
        Row::add,
    );
    losses.into_iter().sum()
}

/// A matrix block that samples add to.
pub trait SampleBlock: Block {
    /// `Jᵀ s ω s J` and `−Jᵀ s ω r`; none where nothing is asked.
    fn of(jacobian: &Jacobian, response: &Response, weights: Vec4) -> Option<(Self, Vec4)>;

    /// Adds them, times the products of the bilinear weights, at the four places.
    fn add_sample(rows: &mut [Row<Self>], places: [usize; 4], w: [f32; 4], block: &Self, right: Vec4);
}

impl SampleBlock for Diagonal {
    #[inline(always)]
    fn of(jacobian: &Jacobian, response: &Response, weights: Vec4) -> Option<(Self, Vec4)> {
        match *jacobian {
            Jacobian::Diagonal(slopes) => {
                let j = response.slope * slopes;
                Some((Self(j * j * weights), j * response.residual * -weights))
            }
            // Couplings between channels are left to the next steps.
            Jacobian::RankOne { value, .. } => {
                let (curvature, pull) = along(jacobian, response, weights)?;
                Some((Self((value * value * curvature).extend(0.0)), (value * pull).extend(0.0)))
            }
            Jacobian::Full(columns) => {
                let j = columns.map(|column| response.slope * column);
                let curvature = Vec3::from(j.map(|j| j.dot(j * weights)));
                Some((Self(curvature.extend(0.0)), pulls(&j, response, weights)))
            }
        }
    }

    #[inline(always)]
    fn add_sample(rows: &mut [Row<Self>], places: [usize; 4], w: [f32; 4], block: &Self, right: Vec4) {
        add_diagonal(rows, places, w, block.0, right);
    }
}

impl SampleBlock for Symmetric {
    #[inline(always)]
    fn of(jacobian: &Jacobian, response: &Response, weights: Vec4) -> Option<(Self, Vec4)> {
        match *jacobian {
            Jacobian::Diagonal(slopes) => {
                let j = response.slope * slopes;
                let [xx, yy, zz, _] = (j * j * weights).to_array();
                Some((Self([xx, yy, zz, 0.0, 0.0, 0.0]), j * response.residual * -weights))
            }
            Jacobian::RankOne { value, .. } => {
                let (curvature, pull) = along(jacobian, response, weights)?;
                Some((Self::outer(value, curvature), (value * pull).extend(0.0)))
            }
            Jacobian::Full(columns) => {
                let j = columns.map(|column| response.slope * column);
                let product = |a: usize, b: usize| j[a].dot(j[b] * weights);
                let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
                Some((Self(pairs.map(|(a, b)| product(a, b))), pulls(&j, response, weights)))
            }
        }
    }

    #[inline(always)]
    fn add_sample(rows: &mut [Row<Self>], places: [usize; 4], w: [f32; 4], block: &Self, right: Vec4) {
        add_symmetric(rows, places, w, block, right);
    }
}

/// `−Jᵀ s ω r` of three columns of `s J`.
#[inline(always)]
fn pulls(j: &[Vec4; 3], response: &Response, weights: Vec4) -> Vec4 {
    Vec3::from(j.map(|j| -j.dot(response.residual * weights))).extend(0.0)
}

/// Curvature and pull of the loss along the one number that light depends on.
#[inline(always)]
fn along(jacobian: &Jacobian, response: &Response, weights: Vec4) -> Option<(f32, f32)> {
    let Jacobian::RankOne { light, only_brighter, .. } = *jacobian else { return None };
    let j = response.slope * light;
    let curvature = j.dot(j * weights);
    let pull = -j.dot(response.residual * weights);
    // Turned away from the light: only asked to turn back where the reference is brighter.
    (!only_brighter || pull > 0.0).then_some((curvature, pull))
}
