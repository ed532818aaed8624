//! Textures of a GLB file out, in the format that was asked for, with what that lost.
//!
//! Contract: what a format cannot hold (alpha in JPEG) is written as PNG, and the media type says so.

use crate::image_out::{Raw, pack_png, refuse};
use crate::write_options::{LEAST_DATA_QUALITY, TextureFormat, WriteOptions};
use crate::{FileError, Limits, decode_image};
use image::codecs::jpeg::JpegEncoder;
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder};
use parbake_model::Image;

/// What a texture is used for, which bounds what it may lose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    /// Seen as it is: base colour, emission.
    Color,
    /// Input of shading: normals, metal, roughness, occlusion.
    Data,
    /// Coefficients, of which every bit counts.
    Exact,
}

/// An encoded texture.
pub(crate) struct Encoded {
    pub bytes: Vec<u8>,
    pub mime_type: &'static str,
    /// As in [`crate::WrittenTexture`].
    pub psnr: Option<f64>,
}

/// Encodes a texture.
///
/// # Errors
/// As [`crate::encode_png`].
pub(crate) fn encode_texture(image: &Image, of: Use, options: &WriteOptions) -> Result<Encoded, FileError> {
    match (options.texture_format, of) {
        (TextureFormat::Jpeg, Use::Color | Use::Data) => {
            let raw = Raw::new(image)?;
            if raw.opaque {
                let least = if of == Use::Data { LEAST_DATA_QUALITY } else { 1 };
                return jpeg(image, &raw, options.texture_quality.clamp(least, 100));
            }
            png(image)
        }
        (TextureFormat::Webp, _) => webp(image),
        _ => png(image),
    }
}

fn png(image: &Image) -> Result<Encoded, FileError> {
    Ok(Encoded { bytes: pack_png(image)?, mime_type: "image/png", psnr: None })
}

fn jpeg(image: &Image, raw: &Raw, quality: u8) -> Result<Encoded, FileError> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .write_image(&raw.samples, raw.width, raw.height, ExtendedColorType::Rgb8)
        .map_err(|e| refuse(image, format!("cannot be encoded as JPEG: {e}")))?;
    let shown = decode_image(&image.name, &bytes, &Limits::default())?;
    Ok(Encoded { bytes, mime_type: "image/jpeg", psnr: psnr(image, &shown) })
}

fn webp(image: &Image) -> Result<Encoded, FileError> {
    let Raw { width, height, samples, opaque } = Raw::new(image)?;
    let kind = if opaque { ExtendedColorType::Rgb8 } else { ExtendedColorType::Rgba8 };
    let mut bytes = Vec::new();
    WebPEncoder::new_lossless(&mut bytes)
        .write_image(&samples, width, height, kind)
        .map_err(|e| refuse(image, format!("cannot be encoded as WebP: {e}")))?;
    Ok(Encoded { bytes, mime_type: "image/webp", psnr: None })
}

/// Over red, green and blue, since no alpha is lossy; none where both are alike.
fn psnr(one: &Image, other: &Image) -> Option<f64> {
    let channels = one.pixels.iter().zip(&other.pixels).flat_map(|(a, b)| (0..3).map(|c| (a[c], b[c])));
    let sum: u64 = channels.map(|(a, b)| u64::from(a.abs_diff(b)).pow(2)).sum();
    let mean = sum as f64 / (3 * one.pixels.len().max(1)) as f64;
    (sum > 0).then(|| 20.0 * 255f64.log10() - 10.0 * mean.log10())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshCompression;

    fn options(texture_format: TextureFormat, texture_quality: u8) -> WriteOptions {
        WriteOptions { texture_format, texture_quality, mesh_compression: MeshCompression::None }
    }

    fn picture() -> Image {
        let mut image = Image::solid("a", 64, 64, [0, 0, 0, 255]);
        for (i, p) in image.pixels.iter_mut().enumerate() {
            let (x, y) = ((i % 64) as f32, (i / 64) as f32);
            let wave = |f: f32| (127.5 + 120.0 * (f * x).sin() * (0.5 * f * y).cos()) as u8;
            *p = [wave(0.1), wave(0.2), wave(0.3), 255];
        }
        image
    }

    /// Protects the figure of loss, and the order of qualities.
    #[test]
    fn jpeg_says_what_it_lost() {
        let image = picture();
        let at =
            |quality| encode_texture(&image, Use::Color, &options(TextureFormat::Jpeg, quality)).unwrap();
        let (low, high) = (at(30), at(95));
        assert!(low.bytes.len() < high.bytes.len());
        assert!(low.psnr.unwrap() < high.psnr.unwrap() && high.psnr.unwrap() > 35.0);
        assert_eq!(high.mime_type, "image/jpeg");
    }

    /// Protects data maps and coefficients from low qualities, and alpha from JPEG.
    #[test]
    fn what_must_not_be_lost_is_kept() {
        let mut image = picture();
        let write = |image: &Image, of| encode_texture(image, of, &options(TextureFormat::Jpeg, 10)).unwrap();
        assert!(write(&image, Use::Data).psnr.unwrap() > write(&image, Use::Color).psnr.unwrap() + 3.0);
        assert_eq!(write(&image, Use::Exact).mime_type, "image/png");
        image.pixels[0][3] = 9;
        assert_eq!(write(&image, Use::Color).mime_type, "image/png");
    }

    /// Protects the promise that WebP loses nothing, with and without alpha.
    #[test]
    fn webp_is_lossless() {
        let mut image = picture();
        for alpha in [255, 7] {
            image.pixels[5][3] = alpha;
            let out = encode_texture(&image, Use::Data, &options(TextureFormat::Webp, 1)).unwrap();
            assert_eq!(decode_image("a", &out.bytes, &Limits::default()).unwrap(), image);
            assert_eq!(out.psnr, None);
        }
    }
}
