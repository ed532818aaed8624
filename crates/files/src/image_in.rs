//! Pictures in: PNG, JPEG and WebP to 8-bit RGBA.
//!
//! The format is told by the first bytes, not by the name. Samples of 16 bits are
//! rounded to 8, greys and palettes become RGB, a missing alpha becomes 255. Colour
//! profiles, gamma chunks and EXIF turns are ignored, as glTF 2.0 asks (3.8.2).
//!
//! Contract: the declared size is held against the limits before any pixel memory
//! is reserved.

use crate::resources::read_file;
use crate::{FileError, Limits, Place};
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};
use parbake_model::Image;
use std::io::Cursor;
use std::path::Path;

const SUPPORTED: &str = "PNG, JPEG and WebP";

/// No deflate stream unpacks to more than this many bytes for each of its own.
const DEFLATE_MOST: u64 = 1032;

/// Why a picture could not be had, before it is known whose picture it is.
#[derive(Debug)]
pub(crate) enum ImageTrouble {
    UnknownFormat,
    Side(u64),
    Pixels(u64),
    Damaged(String),
}

impl ImageTrouble {
    pub fn into_error(self, path: &Path, place: Place, limits: &Limits) -> FileError {
        let path = path.to_path_buf();
        match self {
            Self::UnknownFormat if place == Place::File => {
                FileError::UnknownFormat { path, supported: SUPPORTED }
            }
            Self::UnknownFormat => FileError::Unsupported {
                path,
                place,
                feature: "this picture's format".into(),
                advice: format!("convert it to one of {SUPPORTED}"),
            },
            Self::Side(found) => FileError::OverLimit {
                path,
                place,
                what: "texels along the image's longer side",
                found,
                limit: limits.max_image_side.into(),
            },
            Self::Pixels(found) => FileError::OverLimit {
                path,
                place,
                what: "texels of the image",
                found,
                limit: limits.max_image_pixels,
            },
            Self::Damaged(reason) => FileError::Invalid { path, place, reason },
        }
    }
}

/// Reads a picture file.
///
/// # Errors
/// When it cannot be read, is of another format, is damaged, or is over the limits.
pub fn read_image(path: &Path, limits: &Limits) -> Result<Image, FileError> {
    let bytes = read_file(path, limits.max_file_bytes).map_err(|source| FileError::Read {
        path: path.into(),
        place: Place::File,
        source,
    })?;
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    decode(&name, &bytes, limits).map_err(|trouble| trouble.into_error(path, Place::File, limits))
}

/// Decodes a picture in memory. `name` becomes the image's, and the errors', name.
///
/// # Errors
/// When it is of another format, is damaged, or is over the limits.
pub fn decode_image(name: &str, bytes: &[u8], limits: &Limits) -> Result<Image, FileError> {
    decode(name, bytes, limits).map_err(|trouble| trouble.into_error(Path::new(name), Place::File, limits))
}

pub(crate) fn decode(name: &str, bytes: &[u8], limits: &Limits) -> Result<Image, ImageTrouble> {
    let format = match image::guess_format(bytes) {
        Ok(f @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP)) => f,
        _ => return Err(ImageTrouble::UnknownFormat),
    };
    let damaged = |e: ImageError| {
        // Some reasons go over several lines.
        let reason = e.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        ImageTrouble::Damaged(format!("the picture cannot be decoded: {reason}"))
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(decoder_limits(limits));
    let decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let side = u64::from(width.max(height));
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 {
        return Err(ImageTrouble::Damaged("the picture has no pixels".into()));
    }
    if side > limits.max_image_side.into() {
        return Err(ImageTrouble::Side(side));
    }
    if pixels > limits.max_image_pixels {
        return Err(ImageTrouble::Pixels(pixels));
    }
    // A PNG of one bit a pixel is the densest; what is shorter than that was cut off.
    if format == ImageFormat::Png && pixels / 8 > DEFLATE_MOST * bytes.len() as u64 {
        return Err(ImageTrouble::Damaged(format!(
            "the picture declares {width} × {height} pixels but has only {} bytes",
            bytes.len()
        )));
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgba8();
    let pixels = picture.as_raw().as_chunks::<4>().0.to_vec();
    Ok(Image { name: name.into(), width: width as usize, height: height as usize, pixels })
}

/// Sizes are checked by us, so that the message can say what the limit is; the
/// decoder is told how much memory it may take: four 16-bit channels a texel,
/// and as much again for its own tables and rows.
fn decoder_limits(limits: &Limits) -> image::Limits {
    let mut told = image::Limits::no_limits();
    told.max_alloc = Some(limits.max_image_pixels.saturating_mul(16).saturating_add(64 << 20));
    told
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode_png;

    fn png(width: u32, height: u32) -> Vec<u8> {
        encode_png(&Image::solid("a", width as usize, height as usize, [1, 2, 3, 255])).unwrap()
    }

    /// Protects the pixels' order and the filled-in alpha.
    #[test]
    fn png_comes_back() {
        let mut image = Image::solid("a.png", 3, 2, [9, 8, 7, 255]);
        image.pixels[4] = [1, 2, 3, 255];
        let bytes = encode_png(&image).unwrap();
        assert_eq!(decode_image("a.png", &bytes, &Limits::default()).unwrap(), image);
    }

    /// Protects memory: limits are held against the header.
    #[test]
    fn sizes_over_the_limits_are_refused() {
        let limits = Limits { max_image_side: 16, max_image_pixels: 100, ..Limits::default() };
        let side = decode_image("a.png", &png(17, 1), &limits).unwrap_err();
        assert!(side.to_string().contains("longer side: 17, and the limit is 16"), "{side}");
        let pixels = decode_image("a.png", &png(11, 10), &limits).unwrap_err();
        assert!(pixels.to_string().contains("110"), "{pixels}");
        assert!(decode_image("a.png", &png(10, 10), &limits).is_ok());
    }

    /// Protects against bombs whose size is within the limits.
    #[test]
    fn a_header_without_pixels_is_refused_early() {
        let mut bytes = png(4, 4);
        let ihdr = [b"IHDR".as_slice(), &[0, 0, 0x3f, 0, 0, 0, 0x3f, 0, 8, 6, 0, 0, 0]].concat();
        bytes[12..29].copy_from_slice(&ihdr);
        let crc = crc32(&ihdr).to_be_bytes();
        bytes[29..33].copy_from_slice(&crc);
        let error = decode_image("bomb.png", &bytes, &Limits::default()).unwrap_err().to_string();
        assert!(error.contains("declares 16128 × 16128"), "{error}");
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0u32, |crc, &b| {
            (0..8).fold(crc ^ u32::from(b), |c, _| if c & 1 == 1 { c >> 1 ^ 0xedb8_8320 } else { c >> 1 })
        })
    }

    /// Protects the messages about other formats and damaged files.
    #[test]
    fn other_bytes_are_named() {
        let error = decode_image("a.tga", b"nonsense", &Limits::default()).unwrap_err().to_string();
        assert!(error.starts_with("a.tga") && error.contains("WebP"), "{error}");
        let bytes = png(40, 40);
        let error = decode_image("b.png", &bytes[..60], &Limits::default()).unwrap_err().to_string();
        assert!(error.starts_with("b.png") && error.contains("decoded"), "{error}");
    }
}
