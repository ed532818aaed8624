//! The thin plate (`thin_plate.rs`) through a parallax map's texels: coefficients that no view
//! tells apart from their neighbours' follow those, so lines stay whole where shifts are far.
//!
//! Contract: only texels that some view fetches count, so no chart holds another; maps without
//! texels have no plate.

use parbake_image::pyramid::taps;
use parbake_model::Wrap;
use parbake_model::glam::Vec4;
use parbake_render::parallax_variants::shift_map::ShiftMap;
use parbake_solve::thin_plate::ThinPlate;
use parbake_views::view_sample::ViewSample;
use rayon::prelude::*;

/// A plate on the texels that views fetch.
pub(super) struct MapPlate {
    plate: ThinPlate,
    texels: usize,
}

impl MapPlate {
    /// None where the map's parameters lie on no texels.
    pub fn new<M: ShiftMap>(views: &[Vec<ViewSample>], map: &M) -> Option<Self> {
        let [width, height] = map.texels()?;
        let texels = width * height;
        let fetched_by = |samples: &Vec<ViewSample>| {
            let mut fetched = vec![false; texels];
            for sample in samples {
                let at = taps(sample.uv, width, height, [Wrap::Clamp; 2]);
                at.index.into_iter().for_each(|i| fetched[i as usize] = true);
            }
            fetched
        };
        let either = |mut a: Vec<bool>, b: Vec<bool>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a |= b);
            a
        };
        let fetched = views.par_iter().map(fetched_by).reduce(|| vec![false; texels], either);
        Some(Self { plate: ThinPlate::new(width, fetched), texels })
    }

    /// Half the gradient of `weight / texels · Σ |bend|²`, in lanes as the map's parameters are.
    pub fn pull<M: ShiftMap>(&self, map: &M, weight: f32) -> Vec<Vec4> {
        let values: Vec<f32> = map.parameters().iter().flat_map(|lane| lane.to_array()).collect();
        let mut pull = vec![0.0; values.len()];
        self.plate.add_gradient(&values, weight / self.texels as f32, &mut pull);
        pull.chunks_exact(4).map(Vec4::from_slice).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::Basis;
    use parbake_model::glam::Vec2;
    use parbake_render::parallax::ParallaxCoefficients;
    use parbake_render::parallax_variants::shift_map::Unshifted;

    /// A pixel that fetches the texel in this column and row of three.
    fn at(u: usize, v: usize) -> ViewSample {
        let uv = Vec2::new(u as f32 + 0.5, v as f32 + 0.5) / 3.0;
        ViewSample::at(uv)
    }

    /// Protects maps whose last lane is padding, and texels that no view fetches: a bump in the
    /// middle of what is seen is pulled down, its neighbours up, and nothing else moves.
    #[test]
    fn a_bump_is_pulled_flat_where_views_look() {
        let mut map = ParallaxCoefficients::zeros(Basis::Harmonics(0), 3);
        map.coefficients[4] = Vec2::new(1.0, -2.0);
        let row: Vec<ViewSample> = (0..3).map(|u| at(u, 1)).collect();
        let pull = MapPlate::new(&[row], &map).unwrap().pull(&map, 9.0);
        assert_eq!(pull.len(), map.parameters().len());
        let values: Vec<f32> = pull.iter().flat_map(|lane| lane.to_array()).collect();
        let row = [[-2.0, 4.0], [4.0, -8.0], [-2.0, 4.0]].into_iter().flatten();
        let expected = [0.0; 6].into_iter().chain(row).chain([0.0; 8]);
        values.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-5, "{values:?}"));
    }

    /// Protects maps of other kinds.
    #[test]
    fn what_has_no_texels_has_no_plate() {
        assert!(MapPlate::new(&[vec![at(1, 1)]], &Unshifted).is_none());
    }
}
