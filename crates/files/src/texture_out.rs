//! Textures of a GLB file out, in the format that was asked for, with what that lost.
//!
//! Textures that only viewers without parallax maps see are JPEG where others are lossless: a third of PNG's bytes, for
//! 0.1 dB at 35 (mask's fallback of 256², quality 90 to 93).
//!
//! Contract: what a format cannot hold (alpha in JPEG, sides of 30 texels in KTX2) is written as PNG, and the
//! result says so and why.

use crate::image_out::{Raw, encode_png, pack_png, refuse};
use crate::ktx2_out::{self, Codec, Content};
use crate::write_options::{LEAST_DATA_QUALITY, TextureFormat, WriteOptions};
use crate::{FileError, Limits, decode_image};
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};
use parbake_model::Image;
use webp::{Encoder, WebPConfig};

/// What a texture is used for, which bounds what it may lose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    /// Seen as it is: base colour, emission.
    Color,
    /// Input of shading: normals, metal, roughness, occlusion.
    Data,
    /// Coefficients, of which every bit counts.
    Exact,
    /// Base colour or normals that only viewers without parallax maps see: coarse, and not worth many bytes.
    Fallback,
}

/// What is known of a texture from the materials that have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Purpose {
    pub of: Use,
    /// What its numbers are, for mip levels.
    pub content: Content,
    /// The alpha from which on a material shows anything, if one cuts out by this texture.
    pub cutoff: Option<f32>,
}

/// An encoded texture.
pub(crate) struct Encoded {
    pub bytes: Vec<u8>,
    pub format: TextureFormat,
    /// As in [`crate::WrittenTexture`].
    pub psnr: Option<f64>,
    /// As in [`crate::WrittenTexture`].
    pub reason: Option<String>,
}

/// The longest side of a WebP picture.
const LONGEST_WEBP: usize = 16_383;

/// Quality from which on UASTC's encoder takes its time: for 0.2 to 0.4 dB, twice as long.
const CAREFUL: u8 = 96;

/// Encodes a texture.
///
/// # Errors
/// As [`crate::encode_png`].
pub(crate) fn encode_texture(
    image: &Image,
    purpose: Purpose,
    options: &WriteOptions,
) -> Result<Encoded, FileError> {
    let raw = Raw::new(image)?;
    let is_normal = purpose.content == Content::Normal;
    let of_fallback = purpose.of == Use::Fallback && raw.opaque;
    let format = match options.texture_format {
        TextureFormat::Png | TextureFormat::WebpLossless if of_fallback => TextureFormat::Jpeg,
        // It would halve the chroma of normals.
        TextureFormat::Webp if of_fallback && is_normal => TextureFormat::Jpeg,
        format => format,
    };
    let reason = (format != options.texture_format).then(|| "for viewers without parallax maps".into());
    if let Some(reason) = misfit(image, &raw, purpose.of, format) {
        return Ok(Encoded { reason: Some(reason), ..png(image, options)? });
    }
    let least = if purpose.of == Use::Data { LEAST_DATA_QUALITY } else { 1 };
    let quality = options.texture_quality.clamp(least, 100);
    let with = |texture_format| WriteOptions { texture_format, ..*options };
    let bytes = match format {
        TextureFormat::Png => return png(image, options),
        TextureFormat::Jpeg => jpeg(image, &raw, quality)?,
        TextureFormat::Webp if purpose.of == Use::Data => {
            // It has chroma at half the resolution: a baked normal map would be left with 27 dB.
            return encode_texture(image, purpose, &with(TextureFormat::WebpLossless));
        }
        TextureFormat::Webp => webp(image, &raw, Some(quality))?,
        TextureFormat::WebpLossless => webp(image, &raw, None)?,
        TextureFormat::Ktx2 => ktx2(image, purpose, uastc(options))?,
        TextureFormat::Ktx2Etc1s if purpose.of == Use::Data || is_normal => {
            // One hue a block is too little for normals: 12 dB less.
            return encode_texture(image, purpose, &with(TextureFormat::Ktx2));
        }
        TextureFormat::Ktx2Etc1s => {
            // 1 to 100 onto the codec's own 1 to 255.
            let quality = 1 + (u32::from(quality) - 1) * 254 / 99;
            ktx2(image, purpose, Codec::Etc1s(quality))?
        }
    };
    let shown = decode_image(&image.name, &bytes, &Limits::default())?;
    Ok(Encoded { bytes, format, psnr: psnr(image, &shown), reason })
}

/// Why a picture cannot be in a format.
fn misfit(image: &Image, raw: &Raw, of: Use, format: TextureFormat) -> Option<String> {
    let (width, height) = (image.width, image.height);
    match format {
        TextureFormat::Png => None,
        TextureFormat::Webp | TextureFormat::WebpLossless if width.max(height) > LONGEST_WEBP => {
            Some(format!("WebP has sides of up to {LONGEST_WEBP} texels"))
        }
        TextureFormat::WebpLossless => None,
        _ if of == Use::Exact => Some("every bit of it counts".into()),
        TextureFormat::Jpeg if !raw.opaque => Some("JPEG has no alpha".into()),
        TextureFormat::Ktx2 | TextureFormat::Ktx2Etc1s if !ktx2_out::fits(image) => Some(format!(
            "KTX2 in glTF has sides of 4, 8, 12 and so on up to {} texels, this one has {width} × {height}",
            ktx2_out::LONGEST_SIDE
        )),
        _ => None,
    }
}

fn png(image: &Image, options: &WriteOptions) -> Result<Encoded, FileError> {
    let bytes = if options.is_urgent { encode_png(image)? } else { pack_png(image)? };
    Ok(Encoded { bytes, format: TextureFormat::Png, psnr: None, reason: None })
}

fn jpeg(image: &Image, raw: &Raw, quality: u8) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality)
        .write_image(&raw.samples, raw.width, raw.height, ExtendedColorType::Rgb8)
        .map_err(|e| refuse(image, format!("cannot be encoded as JPEG: {e}")))?;
    Ok(bytes)
}

/// Without a quality, lossless.
fn webp(image: &Image, raw: &Raw, quality: Option<u8>) -> Result<Vec<u8>, FileError> {
    let failed = |reason: &str| refuse(image, format!("cannot be encoded as WebP: {reason}"));
    let mut config = WebPConfig::new().map_err(|()| failed("the encoder has another version"))?;
    match quality {
        Some(quality) => config.quality = f32::from(quality),
        None => {
            config.lossless = 1;
            // Effort: a second at 1024², for nearly all that ten seconds gain.
            (config.quality, config.method) = (90.0, 5);
        }
    }
    config.alpha_quality = 100;
    // Colours beside and under what is transparent are seen where textures are filtered.
    config.exact = 1;
    // Chroma at half the resolution is the format's; this sharpens what is made of it.
    config.use_sharp_yuv = 1;
    let encoder = match raw.opaque {
        true => Encoder::from_rgb(&raw.samples, raw.width, raw.height),
        false => Encoder::from_rgba(&raw.samples, raw.width, raw.height),
    };
    Ok(encoder.encode_advanced(&config).map_err(|e| failed(&format!("{e:?}")))?.to_vec())
}

fn uastc(options: &WriteOptions) -> Codec {
    Codec::Uastc { careful: options.texture_quality >= CAREFUL }
}

fn ktx2(image: &Image, purpose: Purpose, codec: Codec) -> Result<Vec<u8>, FileError> {
    ktx2_out::encode(image, purpose.content, purpose.cutoff, codec)
        .ok_or_else(|| refuse(image, "cannot be encoded as KTX2: the Basis Universal encoder failed".into()))
}

/// Over red, green and blue, and over alpha where there is any; none where both are alike.
fn psnr(one: &Image, other: &Image) -> Option<f64> {
    let has_alpha = [one, other].iter().any(|image| image.pixels.iter().any(|p| p[3] != 255));
    let channels = if has_alpha { 4 } else { 3 };
    let pairs = one.pixels.iter().zip(&other.pixels).flat_map(|(a, b)| (0..channels).map(|c| (a[c], b[c])));
    let sum: u64 = pairs.map(|(a, b)| u64::from(a.abs_diff(b)).pow(2)).sum();
    let mean = sum as f64 / (channels * one.pixels.len().max(1)) as f64;
    (sum > 0).then(|| 20.0 * 255f64.log10() - 10.0 * mean.log10())
}

#[cfg(test)]
#[path = "texture_out_tests.rs"]
mod tests;
