//! The plane that carries a picture: a square grid of cells, each split along its
//! diagonal from the upper left to the lower right, the texture laid over it once.

use crate::signal::Pixels;
use parbake_atlas::Layout;
use parbake_model::Mesh;
use parbake_model::glam::{DMat2, DVec2, Vec2, Vec3, dvec2, vec2};

/// A grid of `cells` × `cells`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plane {
    /// Cells along a side, at least 1.
    pub cells: usize,
}

impl Plane {
    /// The grid's points in the texture, row by row, v down.
    pub fn points(self) -> Vec<Vec2> {
        let n = self.cells;
        let step = |i: usize| i as f32 / n as f32;
        (0..=n).flat_map(|j| (0..=n).map(move |i| vec2(step(i), step(j)))).collect()
    }

    /// The mesh: `width` × `height` in the plane z = 0, centred, seen from +z.
    /// Without normals, which readers then take from the triangles.
    pub fn mesh(self, width: f32, height: f32) -> Mesh {
        let uvs = self.points();
        let positions = uvs.iter().map(|p| Vec3::new((p.x - 0.5) * width, (0.5 - p.y) * height, 0.0));
        // Layouts swap two corners: v points down, counter-clockwise in space is clockwise there.
        let triangles: Vec<[u32; 3]> = self.cells().flat_map(|[a, b, c, d]| [[a, c, b], [a, d, c]]).collect();
        Mesh {
            positions: positions.collect(),
            triangle_materials: vec![0; triangles.len()],
            uvs,
            triangles,
            ..Mesh::default()
        }
    }

    /// Corners of each cell: upper left, upper right, lower right, lower left.
    fn cells(self) -> impl Iterator<Item = [u32; 4]> {
        let n = self.cells;
        (0..n * n).map(move |cell| {
            let a = (cell / n * (n + 1) + cell % n) as u32;
            [a, a + 1, a + n as u32 + 2, a + n as u32 + 1]
        })
    }

    /// The triangle that a point of the undeformed plane lies on, (0, 0) its upper left
    /// corner and (1, 1) its lower right one, and the weights of its second and third point.
    #[inline]
    pub fn locate(self, x: f64, y: f64) -> (u32, [f32; 2]) {
        let n = self.cells as f64;
        let cell = |t: f64| ((t * n) as usize).min(self.cells - 1);
        let (i, j) = (cell(x), cell(y));
        let (fx, fy) = (x * n - i as f64, y * n - j as f64);
        let index = 2 * (j * self.cells + i) as u32;
        if fx >= fy {
            (index, [(fx - fy) as f32, fy as f32])
        } else {
            (index + 1, [fx as f32, (fy - fx) as f32])
        }
    }

    /// What a pixel of a `width` × `height` picture is on each triangle
    /// ([`Pixels`]).
    pub fn pixels(self, width: usize, height: usize) -> Pixels {
        let (x, y) = (self.cells as f64 / width as f64, self.cells as f64 / height as f64);
        let upper = DMat2::from_cols(dvec2(x, 0.0), dvec2(-y, y));
        let lower = DMat2::from_cols(dvec2(x, -x), dvec2(0.0, y));
        Pixels::ByTurns([upper, lower])
    }

    /// A grid of twice as many cells whose points lie on the triangles of this one.
    pub fn refined(self, points: &[DVec2]) -> (Self, Vec<DVec2>) {
        let (n, twice) = (self.cells, 2 * self.cells);
        let at = |i: usize, j: usize| points[j * (n + 1) + i];
        let fine = (0..=twice).flat_map(|j| (0..=twice).map(move |i| (i, j))).map(|(i, j)| {
            // Odd indices lie half-way: on an edge, or in the middle of the diagonal.
            let (from, to) = (at(i / 2, j / 2), at(i.div_ceil(2), j.div_ceil(2)));
            ((from + to) * 0.5).as_vec2().as_dvec2()
        });
        (Self { cells: twice }, fine.collect())
    }

    /// For each point of a grid of at most `most` cells along a side the nearest one of this grid, and
    /// that grid.
    pub fn thinned(self, most: usize) -> (Self, Vec<usize>) {
        let cells = self.cells.min(most);
        let nearest = |i: usize| (i * self.cells + cells / 2) / cells;
        let row = |j: usize| nearest(j) * (self.cells + 1);
        let points = (0..=cells).flat_map(|j| (0..=cells).map(move |i| row(j) + nearest(i)));
        (Self { cells }, points.collect())
    }

    /// The layout of this grid with these points.
    pub fn layout(self, points: Vec<DVec2>) -> Layout {
        // `Layout::new` keeps the order of vertices, which are all different here.
        Layout { points, ..Layout::new(&self.mesh(1.0, 1.0)) }
    }

    /// F shapes of the triangles in the texture before anything moved.
    pub fn rest(self) -> Vec<DMat2> {
        let points = self.points();
        let layout = self.layout(points.iter().map(|p| p.as_dvec2()).collect());
        (0..layout.triangles.len())
            .map(|t| {
                let [a, b, c] = layout.corners(t);
                DMat2::from_cols(b - a, c - a)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the agreement of `locate`, `layout` and `pixels`: a place and its neighbour
    /// to the right map to where they are.
    #[test]
    fn places_are_where_they_are() {
        let plane = Plane { cells: 5 };
        let layout = plane.layout(plane.points().iter().map(|p| p.as_dvec2()).collect());
        let pixels = plane.pixels(100, 50);
        for (x, y) in [(0.03, 0.05), (0.55, 0.31), (0.999, 0.001), (1.0, 1.0), (0.0, 0.7)] {
            let (t, [b, c]) = plane.locate(x, y);
            let [p, q, r] = layout.corners(t as usize);
            let edges = DMat2::from_cols(q - p, r - p);
            assert!((p + edges * dvec2(b.into(), c.into()) - dvec2(x, y)).length() < 1e-6);
            let step = edges * *pixels.of(t as usize).expect("pixels have a size");
            assert!((step.x_axis - dvec2(0.01, 0.0)).length() < 1e-6);
            assert!((step.y_axis - dvec2(0.0, 0.02)).length() < 1e-6);
            assert!(layout.doubled_area(t as usize) > 0.0);
        }
    }

    /// Protects the thinned grid of drawings: its corners are the plane's, and fine ones stay whole.
    #[test]
    fn thinned_grids_reach_the_corners() {
        let (plane, points) = Plane { cells: 7 }.thinned(3);
        assert_eq!((plane.cells, points.len()), (3, 16));
        assert_eq!([points[0], points[3], points[12], points[15]], [0, 7, 56, 63]);
        assert_eq!(Plane { cells: 3 }.thinned(50).1, (0..16).collect::<Vec<_>>());
    }

    /// Protects refinement: the finer grid is the same surface.
    #[test]
    fn refinement_moves_nothing() {
        let plane = Plane { cells: 2 };
        let mut points: Vec<DVec2> = plane.points().iter().map(|p| p.as_dvec2()).collect();
        points[4] = dvec2(0.375, 0.625);
        let (fine, moved) = plane.refined(&points);
        assert_eq!(fine.cells, 4);
        assert_eq!(moved.len(), 25);
        assert_eq!(moved[12], points[4]);
        assert_eq!(moved[6], (points[0] + points[4]) * 0.5);
        assert_eq!(moved[7], (points[1] + points[4]) * 0.5);
    }
}
