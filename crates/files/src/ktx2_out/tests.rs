//! Files by the letter of the specification, and back through our own reader.

use super::mips::tests::foliage;
use super::*;
use crate::{Limits, decode_image};
use basisu::{DecodeFlags, TargetFormat, Transcoder};

fn word(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

fn long(bytes: &[u8], at: usize) -> usize {
    usize::try_from(u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())).unwrap()
}

fn opaque(size: usize) -> Image {
    let mut image = foliage(size);
    image.pixels.iter_mut().for_each(|p| p[3] = 255);
    image
}

const CODECS: [Codec; 2] = [Codec::Etc1s(200), Codec::Uastc { careful: false }];

/// Protects readers that go by the specification: places, lengths, order and alignment of all parts.
#[test]
fn parts_are_where_the_header_says() {
    for (image, samples) in [(opaque(48), 1), (foliage(48), 2)] {
        for codec in CODECS {
            let file = encode(&image, Content::Color, None, codec).unwrap();
            let is_etc1s = codec == CODECS[0];
            let head: Vec<usize> = (0..9).map(|i| word(&file, 12 + 4 * i)).collect();
            assert_eq!(head, [0, 1, 48, 48, 0, 0, 1, 6, if is_etc1s { 1 } else { 2 }]);
            let [descriptor, length, values, values_length] = [48, 52, 56, 60].map(|at| word(&file, at));
            let samples = if is_etc1s { samples } else { 1 };
            assert_eq!(
                (descriptor, length, word(&file, descriptor)),
                (80 + 6 * 24, 28 + 16 * samples, length)
            );
            assert_eq!(values, descriptor + length);
            let text = b"\x12\0\0\0KTXorientation\0rd\0\0\0";
            assert_eq!(&file[values..values + text.len()], text);
            let (global, global_length) = (long(&file, 64), long(&file, 72));
            let mut end = values + values_length;
            if is_etc1s {
                assert_eq!(global, end.next_multiple_of(8));
                end = global + global_length;
            } else {
                assert_eq!((global, global_length), (0, 0));
            }
            // The smallest level comes first, and the largest ends the file.
            for level in (0..6).rev() {
                let [place, length, whole] = [0, 8, 16].map(|at| long(&file, 80 + 24 * level + at));
                assert_eq!(place, end);
                let blocks = (48usize >> level).div_ceil(4).pow(2);
                assert_eq!(whole, if is_etc1s { 0 } else { 16 * blocks });
                assert!(is_etc1s || level > 0 || length < whole, "{length} {whole}");
                end = place + length;
            }
            assert_eq!(end, file.len());
        }
    }
}

/// Protects the look of colours and of numbers: transfer and primaries are what glTF asks for.
#[test]
fn descriptors_say_what_texels_are() {
    let of = |image: &Image, content, codec| {
        let file = encode(image, content, None, codec).unwrap();
        let at = word(&file, 48);
        (word(&file, at + 12), word(&file, at + 20), file[at + 31])
    };
    let (plain, alpha) = (opaque(16), foliage(16));
    let [etc1s, uastc] = CODECS;
    let kinds = |model: usize, primaries: usize, transfer: usize| model | primaries << 8 | transfer << 16;
    assert_eq!(of(&plain, Content::Color, etc1s), (kinds(163, 1, 2), 0, 0));
    assert_eq!(of(&plain, Content::Color, uastc), (kinds(166, 1, 2), 16, 0));
    assert_eq!(of(&alpha, Content::Color, uastc), (kinds(166, 1, 2), 16, 3));
    assert_eq!(of(&plain, Content::Normal, uastc), (kinds(166, 0, 1), 16, 0));
    assert_eq!(of(&plain, Content::Values, etc1s), (kinds(163, 0, 1), 0, 0));
}

fn psnr(one: &[[u8; 4]], other: &[[u8; 4]]) -> f64 {
    let pairs = one.as_flattened().iter().zip(other.as_flattened());
    let sum: u64 = pairs.map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2)).sum();
    20.0 * 255f64.log10() - 10.0 * (sum.max(1) as f64 / (4 * one.len()) as f64).log10()
}

/// Protects pictures: our reader shows the largest level, the transcoder every level; each as it was, with alpha.
#[test]
fn every_level_comes_back() {
    for image in [opaque(64), foliage(64)] {
        for codec in CODECS {
            let file = encode(&image, Content::Color, Some(0.5), codec).unwrap();
            let shown = decode_image("leaf", &file, &Limits::default()).unwrap();
            let least = if codec == CODECS[0] { 27.0 } else { 33.0 };
            assert!(
                psnr(&shown.pixels, &image.pixels) > least,
                "{codec:?} {}",
                psnr(&shown.pixels, &image.pixels)
            );
            let transcoder = Transcoder::new(&file).unwrap();
            for (number, level) in mips::levels(&image, Content::Color, Some(0.5)).iter().enumerate() {
                let texels =
                    transcoder.transcode(number as u32, TargetFormat::Rgba32, DecodeFlags::NONE).unwrap();
                let figure = psnr(texels.as_chunks().0, &level.pixels);
                assert!(figure > least - 7.0, "{codec:?} level {number}: {figure}");
            }
        }
    }
}

/// Protects foliage in what viewers decode, not only in what was encoded.
#[test]
fn coverage_is_kept_through_the_codec() {
    let image = foliage(256);
    let coverage =
        |texels: &[[u8; 4]]| texels.iter().filter(|p| p[3] >= 128).count() as f64 / texels.len() as f64;
    for (codec, most) in CODECS.into_iter().zip([0.05, 0.015]) {
        let file = encode(&image, Content::Color, Some(0.5), codec).unwrap();
        let transcoder = Transcoder::new(&file).unwrap();
        for level in 0..5 {
            let texels = transcoder.transcode(level, TargetFormat::Rgba32, DecodeFlags::NONE).unwrap();
            let difference = (coverage(texels.as_chunks().0) - coverage(&image.pixels)).abs();
            assert!(difference < most, "{codec:?} level {level}: {difference}");
        }
    }
}

/// Protects reproducible files: neither codec's bytes depend on the number of threads.
#[test]
fn bytes_do_not_depend_on_threads() {
    let image = foliage(300);
    for codec in CODECS {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| encode(&image, Content::Color, Some(0.5), codec).unwrap())
        };
        let one = with(1);
        assert!(one == with(2) && one == with(5), "{codec:?}");
    }
}

/// Protects from sides that glTF forbids, and from an encoder that trusts what it is told.
#[test]
fn what_does_not_fit_is_refused() {
    let [_, uastc] = CODECS;
    for (width, height) in [(6, 4), (4, 2), (0, 4), (4, 16_388)] {
        let image = Image::solid("a", width, height, [1; 4]);
        assert!(!fits(&image) && encode(&image, Content::Color, None, uastc).is_none(), "{width} × {height}");
    }
    let mut broken = Image::solid("a", 8, 8, [1; 4]);
    broken.pixels.pop();
    assert!(encode(&broken, Content::Color, None, uastc).is_none());
}
