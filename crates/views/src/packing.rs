//! How light meets a surface, in 16 bits a number: none of the nine exceeds 1.

use parbake_model::glam::Vec3;
use parbake_render::frame::TangentLight;

/// Inverse of [`packed`].
#[inline]
pub(crate) fn unpacked(light: [i16; 9]) -> TangentLight {
    let [x, y, z, tt, bb, nn, tb, tn, bn] = light.map(|v| f32::from(v) * (1.0 / 32767.0));
    TangentLight { light: Vec3::new(x, y, z), gram: [tt, bb, nn, tb, tn, bn] }
}

/// The light's three numbers and the Gram matrix's six, in 32767ths.
pub(crate) fn packed(light: &TangentLight) -> [i16; 9] {
    let [x, y, z] = light.light.to_array();
    let [tt, bb, nn, tb, tn, bn] = light.gram;
    [x, y, z, tt, bb, nn, tb, tn, bn].map(|v| (v.clamp(-1.0, 1.0) * 32767.0).round_ties_even() as i16)
}
