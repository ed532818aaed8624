//! The sRGB transfer function (IEC 61966-2-1), in doubles so that a colour comes
//! back from an OBJ file as it went in.

/// Encoded to linear; both from 0, and above 1 by the same power (strong emission).
pub(super) fn decode(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Linear to encoded; the inverse.
pub(super) fn encode(linear: f64) -> f64 {
    if linear <= 0.04045 / 12.92 { linear * 12.92 } else { linear.powf(1.0 / 2.4) * 1.055 - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects colours on their way out and in again.
    #[test]
    fn encode_and_decode_are_inverse() {
        for i in 0..=5000 {
            let linear = f64::from(i) / 1000.0;
            assert!((decode(encode(linear)) - linear).abs() < 1e-12);
        }
        assert!((decode(0.5) - 0.214_041_140_482_232_55).abs() < 1e-15);
    }
}
