//! Multi-scale structural similarity: Wang, Simoncelli, Bovik 2003.
//!
//! Per channel, `Π_{j<5} max(cs_j, 0)^{w_j} · max(ssim_5, 0)^{w_5}`; each scale is the
//! 2×2 mean of the one above (an odd last row or column is dropped). With μ, σ the
//! moments under an 11-tap Gaussian of σ = 1.5 over windows that lie wholly inside
//! the picture, `cs = (2σ_ab + C₂) / (σ_a² + σ_b² + C₂)` and
//! `ssim = cs · (2μ_a μ_b + C₁) / (μ_a² + μ_b² + C₁)`, both averaged over the windows;
//! C₁ = 0.01², C₂ = 0.03². The result is the mean over channels.
//!
//! Where both pictures are equal, the sum of their squares is exactly twice their product, so numerators and
//! denominators are the same numbers and `ssim = cs = 1` exactly. Windows beside all differences are counted, not filtered.
//!
//! Contract: row sums are kept apart and added in order, so the result does not
//! depend on the number of threads.

use crate::{MetricError, Rgb, check};
use rayon::prelude::*;
use std::ops::Range;

const TAPS: usize = 11;
/// Columns filtered together: their accumulators fit the registers of a CPU with
/// 128-bit lanes.
const LANES: usize = 8;
const WEIGHTS: [f64; 5] = [0.0448, 0.2856, 0.3001, 0.2363, 0.1333];
const C1: f32 = 0.01 * 0.01;
const C2: f32 = 0.03 * 0.03;

/// Pictures whose smaller side is below this have no whole window on the coarsest
/// scale: 11 · 2⁴.
pub const SMALLEST_SIDE: usize = TAPS << 4;

/// One channel; rows are padded with zeros so that whole lanes can be read.
struct Plane {
    width: usize,
    height: usize,
    stride: usize,
    values: Vec<f32>,
}

/// Lanes that cover `width`, and those that the horizontal taps reach beyond.
fn stride(width: usize) -> usize {
    width.next_multiple_of(LANES) + 2 * LANES
}

impl Plane {
    fn channel(picture: &Rgb, channel: usize) -> Self {
        let &Rgb { width, height, ref pixels } = picture;
        let stride = stride(width);
        let mut values = vec![0.0; stride * height];
        for (out, row) in values.chunks_mut(stride).zip(pixels.chunks(width)) {
            for (out, pixel) in out.iter_mut().zip(row) {
                *out = pixel[channel];
            }
        }
        Self { width, height, stride, values }
    }

    fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.stride..][..self.stride]
    }

    fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let stride = stride(width);
        let mut values = vec![0.0; stride * height];
        for (y, out) in values.chunks_mut(stride).enumerate() {
            let rows = self.row(2 * y).chunks_exact(2).zip(self.row(2 * y + 1).chunks_exact(2));
            for (out, (above, below)) in out[..width].iter_mut().zip(rows) {
                *out = (above[0] + above[1] + below[0] + below[1]) * 0.25;
            }
        }
        Self { width, height, stride, values }
    }
}

fn gaussian() -> [f32; TAPS] {
    let raw: [f64; TAPS] = std::array::from_fn(|i| (-(i as f64 - 5.0).powi(2) / (2.0 * 1.5 * 1.5)).exp());
    let sum: f64 = raw.iter().sum();
    raw.map(|g| (g / sum) as f32)
}

/// Vertically filtered a, b, a² + b² and ab, one row each.
type Moments = [Vec<f32>; 4];

/// Filters down these columns of the `TAPS` rows from `y` on.
fn filter_columns(
    [a, b]: [&Plane; 2],
    y: usize,
    columns: Range<usize>,
    kernel: &[f32; TAPS],
    moments: &mut Moments,
) {
    for x in columns.step_by(LANES) {
        let mut sums = [[0f32; LANES]; 4];
        for (k, &weight) in kernel.iter().enumerate() {
            let at = (y + k) * a.stride + x;
            let (row_a, row_b) = (&a.values[at..at + LANES], &b.values[at..at + LANES]);
            for i in 0..LANES {
                let (p, q) = (row_a[i], row_b[i]);
                let (wp, wq) = (weight * p, weight * q);
                sums[0][i] += wp;
                sums[1][i] += wq;
                sums[2][i] += wp * p + wq * q;
                sums[3][i] += wp * q;
            }
        }
        for (out, sum) in moments.iter_mut().zip(sums) {
            out[x..x + LANES].copy_from_slice(&sum);
        }
    }
}

/// Filters along the row and sums (ssim, cs) over these of its windows.
fn sum_row(moments: &Moments, windows: Range<usize>, kernel: &[f32; TAPS]) -> [f64; 2] {
    let mut ssim = [0f64; LANES];
    let mut structure = [0f64; LANES];
    for x in windows.clone().step_by(LANES) {
        let mut means = [[0f32; LANES]; 4];
        for (mean, row) in means.iter_mut().zip(moments) {
            for (k, &weight) in kernel.iter().enumerate() {
                let row = &row[x + k..x + k + LANES];
                for i in 0..LANES {
                    mean[i] += weight * row[i];
                }
            }
        }
        let [a, b, squares, products] = means;
        let mut terms = [[0f32; LANES]; 2];
        for i in 0..LANES {
            let (ab, aa_bb) = (a[i] * b[i], a[i] * a[i] + b[i] * b[i]);
            let cs = (2.0 * (products[i] - ab) + C2) / (squares[i] - aa_bb + C2);
            terms[0][i] = cs * (2.0 * ab + C1) / (aa_bb + C1);
            terms[1][i] = cs;
        }
        // Windows that stick out of the picture do not count.
        let inside = (windows.end - x).min(LANES);
        for i in 0..inside {
            ssim[i] += f64::from(terms[0][i]);
            structure[i] += f64::from(terms[1][i]);
        }
    }
    [ssim.iter().sum(), structure.iter().sum()]
}

/// The columns of a row in which the planes differ, from the first to the last.
fn differing(a: &[f32], b: &[f32]) -> Range<usize> {
    let mut pairs = a.iter().zip(b).map(|(a, b)| a != b);
    let Some(first) = pairs.position(|differs| differs) else { return 0..0 };
    first..first + 1 + pairs.rposition(|differs| differs).map_or(0, |last| last + 1)
}

/// The smallest range that covers both.
fn union(a: &Range<usize>, b: &Range<usize>) -> Range<usize> {
    match (a.is_empty(), b.is_empty()) {
        (true, _) => b.clone(),
        (_, true) => a.clone(),
        _ => a.start.min(b.start)..a.end.max(b.end),
    }
}

/// Mean ssim and mean contrast-structure term of one scale.
fn similarity(a: &Plane, b: &Plane, kernel: &[f32; TAPS]) -> [f64; 2] {
    let (rows, columns) = (a.height - TAPS + 1, a.width - TAPS + 1);
    let differing_columns: Vec<Range<usize>> = (0..a.height).map(|y| differing(a.row(y), b.row(y))).collect();
    let sums: Vec<[f64; 2]> = (0..rows)
        .into_par_iter()
        .with_min_len(16)
        .map_init(
            || std::array::from_fn(|_| vec![0.0; a.stride]),
            |moments, y| {
                let differs = differing_columns[y..y + TAPS].iter().fold(0..0, |all, row| union(&all, row));
                if differs.is_empty() {
                    return [columns as f64; 2];
                }
                let begin = differs.start.saturating_sub(TAPS - 1) / LANES * LANES;
                let windows = begin..differs.end.min(columns);
                filter_columns([a, b], y, begin..windows.end + TAPS - 1, kernel, moments);
                let equal = (columns - windows.len()) as f64;
                sum_row(moments, windows, kernel).map(|sum| sum + equal)
            },
        )
        .collect();
    let count = (rows * columns) as f64;
    [0, 1].map(|k| sums.iter().map(|s| s[k]).sum::<f64>() / count)
}

/// MS-SSIM, at most 1; `None` where a side is shorter than [`SMALLEST_SIDE`].
///
/// # Errors
///
/// [`MetricError::PixelCount`] where a picture holds more or fewer pixels than its size says, and
/// [`MetricError::SizeMismatch`] where the sizes differ.
pub fn ms_ssim(a: &Rgb, b: &Rgb) -> Result<Option<f64>, MetricError> {
    check(a, b)?;
    if a.width.min(a.height) < SMALLEST_SIDE {
        return Ok(None);
    }
    let kernel = gaussian();
    let channels: Vec<f64> = (0..3)
        .into_par_iter()
        .map(|channel| {
            let (mut a, mut b) = (Plane::channel(a, channel), Plane::channel(b, channel));
            let mut value = 1.0;
            for (scale, weight) in WEIGHTS.into_iter().enumerate() {
                if scale > 0 {
                    (a, b) = (a.halved(), b.halved());
                }
                let [ssim, structure] = similarity(&a, &b, &kernel);
                let factor = if scale + 1 == WEIGHTS.len() { ssim } else { structure };
                value *= factor.max(0.0).powf(weight);
            }
            value
        })
        .collect();
    Ok(Some(channels.iter().sum::<f64>() / 3.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::pair;

    /// Protects the agreement with the independent evaluator, odd sides included.
    #[test]
    fn matches_the_reference_evaluator() {
        for (width, height, golden) in GOLDEN {
            let (a, b) = pair(width, height);
            let value = ms_ssim(&a, &b).unwrap().unwrap();
            assert!((value - golden).abs() < 2e-6, "{width}x{height}: {value} {golden}");
        }
    }

    /// Protects the two ends of what is defined.
    #[test]
    fn equal_pictures_give_one_and_small_ones_nothing() {
        let a = pair(SMALLEST_SIDE, SMALLEST_SIDE + 1).0;
        assert_eq!(ms_ssim(&a, &a), Ok(Some(1.0)));
        let a = pair(SMALLEST_SIDE - 1, 400).0;
        assert_eq!(ms_ssim(&a, &a), Ok(None));
    }

    /// Protects the figures of models before a background: what is counted without being filtered is what filtering all
    /// windows gives, wherever the pictures differ.
    #[test]
    fn equal_windows_are_counted_as_one() {
        let (width, height) = (61, 47);
        let picture = pair(width, height).0;
        let (kernel, a) = (gaussian(), Plane::channel(&picture, 1));
        let (rows, columns) = (height - TAPS + 1, width - TAPS + 1);
        let all_windows = |b: &Plane| -> Vec<[f64; 2]> {
            let mut moments = std::array::from_fn(|_| vec![0.0; a.stride]);
            let row = |y| {
                filter_columns([&a, b], y, 0..width, &kernel, &mut moments);
                sum_row(&moments, 0..columns, &kernel)
            };
            (0..rows).map(row).collect()
        };
        assert!(all_windows(&a).iter().all(|sums| *sums == [columns as f64; 2]));
        for (left, top, side) in [(0, 0, 1), (60, 46, 1), (30, 20, 9), (13, 0, 40), (5, 33, 14), (0, 0, 47)] {
            let mut other = picture.clone();
            for y in top..height.min(top + side) {
                other.pixels[y * width + left..][..side.min(width - left)]
                    .iter_mut()
                    .for_each(|p| p[1] *= 0.8);
            }
            let b = Plane::channel(&other, 1);
            let sums = all_windows(&b).into_iter().fold([0.0; 2], |[s, c], [p, q]| [s + p, c + q]);
            for (found, sum) in similarity(&a, &b, &kernel).into_iter().zip(sums) {
                let wanted = sum / (rows * columns) as f64;
                assert!((found - wanted).abs() < 1e-13, "{left} {top} {side}: {found} {wanted}");
            }
        }
    }

    /// Protects reproducible reports: the same bits whatever the threads.
    #[test]
    fn does_not_depend_on_the_number_of_threads() {
        let (a, b) = pair(300, 211);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| ms_ssim(&a, &b).unwrap().unwrap().to_bits())
        };
        assert_eq!(on(1), on(3));
    }

    const GOLDEN: [(usize, usize, f64); 3] =
        [(256, 200, 0.7252915884911397), (181, 223, 0.7573757055333195), (512, 512, 0.5548163144896928)];
}
