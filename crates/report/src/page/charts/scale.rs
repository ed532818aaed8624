//! One axis of a chart: which values it holds, where they stand on it, and its round ticks.
//!
//! Contract: ranges may be empty or a point and are then widened; every place that comes out
//! lies in 0 … 1, whatever went in; ticks lie on the axis, in order, and have no number twice.

use crate::page::axes::round_step;
use crate::page::text::{grouped, scientific};

/// Largest magnitude that is told apart; squares of it and sums of them stay finite.
pub(super) const FARTHEST: f64 = 1e100;
/// Magnitudes from which on ticks are written with powers of ten.
const POWERS: (i32, i32) = (-6, 7);
/// Most decades on an axis that have a tick each.
const MOST_DECADES: i32 = 8;

/// A value with a line of the grid.
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: String,
}

/// An axis.
pub(super) struct Scale {
    /// Its ends; their logarithms on a logarithmic axis.
    ends: (f64, f64),
    logarithmic: bool,
    pub(super) ticks: Vec<Tick>,
}

impl Scale {
    /// An axis from tick to tick with all finite `values` between, and about so many steps.
    pub(super) fn around(values: impl Iterator<Item = f64>, steps: usize) -> Self {
        let (low, high) = range(values);
        let step = round_step((high - low) / steps.max(1) as f64);
        // What is a tick but for rounding does not ask for one more.
        let (first, last) = ((low / step + 1e-6).floor(), (high / step - 1e-6).ceil());
        Self::linear((first * step, last * step), step, first, last)
    }

    /// An axis that ends where the finite `values` do, with the ticks between.
    pub(super) fn within(values: impl Iterator<Item = f64> + Clone, steps: usize) -> Self {
        let (low, high) = range(values.clone());
        let mut step = round_step((high - low) / steps.max(1) as f64);
        // There is no half of a step of an optimisation.
        if values.filter(|v| v.is_finite()).all(|v| v.fract() == 0.0) {
            step = step.max(1.0);
        }
        Self::linear((low, high), step, (low / step - 1e-6).ceil(), (high / step + 1e-6).floor())
    }

    fn linear(ends: (f64, f64), step: f64, first: f64, last: f64) -> Self {
        let power = step.log10().floor() as i32;
        let largest = ends.0.abs().max(ends.1.abs()).log10().floor() as i32;
        let label = |value: f64| {
            if power < POWERS.0 || largest >= POWERS.1 {
                let own = value.abs().log10().floor().max(f64::from(power)) as i32;
                // As a multiple of the step zero is zero, as a sum it is almost.
                if value.abs() < step / 2.0 { "0".into() } else { scientific(value, (own - power) as usize) }
            } else {
                grouped(value, (-power).max(0) as usize)
            }
        };
        let ticks = (0..=(last - first).clamp(0.0, 100.0) as usize)
            .map(|i| (first + i as f64) * step)
            .map(|value| Tick { value, label: label(value) });
        Self { ends, logarithmic: false, ticks: ticks.collect() }
    }

    /// A logarithmic axis between round ends with all finite positive `values` on it.
    pub(super) fn logarithmic(values: impl Iterator<Item = f64>) -> Self {
        let logarithms = values.filter(|&v| v > 0.0 && v.is_finite()).map(log);
        let (low, high) = logarithms.fold(NOTHING, |(low, high), v| (v.min(low), v.max(high)));
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        let factors: &[f64] = match high - low {
            span if span <= 0.8 => &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
            _ => &[1.0, 2.0, 5.0],
        };
        let decades = high - low > 3.0;
        let powers = low.floor() as i32 - 1..=high.ceil() as i32 + 1;
        let all: Vec<(f64, i32)> =
            powers.flat_map(|power| factors.iter().map(move |factor| (*factor, power))).collect();
        let place = |(factor, power): &(f64, i32)| f64::from(*power) + factor.log10();
        let first = all.iter().rposition(|tick| place(tick) <= low + 1e-6).unwrap_or(0);
        let last = all.iter().position(|tick| place(tick) >= high - 1e-6).unwrap_or(all.len() - 1);
        // A single value on a tick would leave an axis of no length.
        let (first, last) = if first < last {
            (first, last)
        } else {
            (first.saturating_sub(1), (first + 1).min(all.len() - 1))
        };
        // Decades only, and of very many each second, third ….
        let every = if decades { (all[last].1 - all[first].1) / MOST_DECADES + 1 } else { 1 };
        let ticked = |(factor, power): &&(f64, i32)| !decades || (*factor == 1.0 && power % every == 0);
        let powers = all[first].1 <= POWERS.0 || all[last].1 >= POWERS.1;
        let ticks = all[first..=last].iter().filter(ticked).map(|(factor, power)| {
            let value = factor * 10f64.powi(*power);
            let label = if powers { scientific(value, 0) } else { grouped(value, (-power).max(0) as usize) };
            Tick { value, label }
        });
        Self { ends: (place(&all[first]), place(&all[last])), logarithmic: true, ticks: ticks.collect() }
    }

    /// Where a value stands between the axis' ends, 0 and 1.
    pub(super) fn share(&self, value: f64) -> f64 {
        let value = if self.logarithmic { log(value) } else { value };
        let share = (value - self.ends.0) / (self.ends.1 - self.ends.0);
        if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
    }

    /// Length of the axis in values; not for logarithmic ones.
    pub(super) fn length(&self) -> f64 {
        self.ends.1 - self.ends.0
    }
}

/// The range before the first value.
const NOTHING: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// Logarithm of a value, of the smallest where there is none.
fn log(value: f64) -> f64 {
    value.clamp(1.0 / FARTHEST, FARTHEST).log10()
}

/// Range of the finite values, widened where rounding errors would be all there is to see.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|v| v.is_finite()).map(|v| v.clamp(-FARTHEST, FARTHEST));
    let (low, high) = finite.fold(NOTHING, |(low, high), v| (v.min(low), v.max(high)));
    if low > high {
        return (0.0, 1.0);
    }
    let magnitude = low.abs().max(high.abs());
    if high - low > (1e-9 * magnitude).max(1.0 / FARTHEST) {
        return (low, high);
    }
    let widened = if magnitude > 1.0 / FARTHEST { 0.1 * magnitude } else { 1.0 };
    (low - widened, high + widened)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: &Scale) -> Vec<&str> {
        scale.ticks.iter().map(|tick| tick.label.as_str()).collect()
    }

    /// Protects readable ticks.
    #[test]
    fn ticks_are_round() {
        let around = |values: &[f64], steps| Scale::around(values.iter().copied(), steps);
        assert_eq!(labels(&around(&[-0.13, 0.52], 4)), ["−0.2", "0.0", "0.2", "0.4", "0.6"]);
        assert_eq!(labels(&around(&[0.0, 40_000.0], 4)).last(), Some(&"40\u{202f}000"));
        assert_eq!(labels(&around(&[0.0, 4e-9], 2)), ["0", "2×10⁻⁹", "4×10⁻⁹"]);
        assert_eq!(labels(&around(&[0.0, 3e7], 3)), ["0", "10⁷", "2×10⁷", "3×10⁷"]);
        let within = Scale::within([0.7, 5.1].into_iter(), 4);
        assert_eq!(labels(&within), ["1", "2", "3", "4", "5"]);
        assert!((within.share(0.7), within.share(5.1)) == (0.0, 1.0));
        assert_eq!(labels(&Scale::within([0.0, 2.0].into_iter(), 8)), ["0", "1", "2"]);
    }

    /// Protects logarithmic axes: steps of 1, 2 and 5, decades where there are many.
    #[test]
    fn logarithmic_ticks() {
        let log = |values: &[f64]| Scale::logarithmic(values.iter().copied());
        assert_eq!(labels(&log(&[0.003, 0.04])), ["0.002", "0.005", "0.01", "0.02", "0.05"]);
        assert_eq!(labels(&log(&[0.007, 1000.0])), ["0.01", "0.1", "1", "10", "100", "1\u{202f}000"]);
        assert_eq!(labels(&log(&[1e-7, 1e-2]))[..2], ["10⁻⁷", "10⁻⁶"]);
        assert_eq!(labels(&log(&[3.1, 4.2])), ["3", "4", "5"]);
        assert!((2..=10).contains(&log(&[1e-60, 1e60]).ticks.len()));
        let scale = log(&[1.0, 100.0]);
        assert!((scale.share(10.0) - 0.5).abs() < 1e-9 && scale.share(-1.0) == 0.0);
    }

    /// Protects against axes of nothing, of one value, of rounding errors and of no numbers.
    #[test]
    fn odd_ranges_stay_finite() {
        let odd = [f64::NAN, f64::INFINITY, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324, -0.0, 1.0, 30.0];
        let mut ranges: Vec<Vec<f64>> = vec![vec![], odd.to_vec(), vec![1e9, 1e9 + 1e-7]];
        ranges.extend(odd.iter().map(|&value| vec![value]));
        ranges.extend(odd.iter().flat_map(|&a| odd.iter().map(move |&b| vec![a, b])));
        for values in &ranges {
            let scales = [
                Scale::around(values.iter().copied(), 5),
                Scale::within(values.iter().copied(), 5),
                Scale::logarithmic(values.iter().copied()),
            ];
            for scale in &scales {
                assert!(odd.iter().all(|&value| (0.0..=1.0).contains(&scale.share(value))), "{values:?}");
                assert!(scale.ticks.iter().all(|tick| tick.value.is_finite()), "{values:?}");
                assert!(labels(scale).windows(2).all(|pair| pair[0] != pair[1]), "{values:?}");
                assert!((1..=20).contains(&scale.ticks.len()), "{values:?} {:?}", labels(scale));
            }
        }
    }
}
