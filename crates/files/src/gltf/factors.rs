//! Factors of materials as a document has them: in range, and left out where they say nothing.

use serde_json::{Value, json};

/// From 0 to 1; `otherwise` where it is no number.
pub(super) fn in_range(x: f32, otherwise: f64) -> f64 {
    if x.is_nan() { otherwise } else { f64::from(x).clamp(0.0, 1.0) }
}

/// A number without an upper limit; `None` where it is the default, or not finite.
pub(super) fn from_zero(x: f32, default: f32) -> Option<f64> {
    (x.is_finite() && x != default).then(|| f64::from(x.max(0.0)))
}

/// 0 and 1 without a decimal point.
pub(super) fn short(x: f64) -> Value {
    if x == 0.0 || x == 1.0 { json!(x as u8) } else { x.into() }
}
