//! The guard of the default method: however far texture coordinates move, no size is shown
//! worse than with an ordinary texture.

use super::rounding::as_written;
use super::texture::{NOTHING, errors, written_texture};
use crate::optimise::Balance;
use crate::signal::Signal;
use glam::Vec4;
use parbake_atlas::Layout;
use parbake_image::FloatImage;

/// A minified picture may be so much worse than that of an ordinary texture, as a ratio of
/// errors: 0.1 dB.
const TOLERATED: f64 = 1.0233;

/// The moved layout, or as much of its move as leaves no size worse; None where even a
/// small share of it does.
pub fn best_share(
    start: &Layout,
    (moved, texture, balance): (Layout, FloatImage<Vec4>, Balance),
    all: &[Signal],
    kept: &[f64],
) -> Option<(Layout, FloatImage<Vec4>)> {
    for share in [1.0, 0.7, 0.4, 0.2] {
        let mut layout = moved.clone();
        for (p, from) in layout.points.iter_mut().zip(&start.points) {
            *p = from.lerp(*p, share);
        }
        if let Some(layout) = as_written(layout)
            && let Some(texture) = balanced_texture(&layout, all, texture.clone(), balance.clone(), kept)
        {
            return Some((layout, texture));
        }
    }
    None
}

/// The texture for moved coordinates such that no size is shown worse than by an ordinary
/// one; None where that cannot be, or nothing is gained.
fn balanced_texture(
    layout: &Layout,
    all: &[Signal],
    start: FloatImage<Vec4>,
    mut balance: Balance,
    kept: &[f64],
) -> Option<FloatImage<Vec4>> {
    const ATTEMPTS: usize = 4;
    balance.baseline = kept.iter().map(|e| e.max(1e-9)).collect();
    let mut best: Option<(f64, FloatImage<Vec4>)> = None;
    let mut texture = start;
    for _ in 0..ATTEMPTS {
        texture = written_texture(layout, &balance.weighted(all), texture);
        let found = errors(layout, all, &texture);
        let relative: Vec<f64> = found.iter().zip(&balance.baseline).map(|(e, kept)| e / kept).collect();
        let fine = kept[0] > NOTHING && relative[0] < 1.0 && relative[1..].iter().all(|r| *r <= TOLERATED);
        let better = best.as_ref().is_none_or(|(error, _)| relative[0] < 0.99 * error);
        if fine && better {
            best = Some((relative[0], texture.clone()));
        } else if best.is_some() {
            break;
        }
        balance.update(&relative);
    }
    best.map(|(_, texture)| texture)
}
