//! Pictures out: PNG, lossless, the same bytes for the same picture.
//!
//! An alpha channel that is 255 everywhere is left out: it says nothing, and a
//! third of the bytes would go to it.

use crate::FileError;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use parbake_model::Image;

/// Encodes as an 8-bit RGB or RGBA PNG.
///
/// # Errors
/// When the image has no texels, more than a PNG can hold, or another number than
/// `width * height`.
pub fn encode_png(image: &Image) -> Result<Vec<u8>, FileError> {
    let refuse = |reason: String| FileError::Invalid {
        path: image.name.clone().into(),
        place: crate::Place::Image(image.name.clone()),
        reason,
    };
    let sizes = (u32::try_from(image.width), u32::try_from(image.height));
    let (Ok(width @ 1..), Ok(height @ 1..)) = sizes else {
        return Err(refuse(format!("a PNG cannot have {} × {} texels", image.width, image.height)));
    };
    if image.width.checked_mul(image.height) != Some(image.pixels.len()) {
        let (w, h, n) = (image.width, image.height, image.pixels.len());
        return Err(refuse(format!("{w} × {h} texels were announced, but there are {n}")));
    }
    let opaque = image.pixels.iter().all(|p| p[3] == 255);
    let (samples, kind) = if opaque {
        (image.pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect(), ExtendedColorType::Rgb8)
    } else {
        (image.pixels.as_flattened().to_vec(), ExtendedColorType::Rgba8)
    };
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive)
        .write_image(&samples, width, height, kind)
        .map_err(|e| refuse(format!("cannot be encoded as PNG: {e}")))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Limits, decode_image};

    /// Protects losslessness, with and without alpha, and the dropped channel.
    #[test]
    fn png_is_lossless_and_drops_full_alpha() {
        let mut image = Image::solid("a", 7, 5, [0, 0, 0, 255]);
        for (i, p) in image.pixels.iter_mut().enumerate() {
            *p = [i as u8, (i * 7) as u8, (i * i) as u8, 255];
        }
        let rgb = encode_png(&image).unwrap();
        assert_eq!(rgb[25], 2, "colour type RGB");
        assert_eq!(decode_image("a", &rgb, &Limits::default()).unwrap(), image);
        image.pixels[3][3] = 17;
        let rgba = encode_png(&image).unwrap();
        assert_eq!(rgba[25], 6, "colour type RGBA");
        assert_eq!(decode_image("a", &rgba, &Limits::default()).unwrap(), image);
        assert_eq!(encode_png(&image).unwrap(), rgba, "deterministic");
    }

    /// Protects against a panic on an image that breaks its contract.
    #[test]
    fn broken_images_are_refused() {
        let mut image = Image::solid("a", 2, 2, [0; 4]);
        image.pixels.pop();
        assert!(encode_png(&image).is_err());
        assert!(encode_png(&Image::default()).is_err());
    }
}
