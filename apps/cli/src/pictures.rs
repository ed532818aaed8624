//! The demo's pictures side by side, as README shows them: high-poly, ray-cast bake, bake, and bake with
//! parallax maps.
//!
//! Contract: one lossless WebP of four squares, rendered by the convention that was baked with from one
//! direction. The ray-cast bake has the low-poly's own vertices and texture coordinates.

use crate::bake::Pair;
use crate::failure::Failure;
use crate::progress::Console;
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder};
use parbake::{
    BakeOptions, Baked, EvaluateOptions, Model, Parallax, Renderer, ShapeMode, UvMode, bake, write_file,
};
use parbake_model::glam::Vec3;
use std::path::Path;

/// Side of one picture in pixels: four beside each other take 1024 pixels and some 250 kB.
const SIDE: usize = 256;

/// Where the camera stands: a little to the side and above.
const FROM: Vec3 = Vec3::new(0.55, 0.4, 0.75);

/// Field of view in degrees, in which the models fill most of the picture.
const FIELD_OF_VIEW: f32 = 37.0;

/// A light grey, of linear light.
const BACKGROUND: [f32; 3] = [0.72; 3];

/// Bakes what is missing of the four, renders them and writes the picture.
pub fn write_pictures(path: &Path, pair: &Pair, baked: &Baked, console: &Console) -> Result<(), Failure> {
    let own = &baked.report.options;
    let with = |options: BakeOptions| -> Result<Baked, Failure> {
        if options == *own { Ok(baked.clone()) } else { Ok(bake(&pair.high, &pair.low, &options, console)?) }
    };
    let plain = BakeOptions { parallax: Parallax::None, ..own.clone() };
    let ray_cast = BakeOptions { uv: UvMode::Keep, shape: ShapeMode::Keep, rounds: Some(0), ..plain.clone() };
    let maps = BakeOptions { parallax: Parallax::Tangent, ..own.clone() };
    let lows = [ray_cast, plain, maps].map(with);
    let options = EvaluateOptions {
        resolution: SIDE,
        supersample: 4,
        fov: FIELD_OF_VIEW,
        convention: own.convention,
        ..EvaluateOptions::default()
    };
    let renderer = Renderer::new(&pair.high, &options)?;
    let mut squares = Vec::new();
    let mut render = |model: &Model| {
        squares
            .push(renderer.tonemap(&renderer.render(&renderer.place(model), FROM.normalize()), BACKGROUND));
    };
    render(&pair.high);
    for low in lows {
        render(&low?.model);
    }
    let rows = (0..SIDE).flat_map(|y| squares.iter().map(move |square| (y, square)));
    let pixels = rows.flat_map(|(y, square)| square.pixels.iter().skip(y * SIDE).take(SIDE));
    let bytes: Vec<u8> = pixels.flatten().map(|&x| (255.0 * x).round() as u8).collect();
    let (width, height) = ((SIDE * squares.len()) as u32, SIDE as u32);
    let mut file = Vec::new();
    WebPEncoder::new_lossless(&mut file)
        .write_image(&bytes, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| Failure::Output(format!("{}: {error}", path.display())))?;
    Ok(write_file(path, &file)?)
}
