//! What stands behind the model, and putting the model in front of it.
//!
//! Forward: `x = gain · rgb + (1 − a) · background` in linear light, then
//! `e = curve(x)`: the background is as bright as it says, whatever the model's light.
//! Adjoint: `dL/drgb = gain · curve'(x) · dL/de`, `dL/da = −Σ background · curve'(x) · dL/de`.
//! The curve is read from a table (`display_table.rs`), in a quarter of the time of three powers.
//!
//! Contract: no light is below 0, no alpha above 1; the table knows nothing of darker than dark.
//!
//! A fit on one background learns to paint that colour where the model ought to end;
//! backgrounds that change from view to view leave nothing to gain by it. Plain greys
//! are no help against grey models, so [`Background::Random`] draws black, white and
//! saturated colours.

use parbake_image::display::{Curve, Display};
use parbake_image::display_table::DisplayTable;

/// What is asked for behind the model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// No light.
    #[default]
    Black,
    /// Linear 1.
    White,
    /// Linear 0.5.
    Grey,
    /// This linear colour, each channel 0 … 1.
    Color([f32; 3]),
    /// Squares of linear 0.33 and 0.75, this many along a side of the picture.
    Checker {
        /// At least 1.
        cells: usize,
    },
    /// Black, white or a saturated colour, by the view's seed.
    Random,
}

/// What is behind the model in one view: a checker of two colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewBackground {
    /// Linear colours of the squares whose column + row is even, and odd.
    colors: [[f32; 3]; 2],
    cells: usize,
}

/// A well-mixed number for each seed (SplitMix64; Steele et al. 2014).
fn mix(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// One in four black, one in four white, else a full-strength hue.
fn random_color(seed: u64) -> [f32; 3] {
    let bits = mix(seed);
    match bits & 3 {
        0 => [0.0; 3],
        1 => [1.0; 3],
        _ => {
            let hue = 6.0 * (bits >> 40) as f32 / (1u64 << 24) as f32;
            [0.0, 2.0, 4.0].map(|peak: f32| {
                let away = (hue - peak).abs();
                (2.0 - away.min(6.0 - away)).clamp(0.0, 1.0)
            })
        }
    }
}

impl Background {
    /// What it is in the view of this seed. Only [`Background::Random`] depends on it.
    pub fn for_view(self, seed: u64) -> ViewBackground {
        let solid = |color| ViewBackground { colors: [color; 2], cells: 1 };
        match self {
            Self::Black => solid([0.0; 3]),
            Self::White => solid([1.0; 3]),
            Self::Grey => solid([0.5; 3]),
            Self::Color(color) => solid(color),
            Self::Checker { cells } => ViewBackground { colors: [[0.33; 3], [0.75; 3]], cells: cells.max(1) },
            Self::Random => solid(random_color(seed)),
        }
    }
}

/// A composed pixel: what the screen shows, and how it changes with the light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Composed {
    /// Display values; not clipped.
    pub value: [f32; 3],
    /// Their derivatives with respect to the linear light x.
    pub slope: [f32; 3],
}

/// Composition of one view's pixels: background and display together.
#[derive(Clone, Debug)]
pub struct Composer {
    background: ViewBackground,
    gain: f32,
    /// None where the display is linear.
    curve: Option<DisplayTable>,
    /// For each column (and row): is its square an odd one?
    odd: Vec<bool>,
    /// The bare background's two squares: most pixels of a view are one of them.
    bare: [Composed; 2],
}

impl Composer {
    /// For pictures of `size` pixels along a side.
    pub fn new(background: ViewBackground, display: Display, size: usize) -> Self {
        let of_display = || DisplayTable::new(&Display { gain: 1.0, ..display });
        let curve = (display.curve != Curve::Linear).then(of_display);
        let bare = background.colors.map(|c| compose(curve.as_ref(), c));
        let odd = (0..size).map(|i| (i * background.cells / size) & 1 == 1).collect();
        Self { background, gain: display.gain, curve, odd, bare }
    }

    /// Which of the background's two colours is behind a pixel.
    #[inline]
    fn square(&self, column: usize, row: usize) -> usize {
        usize::from(self.odd[column] != self.odd[row])
    }

    /// Forward: a premultiplied linear pixel in front of the background, encoded.
    #[inline]
    pub fn forward(&self, rgba: &[f32; 4], column: usize, row: usize) -> Composed {
        let square = self.square(column, row);
        if *rgba == [0.0; 4] {
            return self.bare[square];
        }
        let behind = self.background.colors[square];
        let light = std::array::from_fn(|k| self.gain * rgba[k] + (1.0 - rgba[3]) * behind[k]);
        compose(self.curve.as_ref(), light)
    }

    /// Adjoint: the gradient of the display values to that of the premultiplied pixel.
    #[inline]
    pub fn adjoint(&self, composed: &Composed, gradient: [f32; 3], column: usize, row: usize) -> [f32; 4] {
        let behind = self.background.colors[self.square(column, row)];
        let light: [f32; 3] = std::array::from_fn(|k| gradient[k] * composed.slope[k]);
        let alpha = -(light[0] * behind[0] + light[1] * behind[1] + light[2] * behind[2]);
        [light[0] * self.gain, light[1] * self.gain, light[2] * self.gain, alpha]
    }
}

#[inline]
fn compose(curve: Option<&DisplayTable>, light: [f32; 3]) -> Composed {
    let Some(curve) = curve else {
        return Composed { value: light, slope: [1.0; 3] };
    };
    let [r, g, b] = light;
    // `map` on an array is a call here.
    let [r, g, b] =
        [curve.encode_with_derivative(r), curve.encode_with_derivative(g), curve.encode_with_derivative(b)];
    Composed { value: [r.0, g.0, b.0], slope: [r.1, g.1, b.1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the gradients of colour and coverage on every background.
    #[test]
    fn adjoint_matches_central_differences() {
        let backgrounds = [Background::Black, Background::White, Background::Color([0.1, 0.7, 0.3])];
        for (i, background) in backgrounds.into_iter().chain([Background::Checker { cells: 4 }]).enumerate() {
            let curve = if i == 0 { Curve::Linear } else { Curve::Srgb };
            let composer = Composer::new(background.for_view(0), Display { gain: 1.59, curve }, 8);
            let (pixel, g) = ([0.2, 0.05, 0.4, 0.6], [0.7f32, -1.1, 0.4]);
            let value = |p: [f32; 4]| -> f32 {
                composer.forward(&p, 3, 0).value.iter().zip(g).map(|(v, g)| v * g).sum()
            };
            let analytic = composer.adjoint(&composer.forward(&pixel, 3, 0), g, 3, 0);
            for k in 0..4 {
                let (mut lo, mut hi) = (pixel, pixel);
                lo[k] -= 2e-3;
                hi[k] += 2e-3;
                let numeric = (value(hi) - value(lo)) / 4e-3;
                assert!((numeric - analytic[k]).abs() < 2e-3 * numeric.abs().max(1.0), "{i} {k}");
            }
        }
    }

    /// Protects the training against a background that a fit could learn.
    #[test]
    fn random_backgrounds_are_black_white_and_saturated() {
        let colors: Vec<[f32; 3]> = (0..400).map(random_color).collect();
        let count = |c: [f32; 3]| colors.iter().filter(|&&d| d == c).count();
        assert!((70..130).contains(&count([0.0; 3])) && (70..130).contains(&count([1.0; 3])));
        for c in colors.iter().filter(|c| **c != [0.0; 3] && **c != [1.0; 3]) {
            let (lo, hi) = (c.iter().copied().fold(1.0, f32::min), c.iter().copied().fold(0.0, f32::max));
            assert!(lo == 0.0 && hi == 1.0, "{c:?}");
        }
        assert_eq!(Background::Random.for_view(7), Background::Random.for_view(7));
    }

    /// Protects the agreement with the independent evaluator's checker: 8-pixel squares.
    #[test]
    fn checker_squares_alternate() {
        let display = Display { gain: 1.0, curve: Curve::Linear };
        let composer = Composer::new(Background::Checker { cells: 4 }.for_view(0), display, 32);
        let at = |x, y| composer.forward(&[0.0; 4], x, y).value[0];
        assert_eq!([at(0, 0), at(7, 7), at(8, 0), at(0, 8), at(8, 8)], [0.33, 0.33, 0.75, 0.75, 0.33]);
    }
}
