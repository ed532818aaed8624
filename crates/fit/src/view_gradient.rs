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

use crate::problem::respond;
use crate::texels::{Fetched, Texel, Texels, scatter};
use parbake_image::display_table::DisplayTable;
use parbake_image::pyramid::Taps;
use parbake_model::glam::{Vec2, Vec4};
use parbake_render::frame::TangentLight;
use parbake_render::parallax_variants::shift_map::{ShiftMap, TangentView};
use parbake_render::shade::{Brdf, Jacobian};
use parbake_views::view_sample::ViewSample;

/// Pixels of a group.
const GROUP: usize = 16;

/// Loss and gradients of some views.
pub struct Sums<M, const N: usize> {
    /// Squared differences of all three channels.
    pub loss: f64,
    /// Gradient by the parallax map.
    pub map: M,
    /// Gradient by the maps, texel by texel.
    pub texels: Vec<Texel<N>>,
}

impl<M: ShiftMap, const N: usize> Sums<M, N> {
    /// Nothing yet, for these maps.
    pub fn zeros(map: &M, texels: &Texels<N>) -> Self {
        Self { loss: 0.0, map: map.zeros_like(), texels: vec![[Vec4::ZERO; N]; texels.texels.len()] }
    }
}

/// Adds what one view says.
pub(crate) fn add_view<B: Brdf, M: ShiftMap, const N: usize>(
    pixels: &[ViewSample],
    map: &M,
    texels: &Texels<N>,
    brdf: &B,
    display: &DisplayTable,
    sums: &mut Sums<M, N>,
) {
    let mut from = [TangentView::default(); GROUP];
    let mut light = [TangentLight::default(); GROUP];
    let mut at = [Taps::default(); GROUP];
    let mut fetched = [Fetched::<N>::default(); GROUP];
    let mut gradient = [[Vec4::ZERO; N]; GROUP];
    let mut to_shift = [Vec2::ZERO; GROUP];
    for group in pixels.chunks(GROUP) {
        for (i, pixel) in group.iter().enumerate() {
            light[i] = pixel.light();
            from[i] = TangentView::under_headlight(pixel.view_direction(), &light[i]);
            at[i] = texels.taps(pixel.uv + map.shift(pixel.uv, &from[i]));
        }
        for i in 0..group.len() {
            fetched[i] = texels.fetch(&at[i]);
        }
        for (i, pixel) in group.iter().enumerate() {
            let square;
            (square, gradient[i]) = compare(pixel, &light[i], &fetched[i].value, texels, brdf, display);
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

/// The weighted squared difference of one pixel, and half its gradient by each map.
#[inline]
fn compare<B: Brdf, const N: usize>(
    pixel: &ViewSample,
    light: &TangentLight,
    value: &Texel<N>,
    texels: &Texels<N>,
    brdf: &B,
    display: &DisplayTable,
) -> (f32, Texel<N>) {
    let values = texels.values(value);
    let slopes: [(Vec4, Jacobian); N] = texels.kinds.map(|kind| brdf.jacobian(kind, light, &values));
    let [r, g, b] = pixel.target.map(|t| f32::from(t) * (1.0 / 65535.0));
    let response = respond(display, slopes[0].0, Vec4::new(r, g, b, 0.0));
    let weight = f32::from(pixel.weight) * (1.0 / 65535.0);
    let to_light = response.residual * response.slope * weight;
    (response.residual.length_squared() * weight, slopes.map(|(_, slope)| slope.pull(to_light)))
}
