//! The display transform: linear light to what a screen shows.
//!
//! `e = curve(gain · x)`, the curve being the sRGB transfer function
//! (IEC 61966-2-1) or none. Adjoint: `gain · curve'(gain · x)`. Clipping at 1 is
//! left to whoever compares: a fit still wants to know on which side it is.
//!
//! Contract: defined for all finite x; below 0 and above 1 the curve goes on.

/// How linear light is encoded before two pictures are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curve {
    /// IEC 61966-2-1, what screens expect.
    #[default]
    Srgb,
    /// None: the numbers as they are.
    Linear,
}

/// Gain and curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Display {
    /// Light intensity: multiplies linear light, > 0.
    pub gain: f32,
    /// Applied after the gain.
    pub curve: Curve,
}

impl Display {
    /// Linear light to display value.
    #[inline]
    pub fn encode(&self, linear: f32) -> f32 {
        let x = linear * self.gain;
        match self.curve {
            Curve::Srgb => encode_srgb(x),
            Curve::Linear => x,
        }
    }

    /// Derivative of [`Display::encode`].
    #[inline]
    pub fn derivative(&self, linear: f32) -> f32 {
        let x = linear * self.gain;
        match self.curve {
            Curve::Srgb if x > 0.003_130_8 => self.gain * (1.055 / 2.4) * x.powf(1.0 / 2.4 - 1.0),
            Curve::Srgb => self.gain * 12.92,
            Curve::Linear => self.gain,
        }
    }

    /// Value and derivative together: one power instead of two.
    #[inline]
    pub fn encode_with_derivative(&self, linear: f32) -> (f32, f32) {
        let x = linear * self.gain;
        match self.curve {
            Curve::Srgb if x > 0.003_130_8 => {
                let power = x.powf(1.0 / 2.4);
                (1.055 * power - 0.055, self.gain * (1.055 / 2.4) * power / x)
            }
            Curve::Srgb => (12.92 * x, self.gain * 12.92),
            Curve::Linear => (x, self.gain),
        }
    }
}

/// Linear light to sRGB.
#[inline]
pub fn encode_srgb(x: f32) -> f32 {
    if x <= 0.003_130_8 { x * 12.92 } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

/// sRGB to linear light.
#[inline]
pub fn decode_srgb(x: f32) -> f32 {
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects colour round trips through files.
    #[test]
    fn srgb_round_trips() {
        for i in 0..=255 {
            let x = i as f32 / 255.0;
            assert!((encode_srgb(decode_srgb(x)) - x).abs() < 1e-5);
        }
    }

    /// Protects the gradient through the curve, above 1 too.
    #[test]
    fn derivative_matches_central_differences() {
        for curve in [Curve::Srgb, Curve::Linear] {
            let display = Display { gain: 1.59, curve };
            for x in [0.0005f32, 0.02, 0.3, 0.9, 1.3] {
                let h = x * 1e-2;
                let numeric = (display.encode(x + h) - display.encode(x - h)) / (2.0 * h);
                let (value, derivative) = display.encode_with_derivative(x);
                assert!((numeric / derivative - 1.0).abs() < 2e-3);
                assert!((derivative / display.derivative(x) - 1.0).abs() < 1e-5);
                assert!((value - display.encode(x)).abs() < 1e-6);
            }
        }
    }
}
