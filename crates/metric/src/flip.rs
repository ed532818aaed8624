//! FLIP, the difference that a person sees when flipping between two pictures:
//! Andersson et al. 2020, LDR, by the `nv-flip` binding of the authors' code.
//!
//! Contract: 0 (equal) … 1; values are taken as sRGB-encoded and rounded to 8 bits.

use crate::{MetricError, Rgb, check};
use nv_flip::FlipImageRgb8;

/// The authors' default viewing condition: a 0.7 m wide screen of 3,840 pixels seen
/// from 0.7 m.
pub const PIXELS_PER_DEGREE: f32 = nv_flip::DEFAULT_PIXELS_PER_DEGREE;

/// Columns and rows of a part of a picture.
type Window = [std::ops::Range<usize>; 2];

fn eight_bits(picture: &Rgb, [columns, rows]: &Window) -> FlipImageRgb8 {
    let to_byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let bytes: Vec<u8> = (picture.pixels.chunks(picture.width).take(rows.end).skip(rows.start))
        .flat_map(|row| row[columns.clone()].iter().flatten().map(|&v| to_byte(v)))
        .collect();
    FlipImageRgb8::with_data(columns.len() as u32, rows.len() as u32, &bytes)
}

/// The part outside of which the map is 0: where two pictures are equal within
/// reach of the filters, so is what the filters make of them. Twice their reach
/// (at most 0.137 degrees) around all differences, so that no pixel that counts
/// sees the part's border. Pictures of a model are mostly background.
fn differing(a: &Rgb, b: &Rgb, pixels_per_degree: f32) -> Window {
    let margin = 2 * (0.14 * pixels_per_degree).ceil() as usize + 2;
    let (mut first, mut end) = ([usize::MAX; 2], [0; 2]);
    for (i, _) in a.pixels.iter().zip(&b.pixels).enumerate().filter(|(_, (a, b))| a != b) {
        for (axis, at) in [i % a.width, i / a.width].into_iter().enumerate() {
            first[axis] = first[axis].min(at);
            end[axis] = end[axis].max(at + 1);
        }
    }
    let size = [a.width, a.height];
    [0, 1].map(|k: usize| first[k].saturating_sub(margin).min(size[k])..(end[k] + margin).min(size[k]))
}

/// The difference at each pixel, width × height values, row 0 on top.
///
/// # Errors
///
/// [`MetricError::PixelCount`] where a picture holds more or fewer pixels than its size says, and
/// [`MetricError::SizeMismatch`] where the sizes differ.
pub fn flip_map(reference: &Rgb, test: &Rgb, pixels_per_degree: f32) -> Result<Vec<f32>, MetricError> {
    check(reference, test)?;
    if reference.pixels.is_empty() {
        return Ok(Vec::new());
    }
    let mut map = vec![0.0; reference.pixels.len()];
    let window = differing(reference, test, pixels_per_degree);
    if window.iter().all(|r| !r.is_empty()) {
        let part =
            nv_flip::flip(eight_bits(reference, &window), eight_bits(test, &window), pixels_per_degree)
                .to_vec();
        let [columns, rows] = window;
        for (row, part) in rows.zip(part.chunks(columns.len())) {
            map[row * reference.width..][columns.clone()].copy_from_slice(part);
        }
    }
    Ok(map)
}

/// Mean of [`flip_map`]; 0 for pictures without pixels.
///
/// # Errors
///
/// As [`flip_map`].
pub fn flip(reference: &Rgb, test: &Rgb, pixels_per_degree: f32) -> Result<f64, MetricError> {
    let map = flip_map(reference, test, pixels_per_degree)?;
    Ok(map.iter().copied().map(f64::from).sum::<f64>() / map.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::pair;

    /// Protects the ends of the scale and the order in between.
    #[test]
    fn grows_with_the_difference() {
        let (a, b) = pair(64, 48);
        let solid = |v: f32| Rgb { width: 64, height: 48, pixels: vec![[v; 3]; 64 * 48] };
        assert_eq!(flip(&a, &a, PIXELS_PER_DEGREE), Ok(0.0));
        let some = flip(&a, &b, PIXELS_PER_DEGREE).unwrap();
        let far = flip(&solid(0.0), &solid(1.0), PIXELS_PER_DEGREE).unwrap();
        assert!(some > 0.02 && some < 0.9, "{some}");
        assert!(far > 0.9 && far <= 1.0, "{far}");
        assert_eq!(flip_map(&a, &b, PIXELS_PER_DEGREE).unwrap().len(), 64 * 48);
    }

    /// Protects the shortcut: leaving the background out changes no bit.
    #[test]
    fn equal_surroundings_change_nothing() {
        let (width, height) = (150, 130);
        let (a, _) = pair(width, height);
        let all = [0..width, 0..height];
        for (x, y) in [(75, 60), (20, 100), (0, 0), (149, 64)] {
            let mut b = a.clone();
            for dy in 0..9 {
                for dx in 0..7 {
                    let (x, y) = (x + dx, y + dy);
                    if x < width && y < height {
                        b.pixels[y * width + x] = [0.9, 0.1, (dx * dy) as f32 / 63.0];
                    }
                }
            }
            let full = nv_flip::flip(eight_bits(&a, &all), eight_bits(&b, &all), PIXELS_PER_DEGREE).to_vec();
            assert!(differing(&a, &b, PIXELS_PER_DEGREE)[0].len() < width);
            assert_eq!(flip_map(&a, &b, PIXELS_PER_DEGREE).unwrap(), full, "{x} {y}");
        }
    }
}
