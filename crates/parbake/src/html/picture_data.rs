//! Pictures as `data:` addresses, so that the page needs no other file.
//!
//! Contract: PNG, lossless for pictures up to [`LARGEST`] along each side; larger
//! ones are averaged down by a whole factor.

use super::base64;
use crate::error::BakeError;
use parbake_metric::Rgb;
use parbake_model::Image;

/// Longest side of an embedded picture.
pub const LARGEST: usize = 1024;

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
pub fn embed(image: &Image) -> Result<Embedded, BakeError> {
    let mut image = reduced(image, image.width.max(image.height).div_ceil(LARGEST).max(1));
    for pixel in &mut image.pixels {
        pixel[3] = 255;
    }
    let png = parbake_files::encode_png(&image)?;
    let mut address = String::from("data:image/png;base64,");
    base64::encode(&png, &mut address);
    Ok(Embedded { address, width: image.width, height: image.height })
}

/// Embeds a rendered picture.
pub fn embed_rgb(name: &str, picture: &Rgb) -> Result<Embedded, BakeError> {
    let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    let pixels = picture.pixels.iter().map(|&[r, g, b]| [byte(r), byte(g), byte(b), 255]).collect();
    embed(&Image { name: name.into(), width: picture.width, height: picture.height, pixels })
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
}
