//! A picture becomes a plane with a smaller texture that shows the same (the paper's 2D
//! mode): texture coordinates spread what is detailed over many texels and press what is
//! plain into few.
//!
//! ```text
//! picture ─ scales ───┬ shape (coarse grid) ─ refine ─ finer grid ─ refine … ─┬ texture ─ Model
//!                     ├ the paper's method, one grid ─────────────────────────┤
//!                     └ texture for the coordinates as they are (baseline) ───┘
//! ```
//!
//! Colours are those that the file stores: what is compared is the picture as shown.

use crate::error::BakeError;
pub use crate::image_options::{ImageOptions, PictureUv};
use crate::options::Method;
use parbake_atlas::{Layout, UvCheck, check};
use parbake_image::FloatImage;
use parbake_model::glam::Vec4;
use parbake_model::{AlphaMode, Image, Material, Model, TextureSlot, Wrap};
use parbake_progress::Watcher;
use parbake_uv::contact::{Border, ContactOptions};
use parbake_uv::convergence::Convergence;
use parbake_uv::moves::UvMoves;
use parbake_uv::picture::balance::best_share;
use parbake_uv::picture::coarse_to_fine::optimised;
use parbake_uv::picture::plane::Plane;
use parbake_uv::picture::rounding::as_written;
use parbake_uv::picture::signal_scales::{Picture, signal_scales};
use parbake_uv::picture::texture::{decibels, errors, written_texture};
use parbake_uv::picture::{Moves, as_f64, paper};
use serde::Serialize;

/// A picture's plane.
#[derive(Clone, Debug)]
pub struct BakedImage {
    /// The plane with its texture.
    pub model: Model,
    /// How texture coordinates moved, if they did, of at most 50 cells along a side.
    pub uv_moves: Option<UvMoves>,
    /// What the run saw.
    pub report: ImageReport,
}

/// Figures of a run.
#[derive(Clone, Debug, Serialize)]
pub struct ImageReport {
    /// What was asked for.
    pub options: ImageOptions,
    /// PSNR in dB at full size, half and a quarter, with trilinear filtering and 8-bit
    /// texels, of an ordinary texture of this size: the least-squares one.
    pub kept: Vec<f64>,
    /// The same of the texture that is written: after the paper's method the least-squares
    /// one for its coordinates, even where that shows less.
    pub written: Vec<f64>,
    /// Steps that texture coordinates took.
    pub steps: usize,
    /// The written layout's proof.
    pub uv: UvCheck,
    /// True where moving texture coordinates gained nothing, and they were left.
    pub left_as_is: bool,
    /// True where the run was stopped before its end.
    pub stopped_early: bool,
    /// How the paper's method went, where it was asked for.
    pub convergence: Option<Convergence>,
}

/// Makes the plane of a picture.
///
/// When the watcher asks to stop, the best state so far is returned.
///
/// # Errors
/// When an option is out of range, or the picture has not as many pixels as it says.
pub fn bake_image(
    image: &Image,
    options: &ImageOptions,
    watcher: &dyn Watcher,
) -> Result<BakedImage, BakeError> {
    options.check()?;
    if !image.is_whole() {
        return Err(BakeError::BrokenImage { image: image.name.clone() });
    }
    let size = options.texture_size;
    let picture = Picture::new(image);
    let contact = ContactOptions { texture_size: size as u32, border: Border::Slide, ..Default::default() };
    let finest = Plane { cells: options.settled_grid() };
    let all = signal_scales(&picture, finest, usize::MAX);
    let start = finest.layout(as_f64(&finest.points()));
    let kept_texture = written_texture(&start, &all[..1], FloatImage::solid(size, Vec4::splat(0.5)));
    let kept_errors = errors(&start, &all, &kept_texture);

    let mut moves = Moves::new(finest);
    let asked = &options.for_picture();
    let moving = options.uv == PictureUv::Optimize && options.settled_steps() > 0;
    let found = match options.method {
        Method::Fit if moving => optimised(&picture, asked, &contact, &mut moves, watcher)
            // What was moved for fewer samples is judged by all of them.
            .and_then(|found| best_share(&start, found, &all, &kept_errors)),
        Method::Paper if moving => {
            let layout = paper::moved(&picture, asked, &mut moves, watcher);
            let layout = as_written(layout.clone()).unwrap_or(layout);
            let texture = written_texture(&layout, &all[..1], kept_texture.clone());
            Some((layout, texture))
        }
        _ => None,
    };
    let left_as_is = found.is_none() && options.uv == PictureUv::Optimize;
    // Where nothing moved, two triangles show what the finest grid would.
    let plane = if left_as_is { Plane { cells: 1 } } else { finest };
    let (layout, texture) = found.unwrap_or_else(|| (plane.layout(as_f64(&plane.points())), kept_texture));
    let written_errors = if left_as_is { kept_errors.clone() } else { errors(&layout, &all, &texture) };
    let report = ImageReport {
        options: options.clone(),
        kept: kept_errors.iter().map(decibels).collect(),
        written: written_errors.iter().map(decibels).collect(),
        steps: moves.steps,
        uv: check(&layout, size),
        left_as_is,
        stopped_early: watcher.stopped(),
        convergence: moves.convergence.take(),
    };
    let uv_moves = if left_as_is { None } else { moves.drawn() };
    Ok(BakedImage { model: model(image, plane, &layout, &texture), uv_moves, report })
}

/// The plane as a model: its longer side is 1 wide.
fn model(image: &Image, plane: Plane, layout: &Layout, texture: &FloatImage<Vec4>) -> Model {
    let longest = image.width.max(image.height) as f32;
    let mut mesh = plane.mesh(image.width as f32 / longest, image.height as f32 / longest);
    mesh.uvs = layout.uvs();
    let pixels = texture.texels.iter().map(|t| t.to_array().map(|x| (x * 255.0).round() as u8)).collect();
    let opaque = image.pixels.iter().all(|p| p[3] == 255);
    let written = Image { name: "base color".into(), width: texture.width, height: texture.height, pixels };
    let slot = TextureSlot { image: 0, wrap: [Wrap::Clamp; 2], ..TextureSlot::default() };
    let material = Material {
        name: image.name.clone(),
        base_color_texture: Some(slot),
        alpha_mode: if opaque { AlphaMode::Opaque } else { AlphaMode::Blend },
        ..Material::default()
    };
    Model {
        name: image.name.clone(),
        mesh,
        materials: vec![material],
        images: vec![written],
        ..Model::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_progress::Message;
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

    /// Protects pictures on which nothing can be gained: they get two triangles and no plane of
    /// thousands.
    #[test]
    fn a_plain_picture_is_left_as_it_is() {
        let pixels = vec![[90, 120, 40, 255]; 96 * 64];
        let picture = Image { name: "plain".into(), width: 96, height: 64, pixels };
        let options = ImageOptions { texture_size: 16, grid: Some(8), ..ImageOptions::default() };
        let baked = bake_image(&picture, &options, &()).expect("options are in range");
        assert!(baked.report.left_as_is);
        assert_eq!(baked.model.mesh.triangles.len(), 2);
        assert_eq!(baked.report.written, baked.report.kept);
    }

    /// Stops after so many messages.
    struct StopAfter(AtomicUsize);

    impl Watcher for StopAfter {
        fn message(&self, _: Message) {
            self.0.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1)).ok();
        }

        fn stopped(&self) -> bool {
            self.0.load(Relaxed) == 0
        }
    }

    /// Protects a run that is stopped on a coarse grid: its plane is the finest, sound and no worse than
    /// an ordinary texture, its moves are drawn on the grid they are of.
    #[test]
    fn a_run_can_be_stopped_on_any_grid() {
        let checks = |i: usize| if i % 96 / 6 % 2 == i / 96 / 6 % 2 { 30 } else { 220 };
        let pixels = (0..96 * 96).map(|i| if i % 96 < 48 { [checks(i), 90, 40, 255] } else { [90; 4] });
        let picture = Image { name: "checks".into(), width: 96, height: 96, pixels: pixels.collect() };
        let options = ImageOptions { texture_size: 16, grid: Some(80), ..ImageOptions::default() };
        for messages in [0, 1, 3, 20] {
            let baked =
                bake_image(&picture, &options, &StopAfter(messages.into())).expect("options are in range");
            assert!(baked.report.stopped_early, "{messages}");
            assert!(baked.report.uv.is_bijective(), "{messages}");
            assert!(baked.report.written[0] >= baked.report.kept[0]);
            if let Some(moves) = baked.uv_moves {
                let points = moves.triangles.iter().flatten().max().map_or(0, |most| *most as usize + 1);
                assert!(moves.frames.iter().all(|frame| frame.len() == points), "{messages}");
            }
        }
    }

    /// Protects library callers: a picture without its pixels is an error and no panic.
    #[test]
    fn broken_pictures_are_refused() {
        let broken = Image { name: "broken".into(), width: 4, height: 4, pixels: vec![[0; 4]; 15] };
        for picture in [broken, Image::default()] {
            let found = bake_image(&picture, &ImageOptions::default(), &());
            assert!(matches!(found, Err(BakeError::BrokenImage { .. })));
        }
    }
}
