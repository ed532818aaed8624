//! The texture that is written, the least-squares one in 8 bits, and what it leaves of the
//! picture at its sizes.

use crate::least_squares_texture::{ParameterizedSignal, Solve, least_squares_texture_in_bytes};
use crate::signal::Signal;
use crate::triangle_batches::TriangleBatches;
use crate::trilinear_error::trilinear_errors;
use glam::Vec4;
use parbake_atlas::Layout;
use parbake_image::FloatImage;

/// The best texture of 8-bit texels, as numbers from 0 to 1.
pub fn written_texture(
    layout: &Layout,
    signal_scales: &[Signal],
    start: FloatImage<Vec4>,
) -> FloatImage<Vec4> {
    let runs = TriangleBatches::new(&layout.points, &layout.triangles, &signal_scales[0]);
    let mapped = ParameterizedSignal {
        points: &layout.points,
        triangles: &layout.triangles,
        signal_scales,
        runs: &runs,
    };
    least_squares_texture_in_bytes(&mapped, start, &Solve::FINAL)
}

/// Mean squared errors of the sizes at which the picture is shown, by channel.
pub fn errors(layout: &Layout, all: &[Signal], texture: &FloatImage<Vec4>) -> Vec<f64> {
    let runs = TriangleBatches::new(&layout.points, &layout.triangles, &all[0]);
    let mapped = ParameterizedSignal {
        points: &layout.points,
        triangles: &layout.triangles,
        signal_scales: all,
        runs: &runs,
    };
    // Three channels carry the picture; opacity differs rarely.
    trilinear_errors(&mapped, texture).into_iter().map(|e| e / 3.0).collect()
}

/// Mean squared error that counts as none, 100 dB: what rounding leaves of a plain picture.
pub const NOTHING: f64 = 1e-10;

/// PSNR in dB, 100 at most.
pub fn decibels(mean_square: &f64) -> f64 {
    -10.0 * mean_square.max(NOTHING).log10()
}
