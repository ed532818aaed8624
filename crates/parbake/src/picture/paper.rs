//! The paper's method on a picture: one grid, from the identity, for the full size alone
//! (`parbake_uv::paper`).
//!
//! The picture is halved until its shorter side is at most 512 pixels, the size of the
//! paper's pictures. The energy's scale is s = texels / pixels along a side: triangles with
//! errors want as many texels as they have pixels. The sides of the square slide and there
//! is one chart, whose triangles stay upright: no barrier is needed. The paper has 50 cells
//! along a side.
//!
//! Contract: the best round's layout, which is sound; it is returned even where it shows
//! the picture worse than it was.

use super::plane::Plane;
use super::showings::{Picture, showings};
use super::{Moves, as_f64};
use crate::message::{Message, Stage, Watcher};
use crate::options::Method;
use crate::picture::ImageOptions;
use parbake_atlas::Layout;
use parbake_model::glam::Vec2;
use parbake_uv::best_texture::Mapped;
use parbake_uv::contact::ContactOptions;
use parbake_uv::paper::{PaperOptions, paper_method};
use parbake_uv::region::Feasible;
use parbake_uv::runs::Runs;

/// Longest shorter side of the picture that samples are taken from.
const SIDE: usize = 512;
/// λ_uv for pictures on a plane.
const DISTORTION_WEIGHT: f64 = 1e-5;

/// Rounds between two frames of an animation.
const FRAME_ROUNDS: usize = 10;

/// The moved layout of the grid asked for.
pub fn moved(
    picture: &Picture,
    options: &ImageOptions,
    contact: &ContactOptions,
    moves: &mut Moves,
    watcher: &impl Watcher,
) -> Layout {
    let mut picture = picture.clone();
    while picture.width.min(picture.height) > SIDE {
        picture = picture.halved();
    }
    let plane = Plane { cells: options.grid };
    let mut layout = plane.layout(as_f64(&plane.points()));
    let showings = showings(&picture, plane, usize::MAX);
    let runs = Runs::new(&layout.points, &layout.triangles, &showings[0]);
    let mapped = Mapped {
        points: &layout.points,
        triangles: &layout.triangles,
        showings: &showings[..1],
        runs: &runs,
    };
    let own = PaperOptions {
        rounds: options.settled_steps(),
        guide: Method::guide(options.no_content_aware),
        distortion_weight: DISTORTION_WEIGHT,
        scale: options.texture_size as f64 / picture.width.min(picture.height) as f64,
        ..PaperOptions::default()
    };
    let region = Feasible::new(&layout, contact);
    let total = own.rounds;
    let found = paper_method(&mapped, &plane.rest(), options.texture_size, &region, None, &own, |progress| {
        if progress.round == 1 || progress.round.is_multiple_of(FRAME_ROUNDS) {
            moves.frames.push(progress.points.iter().map(|p| p.as_vec2()).collect::<Vec<Vec2>>());
        }
        watcher.message(Message::Progress { stage: Stage::Unfold, done: progress.round, total });
        !watcher.stopped()
    });
    moves.steps = found.rounds;
    moves.convergence = Some(found.history.into());
    moves.frames.push(found.points.iter().map(|p| p.as_vec2()).collect());
    layout.points = found.points;
    layout
}

#[cfg(test)]
mod tests {
    use crate::options::Method;
    use crate::picture::{ImageOptions, bake_image};
    use parbake_model::Image;

    /// A picture with all its detail in one corner.
    fn picture() -> Image {
        let side = 48;
        let pixels = (0..side * side)
            .map(|i| {
                let (x, y) = (i % side, i / side);
                let value = if x < 16 && y < 16 { 60 + 140 * ((x / 2 + y / 2) % 2) } else { 2 * x + y };
                [value as u8, value as u8, 90, 255]
            })
            .collect();
        Image { name: "corner".into(), width: side, height: side, pixels }
    }

    /// Protects the paper's method on pictures: it moves coordinates soundly, by what its guide
    /// says, and is not undone.
    #[test]
    fn coordinates_move_and_stay_sound() {
        let run = |no_content_aware| {
            let options = ImageOptions {
                texture_size: 16,
                grid: 8,
                method: Method::Paper,
                no_content_aware,
                steps: Some(20),
                ..ImageOptions::default()
            };
            bake_image(&picture(), &options, &()).expect("options are in range")
        };
        let (with, without) = (run(false), run(true));
        for baked in [&with, &without] {
            assert!(baked.report.uv.is_bijective());
            assert!(!baked.report.left_as_is);
            assert_eq!(baked.report.steps, 20);
            assert!(baked.report.written[0] > baked.report.kept[0], "{:?}", baked.report.written);
        }
        assert_ne!(with.model.mesh.uvs, without.model.mesh.uvs);
    }
}
