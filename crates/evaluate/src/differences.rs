//! Where on its surface a copy of a model looks different: each pixel's error, with the triangle of the copy and the triangle of the
//! finer surface that are seen there.
//!
//! ```text
//! pictures of the original ─┬ squared differences ─┬ for each pair (triangle of the copy, triangle of the surface) their sum
//! pictures of the copy ─────┘   which triangles ───┘
//! ```
//!
//! The errors of a picture count as shares of its own sum: the PSNR of several pictures is a mean of logarithms. Beside an
//! outline a pixel may show only one of the two; then the other one's triangle is that of a pixel beside it.
//!
//! Contract: deterministic, in ascending order of triangles. What is blended, cut out or seen
//! from behind counts as if it were opaque and seen from both sides.

use crate::screen_size::{Compared, Pictures};
use parbake_model::Mesh;
use parbake_render::raster::{NOTHING, rasterised};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The error where two triangles are seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Triangle of the copy.
    pub of_copy: u32,
    /// Triangle of the surface that it is a copy of.
    pub of_surface: u32,
    /// The squared differences of the pixels that show both, each picture's as a share of its own sum, added up over all pictures; above 0
    /// and at most the number of pictures.
    pub error: f64,
}

/// Tells where copies of a surface look different.
pub struct Differences<'p> {
    pictures: &'p Pictures,
    /// For each picture the triangle of the surface at each pixel.
    seen: Vec<Vec<u32>>,
}

impl<'p> Differences<'p> {
    /// For copies of this surface, which has the coordinates of the model whose pictures these are, and may have other
    /// triangles.
    pub fn new(pictures: &'p Pictures, surface: &Mesh) -> Self {
        Self { pictures, seen: seen(pictures, surface) }
    }

    /// Where one of them differs; `compared` says how it compares with the same pictures.
    pub fn of(&self, copy: &Mesh, compared: &Compared) -> Vec<Difference> {
        let own = seen(self.pictures, copy);
        let size = self.pictures.size();
        let views = (own.par_iter().zip(&self.seen).zip(&compared.errors))
            .map(|((own, others), errors)| sums(size, own, others, errors));
        let mut all = BTreeMap::new();
        for sums in views.collect::<Vec<_>>() {
            sums.into_iter().for_each(|(pair, error)| *all.entry(pair).or_insert(0.0) += error);
        }
        let difference = |((of_copy, of_surface), error)| Difference { of_copy, of_surface, error };
        all.into_iter().map(difference).collect()
    }
}

/// The triangles that are seen from each direction, of a mesh in the original's coordinates.
fn seen(pictures: &Pictures, mesh: &Mesh) -> Vec<Vec<u32>> {
    let positions = pictures.renderer().in_frame(mesh);
    let size = pictures.size();
    let from = |direction| {
        let camera = pictures.renderer().camera(direction);
        rasterised(&positions, &mesh.triangles, &camera, size).triangle
    };
    pictures.directions().into_par_iter().map(from).collect()
}

/// The errors of a picture by the triangles that are seen, as shares of all.
fn sums(size: usize, own: &[u32], others: &[u32], errors: &[f32]) -> BTreeMap<(u32, u32), f64> {
    let mut sums = BTreeMap::new();
    let shown = || errors.iter().enumerate().filter(|(_, error)| **error > 0.0 && error.is_finite());
    let total: f64 = shown().map(|(_, &error)| f64::from(error)).sum();
    for (pixel, &error) in shown() {
        if let (Some(own), Some(other)) = (at_or_beside(size, own, pixel), at_or_beside(size, others, pixel))
        {
            *sums.entry((own, other)).or_insert(0.0) += f64::from(error) / total;
        }
    }
    sums
}

/// The triangle at a pixel, or the first one beside it.
fn at_or_beside(size: usize, seen: &[u32], pixel: usize) -> Option<u32> {
    let something = |pixel: usize| Some(seen[pixel]).filter(|&triangle| triangle != NOTHING);
    let (row, column) = (pixel / size, pixel % size);
    let beside = || {
        let rows = row.saturating_sub(1)..=(row + 1).min(size - 1);
        let columns = column.saturating_sub(1)..=(column + 1).min(size - 1);
        rows.flat_map(|row| columns.clone().map(move |column| row * size + column)).find_map(something)
    };
    something(pixel).or_else(beside)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::screen_size::ScreenComparison;
    use parbake_model::glam::{Vec3, vec3, vec4};
    use parbake_model::{Material, Model};

    /// A square of two triangles across z, each with a colour of its own, the second of this brightness.
    fn square(second: f32) -> Model {
        let corners =
            [vec3(-1.0, -1.0, 0.0), vec3(1.0, -1.0, 0.0), vec3(1.0, 1.0, 0.0), vec3(-1.0, 1.0, 0.0)];
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let mesh = Mesh {
            positions: triangles.as_flattened().iter().map(|&v: &usize| corners[v]).collect(),
            normals: vec![Vec3::Z; 6],
            colors: [[vec4(0.5, 0.5, 0.5, 1.0); 3], [vec4(second, second, second, 1.0); 3]].concat(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        };
        let materials = vec![Material { double_sided: true, ..Material::default() }];
        Model { name: "square".into(), mesh, materials, ..Model::default() }
    }

    /// Protects what is refined: errors belong to the triangles that are seen where they are, equal pictures have none, and
    /// shares add up to the number of pictures.
    #[test]
    fn errors_belong_to_triangles_that_are_seen() {
        let original = square(0.5);
        let screens = ScreenComparison::new(&original);
        let pictures = screens.pictures(&screens.place(&original).unwrap(), 32.0).unwrap();
        let differences = Differences::new(&pictures, &original.mesh);
        let of = |copy: &Model| {
            let mut copy = copy.clone();
            copy.mesh.triangles.reverse();
            let compared = screens.compared(&pictures, &screens.place(&copy).unwrap());
            (compared.psnr, differences.of(&copy.mesh, &compared))
        };
        assert!(of(&original).1.is_empty());
        let (psnr, all) = of(&square(0.1));
        assert!(psnr < 40.0, "{psnr}");
        let sum = |is_meant: &dyn Fn(&&Difference) -> bool| -> f64 {
            all.iter().filter(is_meant).map(|difference| difference.error).sum()
        };
        let everywhere = sum(&|_| true);
        assert!((everywhere - everywhere.round()).abs() < 1e-2 && everywhere > 8.0, "{everywhere}");
        let where_it_is = sum(&|difference| difference.of_copy == 0 && difference.of_surface == 1);
        assert!(where_it_is > 0.9 * everywhere, "{where_it_is} of {everywhere}");
    }

    /// Protects outlines: an error beside a surface belongs to the triangle next to it, and one far away to none.
    #[test]
    fn outlines_belong_to_the_triangle_beside_them() {
        let mut seen = vec![NOTHING; 25];
        seen[12] = 7;
        let found: Vec<usize> = (0..25).filter(|&pixel| at_or_beside(5, &seen, pixel) == Some(7)).collect();
        assert_eq!(found, [6, 7, 8, 11, 12, 13, 16, 17, 18]);
    }
}
