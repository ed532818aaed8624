//! A picture becomes a plane with a smaller texture that shows the same (the paper's 2D
//! mode): texture coordinates spread what is detailed over many texels and press what is
//! plain into few.
//!
//! ```text
//! picture ─ showings ─┬ shape (coarse grid) ─ refine ─ finer grid ─ refine … ─┬ texture ─ Model
//!                     └ texture for the coordinates as they are (baseline) ───┘
//! ```
//!
//! Colours are those that the file stores: what is compared is the picture as shown.

mod options;
mod plane;
mod showings;

pub use options::ImageOptions;

use crate::error::BakeError;
use crate::message::{Message, Stage, Watcher};
use crate::options::UvMode;
use crate::uv_animation::UvMoves;
use parbake_atlas::{Layout, UvCheck, check};
use parbake_model::glam::{DVec2, Vec2, Vec4};
use parbake_model::{AlphaMode, Image, Material, Model, TextureSlot, Wrap};
use parbake_uv::best_texture::{Mapped, Solve, Texture, best_texture_in_box};
use parbake_uv::contact::{Border, ContactOptions};
use parbake_uv::optimise::{Balance, Problem, UvOptions, refine, shape, tensors};
use parbake_uv::runs::Runs;
use parbake_uv::shown::shown_errors;
use parbake_uv::signal::Signal;
use plane::Plane;
use serde::Serialize;
use showings::{Picture, showings};

/// A picture's plane.
#[derive(Clone, Debug)]
pub struct BakedImage {
    /// The plane with its texture.
    pub model: Model,
    /// How texture coordinates moved, if they did.
    pub uv_moves: Option<UvMoves>,
    /// What the run saw.
    pub report: ImageReport,
}

/// Figures of a run.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ImageReport {
    /// What was asked for.
    pub options: ImageOptions,
    /// PSNR in dB at full size, half and a quarter, with trilinear filtering and 8-bit
    /// texels, of an ordinary texture of this size: the least-squares one.
    pub kept: Vec<f64>,
    /// The same of the texture that is written.
    pub written: Vec<f64>,
    /// Steps that texture coordinates took.
    pub steps: usize,
    /// The written layout's proof.
    pub uv: UvCheck,
    /// True where moving texture coordinates gained nothing, and they were left.
    pub left_as_is: bool,
    /// True where the run was stopped before its end.
    pub stopped_early: bool,
}

/// Samples of a showing that texture coordinates are moved for, relative to the texels:
/// more settle details that the texture cannot hold anyway.
const SAMPLES_PER_TEXEL: usize = 16;
/// At least so many, for small textures.
const LEAST_SAMPLES: usize = 1 << 18;
/// Coarsest grid that is worth a descent of its own.
const COARSEST: usize = 20;
/// A minified picture may be so much worse than that of an ordinary texture, as a ratio of
/// errors: 0.1 dB.
const TOLERATED: f64 = 1.0233;

/// Makes the plane of a picture.
///
/// When the watcher asks to stop, the best state so far is returned.
///
/// # Errors
/// When an option is out of range.
pub fn bake_image(image: &Image, options: &ImageOptions, watcher: &impl Watcher) -> Result<BakedImage, BakeError> {
    options.check()?;
    let size = options.texture_size;
    let picture = Picture::new(image);
    let contact = ContactOptions { texture_size: size as u32, border: Border::Slide, ..Default::default() };
    let finest = Plane { cells: options.grid };
    let all = showings(&picture, finest, usize::MAX);
    let start = finest.layout(as_f64(&finest.points()));
    let kept_texture = written_texture(&start, &all[..1], Texture::solid(size, Vec4::splat(0.5)));
    let kept_errors = errors(&start, &all, &kept_texture);

    let mut moves = Moves { frames: Vec::new(), steps: 0 };
    let mut found = None;
    if options.uv == UvMode::Optimize && options.steps > 0 {
        found = optimised(&picture, options, &contact, &mut moves, watcher);
    }
    // What was moved for fewer samples is judged by all of them.
    let (layout, texture, left_as_is) = found
        .and_then(|found| best_share(&start, found, &all, &kept_errors))
        .map(|(layout, texture)| (layout, texture, false))
        .unwrap_or((start, kept_texture, options.uv == UvMode::Optimize));
    let written_errors = errors(&layout, &all, &texture);
    let report = ImageReport {
        options: options.clone(),
        kept: kept_errors.iter().map(decibels).collect(),
        written: written_errors.iter().map(decibels).collect(),
        steps: moves.steps,
        uv: check(&layout, size),
        left_as_is,
        stopped_early: watcher.stopped(),
    };
    let uv_moves = (!left_as_is && !moves.frames.is_empty()).then(|| UvMoves {
        frames: moves.frames,
        triangles: layout.triangles.clone(),
        charts: layout.charts.clone(),
    });
    Ok(BakedImage { model: model(image, finest, &layout, &texture), uv_moves, report })
}

/// Frames and steps so far.
struct Moves {
    frames: Vec<Vec<Vec2>>,
    steps: usize,
}

/// Coarse to fine; None where the watcher stopped it before anything was found.
fn optimised(
    picture: &Picture,
    options: &ImageOptions,
    contact: &ContactOptions,
    moves: &mut Moves,
    watcher: &impl Watcher,
) -> Option<(Layout, Texture, Balance)> {
    let size = options.texture_size;
    let mut grids = vec![options.grid];
    while grids[0] % 2 == 0 && grids[0] / 2 >= COARSEST {
        grids.insert(0, grids[0] / 2);
    }
    let total = grids.len() * options.steps;
    let own = UvOptions { refine_steps: options.steps, ..UvOptions::default() };
    let mut state: Option<(Layout, Texture, Balance)> = None;
    for (turn, &cells) in grids.iter().enumerate() {
        let plane = Plane { cells };
        // The coarse grids place regions, which half the samples show as well.
        let most = (SAMPLES_PER_TEXEL * size * size).max(LEAST_SAMPLES) >> (2 * usize::from(turn + 1 < grids.len()));
        let showings = showings(picture, plane, most.max(LEAST_SAMPLES));
        let rest = plane.rest();
        let problem = Problem { rest: &rest, showings: &showings, texture_size: size, contact };
        let mut frames = Vec::new();
        let mut step = |points: &[DVec2], _| {
            frames.push(points.iter().map(|p| p.as_vec2()).collect::<Vec<Vec2>>());
            let done = turn * options.steps + frames.len();
            watcher.message(Message::Progress { stage: Stage::Unfold, done: done.min(total), total });
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
        moves.frames = frames;
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

/// The moved layout, or as much of its move as leaves no size worse; None where even a
/// small share of it does.
fn best_share(
    start: &Layout,
    (moved, texture, balance): (Layout, Texture, Balance),
    all: &[Signal],
    kept: &[f64],
) -> Option<(Layout, Texture)> {
    for share in [1.0, 0.7, 0.4, 0.2] {
        let mut layout = moved.clone();
        for (p, from) in layout.points.iter_mut().zip(&start.points) {
            *p = from.lerp(*p, share);
        }
        layout.round();
        if (0..layout.triangles.len()).all(|t| layout.doubled_area(t) > 0.0)
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
    start: Texture,
    mut balance: Balance,
    kept: &[f64],
) -> Option<Texture> {
    const ATTEMPTS: usize = 4;
    balance.baseline = kept.iter().map(|e| e.max(1e-9)).collect();
    let mut best: Option<(f64, Texture)> = None;
    let mut texture = start;
    for _ in 0..ATTEMPTS {
        texture = written_texture(layout, &balance.weighted(all), texture);
        let found = errors(layout, all, &texture);
        let relative: Vec<f64> = found.iter().zip(&balance.baseline).map(|(e, kept)| e / kept).collect();
        let fine = relative[0] < 1.0 && relative[1..].iter().all(|r| *r <= TOLERATED);
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

/// The best texture of 8-bit texels, as numbers from 0 to 1.
fn written_texture(layout: &Layout, showings: &[Signal], start: Texture) -> Texture {
    let runs = Runs::new(&layout.points, &layout.triangles, &showings[0]);
    let mapped = Mapped { points: &layout.points, triangles: &layout.triangles, showings, runs: &runs };
    let mut texture = best_texture_in_box(&mapped, start, &Solve::FINAL);
    texture.texels.iter_mut().for_each(|t| *t = (*t * 255.0).round() / 255.0);
    texture
}

/// Mean squared errors of the sizes at which the picture is shown, by channel.
fn errors(layout: &Layout, all: &[Signal], texture: &Texture) -> Vec<f64> {
    let runs = Runs::new(&layout.points, &layout.triangles, &all[0]);
    let mapped = Mapped { points: &layout.points, triangles: &layout.triangles, showings: all, runs: &runs };
    // Three channels carry the picture; opacity differs rarely.
    shown_errors(&mapped, texture).into_iter().map(|e| e / 3.0).collect()
}

fn decibels(mean_square: &f64) -> f64 {
    -10.0 * mean_square.max(1e-10).log10()
}

fn as_f64(points: &[Vec2]) -> Vec<DVec2> {
    points.iter().map(|p| p.as_dvec2()).collect()
}

/// The plane as a model: its longer side is 1 wide.
fn model(image: &Image, plane: Plane, layout: &Layout, texture: &Texture) -> Model {
    let longest = image.width.max(image.height) as f32;
    let mut mesh = plane.mesh(image.width as f32 / longest, image.height as f32 / longest);
    mesh.uvs = layout.uvs();
    let pixels = texture.texels.iter().map(|t| t.to_array().map(|x| (x * 255.0).round() as u8)).collect();
    let opaque = image.pixels.iter().all(|p| p[3] == 255);
    let written = Image { name: "base color".into(), width: texture.size, height: texture.size, pixels };
    let slot = TextureSlot { image: 0, wrap: [Wrap::Clamp; 2], ..TextureSlot::default() };
    let material = Material {
        name: image.name.clone(),
        base_color_texture: Some(slot),
        alpha_mode: if opaque { AlphaMode::Opaque } else { AlphaMode::Blend },
        ..Material::default()
    };
    Model { name: image.name.clone(), mesh, materials: vec![material], images: vec![written] }
}
