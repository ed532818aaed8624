//! What a picture's plane shows, rendered from straight ahead through the product's own renderer
//! at the picture's own size.
//!
//! A light from the camera of strength 1 shades a plane that faces it with 1, so the screen shows
//! the display curve of the stored value; the curve is taken off again.
//!
//! Contract: pixels are the stored values, row 0 on top, of the picture's size.

use parbake::{BakeError, EvaluateOptions, Renderer};
use parbake_image::display::decode_srgb;
use parbake_metric::Rgb;
use parbake_model::glam::Vec3;
use parbake_model::{Image, Model};

/// The plane as it is seen at the picture's size.
pub fn as_shown(plane: &Model, picture: &Image) -> Result<Rgb, BakeError> {
    let longest = picture.width.max(picture.height);
    let options = EvaluateOptions {
        resolution: longest.clamp(16, 4096),
        supersample: 1,
        ortho: Some(1.0),
        gain: Some(1.0),
        ..EvaluateOptions::paper()
    };
    let renderer = Renderer::new(plane, &options)?;
    let view = renderer.render(&renderer.place(plane), Vec3::Z);
    let square = renderer.tonemap(&view, [0.0; 3]);
    let (left, top) = ((square.width - picture.width) / 2, (square.height - picture.height) / 2);
    let pixels = (0..picture.height)
        .flat_map(|y| (0..picture.width).map(move |x| (x, y)))
        .map(|(x, y)| square.pixels[(top + y) * square.width + left + x].map(decode_srgb))
        .collect();
    Ok(Rgb { width: picture.width, height: picture.height, pixels })
}

/// The picture itself, in the same units.
pub fn wanted(picture: &Image) -> Rgb {
    let pixels = picture.pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(|x| f32::from(x) / 255.0)).collect();
    Rgb { width: picture.width, height: picture.height, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake::{ImageOptions, PictureUv, bake_image};
    use parbake_metric::{mean_squared_error, psnr_from_mse};

    /// Protects the comparison of pictures: what the renderer shows of a plane, whatever its
    /// proportions, has the error that the bake itself has found.
    #[test]
    fn a_plane_shows_what_the_bake_says() {
        for (width, height) in [(48, 48), (64, 32), (32, 64)] {
            let pixels = (0..width * height)
                .map(|i| {
                    let (x, y) = (i % width, i / width);
                    [(x * 5 % 256) as u8, (y * 7 % 256) as u8, (x * y % 200) as u8, 255]
                })
                .collect();
            let picture = Image { name: "p".into(), width, height, pixels };
            let options = ImageOptions { texture_size: 16, uv: PictureUv::Keep, ..ImageOptions::default() };
            let baked = bake_image(&picture, &options, &()).unwrap();
            let shown = as_shown(&baked.model, &picture).unwrap();
            let psnr = psnr_from_mse(mean_squared_error(&wanted(&picture), &shown).unwrap());
            assert!((psnr - baked.report.written[0]).abs() < 0.1, "{psnr} {:?}", baked.report.written);
        }
    }
}
