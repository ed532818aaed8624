//! How far apart two pictures of the same view are: mean squared error and PSNR,
//! MS-SSIM, and FLIP.
//!
//! Contract: pictures are display-referred, row 0 on top, and their values have
//! been clipped to [0, 1] by the caller. Results do not depend on the number of
//! threads.

mod flip;
mod ms_ssim;
mod psnr;

pub use flip::{PIXELS_PER_DEGREE, flip, flip_map};
pub use ms_ssim::{SMALLEST_SIDE, ms_ssim};
pub use psnr::{mean_squared_error, psnr_from_mse};

/// A display-referred RGB picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rgb {
    /// Pixels along a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// width × height pixels, row 0 on top, values in [0, 1].
    pub pixels: Vec<[f32; 3]>,
}

/// Why two pictures cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MetricError {
    /// They differ in size.
    #[error("pictures differ in size: {}x{} against {}x{}", .0[0], .0[1], .1[0], .1[1])]
    SizeMismatch([usize; 2], [usize; 2]),
    /// A picture holds more or fewer pixels than its width times its height.
    #[error("a picture of {width}x{height} holds {pixels} pixels")]
    PixelCount {
        /// Pixels along a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Pixels it holds.
        pixels: usize,
    },
}

/// Both pictures are whole and equal in size.
fn check(a: &Rgb, b: &Rgb) -> Result<(), MetricError> {
    for picture in [a, b] {
        let &Rgb { width, height, ref pixels } = picture;
        if width.checked_mul(height) != Some(pixels.len()) {
            return Err(MetricError::PixelCount { width, height, pixels: pixels.len() });
        }
    }
    if (a.width, a.height) != (b.width, b.height) {
        return Err(MetricError::SizeMismatch([a.width, a.height], [b.width, b.height]));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pictures that any language can make: integer arithmetic, then one
    /// division. The second is the first with a gradient, noise and a shift.
    pub(crate) fn pair(width: usize, height: usize) -> (Rgb, Rgb) {
        let value = |x: usize, y: usize, c: usize, altered: usize| {
            let (x, y) = (x + 2 * altered, y + altered);
            let cell = (x / 24 * 37 + y / 18 * 91 + c * 53) % 128;
            let waves = (x * x / 64 + y * y / 96 + 40 * c) % 96;
            let noise = (x * 7919 + y * 104_729 + c * 1299 + x * y * 31) % 31;
            (cell + waves + noise * altered + x * 32 * altered / width) as f32 / 300.0
        };
        let picture = |altered| {
            let pixels = (0..width * height)
                .map(|i| std::array::from_fn(|c| value(i % width, i / width, c, altered).min(1.0)))
                .collect();
            Rgb { width, height, pixels }
        };
        (picture(0), picture(1))
    }

    /// Protects against silent comparison of pictures that do not belong together.
    #[test]
    fn sizes_must_agree() {
        let (a, b) = (pair(20, 10).0, pair(10, 20).0);
        let mismatch = MetricError::SizeMismatch([20, 10], [10, 20]);
        assert_eq!(mean_squared_error(&a, &b), Err(mismatch));
        assert_eq!(ms_ssim(&a, &b), Err(mismatch));
        assert_eq!(flip(&a, &b, 67.0), Err(mismatch));
        assert_eq!(mismatch.to_string(), "pictures differ in size: 20x10 against 10x20");
        let broken = Rgb { pixels: Vec::new(), ..a.clone() };
        assert!(matches!(mean_squared_error(&a, &broken), Err(MetricError::PixelCount { pixels: 0, .. })));
    }
}
