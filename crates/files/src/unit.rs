//! Unit vectors as files hold them: nearly unit is left alone, so that numbers
//! survive a way through a file bit by bit; other lengths are brought to 1.

use parbake_model::glam::{Vec3, Vec4};

/// The validator of glTF allows 5e-4 from 1 in length; we keep well within.
const TOLERANCE: f64 = 1e-4;

/// The vector at unit length; `None` when it has no direction.
pub(crate) fn unit(v: Vec3) -> Option<Vec3> {
    let wide = v.as_dvec3();
    let square = wide.length_squared();
    if (square - 1.0).abs() <= TOLERANCE {
        return Some(v);
    }
    // Doubles, so that neither 1e-30 nor 1e30 leaves the range when squared.
    let length = square.sqrt();
    (length > 0.0 && length.is_finite()).then(|| (wide / length).as_vec3())
}

/// A unit tangent with w = ±1; any direction square to the normal where it has none.
pub(crate) fn unit_tangent(tangent: Vec4, normal: Vec3) -> Vec4 {
    let direction = unit(tangent.truncate()).unwrap_or_else(|| normal.any_orthonormal_vector());
    direction.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects bitwise round trips and tiny or huge vectors.
    #[test]
    fn unit_keeps_and_repairs() {
        let v = Vec3::new(0.6, 0.8, 0.0);
        assert_eq!(unit(v), Some(v));
        assert_eq!(unit(v * 1e-30).map(|u| u.distance(v) < 1e-6), Some(true));
        assert_eq!(unit(v * 1e30).map(|u| u.distance(v) < 1e-6), Some(true));
        assert_eq!(unit(Vec3::ZERO), None);
        assert_eq!(unit(Vec3::new(f32::NAN, 0.0, 0.0)), None);
        assert_eq!(unit_tangent(Vec4::new(0.0, 0.0, 0.0, -2.0), Vec3::Y).w, -1.0);
    }
}
