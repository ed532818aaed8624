//! How a texture really looks: the squared error of the trilinear fetch that engines do,
//! not the bound that is minimised (`least_squares_texture.rs`).

use crate::footprint::{Footprint, shares};
use crate::least_squares_texture::ParameterizedSignal;
use crate::pyramid::{level_count, levels};
use glam::Vec4;
use parbake_image::FloatImage;
use rayon::prelude::*;

/// The weighted squared error of each scale, summed over channels and samples.
pub fn trilinear_errors(mapped: &ParameterizedSignal, texture: &FloatImage<Vec4>) -> Vec<f64> {
    let pyramid = levels(&texture.texels, texture.width, level_count(texture.width));
    let parts: Vec<Vec<f64>> = (0..mapped.runs.count())
        .into_par_iter()
        .map(|run| {
            let mut errors = vec![0.0; mapped.signal_scales.len()];
            for t in mapped.runs.triangles(run) {
                let footprint = Footprint::new(mapped.points, mapped.triangles[t]);
                for (signal, error) in mapped.signal_scales.iter().zip(&mut errors) {
                    let level = footprint.level(signal.pixels.of(t), texture.width, pyramid.len());
                    for sample in signal.of(t) {
                        let mut shown = Vec4::ZERO;
                        for (l, share) in shares(&level) {
                            let size = texture.width >> l;
                            let ([x, y], [fx, fy], _) = footprint.on(size).place(sample);
                            let row = |y: usize| {
                                let (a, b) = (pyramid[l][y * size + x], pyramid[l][y * size + x + 1]);
                                a + (b - a) * fx
                            };
                            shown += (row(y) * (1.0 - fy) + row(y + 1) * fy) * share;
                        }
                        let r = shown - sample.target;
                        *error += f64::from(r.dot(r) * sample.weight);
                    }
                }
            }
            errors
        })
        .collect();
    let mut errors = vec![0.0; mapped.signal_scales.len()];
    for part in parts {
        errors.iter_mut().zip(part).for_each(|(sum, e)| *sum += e);
    }
    errors
}
