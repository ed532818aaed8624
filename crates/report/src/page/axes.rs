//! The frame of a chart: scales, grid lines, tick labels and axis titles, as SVG.
//!
//! Contract: ranges may be empty or a point and are then widened; every coordinate
//! that comes out is finite, whatever went in.

use crate::page::text::{decimal, escape};
use std::fmt::Write;

/// The drawing's size in its own units; the page scales it.
const SIZE: (f64, f64) = (480.0, 270.0);
/// Space at the left, right, top and bottom.
const MARGIN: (f64, f64, f64, f64) = (46.0, 14.0, 22.0, 40.0);

/// Scales of a chart whose horizontal axis counts 0, 1, 2, ….
pub struct Axes {
    /// Largest count on the horizontal axis, at least 1.
    last: f64,
    /// Lower and upper end of the vertical axis.
    range: (f64, f64),
    /// Distance of its grid lines.
    step: f64,
}

impl Axes {
    /// Scales that hold positions 0 … `last` and all finite `values`.
    pub fn new(last: usize, values: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|v| v.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let widened = (1.0 - (high - low)).max(0.0) * 0.5;
        (low, high) = (low - widened, high + widened);
        let step = round_step(((high - low) / 4.0).max(0.1));
        let range = ((low / step).floor() * step, (high / step).ceil() * step);
        Self { last: (last as f64).max(1.0), range, step }
    }

    /// Horizontal place of a position.
    pub fn x(&self, position: usize) -> f64 {
        MARGIN.0 + (SIZE.0 - MARGIN.0 - MARGIN.1) * (position as f64 / self.last).min(1.0)
    }

    /// Vertical place of a value.
    pub fn y(&self, value: f64) -> f64 {
        let share = ((value - self.range.0) / (self.range.1 - self.range.0)).clamp(0.0, 1.0);
        SIZE.1 - MARGIN.3 - (SIZE.1 - MARGIN.2 - MARGIN.3) * if share.is_finite() { share } else { 0.0 }
    }

    /// The whole chart around `content`. `labels` name the positions.
    pub fn svg(&self, title: &str, titles: (&str, &str), labels: &[String], content: &str) -> String {
        let mut out = format!(
            r#"<svg class="chart" viewBox="0 0 {} {}" role="img" aria-label="{}"><g class="grid">"#,
            SIZE.0,
            SIZE.1,
            escape(title)
        );
        let (left, right, bottom) = (MARGIN.0, SIZE.0 - MARGIN.1, SIZE.1 - MARGIN.3);
        let lines = ((self.range.1 - self.range.0) / self.step).round() as usize;
        let decimals = if self.step < 0.95 { 1 } else { 0 };
        for i in 0..=lines {
            let value = self.range.0 + i as f64 * self.step;
            let y = self.y(value);
            let _ = write!(
                out,
                r#"<path d="M{left:.1} {y:.1}H{right:.1}"/><text x="{:.1}" y="{:.1}" text-anchor="end">{}</text>"#,
                left - 7.0,
                y + 4.0,
                decimal(value, decimals)
            );
        }
        let every = labels.len().div_ceil(14).max(1);
        for (i, label) in labels.iter().enumerate().step_by(every) {
            let x = self.x(i);
            let _ = write!(
                out,
                r#"<text x="{x:.1}" y="{:.1}" text-anchor="middle">{}</text>"#,
                bottom + 16.0,
                escape(label)
            );
        }
        let _ = write!(
            out,
            r#"</g><g class="axis"><text x="{right:.1}" y="{:.1}" text-anchor="end">{}</text><text x="4" y="11">{}</text></g>{content}</svg>"#,
            SIZE.1 - 5.0,
            escape(titles.0),
            escape(titles.1)
        );
        out
    }
}

/// The nearest of 1, 2 and 5 times a power of ten; 1 where there is no step.
pub(crate) fn round_step(step: f64) -> f64 {
    let step = if step.is_finite() && step > 0.0 { step } else { 1.0 };
    let power = 10f64.powf(step.log10().floor());
    match step / power {
        r if r < 1.5 => power,
        r if r < 3.5 => 2.0 * power,
        r if r < 7.5 => 5.0 * power,
        _ => 10.0 * power,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects readable tick labels.
    #[test]
    fn steps_are_round() {
        for (step, rounded) in [(0.0, 1.0), (0.013, 0.01), (0.3, 0.2), (0.9, 1.0), (2.2, 2.0), (40.0, 50.0)] {
            assert!((round_step(step) - rounded).abs() < 1e-9, "{step}");
        }
    }

    /// Protects against charts of nothing, of one value and of no numbers.
    #[test]
    fn odd_ranges_stay_finite() {
        let none: [f64; 0] = [];
        for values in [&none[..], &[30.0], &[f64::NAN, f64::INFINITY], &[5.0, f64::NAN]] {
            let axes = Axes::new(0, values.iter().copied());
            for value in [0.0, 30.0, f64::NAN, f64::INFINITY] {
                assert!(axes.y(value).is_finite() && axes.x(3).is_finite());
            }
            let svg = axes.svg("<t>", ("x", "y"), &["a".into()], "");
            assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("<t>"), "{svg}");
        }
    }
}
