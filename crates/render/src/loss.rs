//! Image losses: how far a view's display values are from the reference's.
//!
//! Per value, with x the view and y the reference, both clipped above at 1 as a
//! screen does: L1 `|x − y|`, L2 `(x − y)²`, log-L1 `|ln(x + ε) − ln(y + ε)|`. The last
//! is meant for linear light ([`Curve::Linear`](parbake_image::display::Curve)), where it weighs
//! shadows and lights alike; below 0 its logarithm goes on as a straight line.
//! Coverage has its own loss, `(a − b)²`, which no background can hide.
//! Adjoint: the derivative by x. Where x is clipped and the reference is not, the
//! derivative at the clip goes straight through, or a too bright texel would stay so;
//! where both are clipped it is zero.
//!
//! Contract: values are sums over pixels in f64, row by row; the caller's
//! normalisation is the mean over pixels (and channels). Where only some pixels are shaded, values are estimates from those
//! that the adjoint reads, and pixels that are not shaded have no gradient.

use crate::background::Composer;
use crate::gradient_pixels::ShadedPixels;
use rayon::prelude::*;

/// Added inside the logarithm of [`ImageLoss::LogL1`]: 1 % of full light.
pub const LOG_EPSILON: f32 = 0.01;

/// How two values are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ImageLoss {
    /// Absolute difference.
    L1,
    /// Squared difference: what PSNR measures.
    #[default]
    L2,
    /// Absolute difference of logarithms.
    LogL1,
}

/// ln(x + ε) and its derivative.
#[inline]
fn logarithm(x: f32) -> (f32, f32) {
    if x > 0.0 {
        ((x + LOG_EPSILON).ln(), 1.0 / (x + LOG_EPSILON))
    } else {
        (LOG_EPSILON.ln() + x / LOG_EPSILON, 1.0 / LOG_EPSILON)
    }
}

impl ImageLoss {
    /// The loss of one value, and its derivative with respect to `view`.
    #[inline]
    pub fn with_derivative(self, view: f32, reference: f32) -> (f32, f32) {
        let (x, y) = (view.min(1.0), reference.min(1.0));
        let difference = x - y;
        // Not `signum`, which is 1 at 0: equal values must not pull.
        let sign = f32::from(i8::from(difference > 0.0) - i8::from(difference < 0.0));
        match self {
            Self::L1 => (difference.abs(), sign),
            Self::L2 => (difference * difference, 2.0 * difference),
            Self::LogL1 => {
                let ((at_x, slope), (at_y, _)) = (logarithm(x), logarithm(y));
                ((at_x - at_y).abs(), sign * slope)
            }
        }
    }
}

/// Squared difference of coverages, and its derivative with respect to `view`.
#[inline]
pub fn coverage_loss(view: f32, reference: f32) -> (f32, f32) {
    let difference = view - reference;
    (difference * difference, 2.0 * difference)
}

/// A picture that a view is compared with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    /// Pixels along a side.
    pub size: usize,
    /// size² pixels of premultiplied linear light and coverage.
    pub pixels: Vec<[f32; 4]>,
}

/// What is compared, and how much each part counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Of display values.
    pub image: ImageLoss,
    /// Weight of the coverage loss beside the image's; ≥ 0.
    pub coverage: f32,
    /// How much less a pixel counts of which the view covers more than the reference: 0 as
    /// much as any, 1 not at all. For surfaces whose overhang will be cut out.
    pub overhang_discount: f32,
}

/// Mean losses of a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LossValue {
    /// Mean over pixels and channels.
    pub image: f64,
    /// Mean over pixels, before its weight.
    pub coverage: f64,
}

impl LossValue {
    /// What the gradients are of.
    pub fn total(&self, comparison: &Comparison) -> f64 {
        self.image + f64::from(comparison.coverage) * self.coverage
    }
}

/// Puts two premultiplied linear pictures in front of the same background, compares them where pixels are shaded, and
/// returns the mean loss with its gradient with respect to the first picture's pixels.
pub fn compare(
    rgba: &[[f32; 4]],
    composer: &Composer,
    reference: &Reference,
    comparison: &Comparison,
    shaded: &ShadedPixels,
) -> (LossValue, Vec<[f32; 4]>) {
    let size = reference.size.max(1);
    let (per_value, per_pixel) = (1.0 / (3 * size * size) as f32, 1.0 / (size * size) as f32);
    let mut gradient = vec![[0.0; 4]; rgba.len()];
    let sums: Vec<[f64; 2]> = (gradient.par_chunks_mut(size))
        .zip(rgba.par_chunks(size).zip(reference.pixels.par_chunks(size)))
        .enumerate()
        .map(|(row, (gradient, (rgba, reference)))| {
            let mut sums = [0.0; 2];
            for (column, (out, (rgba, wanted))) in
                gradient.iter_mut().zip(rgba.iter().zip(reference)).enumerate()
            {
                // Equal pixels, as most of the background, have neither loss nor gradient.
                if rgba == wanted || !shaded.contains(column, row) {
                    continue;
                }
                let composed = composer.forward(rgba, column, row);
                let shown = composer.forward(wanted, column, row).value;
                let counts = shaded.loss_weight(column, row);
                let share = if rgba[3] > wanted[3] { 1.0 - comparison.overhang_discount } else { 1.0 };
                let mut to_value = [0.0; 3];
                for k in 0..3 {
                    let (value, slope) = comparison.image.with_derivative(composed.value[k], shown[k]);
                    sums[0] += f64::from(counts * share * value);
                    to_value[k] = slope * share * per_value;
                }
                *out = composer.adjoint(&composed, to_value, column, row);
                let (value, slope) = coverage_loss(rgba[3], wanted[3]);
                sums[1] += f64::from(counts * share * value);
                out[3] += comparison.coverage * slope * share * per_pixel;
            }
            sums
        })
        .collect();
    let [image, coverage] = [0, 1].map(|k| sums.iter().map(|s| s[k]).sum::<f64>());
    let value =
        LossValue { image: image / (3 * size * size) as f64, coverage: coverage / (size * size) as f64 };
    (value, gradient)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [ImageLoss; 3] = [ImageLoss::L1, ImageLoss::L2, ImageLoss::LogL1];

    /// Protects the first link of the adjoint chain.
    #[test]
    fn derivatives_match_central_differences() {
        for loss in ALL {
            for (x, y) in [(0.3f32, 0.5), (0.9, 0.2), (0.05, 0.04), (-0.02, 0.1), (0.7, 1.4)] {
                let h = 1e-3;
                let at = |x| loss.with_derivative(x, y).0;
                let (numeric, analytic) = ((at(x + h) - at(x - h)) / (2.0 * h), loss.with_derivative(x, y).1);
                assert!((numeric - analytic).abs() < 1e-2 * analytic.abs().max(0.1), "{loss:?} {x} {y}");
            }
        }
    }

    /// Protects highlights: clipped values compare as a screen shows them, can come
    /// back below the clip, and are left alone where the reference is clipped, too.
    #[test]
    fn clipped_values_pass_gradients_only_where_needed() {
        for loss in ALL {
            assert_eq!(loss.with_derivative(1.7, 1.2), (0.0, 0.0));
            assert_eq!(loss.with_derivative(0.4, 0.4), (0.0, 0.0));
            let (value, slope) = loss.with_derivative(1.7, 0.6);
            assert_eq!((value, slope), loss.with_derivative(1.0, 0.6));
            assert!(value > 0.0 && slope > 0.0);
        }
    }
}
