//! How fast the signal changes on each triangle, and in which direction: the structure
//! tensor `S = mean Σ_channels ∇y ∇yᵀ` over the triangle's samples, in its rest frame
//! (Sander, Gortler, Snyder and Hoppe 2002, "Signal-specialized parameterization").
//!
//! The signal's derivatives are read off a texture that was solved for at the start's
//! texture coordinates: a linear map J from rest shape to texture turns the derivative in
//! the texture, g, into `Jᵀ g` on the triangle.

use crate::distortion::{Distortion, Element, has_area, total_area};
use crate::footprint::Footprint;
use crate::least_squares_texture::ParameterizedSignal;
use glam::Vec4;
use glam::{DMat2, dvec2};
use parbake_image::FloatImage;
use rayon::prelude::*;

/// Structure tensors of the F triangles, each times what a sample of it counts relative to the mean;
/// zero where a triangle has no samples or area.
pub fn structure_tensors(
    mapped: &ParameterizedSignal,
    texture: &FloatImage<Vec4>,
    rest: &[DMat2],
) -> Vec<DMat2> {
    let total = total_area(rest);
    let Some(signal) = mapped.signal_scales.first() else { return vec![DMat2::ZERO; rest.len()] };
    let all = signal.samples.len() as f64 / signal.weight().max(f64::MIN_POSITIVE);
    (0..mapped.triangles.len())
        .into_par_iter()
        .map(|t| {
            if signal.of(t).is_empty() || !has_area(&rest[t], total) {
                return DMat2::ZERO;
            }
            let in_texture = tensor_in_texture(mapped, texture, t);
            let [a, b, c] = mapped.triangles[t].map(|i| mapped.points[i as usize]);
            let j = DMat2::from_cols(b - a, c - a) * rest[t].inverse();
            let weight: f64 = signal.of(t).iter().map(|s| f64::from(s.weight)).sum();
            let counts = all * weight / signal.of(t).len() as f64;
            j.transpose() * in_texture * j * counts
        })
        .collect()
}

fn tensor_in_texture(mapped: &ParameterizedSignal, texture: &FloatImage<Vec4>, t: usize) -> DMat2 {
    let size = texture.width;
    let place = Footprint::new(mapped.points, mapped.triangles[t]).on(size);
    let mut sum = DMat2::ZERO;
    let samples = mapped.signal_scales[0].of(t);
    for sample in samples {
        let ([x, y], [fx, fy], _) = place.place(sample);
        let texel = |i: usize, j: usize| texture.texels[(y + j) * size + x + i];
        let (a, b, c, d) = (texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1));
        let across = (b - a) + ((d - c) - (b - a)) * fy;
        let down = (c - a) + ((d - b) - (c - a)) * fx;
        let cross = f64::from(across.dot(down));
        sum += DMat2::from_cols(
            dvec2(f64::from(across.dot(across)), cross),
            dvec2(cross, f64::from(down.dot(down))),
        );
    }
    sum * ((size * size) as f64 / samples.len() as f64)
}

/// How steep the texture is where the first scale's samples fall: `Σₛ ωₛ Σ_channels |∇T|²`, Gauss and
/// Newton's half of the error's second derivative for a common motion, with the texture held.
pub fn steepness(mapped: &ParameterizedSignal, texture: &FloatImage<Vec4>) -> f64 {
    let by_triangle: Vec<f64> = (0..mapped.triangles.len())
        .into_par_iter()
        .map(|t| {
            let samples = mapped.signal_scales.first().map_or(&[][..], |signal| signal.of(t));
            if samples.is_empty() {
                return 0.0;
            }
            let weight: f64 = samples.iter().map(|s| f64::from(s.weight)).sum();
            let tensor = tensor_in_texture(mapped, texture, t);
            weight * (tensor.x_axis.x + tensor.y_axis.y)
        })
        .collect();
    by_triangle.iter().sum()
}

/// How strongly the start follows the signal's direction, from 0 to 1: above, the other
/// direction would be squeezed to nothing.
const ANISOTROPY: f64 = 0.95;
/// Weight of growth, relative to that of shrinking; without any the start has no minimum.
const GROWTH: f64 = 0.002;

/// The energy of the signal-specialised start: triangles grow with their signal,
/// `M = (w + flat) ((1 − a) I + 2 a S / tr S)`, `w = tr S` relative to its mean by area,
/// `α = GROWTH · w + flat`. Rest shapes are taken with a total area of 1.
pub fn signal_specialised(tensors: &[DMat2], rest: &[DMat2], flat: f64) -> Distortion {
    let total = total_area(rest);
    let trace = |m: &DMat2| m.x_axis.x + m.y_axis.y;
    let mean = rest.iter().zip(tensors).map(|(r, m)| 0.5 * r.determinant() * trace(m)).sum::<f64>() / total;
    let elements = rest
        .iter()
        .zip(tensors)
        .map(|(rest, tensor)| {
            let own = trace(tensor);
            let weight = if mean > 0.0 { own / mean } else { 1.0 };
            let direction = if own > 0.0 { *tensor * (1.0 / own) } else { DMat2::IDENTITY * 0.5 };
            let shape = DMat2::IDENTITY * (1.0 - ANISOTROPY) + direction * (2.0 * ANISOTROPY);
            Element::new(*rest * (1.0 / total.sqrt()), 1.0, GROWTH * weight + flat, shape * (weight + flat))
        })
        .collect();
    Distortion { elements }
}

/// How much larger than by its area alone each chart should be drawn: for charts of areas A
/// and mean traces m the error `Σ A m / s²` is least with `Σ A s²` given where
/// `s ∝ m^¼`. Held between 1 / `most` and `most`.
pub fn chart_scales(tensors: &[DMat2], rest: &[DMat2], charts: &[u32], most: f64) -> Vec<f64> {
    let count = charts.iter().max().map_or(0, |c| *c as usize + 1);
    let (mut signal, mut area) = (vec![0.0; count], vec![0.0; count]);
    for ((tensor, rest), chart) in tensors.iter().zip(rest).zip(charts) {
        let own = 0.5 * rest.determinant();
        area[*chart as usize] += own;
        signal[*chart as usize] += own * (tensor.x_axis.x + tensor.y_axis.y);
    }
    let mean = signal.iter().sum::<f64>() / area.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    (signal.iter().zip(&area))
        .map(|(signal, area)| {
            let relative = signal / (area * mean).max(f64::MIN_POSITIVE);
            relative.powf(0.25).clamp(1.0 / most, most)
        })
        .collect()
}
