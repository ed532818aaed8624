//! The default method on a picture: a coarse grid takes its shape from the signal, then each
//! grid is refined by variable projection (`crate::optimise`), with more samples on the
//! last one.
//!
//! Contract: the result's layout is one of the finest grid, and sound.

use super::plane::Plane;
use super::signal_scales::{Picture, signal_scales};
use super::{Moves, PictureOptions, as_f64};
use crate::contact::ContactOptions;
use crate::optimise::{Balance, Problem, RefineBy, ShapeBy, UvOptions, refine, shape, tensors};
use glam::Vec4;
use parbake_atlas::Layout;
use parbake_image::FloatImage;
use parbake_model::glam::{DVec2, Vec2};
use parbake_progress::{Message, Stage, Watcher};

/// Samples of a scale that texture coordinates are moved for, relative to the texels: more settle
/// details that the texture cannot hold anyway. With a quarter of them on the coarse grids
/// pictures at 256² gain 0.6 dB less.
const SAMPLES_PER_TEXEL: usize = 16;
/// …and relative to the grid's cells: with fewer the points fit the samples and not the picture (at
/// 128² 200 cells left 13 % of the error of 131,072 samples and 80 % of that of all pixels).
const SAMPLES_PER_CELL: usize = 16;
/// At least so many on coarse grids, which place regions…
const LEAST_SAMPLES: usize = 1 << 18;
/// …and on the finest one: with an eighth of them pictures of two million pixels gain 0.35 dB less.
const LEAST_FINEST_SAMPLES: usize = 1 << 21;
/// A coarse grid is left once its steps gain less than this share: the next one goes on from there.
/// With a quarter of it pictures take an eighth longer and gain 0.02 dB, with twice as much they
/// gain 0.05 dB less on average.
const COARSE_TOLERANCE: f64 = 4e-3;
/// Weight of the symmetric Dirichlet energy. Eight times as much costs pictures 0.1 to 0.3 dB, half of
/// it gains next to nothing.
const DISTORTION_WEIGHT: f64 = 5e-3;
/// Coarsest grid that is worth a descent of its own.
const COARSEST: usize = 20;

/// Coarse to fine; None where the watcher stopped it before anything was found.
pub fn optimised(
    picture: &Picture,
    options: &PictureOptions,
    contact: &ContactOptions,
    moves: &mut Moves,
    watcher: &dyn Watcher,
) -> Option<(Layout, FloatImage<Vec4>, Balance)> {
    let size = options.texture_size;
    let steps = options.steps;
    let mut grids = vec![options.grid];
    while grids[0] % 2 == 0 && grids[0] / 2 >= COARSEST {
        grids.insert(0, grids[0] / 2);
    }
    let total = grids.len() * steps;
    let own = UvOptions {
        refine_steps: steps,
        // A plane fills its square; what is plain in it may close.
        shape_by: ShapeBy::QuasiNewton,
        refine_by: RefineBy::Stiffness,
        flat: 1e-3,
        distortion_weight: DISTORTION_WEIGHT,
        ..UvOptions::default()
    };
    let mut state: Option<(Layout, FloatImage<Vec4>, Balance)> = None;
    for (turn, &cells) in grids.iter().enumerate() {
        let plane = Plane { cells };
        let finest = turn + 1 == grids.len();
        let least = if finest { LEAST_FINEST_SAMPLES } else { LEAST_SAMPLES };
        let tolerance = if finest { own.tolerance } else { COARSE_TOLERANCE };
        let own = UvOptions { tolerance, ..own };
        let most = (SAMPLES_PER_TEXEL * size * size).max(SAMPLES_PER_CELL * cells * cells).max(least);
        let signal_scales = signal_scales(picture, plane, most);
        let rest = plane.rest();
        let problem = Problem { rest: &rest, signal_scales: &signal_scales, texture_size: size, contact };
        let mut frames = Vec::new();
        let mut step = |points: &[DVec2], _| {
            frames.push(points.iter().map(|p| p.as_vec2()).collect::<Vec<Vec2>>());
            let done = turn * steps + frames.len();
            watcher.message(Message::Progress { stage: Stage::Uv, done: done.min(total), total });
            !watcher.stopped()
        };
        let (mut layout, texture, mut balance) = match state.take() {
            None => {
                let mut layout = plane.layout(as_f64(&plane.points()));
                let (balance, texture) = Balance::new(&problem, &layout);
                let tensors = tensors(&problem, &layout);
                shape(&problem, &mut layout, &tensors, &own, |_, _| !watcher.stopped());
                (layout, texture, balance)
            }
            Some((coarse, texture, balance)) => {
                let (_, points) = Plane { cells: cells / 2 }.refined(&coarse.points);
                (plane.layout(points), texture, balance)
            }
        };
        let refined = refine(&problem, &balance, &mut layout, texture, &own, &mut step);
        balance.update(&refined.relative);
        moves.steps += refined.descent.values.len() - 1;
        // Grids of other turns have other triangles: only the last one's moves are drawn.
        (moves.plane, moves.frames) = (plane, frames);
        state = Some((layout, refined.texture, balance));
        if watcher.stopped() {
            // The layout must be one of the finest grid.
            let mut at = cells;
            while let Some((layout, texture, balance)) = state.take_if(|_| at < options.grid) {
                let (plane, points) = Plane { cells: at }.refined(&layout.points);
                at = plane.cells;
                state = Some((plane.layout(points), texture, balance));
            }
            break;
        }
    }
    state
}
