//! What pixels of a view say of a shifted texture: their loss and its gradients.
//!
//! Forward: `t' = t + shift(t)` → bilinear fetch → shading → display value, less what is wanted.
//! Adjoint: the same backwards, to the texels, and through the fetch's coordinate to the map.
//!
//! A texel that is not in the cache takes longer to come than all the arithmetic of a pixel. So
//! pixels go through each of these stages in small groups: while the first waits for its texels,
//! the others' are already on their way.
//!
//! Contract: adds half the gradient of the squared differences of display values, each weighted by
//! its pixel; pixels are summed in their order.

use super::texels::{Fetched, Texel, Texels, scatter};
use crate::color::respond;
use crate::sighted::Sighted;
use parbake_model::glam::{Vec2, Vec4};
use parbake_render::display_table::DisplayTable;
use parbake_render::frame::TangentLight;
use parbake_render::parallax_variants::shift_map::{ShiftMap, Vantage};
use parbake_render::shade::cosine_with_derivative;
use parbake_render::texture::Taps;

/// Pixels of a group.
const GROUP: usize = 16;

/// Loss and gradients of some views.
pub(super) struct Sums<M> {
    /// Squared differences of all three channels.
    pub loss: f64,
    pub map: M,
    pub texels: Vec<Texel>,
}

impl<M: ShiftMap> Sums<M> {
    pub fn zeros(map: &M, texels: &Texels) -> Self {
        Self { loss: 0.0, map: map.zeros_like(), texels: vec![[Vec4::ZERO; 2]; texels.texels.len()] }
    }
}

/// Adds what one view says.
pub(super) fn add_view<M: ShiftMap>(
    pixels: &[Sighted],
    map: &M,
    texels: &Texels,
    display: &DisplayTable,
    sums: &mut Sums<M>,
) {
    let mut from = [Vantage::default(); GROUP];
    let mut light = [TangentLight::default(); GROUP];
    let mut at = [Taps::default(); GROUP];
    let mut fetched = [Fetched::default(); GROUP];
    let mut gradient = [[Vec4::ZERO; 2]; GROUP];
    let mut to_shift = [Vec2::ZERO; GROUP];
    for group in pixels.chunks(GROUP) {
        for (i, pixel) in group.iter().enumerate() {
            light[i] = pixel.light();
            from[i] = Vantage::under_headlight(pixel.sight(), &light[i]);
            at[i] = texels.taps(pixel.uv + map.shift(pixel.uv, &from[i]));
        }
        for i in 0..group.len() {
            fetched[i] = texels.fetch(&at[i]);
        }
        for (i, pixel) in group.iter().enumerate() {
            let square;
            (square, gradient[i]) = compare(pixel, &light[i], &fetched[i].value, display);
            sums.loss += f64::from(square);
            to_shift[i] = fetched[i].by_coordinate(&gradient[i], texels.size);
        }
        for i in 0..group.len() {
            scatter(&at[i], &gradient[i], &mut sums.texels);
        }
        for (i, pixel) in group.iter().enumerate() {
            map.adjoint_of_maps(pixel.uv, &from[i], to_shift[i], &mut sums.map);
        }
    }
}

/// The weighted squared difference of one pixel, and half its gradient by albedo and normal.
#[inline]
fn compare(
    pixel: &Sighted,
    light: &TangentLight,
    [albedo, normal]: &Texel,
    display: &DisplayTable,
) -> (f32, Texel) {
    let (k, per_normal) = cosine_with_derivative(light, normal.truncate());
    let [r, g, b] = pixel.target.map(|t| f32::from(t) * (1.0 / 65535.0));
    let response = respond(display, *albedo * k.max(0.0), Vec4::new(r, g, b, 0.0));
    let weight = f32::from(pixel.weight) * (1.0 / 65535.0);
    let to_light = response.residual * response.slope * weight;
    let to_k = to_light.dot(*albedo);
    // Turned away from the light: only asked to turn back, see `normal.rs`.
    let to_color = if k > 0.0 { to_light * k } else { Vec4::ZERO };
    let to_normal = if k > 0.0 || to_k < 0.0 { (per_normal * to_k).extend(0.0) } else { Vec4::ZERO };
    (response.residual.length_squared() * weight, [to_color, to_normal])
}
