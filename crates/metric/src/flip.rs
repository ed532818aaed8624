//! FLIP, the difference that a person sees when flipping between two pictures:
//! Andersson et al. 2020, LDR, by the `nv-flip` binding of the authors' code.
//!
//! Contract: 0 (equal) … 1; values are taken as sRGB-encoded and rounded to 8 bits.

use crate::{MetricError, Rgb, check};
use nv_flip::FlipImageRgb8;

/// The authors' default viewing condition: a 0.7 m wide screen of 3,840 pixels seen
/// from 0.7 m.
pub const PIXELS_PER_DEGREE: f32 = nv_flip::DEFAULT_PIXELS_PER_DEGREE;

fn eight_bits(picture: &Rgb) -> FlipImageRgb8 {
    let to_byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let bytes: Vec<u8> = picture.pixels.iter().flatten().map(|&v| to_byte(v)).collect();
    FlipImageRgb8::with_data(picture.width as u32, picture.height as u32, &bytes)
}

/// The difference at each pixel, width × height values, row 0 on top.
pub fn flip_map(reference: &Rgb, test: &Rgb, pixels_per_degree: f32) -> Result<Vec<f32>, MetricError> {
    check(reference, test)?;
    if reference.pixels.is_empty() {
        return Ok(Vec::new());
    }
    Ok(nv_flip::flip(eight_bits(reference), eight_bits(test), pixels_per_degree).to_vec())
}

/// Mean of [`flip_map`]; 0 for pictures without pixels.
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
}
