//! The display curve as a table: value and slope without a power function, for
//! loops that ask for them a hundred million times.
//!
//! Linear between 128 knots an octave, which are found by a float's upper bits;
//! the error of the value is below 1e-5 of it, that of the slope below 0.5 %.
//!
//! Contract: for linear light whose display input `gain · x` lies in [0, ∞); below
//! the first octave and above the last the outermost pieces go on.

use crate::display::Display;

/// log₂ of the first and the last knot of `gain · x`.
const OCTAVES: (i32, i32) = (-9, 2);

/// Knots in an octave: as many as seven bits of mantissa tell apart.
const KNOTS: u32 = 128;

/// Bits of a float below those seven.
const BELOW: u32 = 23 - 7;

/// Value and slope of a [`Display`], tabulated.
#[derive(Clone, Debug)]
pub struct DisplayTable {
    gain: f32,
    first: u32,
    /// Value at each knot, and slope towards the next.
    pieces: Vec<[f32; 2]>,
}

impl DisplayTable {
    /// Tabulates.
    pub fn new(display: &Display) -> Self {
        let first = 2f32.powi(OCTAVES.0).to_bits() >> BELOW;
        let count = (OCTAVES.1 - OCTAVES.0) as u32 * KNOTS;
        let shown = |x: f32| display.encode(x / display.gain);
        let mut pieces = vec![[shown(0.0), (shown(knot(first)) - shown(0.0)) / knot(first)]];
        pieces.extend((first..first + count).map(|i| {
            let (a, b) = (knot(i), knot(i + 1));
            [shown(a), (shown(b) - shown(a)) / (b - a)]
        }));
        Self { gain: display.gain, first: first - 1, pieces }
    }

    /// Display value of linear light and its derivative.
    #[inline]
    pub fn encode_with_derivative(&self, linear: f32) -> (f32, f32) {
        let x = linear * self.gain;
        let bits = x.to_bits() >> BELOW;
        let index = bits.saturating_sub(self.first).min(self.pieces.len() as u32 - 1);
        let [value, slope] = self.pieces[index as usize];
        let left = if index == 0 { 0.0 } else { knot(self.first + index) };
        (value + slope * (x - left), slope * self.gain)
    }
}

#[inline]
fn knot(bits: u32) -> f32 {
    f32::from_bits(bits << BELOW)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display::Curve;

    /// Protects the error that the header states, over the whole range and beyond.
    #[test]
    fn the_table_follows_the_curve() {
        for curve in [Curve::Srgb, Curve::Linear] {
            let display = Display { gain: 1.59, curve };
            let table = DisplayTable::new(&display);
            for i in 0..=30_000 {
                let x = i as f32 * 1e-4 / display.gain;
                let (value, slope) = table.encode_with_derivative(x);
                let want = display.encode(x);
                assert!((value - want).abs() <= 1e-5 * want.max(0.05), "{x}: {value} for {want}");
                // The curve's own slope jumps where its linear foot ends.
                if !(0.003..0.0033).contains(&(x * display.gain)) {
                    assert!((slope / display.derivative(x) - 1.0).abs() < 5e-3, "{x}: slope {slope}");
                }
            }
            assert!(table.encode_with_derivative(100.0).0 > 1.0);
        }
    }
}
