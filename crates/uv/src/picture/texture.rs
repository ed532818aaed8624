//! The texture that is written, the least-squares one in 8 bits, and what it leaves of the
//! picture at its sizes.

use crate::best_texture::{Mapped, Solve, best_texture_in_bytes};
use crate::runs::Runs;
use crate::shown::shown_errors;
use crate::signal::Signal;
use glam::Vec4;
use parbake_atlas::Layout;
use parbake_image::FloatImage;

/// The best texture of 8-bit texels, as numbers from 0 to 1.
pub fn written_texture(layout: &Layout, showings: &[Signal], start: FloatImage<Vec4>) -> FloatImage<Vec4> {
    let runs = Runs::new(&layout.points, &layout.triangles, &showings[0]);
    let mapped = Mapped { points: &layout.points, triangles: &layout.triangles, showings, runs: &runs };
    best_texture_in_bytes(&mapped, start, &Solve::FINAL)
}

/// Mean squared errors of the sizes at which the picture is shown, by channel.
pub fn errors(layout: &Layout, all: &[Signal], texture: &FloatImage<Vec4>) -> Vec<f64> {
    let runs = Runs::new(&layout.points, &layout.triangles, &all[0]);
    let mapped = Mapped { points: &layout.points, triangles: &layout.triangles, showings: all, runs: &runs };
    // Three channels carry the picture; opacity differs rarely.
    shown_errors(&mapped, texture).into_iter().map(|e| e / 3.0).collect()
}

/// Mean squared error that counts as none, 100 dB: what rounding leaves of a plain picture.
pub const NOTHING: f64 = 1e-10;

/// PSNR in dB, 100 at most.
pub fn decibels(mean_square: &f64) -> f64 {
    -10.0 * mean_square.max(NOTHING).log10()
}
