//! Pictures in: PNG, JPEG, WebP and KTX2 (`ktx2.rs`), and beside OBJ files TGA, BMP and GIF, to 8-bit RGBA.
//!
//! The format is told by the first bytes, not by the name, but for TGA, which starts with none of its own. Samples of 16 bits are
//! rounded to 8, greys and palettes become RGB, a missing alpha becomes 255. Colour
//! profiles, gamma chunks and EXIF turns are ignored, as glTF 2.0 asks (3.8.2).
//!
//! Contract: the declared size is held against the limits before any pixel memory
//! is reserved. TIFF is not read: its decoder reserves what a file asks for, and decodes pictures of any size inside of it.

use crate::contents::PictureFormat;
use crate::guard::guarded;
use crate::image_trouble::ImageTrouble;
use crate::ktx2;
use crate::resources::read_file;
use crate::words::shown;
use crate::{FileError, Limits, Place};
use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};
use parbake_model::Image;
use std::io::Cursor;
use std::path::Path;

/// The most pixels that one byte of a whole file can stand for: a PNG of one bit a
/// pixel, at the 1032 bytes that deflate makes of one; a JPEG's 64 pixels a bit, and
/// as much again to be on the safe side; a TGA's 128 pixels in two bytes; a GIF's 4096 in nine bits.
/// Lossless WebP, BMP, whose rows may be skipped, know no such bound.
fn most_pixels_a_byte(format: ImageFormat) -> u64 {
    match format {
        ImageFormat::Png => 8 * 1032,
        ImageFormat::Jpeg => 2 * 8 * 64,
        ImageFormat::Tga => 64,
        ImageFormat::Gif => 4096,
        _ => u64::MAX,
    }
}

/// Where a picture belongs, and so which formats it may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// To a glTF: what this and its extensions know.
    Gltf,
    /// To an OBJ, or to nothing.
    Other,
}

impl Origin {
    /// The formats in words.
    fn formats(self) -> &'static str {
        match self {
            Self::Gltf => "PNG, JPEG, WebP and KTX2 (Basis Universal)",
            Self::Other => "PNG, JPEG, WebP, KTX2 (Basis Universal), TGA, BMP and GIF",
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
    decode(&name, &bytes, Origin::Other, limits)
        .map_err(|trouble| trouble.into_error(path, Place::File, limits))
}

/// Decodes a picture in memory. `name` becomes the image's, and the errors', name.
///
/// # Errors
/// When it is of another format, is damaged, or is over the limits.
pub fn decode_image(name: &str, bytes: &[u8], limits: &Limits) -> Result<Image, FileError> {
    decode(name, bytes, Origin::Other, limits)
        .map_err(|trouble| trouble.into_error(Path::new(name), Place::File, limits))
}

/// The number of texels that a picture declares, if that is believable and within
/// the limits. Costs next to nothing.
pub(crate) fn texels(name: &str, bytes: &[u8], origin: Origin, limits: &Limits) -> Result<u64, ImageTrouble> {
    let (width, height) = if ktx2::is_ktx2(bytes) {
        let header = ktx2::header(bytes)?;
        within(header.width, header.height, limits)?;
        (header.width, header.height)
    } else {
        open(name, bytes, origin, limits)?.0.dimensions()
    };
    Ok(u64::from(width) * u64::from(height))
}

pub(crate) fn decode(
    name: &str,
    bytes: &[u8],
    origin: Origin,
    limits: &Limits,
) -> Result<Image, ImageTrouble> {
    if ktx2::is_ktx2(bytes) {
        let header = ktx2::header(bytes)?;
        within(header.width, header.height, limits)?;
        let pixels = ktx2::decode(bytes, header)?;
        let (width, height) = (header.width as usize, header.height as usize);
        return Ok(Image { name: name.into(), width, height, pixels });
    }
    let (decoder, format) = open(name, bytes, origin, limits)?;
    // The decoder would fill up what is missing with grey.
    if format == ImageFormat::Jpeg && !jpeg_has_end(bytes) {
        return Err(ImageTrouble::Damaged("the picture is cut off".into()));
    }
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    let pixels =
        guarded(|| rgba(decoder, width * height)).unwrap_or_else(|| Err(failed())).map_err(damaged)?;
    Ok(Image { name: name.into(), width, height, pixels })
}

/// Reads the header and holds it against the limits.
fn open<'b>(
    name: &str,
    bytes: &'b [u8],
    origin: Origin,
    limits: &Limits,
) -> Result<(impl ImageDecoder + use<'b>, ImageFormat), ImageTrouble> {
    let format = PictureFormat::of(name, bytes)
        .filter(|format| origin == Origin::Other || format.is_of_gltf())
        .and_then(PictureFormat::decoder)
        .ok_or(ImageTrouble::UnknownFormat(origin.formats()))?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(decoder_limits(limits.max_image_pixels));
    // None of these decoders is known to panic; what a stranger sent must not be what finds one that does.
    let mut decoder = guarded(|| reader.into_decoder()).unwrap_or_else(|| Err(failed())).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let pixels = within(width, height, limits)?;
    if pixels > most_pixels_a_byte(format).saturating_mul(bytes.len() as u64) {
        return Err(ImageTrouble::Damaged(format!(
            "the picture declares {width} × {height} pixels but has only {} bytes",
            bytes.len()
        )));
    }
    // A GIF's frame may be larger than the picture that it is put into.
    decoder.set_limits(decoder_limits(pixels)).map_err(damaged)?;
    Ok((decoder, format))
}

fn failed() -> ImageError {
    ImageError::IoError(std::io::Error::other("the decoder failed"))
}

/// The number of texels, if it is within the limits.
fn within(width: u32, height: u32, limits: &Limits) -> Result<u64, ImageTrouble> {
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
    Ok(pixels)
}

fn damaged(error: ImageError) -> ImageTrouble {
    ImageTrouble::Damaged(format!("the picture cannot be decoded: {}", shown(&tidy(&error))))
}

/// All pixels, with no more copies in memory than needed: textures are large.
fn rgba(decoder: impl ImageDecoder, count: usize) -> Result<Vec<[u8; 4]>, ImageError> {
    let wide = |high, low| ((u32::from(u16::from_ne_bytes([high, low])) + 128) / 257) as u8;
    match decoder.color_type() {
        ColorType::L8 => read(decoder, count, |[l]| [l, l, l, 255]),
        ColorType::La8 => read(decoder, count, |[l, a]| [l, l, l, a]),
        ColorType::Rgb8 => read(decoder, count, |[r, g, b]| [r, g, b, 255]),
        ColorType::Rgba8 => {
            let mut pixels = vec![[0; 4]; count];
            decoder.read_image(pixels.as_flattened_mut())?;
            Ok(pixels)
        }
        ColorType::L16 => read(decoder, count, |[l, m]| [wide(l, m), wide(l, m), wide(l, m), 255]),
        ColorType::La16 => {
            read(decoder, count, |[l, m, a, b]| [wide(l, m), wide(l, m), wide(l, m), wide(a, b)])
        }
        ColorType::Rgb16 => {
            read(decoder, count, |[r, s, g, h, b, c]| [wide(r, s), wide(g, h), wide(b, c), 255])
        }
        ColorType::Rgba16 => {
            read(decoder, count, |[r, s, g, h, b, c, a, d]| [wide(r, s), wide(g, h), wide(b, c), wide(a, d)])
        }
        // No decoder that we use gives anything else.
        _ => Ok(DynamicImage::from_decoder(decoder)?.into_rgba8().as_raw().as_chunks().0.to_vec()),
    }
}

/// Pixels of N bytes each, widened one by one.
fn read<const N: usize>(
    decoder: impl ImageDecoder,
    count: usize,
    widen: impl Fn([u8; N]) -> [u8; 4],
) -> Result<Vec<[u8; 4]>, ImageError> {
    let mut samples = vec![0; N * count];
    decoder.read_image(&mut samples)?;
    Ok(samples.as_chunks().0.iter().map(|&pixel| widen(pixel)).collect())
}

/// Whether a JPEG (ITU-T T.81, annex B) goes on to its end marker.
fn jpeg_has_end(bytes: &[u8]) -> bool {
    if bytes.trim_ascii_end().ends_with(&[0xff, 0xd9]) {
        return true;
    }
    let mut rest = bytes;
    while let Some(at) = rest.iter().position(|&b| b == 0xff) {
        rest = &rest[at + 1..];
        let Some(&code) = rest.first() else { return false };
        match code {
            0xd9 => return true,
            // Fill bytes, stuffed bytes, and markers that stand alone.
            0xff => {}
            0x00 | 0x01 | 0xd0..=0xd8 => rest = &rest[1..],
            // Segments may contain anything, a thumbnail with its own end too.
            _ => {
                let Some(&[high, low]) = rest[1..].first_chunk() else { return false };
                let end = 1 + usize::from(u16::from_be_bytes([high, low])).max(2);
                rest = rest.get(end..).unwrap_or_default();
            }
        }
    }
    false
}

/// The decoder's reason without the words around it, on one line.
fn tidy(error: &ImageError) -> String {
    let inner = std::error::Error::source(error).map(ToString::to_string);
    let text = inner.unwrap_or_else(|| error.to_string());
    let mut text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    // `ChunkType { type: IDAT, critical: true, … }` becomes `IDAT`.
    while let Some((before, rest)) = text.split_once("ChunkType { type: ") {
        let Some((inside, after)) = rest.split_once(" }") else { break };
        let name = inside.split(',').next().unwrap_or_default();
        text = format!("{before}{name}{after}");
    }
    text
}

/// Sizes are checked by us, so that the message can say what the limit is; the
/// decoder is told how much memory it may take: four 16-bit channels a texel,
/// and as much again for its own tables and rows.
fn decoder_limits(pixels: u64) -> image::Limits {
    let mut told = image::Limits::no_limits();
    told.max_alloc = Some(pixels.saturating_mul(16).saturating_add(64 << 20));
    told
}

#[cfg(test)]
#[path = "image_in_tests.rs"]
mod tests;
