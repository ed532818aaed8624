//! What is left of a signal with a given texture, and how that changes with the texture
//! coordinates.
//!
//! Forward: `R = Σ ωₛ ((1 − f) |rˡ|² + f |rˡ⁺¹|²)`, r the difference of a fetch and its target
//! on two mip levels (`least_squares_texture.rs`). Adjoint for a triangle's points: through the place
//! of each sample, `2 ωₛ r · ∂T/∂uv` on either level, and through the level itself,
//! `Σ ωₛ (|rˡ⁺¹|² − |rˡ|²) · ∂λ/∂uv`. At the best texture this is the whole derivative
//! (variable projection).

use crate::footprint::{Footprint, OnLevel, shares};
use crate::least_squares_texture::ParameterizedSignal;
use crate::pyramid::{level_count, levels};
use crate::signal::Sample;
use glam::{DVec2, Vec2, Vec4};
use parbake_image::FloatImage;
use rayon::prelude::*;

/// The residual of each scale, and the derivative of their sum, which is added to
/// `gradient`.
pub fn residual(
    mapped: &ParameterizedSignal,
    texture: &FloatImage<Vec4>,
    gradient: &mut [DVec2],
) -> Vec<f64> {
    let pyramid = levels(&texture.texels, texture.width, level_count(texture.width));
    // For each run the derivatives for its points, and the errors of each scale.
    let parts: Vec<(Vec<DVec2>, Vec<f64>)> = (0..mapped.runs.count())
        .into_par_iter()
        .map(|run| {
            let own = mapped.runs.own_points(run);
            let mut slopes = vec![DVec2::ZERO; own.points.len()];
            let mut errors = vec![0.0; mapped.signal_scales.len()];
            for (t, corners) in mapped.runs.triangles(run).zip(&own.corners) {
                let found = triangle(mapped, &pyramid, texture.width, t, &mut errors);
                for (corner, slope) in corners.iter().zip(found) {
                    slopes[*corner as usize] += slope;
                }
            }
            (slopes, errors)
        })
        .collect();
    let mut residuals = vec![0.0; mapped.signal_scales.len()];
    for (run, (slopes, errors)) in parts.iter().enumerate() {
        residuals.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error);
        for (point, slope) in mapped.runs.own_points(run).points.iter().zip(slopes) {
            gradient[*point as usize] += *slope;
        }
    }
    residuals
}

/// The residual of all scales by triangle (F).
pub fn residual_by_triangle(mapped: &ParameterizedSignal, texture: &FloatImage<Vec4>) -> Vec<f64> {
    let pyramid = levels(&texture.texels, texture.width, level_count(texture.width));
    let of = |errors: &mut Vec<f64>, t: usize| {
        errors.fill(0.0);
        triangle(mapped, &pyramid, texture.width, t, errors);
        errors.iter().sum()
    };
    let room = || vec![0.0; mapped.signal_scales.len()];
    (0..mapped.triangles.len()).into_par_iter().map_init(room, of).collect()
}

/// Adds one triangle's share to each scale's error; gives its derivatives for the three corners.
fn triangle(
    mapped: &ParameterizedSignal,
    pyramid: &[Vec<Vec4>],
    size: usize,
    t: usize,
    errors: &mut [f64],
) -> [DVec2; 3] {
    let footprint = Footprint::new(mapped.points, mapped.triangles[t]);
    let (mut whole, mut second, mut third) = (DVec2::ZERO, DVec2::ZERO, DVec2::ZERO);
    for (signal, sum) in mapped.signal_scales.iter().zip(errors) {
        let samples = signal.of(t);
        if samples.is_empty() {
            continue;
        }
        let shown = footprint.level(signal.pixels.of(t), size, pyramid.len());
        let mut by_level = 0.0;
        for (level, share) in shares(&shown) {
            let own = size >> level;
            let part = on_level(&footprint.on(own), samples, &pyramid[level], own);
            *sum += part.error * f64::from(share);
            by_level += if level == shown.fine { -part.error } else { part.error };
            let scale = 2.0 * own as f64 * f64::from(share);
            whole += part.slopes[0] * scale;
            second += part.slopes[1] * scale;
            third += part.slopes[2] * scale;
        }
        if shown.coarse_share > 0.0 {
            second += shown.slope.x_axis * by_level;
            third += shown.slope.y_axis * by_level;
        }
    }
    [whole - second - third, second, third]
}

/// A triangle's samples on one level.
struct Part {
    error: f64,
    /// Derivative of half the error for a common motion, and for the two edges.
    slopes: [DVec2; 3],
}

fn on_level(place: &OnLevel, samples: &[Sample], texels: &[Vec4], size: usize) -> Part {
    let (mut error, mut whole, mut second, mut third) = (0.0f64, Vec2::ZERO, Vec2::ZERO, Vec2::ZERO);
    for sample in samples {
        let ([x, y], [fx, fy], [dx, dy]) = place.place(sample);
        let texel = y * size + x;
        // Two checks of bounds rather than four.
        let (upper, lower) = (&texels[texel..texel + 2], &texels[texel + size..texel + size + 2]);
        let (a, b, c, d) = (upper[0], upper[1], lower[0], lower[1]);
        let (upper, lower) = (a + (b - a) * fx, c + (d - c) * fx);
        let r = upper + (lower - upper) * fy - sample.target;
        let weighted = r * sample.weight;
        error += f64::from(weighted.dot(r));
        let along_x = (b - a) + ((d - c) - (b - a)) * fy;
        let slope = Vec2::new(weighted.dot(along_x) * dx, weighted.dot(lower - upper) * dy);
        whole += slope;
        second += slope * sample.barycentric[0];
        third += slope * sample.barycentric[1];
    }
    Part { error, slopes: [whole, second, third].map(|s| s.as_dvec2()) }
}
