//! Pictures of every kind, and none.

use super::*;
use crate::encode_png;
use image::codecs::{jpeg::JpegEncoder, png::PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

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

/// Protects textures beside OBJ files: the pictures come back in each format that only these have, a TGA is known by its name alone, and
/// limits and cut files are told as of all others.
#[test]
fn pictures_of_old_files_come_back() {
    let mut image = Image::solid("a", 33, 20, [9, 8, 7, 255]);
    image.pixels[4] = [200, 2, 3, 255];
    let written = |format: ImageFormat| {
        let bytes = image.pixels.as_flattened().to_vec();
        let picture = image::RgbaImage::from_raw(33, 20, bytes).unwrap();
        let mut file = Cursor::new(Vec::new());
        DynamicImage::from(picture).write_to(&mut file, format).unwrap();
        file.into_inner()
    };
    for (name, format) in [("a.TGA", ImageFormat::Tga), ("b", ImageFormat::Bmp), ("c", ImageFormat::Gif)] {
        let bytes = written(format);
        let read = decode_image(name, &bytes, &Limits::default()).unwrap();
        assert_eq!((read.width, read.height, &read.pixels), (33, 20, &image.pixels), "{name}");
        let limits = Limits { max_image_pixels: 600, ..Limits::default() };
        assert!(decode_image(name, &bytes, &limits).unwrap_err().to_string().contains("660"), "{name}");
        let error = decode_image(name, &bytes[..bytes.len() / 3], &Limits::default()).unwrap_err();
        assert!(error.to_string().contains("decoded") || error.to_string().contains("bytes"), "{error}");
        let of_gltf = decode(name, &bytes, Origin::Gltf, &Limits::default()).unwrap_err();
        assert!(
            matches!(of_gltf, ImageTrouble::UnknownFormat(formats) if !formats.contains("TGA")),
            "{name}"
        );
    }
    let unnamed = decode_image("a.png", &written(ImageFormat::Tga), &Limits::default()).unwrap_err();
    assert!(unnamed.to_string().contains("TGA"), "{unnamed}");
}

/// Protects memory: a GIF's frame may not be far larger than the picture that it says it is.
#[test]
fn frames_larger_than_their_gif_are_refused() {
    let picture = |width: u16| {
        let side = width.to_le_bytes();
        let head = [b"GIF89a".as_slice(), &[1, 0, 1, 0, 0x80, 0, 0], &[0, 0, 0, 255, 255, 255]].concat();
        // Cleared, one white pixel, ended: of codes of three bits.
        [head, vec![0x2c, 0, 0, 0, 0], side.to_vec(), side.to_vec(), vec![0, 2, 2, 0x4c, 1, 0, 0x3b]].concat()
    };
    let one = decode_image("a.gif", &picture(1), &Limits::default()).unwrap();
    assert_eq!(one.pixels, [[255; 4]]);
    let error = decode_image("a.gif", &picture(30_000), &Limits::default()).unwrap_err().to_string();
    assert!(error.contains("decoded") && error.to_lowercase().contains("limit"), "{error}");
}

/// Protects the messages about other formats and damaged files.
#[test]
fn other_bytes_are_named() {
    let error = decode_image("a.xyz", b"nonsense", &Limits::default()).unwrap_err().to_string();
    assert!(error.starts_with("a.xyz") && error.contains("WebP"), "{error}");
    let bytes = png(40, 40);
    let error = decode_image("b.png", &bytes[..60], &Limits::default()).unwrap_err().to_string();
    assert!(error.starts_with("b.png") && error.contains("decoded"), "{error}");
}

/// A red texel in a JPEG of cyan, magenta, yellow and black, as Adobe turns them over.
const CMYK: &str = "ffd8ffee000e41646f626500640000000000ffdb004300ffffffffffffffffffffffffffffffffffffffffffffffffff\
    ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffc000140800010001\
    044311004d11005911004b1100ffc40014000100000000000000000000000000000003ffc40014100100000000000000\
    000000000000000000ffda000e0443004d0059004b00003f00418c8fffd9";

/// A red texel in a progressive JPEG.
const PROGRESSIVE: &str = "ffd8ffe000104a46494600010100000100010000ffdb004300ffffffffffffffffffffffffffffffffffffffffffffff\
    ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffdb004301ffff\
    ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff\
    ffffffffffffffffffffffffffffffc20011080001000103012200021101031101ffc400150001010000000000000000\
    0000000000000001ffc4001501010100000000000000000000000000000102ffda000c0301000210031000000180afff\
    c40014100100000000000000000000000000000000ffda00080101000105027fffc40014110100000000000000000000\
    000000000000ffda0008010301013f017fffc40014110100000000000000000000000000000000ffda0008010201013f\
    017fffc40014100100000000000000000000000000000000ffda0008010100063f027fffc40014100100000000000000\
    000000000000000000ffda0008010100013f217fffda000c030100020003000000100bffc40014110100000000000000\
    000000000000000000ffda0008010301013f107fffc40014110100000000000000000000000000000000ffda00080102\
    01013f107fffc40014100100000000000000000000000000000000ffda0008010100013f107fffd9";

fn hex(digits: &str) -> Vec<u8> {
    let digits: Vec<u8> = digits.bytes().filter_map(|b| (b as char).to_digit(16)).map(|d| d as u8).collect();
    digits.as_chunks().0.iter().map(|[high, low]| high * 16 + low).collect()
}

/// Protects JPEGs of printers and of the web.
#[test]
fn cmyk_and_progressive_jpegs() {
    for digits in [CMYK, PROGRESSIVE] {
        let image = decode_image("a.jpg", &hex(digits), &Limits::default()).unwrap();
        let [r, g, b, a] = image.pixels[0];
        assert!(r > 220 && g < 35 && b < 35 && a == 255, "{:?}", image.pixels[0]);
    }
}

/// Protects the widening of each sample format, 16 bits rounded to the nearest 8.
#[test]
fn every_sample_format_becomes_rgba() {
    let wide = |values: &[u16]| values.iter().flat_map(|v| v.to_ne_bytes()).collect::<Vec<u8>>();
    for (kind, samples, expected) in [
        (ExtendedColorType::L8, vec![7], [7, 7, 7, 255]),
        (ExtendedColorType::La8, vec![7, 8], [7, 7, 7, 8]),
        (ExtendedColorType::Rgb8, vec![1, 2, 3], [1, 2, 3, 255]),
        (ExtendedColorType::Rgba8, vec![1, 2, 3, 4], [1, 2, 3, 4]),
        (ExtendedColorType::L16, wide(&[0x8101]), [0x81, 0x81, 0x81, 255]),
        (ExtendedColorType::La16, wide(&[0x807f, 0xffff]), [0x80, 0x80, 0x80, 255]),
        (ExtendedColorType::Rgb16, wide(&[0, 257, 514]), [0, 1, 2, 255]),
        (ExtendedColorType::Rgba16, wide(&[257, 514, 771, 1028]), [1, 2, 3, 4]),
    ] {
        let mut bytes = Vec::new();
        PngEncoder::new(&mut bytes).write_image(&samples, 1, 1, kind).unwrap();
        let image = decode_image("a", &bytes, &Limits::default()).unwrap();
        assert_eq!(image.pixels, [expected], "{kind:?}");
    }
}

/// Protects bakes from pictures of which a download has brought only a part.
#[test]
fn cut_jpegs_are_refused() {
    let mut bytes = Vec::new();
    let samples: Vec<u8> = (0..64 * 64).map(|i| (i * i % 251) as u8).collect();
    JpegEncoder::new(&mut bytes).write_image(&samples, 64, 64, ExtendedColorType::L8).unwrap();
    let read = |bytes: &[u8]| decode_image("a.jpg", bytes, &Limits::default()).map_err(|e| e.to_string());
    assert_eq!(read(&bytes).unwrap().pixels.len(), 64 * 64);
    let padded = [bytes.as_slice(), &[0; 100]].concat();
    assert!(read(&padded).is_ok(), "what follows the end does no harm");
    for length in [bytes.len() / 2, bytes.len() - 2] {
        assert_eq!(read(&bytes[..length]).unwrap_err(), "a.jpg: the picture is cut off");
    }
    // A thumbnail's end is not the picture's.
    let thumbnail = [&[0xff, 0xe1, 0, 6], [0xff, 0xd9].as_slice(), &[0, 0]].concat();
    let with = [&bytes[..2], &thumbnail, &bytes[2..]].concat();
    assert!(read(&with).is_ok());
    assert!(read(&with[..with.len() - 2]).unwrap_err().contains("cut off"));
}

/// Protects messages from the decoder's own notation.
#[test]
fn reasons_are_readable() {
    let mut bytes = png(40, 40);
    let last = bytes.len() - 20;
    bytes[last] ^= 1;
    let error = decode_image("a.png", &bytes, &Limits::default()).unwrap_err().to_string();
    assert!(!error.contains("ChunkType") && !error.contains("Format error"), "{error}");
}
