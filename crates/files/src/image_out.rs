//! Pictures out: PNG, lossless, the same bytes for the same picture.
//!
//! An alpha channel that is 255 everywhere is left out: it says nothing, and a
//! third of the bytes would go to it. What models are written with takes the time to be
//! small (`oxipng`).

use crate::{FileError, Place};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use oxipng::{BitDepth, ColorType, Deflater, Options, RawImage};
use parbake_model::Image;

/// Texels up to which packing takes all the time that pays: 2.4 s at 2048².
const MOST_PATIENT: usize = 1 << 22;
/// Effort beyond (of 12; 10 otherwise): a fifth of the time, and half of the gain.
const LESS_EFFORT: u8 = 7;

/// Encodes as an 8-bit RGB or RGBA PNG, fast.
///
/// # Errors
/// When the image has no texels, more than a PNG can hold, or another number than
/// `width * height`.
pub fn encode_png(image: &Image) -> Result<Vec<u8>, FileError> {
    let Raw { width, height, samples, opaque } = Raw::new(image)?;
    let kind = if opaque { ExtendedColorType::Rgb8 } else { ExtendedColorType::Rgba8 };
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive)
        .write_image(&samples, width, height, kind)
        .map_err(|e| refuse(image, format!("cannot be encoded as PNG: {e}")))?;
    Ok(bytes)
}

/// Encodes numbers as a 16-bit PNG without a colour space: grey for one channel, RGB for three.
///
/// # Errors
/// When there are no texels, more than a PNG can hold, other channels, or another number of samples than
/// `width * height * channels`.
pub fn encode_png16(
    name: &str,
    [width, height]: [usize; 2],
    channels: usize,
    samples: &[u16],
) -> Result<Vec<u8>, FileError> {
    let image = Image { name: name.into(), width, height, pixels: Vec::new() };
    let kind = match channels {
        1 => ExtendedColorType::L16,
        3 => ExtendedColorType::Rgb16,
        _ => return Err(refuse(&image, format!("a picture cannot have {channels} channels of numbers"))),
    };
    let (Ok(w @ 1..), Ok(h @ 1..)) = (u32::try_from(width), u32::try_from(height)) else {
        return Err(refuse(&image, format!("an image cannot have {width} × {height} texels")));
    };
    if width.checked_mul(height).and_then(|texels| texels.checked_mul(channels)) != Some(samples.len()) {
        let reason = format!("{width} × {height} texels do not have {} numbers", samples.len());
        return Err(refuse(&image, reason));
    }
    let bytes: Vec<u8> = samples.iter().flat_map(|number| number.to_ne_bytes()).collect();
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
        .write_image(&bytes, w, h, kind)
        .map_err(|e| refuse(&image, format!("cannot be encoded as PNG: {e}")))?;
    Ok(png)
}

/// As [`encode_png`], but small: 3 to 30 % smaller, in 0.1 s instead of 2 ms at 512².
pub(crate) fn pack_png(image: &Image) -> Result<Vec<u8>, FileError> {
    let Raw { width, height, samples, opaque } = Raw::new(image)?;
    let kind = if opaque { ColorType::RGB { transparent_color: None } } else { ColorType::RGBA };
    let mut options = Options {
        // Readers of data textures count on their channels.
        bit_depth_reduction: false,
        color_type_reduction: false,
        palette_reduction: false,
        grayscale_reduction: false,
        interlace: None,
        ..Options::from_preset(1)
    };
    if image.pixels.len() > MOST_PATIENT {
        options.deflater = Deflater::Libdeflater { compression: LESS_EFFORT };
    }
    RawImage::new(width, height, kind, BitDepth::Eight, samples)
        .and_then(|raw| raw.create_optimized_png(&options))
        .map_err(|e| refuse(image, format!("cannot be encoded as PNG: {e}")))
}

/// What an image is encoded from.
pub(crate) struct Raw {
    pub width: u32,
    pub height: u32,
    /// Three channels a texel where all is opaque, else four.
    pub samples: Vec<u8>,
    pub opaque: bool,
}

impl Raw {
    pub fn new(image: &Image) -> Result<Self, FileError> {
        let sizes = (u32::try_from(image.width), u32::try_from(image.height));
        let (Ok(width @ 1..), Ok(height @ 1..)) = sizes else {
            return Err(refuse(
                image,
                format!("an image cannot have {} × {} texels", image.width, image.height),
            ));
        };
        if image.width.checked_mul(image.height) != Some(image.pixels.len()) {
            let (w, h, n) = (image.width, image.height, image.pixels.len());
            return Err(refuse(image, format!("{w} × {h} texels were announced, but there are {n}")));
        }
        let opaque = image.pixels.iter().all(|p| p[3] == 255);
        let samples = if opaque {
            image.pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect()
        } else {
            image.pixels.as_flattened().to_vec()
        };
        Ok(Self { width, height, samples, opaque })
    }
}

pub(crate) fn refuse(image: &Image, reason: String) -> FileError {
    FileError::Invalid { path: image.name.clone().into(), place: Place::Image(image.name.clone()), reason }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Limits, decode_image};

    /// Protects losslessness, with and without alpha, the dropped channel, and channels that
    /// others could be told from (here all are alike).
    #[test]
    fn png_is_lossless_and_drops_full_alpha() {
        for encode in [encode_png, pack_png] {
            let mut image = Image::solid("a", 7, 5, [0, 0, 0, 255]);
            for (i, p) in image.pixels.iter_mut().enumerate() {
                *p = [(i * 7) as u8, (i * 7) as u8, (i * 7) as u8, 255];
            }
            let rgb = encode(&image).unwrap();
            assert_eq!(rgb[24..26], [8, 2], "eight bits, RGB");
            assert_eq!(decode_image("a", &rgb, &Limits::default()).unwrap(), image);
            image.pixels[3] = [200, 100, 50, 17];
            let rgba = encode(&image).unwrap();
            assert_eq!(rgba[24..26], [8, 6], "eight bits, RGBA");
            assert_eq!(decode_image("a", &rgba, &Limits::default()).unwrap(), image);
            assert_eq!(encode(&image).unwrap(), rgba, "deterministic");
        }
    }

    /// Protects maps of lengths: all 16 bits are there, in the order in which PNG has them.
    #[test]
    fn numbers_keep_sixteen_bits() {
        let numbers = [0x0102u16, 0xfffe, 7, 40_000, 0, 65_535];
        let read = |png: &[u8]| image::load_from_memory(png).unwrap();
        let grey = encode_png16("g", [3, 2], 1, &numbers).unwrap();
        assert_eq!(grey[24..26], [16, 0], "sixteen bits, grey");
        assert_eq!(read(&grey).as_luma16().unwrap().as_raw()[..], numbers);
        let rgb = encode_png16("c", [1, 2], 3, &numbers).unwrap();
        assert_eq!(read(&rgb).as_rgb16().unwrap().as_raw()[..], numbers);
        assert!(encode_png16("c", [2, 2], 3, &numbers).is_err());
        assert!(encode_png16("c", [3, 1], 2, &numbers).is_err());
    }

    /// Protects against a panic on an image that breaks its contract.
    #[test]
    fn broken_images_are_refused() {
        let mut image = Image::solid("a", 2, 2, [0; 4]);
        image.pixels.pop();
        for encode in [encode_png, pack_png] {
            assert!(encode(&image).is_err());
            assert!(encode(&Image::default()).is_err());
        }
    }
}
