//! Parallax from a height map: the four classic variants of Table 1 (Knodt et al. 2023).
//!
//! With h the map, which counts downwards from the surface in units of the scale s, v the
//! direction to the viewer in the tangent frame, and v_z no less than the limit:
//!
//! * parallax (Kaneko et al. 2001): `t' = t − s v_xy h(t) / v_z`
//! * with offset limiting (Welsh 2004): `t' = t − s v_xy h(t)`
//! * steep (McGuire and McGuire 2005), occlusion (Tatarchuk 2006): see `march.rs`.
//!
//! The paper lets h count upwards in the first two; downwards is what a march can follow.
//! Adjoint: all heights that the shift was made from, by the product rule.
//!
//! Contract: heights are 0 … 1, as an image holds them and as layers divide them; whatever
//! parameters are set is brought into that range.

use super::heights::Heights;
use super::march::March;
use super::shift_map::{ShiftMap, TangentView};
use parbake_image::FloatImage;
use parbake_model::Wrap;
use parbake_model::glam::{Vec2, Vec4};

/// Which formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Parallax mapping.
    Parallax,
    /// Parallax mapping with offset limiting.
    OffsetLimited,
    /// Steep parallax mapping.
    Steep,
    /// Parallax occlusion mapping.
    Occlusion,
}

/// The paper's height scale, in texture widths.
pub const SCALE: f32 = 1e-2;
/// Where marches begin: they have a gradient only below the surface.
const MARCH_START: f32 = 0.5;

/// A height map and how it is read.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightParallax {
    /// Which formula.
    pub variant: Variant,
    /// Heights in units of the scale.
    pub heights: Heights,
    /// Texture widths that a height of 1 spans, > 0.
    pub scale: f32,
    /// The least |v_z| that a shift is divided by, > 0.
    pub limit: f32,
}

impl HeightParallax {
    /// What a fit begins with: a flat map of `size`² texels, which shifts nothing, or for a
    /// march lies half-way down; a height of 1 spans `scale` texture widths.
    pub fn flat(variant: Variant, size: usize, scale: f32) -> Self {
        let start = if variant.marches() { MARCH_START } else { 0.0 };
        let level = FloatImage { width: size, height: size, texels: vec![[start]; size * size] };
        Self { variant, heights: Heights { level, wrap: [Wrap::Clamp; 2] }, scale, limit: 0.25 }
    }

    /// Where a height of 1 is met: away from the viewer, in texture widths.
    #[inline]
    fn lean(&self, from: &TangentView) -> Vec2 {
        let v = from.tangent;
        let divisor = match self.variant {
            Variant::OffsetLimited => 1.0,
            _ => v.z.abs().max(self.limit),
        };
        // The bitangent points up in the texture, v down.
        Vec2::new(-v.x, v.y) * (self.scale / divisor)
    }

    fn march(&self, uv: Vec2, from: &TangentView) -> March {
        March::new(&self.heights, uv, self.lean(from), self.variant == Variant::Occlusion)
    }
}

impl Variant {
    /// Whether the formula goes through layers.
    pub fn marches(self) -> bool {
        matches!(self, Variant::Steep | Variant::Occlusion)
    }
}

impl ShiftMap for HeightParallax {
    #[inline]
    fn shift(&self, uv: Vec2, from: &TangentView) -> Vec2 {
        match self.variant.marches() {
            true => self.march(uv, from).shift(),
            false => self.lean(from) * self.heights.at(uv),
        }
    }

    #[inline]
    fn adjoint_of_maps(&self, uv: Vec2, from: &TangentView, to_shift: Vec2, into: &mut Self) {
        match self.variant.marches() {
            true => self.march(uv, from).adjoint(&self.heights, to_shift, &mut into.heights.level),
            false => into.heights.level.scatter(&self.heights.taps(uv), &[self.lean(from).dot(to_shift)]),
        }
    }

    fn zeros_like(&self) -> Self {
        let Heights { level, wrap } = &self.heights;
        Self {
            heights: Heights { level: FloatImage::zeros(level.width, level.height), wrap: *wrap },
            ..*self
        }
    }

    fn parameters(&self) -> Vec<Vec4> {
        let lane = |t: &[[f32; 1]]| Vec4::from(std::array::from_fn(|k| t.get(k).map_or(0.0, |t| t[0])));
        self.heights.level.texels.chunks(4).map(lane).collect()
    }

    fn set_parameters(&mut self, lanes: &[Vec4]) {
        for (texels, lane) in self.heights.level.texels.chunks_mut(4).zip(lanes) {
            for (texel, x) in texels.iter_mut().zip(lane.to_array()) {
                *texel = [x.clamp(0.0, 1.0)];
            }
        }
    }

    fn rate_scale(&self) -> f32 {
        1.0 / self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::super::shift_map::tests::{noise, test_view, worst_gradient};
    use super::*;
    use crate::directions::ViewDirection;
    use parbake_model::glam::Vec3;

    fn map(variant: Variant) -> HeightParallax {
        let texels = (0..6 * 5).map(|i| [0.5 + 0.3 * noise(7 * i + 2)]).collect();
        let mut map = HeightParallax::flat(variant, 1, 0.2);
        map.heights.level = FloatImage { width: 6, height: 5, texels };
        map
    }

    /// Protects the gradients of all four: they are those of the shift, the layer at which a
    /// march ends held.
    #[test]
    fn adjoints_match_central_differences() {
        for variant in [Variant::Parallax, Variant::OffsetLimited, Variant::Steep, Variant::Occlusion] {
            for i in 0..30 {
                let uv = Vec2::new(0.5 + 0.4 * noise(5 * i), 0.5 + 0.4 * noise(3 * i + 1));
                let (map, from) = (map(variant), test_view(i));
                let path =
                    |m: &HeightParallax| variant.marches().then(|| m.march(uv, &from).path(&m.heights));
                let smooth = |down: &HeightParallax, up: &HeightParallax| path(down) == path(up);
                let worst = worst_gradient(&map, uv, &from, 1e-3, smooth);
                assert!(worst < 2e-3, "{variant:?} {i}: {worst}");
            }
        }
    }

    /// Protects the sense of a shift: what lies deeper is seen farther from the viewer, and
    /// offset limiting and the limit hold it back.
    #[test]
    fn what_is_deep_recedes() {
        let from = |x: f32, z: f32| {
            let direction = Vec3::new(x, 0.0, z);
            TangentView { view_direction: ViewDirection { direction, cosine: z }, tangent: direction }
        };
        for variant in [Variant::Parallax, Variant::OffsetLimited, Variant::Steep, Variant::Occlusion] {
            let mut map = HeightParallax::flat(variant, 1, SCALE);
            map.heights.level.texels[0] = [1.0];
            let shift = map.shift(Vec2::splat(0.5), &from(0.6, 0.8));
            let want = if variant == Variant::OffsetLimited { -0.006 } else { -0.0075 };
            assert!((shift - Vec2::new(want, 0.0)).length() < 1e-6, "{variant:?} {shift}");
            assert!(map.shift(Vec2::splat(0.5), &from(1.0, 0.0)).length() < 0.0401);
        }
    }
}
