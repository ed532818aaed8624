//! The paper's method on a picture: one grid, for the full size alone (`crate::paper`).
//!
//! As in section 4.4 the plane begins as the box [0.01, 0.99]² of the texture, and a barrier
//! five texels wide (section 4.5) keeps it from the texture's border. Its rest shape is the plane
//! as the paper's mesh normalization (section 4.4) leaves it, [−1, 1]². The energy's scale is s² =
//! texels / pixels of the whole texture and of the whole picture, which is how we read section
//! 4.5's “the same number of texels”. Without the content-aware term both say how stiff distortion
//! makes the plane, so they matter to Table 3 (docs/experiments.md). Samples are those of the picture
//! halved until its shorter side is at most 512 pixels. The paper has 50 cells along a side.
//!
//! Contract: the best round's layout, which is sound; it is returned even where it shows
//! the picture worse than it was.

use super::plane::Plane;
use super::signal_scales::{Picture, signal_scales};
use super::{Moves, PictureOptions, as_f64};
use crate::contact::{Border, ContactOptions};
use crate::least_squares_texture::ParameterizedSignal;
use crate::paper::{PaperOptions, paper_method};
use crate::region::Feasible;
use crate::triangle_batches::TriangleBatches;
use parbake_atlas::Layout;
use parbake_model::glam::{DMat2, Vec2};
use parbake_progress::{Message, Stage, Watcher};

/// Longest shorter side of the picture that samples are taken from.
const SIDE: usize = 512;
/// The box in which the plane begins, from and to, along both axes.
const BOX: [f64; 2] = [0.01, 0.99];
/// Side of the plane where nothing pulls at it: it fills [−1, 1]².
const PLANE: f64 = 2.0;
/// λ_uv for pictures on a plane.
const DISTORTION_WEIGHT: f64 = 1e-5;

/// Rounds between two frames of an animation.
const FRAME_ROUNDS: usize = 10;

/// The moved layout of the grid asked for.
pub fn moved(
    picture: &Picture,
    options: &PictureOptions,
    moves: &mut Moves,
    watcher: &dyn Watcher,
) -> Layout {
    let own = paper_options(picture, options);
    let mut picture = picture.clone();
    while picture.width.min(picture.height) > SIDE {
        picture = picture.halved();
    }
    let plane = Plane { cells: options.grid };
    let [from, to] = BOX;
    let points = as_f64(&plane.points()).into_iter().map(|p| (p * (to - from) + from).as_vec2().as_dvec2());
    let mut layout = plane.layout(points.collect());
    let signal_scales = signal_scales(&picture, plane, usize::MAX);
    let runs = TriangleBatches::new(&layout.points, &layout.triangles, &signal_scales[0]);
    let mapped = ParameterizedSignal {
        points: &layout.points,
        triangles: &layout.triangles,
        signal_scales: &signal_scales[..1],
        runs: &runs,
    };
    let region = Feasible::new(&layout, &contact(options, own.contact_texels));
    let total = own.rounds;
    let (size, barrier) = (options.texture_size, Some(region.contact()));
    let rest: Vec<DMat2> = plane.rest().into_iter().map(|rest| rest * PLANE).collect();
    let found = paper_method(&mapped, &rest, size, &region, barrier, &own, |progress| {
        if progress.round == 1 || progress.round.is_multiple_of(FRAME_ROUNDS) {
            moves.frames.push(progress.points.iter().map(|p| p.as_vec2()).collect::<Vec<Vec2>>());
        }
        watcher.message(Message::Progress { stage: Stage::Uv, done: progress.round, total });
        !watcher.stopped()
    });
    (moves.plane, moves.steps) = (plane, found.rounds);
    moves.convergence = Some(found.history.into());
    moves.frames.push(found.points.iter().map(|p| p.as_vec2()).collect());
    layout.points = found.points;
    layout
}

fn paper_options(picture: &Picture, options: &PictureOptions) -> PaperOptions {
    let pixels = (picture.width * picture.height) as f64;
    PaperOptions {
        rounds: options.steps,
        guide: options.guide,
        distortion_weight: DISTORTION_WEIGHT,
        scale: options.texture_size as f64 / pixels.sqrt(),
        ..PaperOptions::default()
    }
}

/// One chart that its barrier alone keeps from the border.
fn contact(options: &PictureOptions, activation_texels: f64) -> ContactOptions {
    ContactOptions {
        texture_size: options.texture_size as u32,
        gutter_texels: 0.0,
        activation_texels,
        border: Border::Margin { margin_texels: 0.0 },
        ..ContactOptions::default()
    }
}
