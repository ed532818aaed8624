//! Cutouts: a surface that is not there where it is seen from the wrong side.
//!
//! Forward: a sample at t, seen along d, is opaque where `Σ_k O_k(t) Y_k(d) ≥ 0`, with O the
//! coefficients of the opacity, fetched bilinearly at t (not at the coordinate that parallax
//! shifts to), and Y the functions of a [`Basis`] at the direction d (`directions.rs`). Elsewhere the sample is left out, and what lies behind it is
//! seen, if that is opaque.
//!
//! A point of a coarse mesh that stands out beyond the fine one is beside it for about half
//! of the directions it is seen from, so its border is nearly linear in d: low orders do.
//! Adjoint: of the sum, by the coefficients; whether a sample is there has none, so a fit
//! asks for the sum's sign with a hinge (`parbake_fit::cutout`).
//!
//! Contract: as of `parallax.rs`.

use crate::directions::with_values;
use crate::on_screen::Raster;
use crate::raster::{NOTHING, Visibility};
use parbake_image::pyramid::{Taps, taps};
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{Basis, Wrap};
use rayon::prelude::*;

/// The opacity map of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct CutoutCoefficients {
    /// The functions that they multiply; the first is the same from everywhere.
    pub basis: Basis,
    /// Texels along u.
    pub width: usize,
    /// Texels along v.
    pub height: usize,
    /// width × height texels, row 0 on top, each of as many numbers as there are functions.
    pub coefficients: Vec<f32>,
    /// Wrap modes along u and v.
    pub wrap: [Wrap; 2],
}

impl CutoutCoefficients {
    /// A map with an opacity of 1 from all sides.
    pub fn opaque(basis: Basis, size: usize) -> Self {
        let first = with_values(basis, Vec3::Z, |_, values| values[0]);
        let mut coefficients = vec![0.0; size * size * basis.count()];
        coefficients.iter_mut().step_by(basis.count()).for_each(|c| *c = 1.0 / first);
        Self { basis, width: size, height: size, coefficients, wrap: [Wrap::Clamp; 2] }
    }

    #[inline]
    fn taps(&self, uv: Vec2) -> Taps {
        taps(uv, self.width, self.height, self.wrap)
    }

    /// `Σ_k O_k(t) Y_k(d)`; `direction` as [`view_direction`](crate::directions::view_direction) has it.
    #[inline]
    pub fn opacity(&self, uv: Vec2, direction: Vec3) -> f32 {
        let at = self.taps(uv);
        with_values(self.basis, direction, |count, values| {
            let weights = at.weights();
            let of_texel = at.index.map(|index| &self.coefficients[index as usize * count..][..count]);
            let blended = |k: usize| -> f32 { (0..4).map(|i| of_texel[i][k] * weights[i]).sum() };
            let blended_lanes = |k: usize| -> Vec4 {
                (0..4).map(|i| Vec4::from_slice(&of_texel[i][k..k + 4]) * weights[i]).sum()
            };
            let in_lanes = count - count % 4;
            let sum: Vec4 = (0..in_lanes)
                .step_by(4)
                .map(|k| blended_lanes(k) * Vec4::from_slice(&values[k..k + 4]))
                .sum();
            sum.element_sum() + (in_lanes..count).map(|k| blended(k) * values[k]).sum::<f32>()
        })
    }

    /// Adjoint of [`CutoutCoefficients::opacity`] by the coefficients: adds to `into`, which has as
    /// many as this map.
    #[inline]
    pub fn adjoint(&self, uv: Vec2, direction: Vec3, to_opacity: f32, into: &mut [f32]) {
        let at = self.taps(uv);
        with_values(self.basis, direction, |count, values| {
            for (index, weight) in at.index.into_iter().zip(at.weights()) {
                let to_texel = to_opacity * weight;
                let into = &mut into[index as usize * count..][..count];
                into.iter_mut().zip(values).for_each(|(to, y)| *to += to_texel * y);
            }
        });
    }
}

/// Layers that are looked through before a pixel is taken for empty.
const MOST_LAYERS: usize = 8;

/// [`Raster::rasterise`] for surfaces with cutouts: finds the nearest triangle at each sample that is
/// opaque there. `opaque` is asked with a triangle and a point of the screen.
pub fn rasterise_cut(
    screen: &impl Raster,
    size: usize,
    offset: (f32, f32),
    seen: &mut Visibility,
    opaque: impl Fn(usize, (f64, f64)) -> bool + Sync,
) {
    screen.rasterise(size, offset, None, seen);
    let mut layer = Visibility::default();
    let at = |pixel: usize| {
        let along = |i: usize, shift: f32| i as f64 + 0.5 + f64::from(shift);
        (along(pixel % size, offset.0), along(pixel / size, offset.1))
    };
    let mut asked: Vec<usize> = (0..size * size).filter(|&p| seen.triangle[p] != NOTHING).collect();
    for depth in 0..MOST_LAYERS {
        let cut: Vec<usize> = (asked.into_par_iter())
            .filter(|&p| seen.triangle[p] != NOTHING && !opaque(seen.triangle[p] as usize, at(p)))
            .collect();
        if cut.is_empty() {
            return;
        }
        if depth + 1 < MOST_LAYERS {
            screen.rasterise(size, offset, Some(seen), &mut layer);
        }
        for &pixel in &cut {
            seen.replace(pixel, (depth + 1 < MOST_LAYERS).then_some(&layer));
        }
        asked = cut;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Projection};
    use crate::raster::ScreenTriangles;

    /// Protects the fit's gradient.
    #[test]
    fn adjoint_matches_differences() {
        let mut map =
            CutoutCoefficients { width: 3, height: 2, ..CutoutCoefficients::opaque(Basis::Harmonics(2), 0) };
        map.coefficients = (0..54).map(|i| ((i * 37 + 11) % 101) as f32 / 50.0 - 1.0).collect();
        let (uv, direction) = (Vec2::new(0.4, 0.6), Vec3::new(0.48, -0.6, 0.64));
        let mut into = vec![0.0; 54];
        map.adjoint(uv, direction, 1.5, &mut into);
        for (k, have) in into.into_iter().enumerate() {
            let mut moved = map.clone();
            moved.coefficients[k] += 1.0;
            let want = 1.5 * (moved.opacity(uv, direction) - map.opacity(uv, direction));
            assert!((have - want).abs() < 1e-4);
        }
    }

    /// Protects what is behind a cutout from being lost, and the same triangle from being
    /// found again.
    #[test]
    fn the_next_opaque_layer_is_seen() {
        let quad = |z: f32| [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]].map(|[x, y]| Vec3::new(x, y, z));
        let positions = [quad(0.5), quad(0.0), quad(-0.5)].concat();
        let triangles = [[0, 1, 2], [3, 4, 5], [6, 7, 8]];
        let camera = Camera::towards_origin(Vec3::Z, 3.5, Projection::Perspective(0.2));
        let screen = ScreenTriangles::new(&positions, &triangles, &camera, 4);
        let mut seen = Visibility::default();
        rasterise_cut(&screen, 4, (0.0, 0.0), &mut seen, |t, (x, _)| t == 2 || t == 1 && x > 2.0);
        assert_eq!(seen.triangle[..4], [2, 2, 1, 1]);
        rasterise_cut(&screen, 4, (0.0, 0.0), &mut seen, |_, _| false);
        assert!(seen.triangle.iter().all(|&t| t == NOTHING));
    }

    /// Protects surfaces without a fitted cutout: all is there.
    #[test]
    fn a_new_map_is_opaque() {
        let map = CutoutCoefficients::opaque(Basis::Harmonics(2), 4);
        assert!((map.opacity(Vec2::new(0.3, 0.9), Vec3::X) - 1.0).abs() < 1e-6);
    }
}
