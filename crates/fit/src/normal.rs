//! One Levenberg–Marquardt step of the tangent-space normals, colours held.
//!
//! A sample shows `curve(gain · k(m) · C)` with m the bilinear blend of four texels.
//! All three channels see m through the one cosine k, so a sample adds the block
//! `(Σ slope² C²) ∇k ∇kᵀ` to each pair of its texels. Normals are put back to unit
//! length after the step; damping holds the direction that no view sees.
//!
//! Where the light falls from behind (k ≤ 0) the surface shows black: it is asked to
//! turn towards the light if the reference is brighter, and left alone otherwise.

use crate::canvas::{Canvas, gather};
use crate::color::{Problem, footprint, local_places};
use crate::conjugate_gradient::{Outcome, solve};
use crate::membrane::{add_membrane, mean_pull};
use crate::outliers::Loss;
use crate::stencil::{Block, Row, Stencil, Symmetric, add_symmetric};
use parbake_model::glam::{Vec3, Vec4};
use parbake_render::shade::cosine_with_derivative;
use rayon::prelude::*;

/// The least z of a mapped normal: it stays on its side of the surface.
const LEAST_Z: f32 = 0.02;

/// The longest change of a normal in one step: beyond it the linear model of the
/// cosine says little.
const LONGEST: f32 = 0.3;

/// One step; returns the loss before it and what the linear solver did.
/// `damping` is a share of the samples' mean pull.
pub fn normal_step(
    problem: &Problem,
    color: &Canvas,
    normal: &mut Canvas,
    start: &Canvas,
    damping: f32,
    rows: &mut Vec<Row<Symmetric>>,
) -> (Loss, Outcome) {
    let size = problem.samples.size;
    let losses = gather(
        size,
        rows,
        |band, first, local| {
            let mut loss = Loss::default();
            for s in &problem.samples.bands[band] {
                let (texels, w) = footprint(s, size);
                let albedo = color.fetch(texels, w);
                let (k, per_normal) = cosine_with_derivative(&s.light(), normal.fetch(texels, w).truncate());
                let (response, weights, share) = problem.respond(albedo * k.max(0.0), s);
                loss += share;
                let j = response.slope * albedo;
                let curvature = j.dot(j * weights);
                let pull = -j.dot(response.residual * weights);
                if k <= 0.0 && pull <= 0.0 {
                    continue;
                }
                let block = Symmetric::outer(per_normal, curvature);
                let right = (per_normal * pull).extend(0.0);
                add_symmetric(local, local_places(texels, first, size), w, &block, right);
            }
            loss
        },
        Row::add,
    );
    let extra = damping * mean_pull(rows);
    add_membrane(rows, problem.atlas, normal, start, &problem.membrane);
    rows.par_iter_mut()
        .filter(|r| r.centre.trace() > 0.0)
        .for_each(|r| r.centre.add(&Symmetric::identity(extra)));
    let matrix = Stencil { size, rows: std::mem::take(rows) };
    let (step, outcome) = solve(&matrix, &matrix.right(), None, &problem.effort);
    normal.texels.par_iter_mut().zip(&step).for_each(|(m, step)| {
        let length = step.length();
        let limit = (LONGEST / length.max(1e-9)).min(1.0);
        *m = upright(*m + *step * limit);
    });
    *rows = matrix.rows;
    (losses.into_iter().sum(), outcome)
}

/// Unit length, and on the outer side of the surface.
pub fn upright(m: Vec4) -> Vec4 {
    let unit = m.truncate().normalize_or(Vec3::Z);
    if unit.z >= LEAST_Z {
        return unit.extend(0.0);
    }
    Vec3::new(unit.x, unit.y, LEAST_Z).normalize_or(Vec3::Z).extend(0.0)
}
