//! Parallax: texture coordinates that shift with the direction they are seen from.
//!
//! Forward (Knodt et al. 2023, eqs. 4 and 5, with other functions if need be), for a point with coordinate t,
//! seen along d:
//!
//! `t' = t + D(t) / max(|n·d|, limit) · Σ_k T_k(t) Y_k(d)`
//!
//! with T the coefficients (a pair of numbers for each function, in texture widths), D the
//! depth (1 where there is no map), Y the functions of a [`Basis`] and d the direction that these are functions of
//! (`directions.rs`), n the interpolated vertex normal, both of unit length. All maps are fetched at t, bilinearly, without mip levels;
//! colours and normals are then fetched at t' with the footprint that they would have at t.
//! Adjoint: by the product rule; what T and D are fetched with goes to their texels.
//!
//! Contract: n·d is in [−1, 1]; where it is below the limit it has no gradient.

use crate::directions::{ViewDirection, adjoint as directions_adjoint, with_values};
use crate::spherical_harmonics::MOST_FUNCTIONS;
use parbake_image::FloatImage;
use parbake_image::pyramid::{Taps, taps};
use parbake_model::glam::{Vec2, Vec3, Vec4, Vec4Swizzles};
use parbake_model::{Basis, Wrap};

/// The coefficient maps of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct ParallaxCoefficients {
    /// The functions that they multiply.
    pub basis: Basis,
    /// Texels along u.
    pub width: usize,
    /// Texels along v.
    pub height: usize,
    /// width × height texels, row 0 on top, each of as many pairs as there are functions.
    pub coefficients: Vec<Vec2>,
    /// Multiplies the shift; 1 everywhere where there is none.
    pub depth: Option<FloatImage<[f32; 1]>>,
    /// The least |n·d| that the shift is divided by, > 0.
    pub limit: f32,
    /// Wrap modes of all maps along u and v.
    pub wrap: [Wrap; 2],
}

/// Gradients of what a shift was made from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShiftGradient {
    /// Of the coordinate at which the maps were fetched (t' = t + shift adds its own).
    pub uv: Vec2,
    /// Of the direction to the viewer.
    pub direction: Vec3,
    /// Of the cosine.
    pub cosine: f32,
}

/// What a shift is multiplied with on its way from the functions.
#[derive(Clone, Copy)]
struct Factors {
    /// 1 / max(|n·d|, limit).
    steepness: f32,
    depth: f32,
}

/// Two pairs as one vector.
#[inline(always)]
fn lanes(pairs: &[Vec2]) -> Vec4 {
    Vec4::new(pairs[0].x, pairs[0].y, pairs[1].x, pairs[1].y)
}

impl ParallaxCoefficients {
    /// A map that shifts nothing.
    pub fn zeros(basis: Basis, size: usize) -> Self {
        Self {
            basis,
            width: size,
            height: size,
            coefficients: vec![Vec2::ZERO; size * size * basis.count()],
            depth: None,
            limit: 0.25,
            wrap: [Wrap::Clamp; 2],
        }
    }

    /// Zeros in this map's shape, depth included.
    pub fn zeros_like(&self) -> Self {
        let coefficients = vec![Vec2::ZERO; self.coefficients.len()];
        let depth = self.depth.as_ref().map(|d| FloatImage::zeros(d.width, d.height));
        Self { coefficients, depth, ..*self }
    }

    /// Where the coefficients of this coordinate lie.
    #[inline]
    pub fn taps(&self, uv: Vec2) -> Taps {
        taps(uv, self.width, self.height, self.wrap)
    }

    /// The first coefficient of a texel.
    #[inline]
    fn texel(&self, index: u32) -> &[Vec2] {
        let count = self.basis.count();
        let start = index as usize * count;
        &self.coefficients[start..start + count]
    }

    /// `Σ_k T_k Y_k` of one texel.
    #[inline]
    fn at_texel(&self, index: u32, values: &[f32; MOST_FUNCTIONS]) -> Vec2 {
        self.texel(index).iter().zip(values).fold(Vec2::ZERO, |sum, (c, y)| sum + *c * *y)
    }

    #[inline]
    fn factors(&self, uv: Vec2, view_direction: &ViewDirection) -> Factors {
        let steepness = 1.0 / view_direction.cosine.abs().max(self.limit);
        let depth =
            self.depth.as_ref().map_or(1.0, |map| map.fetch(&taps(uv, map.width, map.height, self.wrap))[0]);
        Factors { steepness, depth }
    }

    /// `Σ_k T_k(t) Y_k(d)`.
    #[inline]
    fn sum(&self, at: &Taps, direction: Vec3) -> Vec2 {
        with_values(self.basis, direction, |count, values| {
            let weights = at.weights();
            let of_texel = at.index.map(|index| &self.coefficients[index as usize * count..][..count]);
            let mut sum = Vec4::ZERO;
            for k in (0..count - 1).step_by(2) {
                let blended: Vec4 = (0..4).map(|i| lanes(&of_texel[i][k..k + 2]) * weights[i]).sum();
                sum += blended * Vec4::new(values[k], values[k], values[k + 1], values[k + 1]);
            }
            let mut sum = sum.xy() + sum.zw();
            if count % 2 == 1 {
                let blended: Vec2 = (0..4).map(|i| of_texel[i][count - 1] * weights[i]).sum();
                sum += blended * values[count - 1];
            }
            sum
        })
    }

    /// How far the coordinate moves, in texture widths.
    #[inline]
    pub fn shift(&self, uv: Vec2, view_direction: &ViewDirection) -> Vec2 {
        let Factors { steepness, depth } = self.factors(uv, view_direction);
        self.sum(&self.taps(uv), view_direction.direction) * (steepness * depth)
    }

    /// The part of [`ParallaxCoefficients::adjoint`] that goes to the maps: all that a fit needs whose
    /// surface stands still.
    #[inline]
    pub fn adjoint_of_maps(&self, uv: Vec2, view_direction: &ViewDirection, to_shift: Vec2, into: &mut Self) {
        let at = self.taps(uv);
        let Factors { steepness, depth } = self.factors(uv, view_direction);
        if let (Some(map), Some(into)) = (&self.depth, &mut into.depth) {
            let sum = self.sum(&at, view_direction.direction);
            into.scatter(&taps(uv, map.width, map.height, self.wrap), &[sum.dot(to_shift) * steepness]);
        }
        let to_sum = to_shift * (steepness * depth);
        with_values(self.basis, view_direction.direction, |count, values| {
            for (index, weight) in at.index.into_iter().zip(at.weights()) {
                let to_texel = to_sum * weight;
                let to_lanes = Vec4::new(to_texel.x, to_texel.y, to_texel.x, to_texel.y);
                let into = &mut into.coefficients[index as usize * count..][..count];
                for k in (0..count - 1).step_by(2) {
                    let y = Vec4::new(values[k], values[k], values[k + 1], values[k + 1]);
                    let to = lanes(&into[k..k + 2]) + to_lanes * y;
                    into[k] = to.xy();
                    into[k + 1] = to.zw();
                }
                if count % 2 == 1 {
                    into[count - 1] += to_texel * values[count - 1];
                }
            }
        });
    }

    /// The part of [`ParallaxCoefficients::adjoint`] that goes to the point and to the direction.
    pub fn view_direction_adjoint(
        &self,
        uv: Vec2,
        view_direction: &ViewDirection,
        to_shift: Vec2,
    ) -> ShiftGradient {
        let values = with_values(self.basis, view_direction.direction, |_, values| *values);
        let count = self.basis.count();
        let at = self.taps(uv);
        let weights = at.weights();
        let sums = at.index.map(|index| self.at_texel(index, &values));
        let sum: Vec2 = sums.iter().zip(weights).map(|(s, w)| *s * w).sum();
        let Factors { steepness, depth } = self.factors(uv, view_direction);
        let to_sum = to_shift * (steepness * depth);

        let mut to_values = [0.0; MOST_FUNCTIONS];
        for (index, weight) in at.index.into_iter().zip(weights) {
            for (to, c) in to_values[..count].iter_mut().zip(self.texel(index)) {
                *to += weight * c.dot(to_sum);
            }
        }
        let [a, b, c, d] = sums.map(|s| s.dot(to_sum));
        let mut to_uv = Vec2::new(
            ((b - a) * (1.0 - at.fy) + (d - c) * at.fy) * self.width as f32,
            ((c - a) * (1.0 - at.fx) + (d - b) * at.fx) * self.height as f32,
        );
        let along = sum.dot(to_shift);
        if let Some(map) = &self.depth {
            let at = taps(uv, map.width, map.height, self.wrap);
            to_uv += map.uv_adjoint(&at, &[along * steepness]);
        }
        let to_cosine = -along * depth * steepness * steepness * view_direction.cosine.signum();
        ShiftGradient {
            uv: to_uv,
            direction: directions_adjoint(self.basis, view_direction.direction, &to_values),
            cosine: if view_direction.cosine.abs() < self.limit { 0.0 } else { to_cosine },
        }
    }

    /// Adjoint of [`ParallaxCoefficients::shift`]: adds to the maps' gradients (`into` has this map's
    /// shape) and returns those of the rest.
    pub fn adjoint(
        &self,
        uv: Vec2,
        view_direction: &ViewDirection,
        to_shift: Vec2,
        into: &mut Self,
    ) -> ShiftGradient {
        self.adjoint_of_maps(uv, view_direction, to_shift, into);
        self.view_direction_adjoint(uv, view_direction, to_shift)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(i: usize) -> f32 {
        ((i * 37 + 11) % 101) as f32 / 50.0 - 1.0
    }

    fn map(with_depth: bool) -> ParallaxCoefficients {
        let mut map = ParallaxCoefficients {
            width: 5,
            height: 4,
            ..ParallaxCoefficients::zeros(Basis::Harmonics(3), 0)
        };
        map.coefficients = (0..5 * 4 * 16).map(|i| Vec2::new(noise(i), noise(3 * i + 1))).collect();
        map.depth = with_depth.then(|| FloatImage {
            width: 3,
            height: 6,
            texels: (0..18).map(|i| [noise(5 * i + 2)]).collect(),
        });
        map
    }

    /// Protects all gradients of eq. 4: coefficients, depth, coordinate, direction, cosine.
    #[test]
    fn adjoint_matches_central_differences() {
        let to_shift = Vec2::new(0.7, -1.3);
        for with_depth in [false, true] {
            let map = map(with_depth);
            let value = |map: &ParallaxCoefficients, uv, view_direction: &ViewDirection| {
                map.shift(uv, view_direction).dot(to_shift)
            };
            for i in 0..40 {
                let uv = Vec2::new(0.5 + 0.4 * noise(7 * i), 0.5 + 0.4 * noise(11 * i + 5));
                let direction = Vec3::new(noise(i), noise(2 * i + 3), 1.5 * noise(i + 8)).normalize();
                let view_direction = ViewDirection { direction, cosine: noise(13 * i + 1) };
                let mut into = map.clone();
                into.coefficients.fill(Vec2::ZERO);
                into.depth.iter_mut().for_each(|d| d.texels.fill([0.0]));
                let got = map.adjoint(uv, &view_direction, to_shift, &mut into);
                let h = 1e-3;
                let close = |have: f32, want: f32| {
                    assert!((have - want).abs() < 2e-2 * want.abs().max(1.0), "{i}: {have} {want}");
                };
                for k in (0..map.coefficients.len()).step_by(3) {
                    let mut moved = map.clone();
                    moved.coefficients[k].y += 1.0;
                    close(
                        into.coefficients[k].y,
                        value(&moved, uv, &view_direction) - value(&map, uv, &view_direction),
                    );
                }
                for k in 0..map.depth.as_ref().map_or(0, |d| d.texels.len()) {
                    let mut moved = map.clone();
                    moved.depth.iter_mut().for_each(|d| d.texels[k][0] += 1.0);
                    let have = into.depth.as_ref().map_or(0.0, |d| d.texels[k][0]);
                    close(have, value(&moved, uv, &view_direction) - value(&map, uv, &view_direction));
                }
                let along = |f: &dyn Fn(f32) -> f32| (f(h) - f(-h)) / (2.0 * h);
                let kinked = |uv: Vec2, n: usize, axis: usize| {
                    ((uv[axis] - h) * n as f32 - 0.5).floor() != ((uv[axis] + h) * n as f32 - 0.5).floor()
                };
                if !(kinked(uv, 5, 0) || kinked(uv, 3, 0)) {
                    close(got.uv.x, along(&|h| value(&map, uv + Vec2::X * h, &view_direction)));
                }
                if !(kinked(uv, 4, 1) || kinked(uv, 6, 1)) {
                    close(got.uv.y, along(&|h| value(&map, uv + Vec2::Y * h, &view_direction)));
                }
                if (view_direction.cosine.abs() - map.limit).abs() > h {
                    let at = |h: f32| ViewDirection { cosine: view_direction.cosine + h, ..view_direction };
                    close(got.cosine, along(&|h| value(&map, uv, &at(h))));
                }
                let across = direction.any_orthonormal_vector();
                let at = |h: f32| ViewDirection {
                    direction: (direction + across * h).normalize(),
                    ..view_direction
                };
                close(got.direction.dot(across), along(&|h| value(&map, uv, &at(h))));
            }
        }
    }

    /// Protects from blow-ups: at grazing angles the division stops at the limit.
    #[test]
    fn grazing_views_are_limited() {
        let mut map = ParallaxCoefficients::zeros(Basis::Harmonics(0), 1);
        map.coefficients[0] = Vec2::new(1.0, 0.0);
        let shift = |cosine| map.shift(Vec2::splat(0.5), &ViewDirection { direction: Vec3::Z, cosine }).x;
        assert_eq!(shift(0.0), shift(0.25));
        assert!((shift(0.25) / shift(1.0) - 4.0).abs() < 1e-5);
        assert_eq!(shift(-0.5), shift(0.5));
    }
}
