//! `parbake thumbnail`, a part of `batch` that is not in the help: a small picture of one model.
//!
//! Contract: one PNG, the same bytes for the same model; a little from the side and above, on dark grey.

use crate::arguments::ThumbnailCommand;
use crate::bake::read;
use crate::failure::{Ending, Failure};
use crate::progress::Console;
use parbake::{EvaluateOptions, Picture, Renderer, encode_png, write_file};
use parbake_model::glam::Vec3;

/// Side of the picture in pixels.
const SIDE: usize = 320;

/// Where the camera stands.
const FROM: Vec3 = Vec3::new(0.55, 0.4, 0.75);

/// Field of view in degrees, in which models fill most of the picture.
const FIELD_OF_VIEW: f32 = 37.0;

/// Linear light of the background, that of turntables.
const BACKGROUND: [f32; 3] = [0.04; 3];

/// Runs the command.
pub fn run(command: &ThumbnailCommand) -> Result<Ending, Failure> {
    let console = Console::new(command.talk);
    let model = read(&command.model, &console)?.model;
    let options = EvaluateOptions { resolution: SIDE, fov: FIELD_OF_VIEW, ..EvaluateOptions::default() };
    let renderer = Renderer::new(&model, &options)?;
    let shown = renderer.tonemap(&renderer.render(&renderer.place(&model), FROM.normalize()), BACKGROUND);
    let byte = |x: f32| (255.0 * x).round() as u8;
    let pixels = shown.pixels.iter().map(|&[r, g, b]| [byte(r), byte(g), byte(b), 255]).collect();
    let picture = Picture { name: String::new(), width: SIDE, height: SIDE, pixels };
    write_file(&command.picture, &encode_png(&picture)?)?;
    console.finish();
    Ok(Ending::Finished)
}
