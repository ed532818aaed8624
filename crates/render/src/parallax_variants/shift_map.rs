//! What a fit needs of a map that shifts texture coordinates, whatever its formula.
//!
//! Forward: `t' = t + shift(t, v)`, with v from where the point t is seen.
//! Adjoint: the gradient of the shift becomes one of the map's parameters.
//!
//! Contract: shifts are finite, in texture widths, u to the right and v down; nothing depends
//! on the number of threads.

use crate::directions::ViewDirection;
use crate::frame::TangentLight;
use crate::parallax::ParallaxCoefficients;
use parbake_model::Basis;
use parbake_model::glam::{Vec2, Vec3, Vec4};

/// From where a point is seen, in the mesh's axes and in the surface's own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TangentView {
    /// Direction to the viewer in the mesh's axes, and its cosine.
    pub view_direction: ViewDirection,
    /// Direction to the viewer along tangent, bitangent and vertex normal; about of unit length.
    pub tangent: Vec3,
}

impl TangentView {
    /// Where the light stands with the viewer, shading knows the direction in the tangent frame
    /// already, but flipped on faces that are seen from behind: this turns it back.
    #[inline]
    pub fn under_headlight(view_direction: ViewDirection, light: &TangentLight) -> Self {
        let flipped = (light.light.z < 0.0) != (view_direction.cosine < 0.0);
        Self { view_direction, tangent: if flipped { -light.light } else { light.light } }
    }
}

/// A map that shifts texture coordinates and can be fitted by its gradient.
pub trait ShiftMap: Clone + Send + Sync {
    /// How far the coordinate moves, in texture widths.
    fn shift(&self, uv: Vec2, from: &TangentView) -> Vec2;

    /// Adds the gradients of the parameters to `into`, which has this map's shape.
    fn adjoint_of_maps(&self, uv: Vec2, from: &TangentView, to_shift: Vec2, into: &mut Self);

    /// The coefficients that a file can hold; none where this map is only studied.
    fn coefficients(&self) -> Option<&ParallaxCoefficients> {
        None
    }

    /// Zeros in this map's shape.
    fn zeros_like(&self) -> Self;

    /// All that is fitted, in lanes of four; the last lanes may be padding that has no gradient.
    fn parameters(&self) -> Vec<Vec4>;

    /// Takes parameters as [`ShiftMap::parameters`] gives them, brought into the range that the
    /// map allows.
    fn set_parameters(&mut self, lanes: &[Vec4]);

    /// Width and height of the texels that parameters belong to: as many to each, one texel after
    /// the other, without padding between them. None where parameters are no map.
    fn texels(&self) -> Option<[usize; 2]> {
        None
    }

    /// How far each parameter moves in a step beside the others, in the lanes of
    /// [`ShiftMap::parameters`]; empty where all move alike.
    fn parameter_scales(&self) -> Vec<Vec4> {
        Vec::new()
    }

    /// About how far a parameter has to move for a shift to move by one texture width: fits of
    /// different maps then keep the same pace.
    fn rate_scale(&self) -> f32;
}

/// No shift at all: textures as they are without parallax.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Unshifted;

impl ShiftMap for Unshifted {
    #[inline]
    fn shift(&self, _: Vec2, _: &TangentView) -> Vec2 {
        Vec2::ZERO
    }

    fn adjoint_of_maps(&self, _: Vec2, _: &TangentView, _: Vec2, _: &mut Self) {}

    fn zeros_like(&self) -> Self {
        *self
    }

    fn parameters(&self) -> Vec<Vec4> {
        Vec::new()
    }

    fn set_parameters(&mut self, _: &[Vec4]) {}

    fn rate_scale(&self) -> f32 {
        1.0
    }
}

/// Coefficients are fitted; a depth map stays as it is, since it could only scale them.
impl ShiftMap for ParallaxCoefficients {
    #[inline]
    fn shift(&self, uv: Vec2, from: &TangentView) -> Vec2 {
        ParallaxCoefficients::shift(self, uv, &from.view_direction)
    }

    #[inline]
    fn adjoint_of_maps(&self, uv: Vec2, from: &TangentView, to_shift: Vec2, into: &mut Self) {
        ParallaxCoefficients::adjoint_of_maps(self, uv, &from.view_direction, to_shift, into);
    }

    fn coefficients(&self) -> Option<&ParallaxCoefficients> {
        Some(self)
    }

    fn zeros_like(&self) -> Self {
        ParallaxCoefficients::zeros_like(self)
    }

    fn parameters(&self) -> Vec<Vec4> {
        let lane = |c: &[Vec2]| {
            let second = c.get(1).copied().unwrap_or_default();
            Vec4::new(c[0].x, c[0].y, second.x, second.y)
        };
        self.coefficients.chunks(2).map(lane).collect()
    }

    fn texels(&self) -> Option<[usize; 2]> {
        Some([self.width, self.height])
    }

    fn set_parameters(&mut self, lanes: &[Vec4]) {
        for (pair, lane) in self.coefficients.chunks_mut(2).zip(lanes) {
            for (c, x) in pair.iter_mut().zip([Vec2::new(lane.x, lane.y), Vec2::new(lane.z, lane.w)]) {
                *c = x;
            }
        }
    }

    /// Short for functions of high order: there are many, and steps in all of them at once would
    /// throw a shift about farther than they can turn it.
    fn parameter_scales(&self) -> Vec<Vec4> {
        let Basis::Harmonics(order) = self.basis else { return Vec::new() };
        let by_function: Vec<f32> =
            (0..=order).flat_map(|l| std::iter::repeat_n(stride(l), 2 * l + 1)).collect();
        let of = |i: usize| by_function[i % by_function.len()];
        let pairs = self.coefficients.len().div_ceil(2);
        (0..pairs)
            .map(|k| {
                let (a, b) = (of(2 * k), of(2 * k + 1));
                Vec4::new(a, a, b, b)
            })
            .collect()
    }

    fn rate_scale(&self) -> f32 {
        1.0
    }
}

/// The stride of functions of an order: whole up to the second, then it falls with `l (l + 1)`,
/// by which the sphere's Laplacian weighs them.
fn stride(order: usize) -> f32 {
    let beyond = (order * (order + 1)).saturating_sub(6) as f32;
    1.0 / (1.0 + 0.1 * beyond)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Protects high orders from too long steps, and each coefficient from another one's stride.
    #[test]
    fn strides_follow_their_functions() {
        let map = ParallaxCoefficients::zeros(Basis::Harmonics(3), 5);
        let parameter_scales = map.parameter_scales();
        assert_eq!(parameter_scales.len(), map.parameters().len());
        let flat: Vec<f32> = parameter_scales.iter().flat_map(|lane| lane.to_array()).collect();
        for (coefficient, pair) in flat.chunks(2).take(16 * 25).enumerate() {
            let whole = coefficient % 16 < 9;
            assert_eq!(pair, [if whole { 1.0 } else { 0.625 }; 2], "{coefficient}");
        }
        assert!(
            ParallaxCoefficients::zeros(Basis::Harmonics(2), 4)
                .parameter_scales()
                .iter()
                .all(|lane| *lane == Vec4::ONE)
        );
    }

    use crate::frame::tangent_light;

    pub(crate) fn noise(i: usize) -> f32 {
        ((i * 37 + 11) % 101) as f32 / 50.0 - 1.0
    }

    /// A test_view above the surface, in the mesh's axes as in the surface's.
    pub(crate) fn test_view(i: usize) -> TangentView {
        let direction = Vec3::new(noise(i), noise(2 * i + 3), 0.3 + noise(3 * i + 8).abs()).normalize();
        TangentView { view_direction: ViewDirection { direction, cosine: direction.z }, tangent: direction }
    }

    /// How far the gradient of a map's parameters is off central differences of `step`, at the
    /// worst of all parameters; `smooth` says where the shift has no kink within a step.
    pub(crate) fn worst_gradient<M: ShiftMap>(
        map: &M,
        uv: Vec2,
        from: &TangentView,
        step: f32,
        smooth: impl Fn(&M, &M) -> bool,
    ) -> f32 {
        let to_shift = Vec2::new(0.7, -1.3);
        let mut into = map.zeros_like();
        map.adjoint_of_maps(uv, from, to_shift, &mut into);
        let (have, values) = (into.parameters(), map.parameters());
        let mut worst = 0.0f32;
        for lane in 0..values.len() {
            for k in 0..4 {
                let [down, up] = [-step, step].map(|by| {
                    let (mut moved, mut lanes) = (map.clone(), values.clone());
                    lanes[lane][k] += by;
                    moved.set_parameters(&lanes);
                    moved
                });
                // Padding does not come back, and has no gradient.
                if up.parameters()[lane][k] == values[lane][k] {
                    assert_eq!(have[lane][k], 0.0);
                } else if smooth(&down, &up) {
                    let difference = up.shift(uv, from) - down.shift(uv, from);
                    worst = worst.max((difference.dot(to_shift) / (2.0 * step) - have[lane][k]).abs());
                }
            }
        }
        worst
    }

    /// Protects the spherical harmonics behind the interface: an odd number of coefficients
    /// comes back from its lanes, and the gradient is that of the shift.
    #[test]
    fn coefficients_pass_through_lanes() {
        let mut map = ParallaxCoefficients {
            width: 3,
            height: 1,
            ..ParallaxCoefficients::zeros(Basis::Harmonics(0), 0)
        };
        map.coefficients = (0..3).map(|i| Vec2::new(noise(i), noise(i + 7))).collect();
        let mut back = map.zeros_like();
        back.set_parameters(&map.parameters());
        assert_eq!(back, map);
        assert!(worst_gradient(&map, Vec2::new(0.4, 0.5), &test_view(1), 0.5, |_, _| true) < 1e-5);
    }

    /// Protects surfaces seen from behind: the direction is that to the viewer on both sides.
    #[test]
    fn a_flipped_light_is_turned_back() {
        for direction in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.6, 0.0, -0.8)] {
            let light = tangent_light(Vec3::Z, Vec3::X, 1.0, direction, direction.z.signum());
            let view_direction = ViewDirection { direction, cosine: direction.z };
            assert_eq!(TangentView::under_headlight(view_direction, &light).tangent, direction);
        }
    }
}
