//! Mean squared error and peak signal-to-noise ratio.
//!
//! `MSE = mean over pixels and channels of (a − b)²`, `PSNR = 10 log₁₀(1 / MSE)` for
//! a peak of 1.
//!
//! Contract: sums are in f64, row by row in a fixed order.

use crate::{MetricError, Rgb, check};
use rayon::prelude::*;

/// Mean squared difference over all pixels and channels, 0 … 1; 0 for pictures
/// without pixels.
///
/// # Errors
///
/// [`MetricError::PixelCount`] where a picture holds more or fewer pixels than its size says, and
/// [`MetricError::SizeMismatch`] where the sizes differ.
pub fn mean_squared_error(a: &Rgb, b: &Rgb) -> Result<f64, MetricError> {
    check(a, b)?;
    if a.pixels.is_empty() {
        return Ok(0.0);
    }
    let rows: Vec<f64> = (a.pixels.par_chunks(a.width))
        .zip(b.pixels.par_chunks(b.width))
        .map(|(a, b)| {
            let mut sums = [0.0; 3];
            for (a, b) in a.iter().zip(b) {
                for k in 0..3 {
                    let difference = f64::from(a[k]) - f64::from(b[k]);
                    sums[k] += difference * difference;
                }
            }
            sums.iter().sum()
        })
        .collect();
    Ok(rows.iter().sum::<f64>() / (3 * a.pixels.len()) as f64)
}

/// Decibels; equal pictures give 100, the cap at a mean squared error of 1e-10.
pub fn psnr_from_mse(mse: f64) -> f64 {
    10.0 * (1.0 / mse.max(1e-10)).log10()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::pair;

    /// Protects the agreement with the independent evaluator.
    #[test]
    fn matches_the_reference_evaluator() {
        let (a, b) = pair(256, 200);
        let mse = mean_squared_error(&a, &b).unwrap();
        assert!((mse - GOLDEN_MSE).abs() < 1e-9, "{mse}");
    }

    /// Protects the scale of the decibels.
    #[test]
    fn decibels() {
        assert!((psnr_from_mse(1e-3) - 30.0).abs() < 1e-12);
        assert_eq!(psnr_from_mse(0.0), 100.0);
        let a = pair(5, 4).0;
        assert_eq!(mean_squared_error(&a, &a), Ok(0.0));
        assert_eq!(mean_squared_error(&Rgb::default(), &Rgb::default()), Ok(0.0));
    }

    const GOLDEN_MSE: f64 = 0.026374528417697066;
}
