//! Pictures as `data:` addresses, so that the page needs no other file.
//!
//! Contract: PNG, lossless for pictures of at most [`LARGEST`] pixels along a side and
//! [`MOST_BYTES`]; others are averaged down by a whole factor until they are, so that
//! the page stays small whatever the textures.

use crate::page::base64;
use parbake_files::FileError;
use parbake_metric::Rgb;
use parbake_model::Image;

/// Longest side of an embedded picture.
const LARGEST: usize = 1024;
/// Most bytes of its PNG. A texture of 512 × 512 stays below even if it is all noise.
const MOST_BYTES: usize = 1_000_000;

/// A picture ready for an `src` attribute.
pub struct Embedded {
    /// `data:image/png;base64,…`
    pub address: String,
    /// Pixels as embedded.
    pub width: usize,
    /// Rows as embedded.
    pub height: usize,
}

/// Embeds a texture, opaque: alpha would hide colours that a renderer does show.
pub fn embed(image: &Image) -> Result<Embedded, FileError> {
    let mut factor = image.width.max(image.height).div_ceil(LARGEST).max(1);
    loop {
        let mut small = reduced(image, factor);
        for pixel in &mut small.pixels {
            pixel[3] = 255;
        }
        let png = parbake_files::encode_png(&small)?;
        if png.len() > MOST_BYTES && small.width.max(small.height) > 1 {
            factor *= 2;
            continue;
        }
        let mut address = String::from("data:image/png;base64,");
        base64(&png, &mut address);
        return Ok(Embedded { address, width: small.width, height: small.height });
    }
}

/// Embeds a rendered picture.
pub fn embed_rgb(name: &str, picture: &Rgb) -> Result<Embedded, FileError> {
    let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    let pixels = picture.pixels.iter().map(|&[r, g, b]| [byte(r), byte(g), byte(b), 255]).collect();
    embed(&Image { name: name.into(), width: picture.width, height: picture.height, pixels })
}

/// `|a − b|` of two pictures of equal size, so many times as strong, clipped to 1.
pub fn amplified_difference(a: &Rgb, b: &Rgb, times: f32) -> Rgb {
    let pixels = (a.pixels.iter().zip(&b.pixels))
        .map(|(a, b)| [0, 1, 2].map(|k| ((a[k] - b[k]).abs() * times).min(1.0)))
        .collect();
    Rgb { width: a.width, height: a.height, pixels }
}

/// Each pixel the mean of `factor`² (fewer at the far borders).
fn reduced(image: &Image, factor: usize) -> Image {
    if factor == 1 {
        return image.clone();
    }
    let (width, height) = (image.width.div_ceil(factor), image.height.div_ceil(factor));
    let mut pixels = Vec::with_capacity(width * height);
    for y in 0..height {
        let rows = y * factor..((y + 1) * factor).min(image.height);
        for x in 0..width {
            let columns = x * factor..((x + 1) * factor).min(image.width);
            let (mut sums, count) = ([0u32; 4], (rows.len() * columns.len()) as u32);
            for row in rows.clone() {
                for pixel in &image.pixels[row * image.width..][columns.clone()] {
                    (0..4).for_each(|k| sums[k] += u32::from(pixel[k]));
                }
            }
            pixels.push(sums.map(|s| ((s + count / 2) / count) as u8));
        }
    }
    Image { name: image.name.clone(), width, height, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects large textures: the mean is right and the far border is kept.
    #[test]
    fn large_pictures_are_averaged() {
        let mut image = Image::solid("a", 3, 2, [10, 20, 30, 255]);
        image.pixels[1] = [20, 20, 30, 255];
        let small = reduced(&image, 2);
        assert_eq!((small.width, small.height), (2, 1));
        assert_eq!(small.pixels, [[13, 20, 30, 255], [10, 20, 30, 255]]);
        let embedded = embed(&Image::solid("b", 2100, 5, [0; 4])).unwrap();
        assert_eq!((embedded.width, embedded.height), (700, 2));
        assert!(embedded.address.starts_with("data:image/png;base64,iVBORw0KGgo"));
    }

    /// Protects the amplification that pages state.
    #[test]
    fn differences_are_amplified_and_clipped() {
        let of = |v| Rgb { width: 1, height: 1, pixels: vec![v] };
        let d = amplified_difference(&of([0.5, 0.1, 1.0]), &of([0.25, 0.2, 0.0]), 4.0);
        assert_eq!(d.pixels[0][0], 1.0);
        assert!((d.pixels[0][1] - 0.4).abs() < 1e-6);
        assert_eq!(d.pixels[0][2], 1.0);
    }

    /// Protects the page's size from textures that no PNG makes small.
    #[test]
    fn noise_is_averaged_down() {
        let mut image = Image::solid("noise", 1024, 1024, [0; 4]);
        let mut state = 1u32;
        for pixel in &mut image.pixels {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *pixel = state.to_be_bytes();
        }
        let embedded = embed(&image).unwrap();
        assert_eq!(embedded.width, 512);
        assert!(embedded.address.len() < MOST_BYTES * 4 / 3 + 100);
    }
}
