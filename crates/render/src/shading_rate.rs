//! How often surfaces are shaded in a picture: for each sample, or for each pixel as graphics cards do that smooth edges by
//! multisampling.
//!
//! Multisampling shades a triangle once at the centre of each pixel that it covers a part of, even where the centre lies
//! beyond its edge, and filters textures over the whole pixel. So at edges texels beside a chart are read, and a shift by
//! a twentieth of a pixel flips samples: pictures of viewers are stricter with both than many samples are.
//!
//! Contract: where the surface cannot be continued to the centre, it is shaded at the sample.

use crate::interpolate::barycentrics;
use crate::raster::ScreenTriangle;

/// How often surfaces are shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShadingRate {
    /// At each sample, with textures filtered over it.
    #[default]
    Sample,
    /// At the centre of each pixel, with textures filtered over it.
    Pixel,
}

/// Weights of corners up to which a surface is continued beyond its edges.
const FARTHEST: f32 = 2.0;

impl ShadingRate {
    /// Samples along a line over which textures are filtered, of `supersample` along a side of a pixel.
    pub fn footprint(self, supersample: usize) -> f32 {
        match self {
            Self::Sample => 1.0,
            Self::Pixel => supersample as f32,
        }
    }

    /// Where a triangle is shaded that a sample at `at` shows, in samples.
    pub fn point(self, triangle: &ScreenTriangle, at: (f64, f64), supersample: usize) -> (f64, f64) {
        if self == Self::Sample {
            return at;
        }
        let side = supersample as f64;
        let centre = |at: f64| ((at / side).floor() + 0.5) * side;
        let centre = (centre(at.0), centre(at.1));
        let weights = barycentrics(triangle, centre.0, centre.1).weights;
        let is_near = weights.iter().all(|weight| (1.0 - FARTHEST..=FARTHEST).contains(weight));
        if is_near { centre } else { at }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Projection};
    use crate::raster::ScreenTriangles;
    use parbake_model::Mesh;
    use parbake_model::glam::Vec3;

    /// Protects pictures that agree with those of graphics cards: a triangle is shaded at the pixel's centre also where it
    /// covers another part of the pixel, but not so far beyond its edges that nothing of it is left.
    #[test]
    fn pixels_are_shaded_at_their_centre() {
        let camera = Camera::towards_origin(Vec3::Z, 3.0, Projection::Orthographic(1.0));
        let mesh = Mesh {
            positions: [(-0.9, -0.9), (0.9, -0.9), (-0.9, 0.9)].map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            triangles: vec![[0, 1, 2]],
            triangle_materials: vec![0],
            ..Mesh::default()
        };
        let screen = ScreenTriangles::new(&mesh.positions, &mesh.triangles, &camera, 16);
        let triangle = &screen.triangles[0];
        let point = |rate: ShadingRate, at| rate.point(triangle, at, 2);
        assert_eq!(point(ShadingRate::Sample, (6.5, 9.5)), (6.5, 9.5));
        for at in [(6.5, 8.5), (7.5, 9.5)] {
            assert_eq!(point(ShadingRate::Pixel, at), (7.0, 9.0));
        }
        assert_eq!([ShadingRate::Sample, ShadingRate::Pixel].map(|rate| rate.footprint(4)), [1.0, 4.0]);
        // A pixel of all samples of the picture: its centre lies beyond the edge.
        assert_eq!(ShadingRate::Pixel.point(triangle, (14.5, 14.5), 16), (8.0, 8.0));
        assert_eq!(ShadingRate::Pixel.point(triangle, (600.5, 600.5), 16), (600.5, 600.5));
    }
}
