//! What is lost in each format, and what is not.

use super::*;

const COLOR: Purpose = Purpose { of: Use::Color, content: Content::Color, cutoff: None };
const NORMAL: Purpose = Purpose { of: Use::Data, content: Content::Normal, cutoff: None };
const EXACT: Purpose = Purpose { of: Use::Exact, content: Content::Values, cutoff: None };

const FALLBACK: Purpose = Purpose { of: Use::Fallback, content: Content::Normal, cutoff: None };

fn write(image: &Image, purpose: Purpose, (texture_format, texture_quality): (TextureFormat, u8)) -> Encoded {
    let options = WriteOptions { texture_format, texture_quality, ..WriteOptions::default() };
    encode_texture(image, purpose, &options).unwrap()
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
fn lossy_formats_say_what_they_lost() {
    let image = picture();
    for format in [TextureFormat::Jpeg, TextureFormat::Webp, TextureFormat::Ktx2Etc1s] {
        let (low, high) = (write(&image, COLOR, (format, 10)), write(&image, COLOR, (format, 95)));
        assert!(low.bytes.len() < high.bytes.len(), "{format:?}");
        let [low_psnr, high_psnr] = [&low, &high].map(|texture| texture.psnr.unwrap());
        // ETC1S has one hue a block; this picture has none.
        let least = if format == TextureFormat::Ktx2Etc1s { 23.0 } else { 32.0 };
        assert!(low_psnr < high_psnr && high_psnr > least, "{format:?} {low_psnr} {high_psnr}");
        assert_eq!((high.format, high.reason), (format, None));
        let shown = decode_image("a", &high.bytes, &Limits::default()).unwrap();
        assert_eq!(psnr(&image, &shown), high.psnr);
    }
    let best = write(&image, COLOR, (TextureFormat::Ktx2, 50)).psnr.unwrap();
    assert!(best > 36.0, "{best}");
}

/// Protects data maps and coefficients from low qualities, and alpha from formats without it.
#[test]
fn what_must_not_be_lost_is_kept() {
    let mut image = picture();
    for format in [TextureFormat::Jpeg, TextureFormat::Webp, TextureFormat::Ktx2Etc1s] {
        let loss = |purpose| write(&image, purpose, (format, 10)).psnr.unwrap_or(f64::INFINITY);
        assert!(loss(NORMAL) > loss(COLOR) + 3.0, "{format:?}");
        let exact = write(&image, EXACT, (format, 10));
        assert_eq!((exact.format, exact.psnr), (TextureFormat::Png, None));
        assert_eq!(exact.reason.as_deref(), Some("every bit of it counts"));
    }
    assert_eq!(write(&image, NORMAL, (TextureFormat::Ktx2Etc1s, 10)).format, TextureFormat::Ktx2);
    assert_eq!(write(&image, NORMAL, (TextureFormat::Webp, 10)).format, TextureFormat::WebpLossless);
    image.pixels[0][3] = 9;
    let stays = write(&image, COLOR, (TextureFormat::Jpeg, 10));
    assert_eq!((stays.format, stays.reason.as_deref()), (TextureFormat::Png, Some("JPEG has no alpha")));
}

/// Protects what is cut out: lossy WebP keeps alpha, and colours that show once textures are filtered.
#[test]
fn lossy_webp_keeps_alpha() {
    let mut image = picture();
    image
        .pixels
        .iter_mut()
        .enumerate()
        .for_each(|(i, p)| p[3] = if i % 64 < 32 { 0 } else { (i % 251) as u8 });
    let out = write(&image, COLOR, (TextureFormat::Webp, 60));
    let shown = decode_image("a", &out.bytes, &Limits::default()).unwrap();
    assert!(image.pixels.iter().zip(&shown.pixels).all(|(a, b)| a[3] == b[3]));
    let hidden = |image: &Image| image.pixels.iter().map(|p| u64::from(p[2])).step_by(64).sum::<u64>();
    assert!(hidden(&image).abs_diff(hidden(&shown)) < 64 * 12, "{} {}", hidden(&image), hidden(&shown));
}

/// Protects the promise that lossless WebP loses nothing, with and without alpha.
#[test]
fn webp_is_lossless_where_it_says_so() {
    let mut image = picture();
    for alpha in [255, 7] {
        image.pixels[5][3] = alpha;
        let out = write(&image, NORMAL, (TextureFormat::WebpLossless, 1));
        assert_eq!(decode_image("a", &out.bytes, &Limits::default()).unwrap(), image);
        assert_eq!((out.psnr, out.format), (None, TextureFormat::WebpLossless));
        assert!(out.bytes.len() < write(&image, NORMAL, (TextureFormat::Png, 1)).bytes.len());
    }
}

/// Protects KTX2's readers from sides that the extension forbids, and users from silence about it.
#[test]
fn sides_that_ktx2_cannot_have_stay_png() {
    let image = Image { height: 63, pixels: picture().pixels[64..].to_vec(), ..picture() };
    let out = write(&image, COLOR, (TextureFormat::Ktx2, 92));
    assert_eq!(out.format, TextureFormat::Png);
    assert!(out.reason.unwrap().contains("this one has 64 × 63"));
}

/// Protects the size of files with parallax maps, and pictures of viewers that do not know them: what those see alone is
/// JPEG where other textures are lossless, but not where it has alpha.
#[test]
fn fallbacks_are_small() {
    let mut image = picture();
    for format in [TextureFormat::Png, TextureFormat::WebpLossless, TextureFormat::Webp] {
        let written = write(&image, FALLBACK, (format, 92));
        assert_eq!(written.format, TextureFormat::Jpeg, "{format:?}");
        assert!(written.psnr.unwrap() > 32.0 && written.reason.is_some());
    }
    let colors = Purpose { content: Content::Color, ..FALLBACK };
    assert_eq!(write(&image, colors, (TextureFormat::Webp, 92)).format, TextureFormat::Webp);
    assert_eq!(write(&image, FALLBACK, (TextureFormat::Ktx2Etc1s, 92)).format, TextureFormat::Ktx2);
    image.pixels[0][3] = 9;
    let stays = write(&image, FALLBACK, (TextureFormat::Png, 92));
    assert_eq!((stays.format, stays.psnr, stays.reason), (TextureFormat::Png, None, None));
}

/// Protects who interrupts a run: what is written at once has the same texels.
#[test]
fn urgent_textures_have_the_same_texels() {
    let image = picture();
    let texels = |is_urgent| {
        let options = WriteOptions { is_urgent, ..WriteOptions::default() };
        let encoded = encode_texture(&image, COLOR, &options).unwrap();
        assert_eq!((encoded.format, encoded.psnr), (TextureFormat::Png, None));
        (decode_image("a", &encoded.bytes, &Limits::default()).unwrap(), encoded.bytes)
    };
    let [(urgent, fast), (patient, small)] = [true, false].map(texels);
    assert!(urgent == image && patient == image && fast != small);
}
