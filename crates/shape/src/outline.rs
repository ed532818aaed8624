//! How far the outlines of a surface are from the high-poly's, by samples of coverage.
//!
//! Both cover the same samples of a pixel, of which a triangle has each or has it not. The antialiased pictures that
//! vertices follow would not do: they know one edge a pixel, so where triangles are smaller than pixels they differ from the
//! high-poly's even of the high-poly itself, and vertices would follow that difference.
//!
//! Contract: 0 for a surface that covers what the high-poly covers. Views are summed in their order.

use crate::seen::Seen;
use glam::Vec3;
use parbake_render::raster::{NOTHING, ScreenTriangles, Visibility, rasterise};
use parbake_views::reference::Reference;
use rayon::prelude::*;

/// How the outlines of two surfaces differ: shares of the picture's area, means over views.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outline {
    /// Covered by the surface alone.
    pub overhang: f64,
    /// Covered by the reference alone.
    pub underhang: f64,
    /// Pixels that the reference covers in part: as many as its outline is long.
    pub length: f64,
}

impl Outline {
    /// Of triangles between points of the common frame, as the measured views see them.
    pub(crate) fn of(points: &[Vec3], triangles: &[[u32; 3]], seen: &Seen) -> Self {
        let views = &seen.references[..seen.measured().len()];
        let each: Vec<Self> =
            views.par_iter().map(|view| Self::from_view(points, triangles, view, seen)).collect();
        each.into_iter().fold(Self::default(), |sum, view| sum.plus(view.scaled(1.0 / views.len() as f64)))
    }

    fn from_view(points: &[Vec3], triangles: &[[u32; 3]], reference: &Reference, seen: &Seen) -> Self {
        let Seen { size, samples, .. } = *seen;
        let fine = size * samples;
        let screen = ScreenTriangles::new(points, triangles, &reference.view.camera, fine);
        let mut visible = Visibility::default();
        rasterise(&screen, fine, (0.0, 0.0), &mut visible);
        let mut covered = vec![0u32; size * size];
        for (sample, &triangle) in visible.triangle.iter().enumerate() {
            let pixel = sample / fine / samples * size + sample % fine / samples;
            covered[pixel] += u32::from(triangle != NOTHING);
        }
        let mut sum = Self::default();
        let all = (samples * samples) as f64;
        for (&count, reference) in covered.iter().zip(&reference.pixels) {
            // A count of samples once more: half floats do not have all ninths.
            let reference = (reference[3].to_f64() * all).round() / all;
            let own = f64::from(count) / all;
            sum.overhang += (own - reference).max(0.0);
            sum.underhang += (reference - own).max(0.0);
            sum.length += f64::from(u8::from(reference > 0.0 && reference < 1.0));
        }
        sum.scaled(1.0 / covered.len().max(1) as f64)
    }

    /// Mean distance between the outlines, in widths of a pixel of size² in a picture.
    pub fn gap(&self) -> f64 {
        (self.overhang + self.underhang) / self.length.max(1e-9)
    }

    fn scaled(self, by: f64) -> Self {
        Self { overhang: self.overhang * by, underhang: self.underhang * by, length: self.length * by }
    }

    fn plus(self, more: Self) -> Self {
        Self {
            overhang: self.overhang + more.overhang,
            underhang: self.underhang + more.underhang,
            length: self.length + more.length,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use half::f16;
    use parbake_render::camera::{Camera, Projection};
    use parbake_views::pool::View;
    use std::sync::Arc;

    const SIZE: usize = 16;
    /// The field of the camera is 2 wide.
    const PIXEL: f32 = 2.0 / SIZE as f32;

    /// A square of 8² pixels, half a pixel to the right of and above the middle, from one view.
    fn square() -> Seen {
        let camera = Camera::towards_origin(Vec3::Z, 3.5, Projection::Orthographic(1.0));
        let along = |at: f32| (4.5 + 8.0 - at).clamp(0.0, 1.0).min((at + 1.0 - 4.5).clamp(0.0, 1.0));
        let covered = |pixel: usize| {
            let (column, row) = (pixel % SIZE, SIZE - 1 - pixel / SIZE);
            let coverage = f16::from_f32(along(column as f32) * along(row as f32));
            [f16::ZERO, f16::ZERO, f16::ZERO, coverage]
        };
        let pixels = (0..SIZE * SIZE).map(covered).collect();
        let view = View { camera, jitter: [0.0; 2] };
        Seen { references: Arc::new(vec![Reference { view, pixels }]), size: SIZE, samples: 4 }
    }

    /// The outline of a square with these corners, in pixels from where the other one has its own.
    fn of(low: [f32; 2], high: [f32; 2], seen: &Seen) -> Outline {
        let corner = |x: f32, y: f32| Vec3::new(PIXEL * (x + 0.5), PIXEL * (y + 0.5), 0.0);
        let ([left, bottom], [right, top]) = (low.map(|shift| shift - 4.0), high.map(|shift| shift + 4.0));
        let points = [corner(left, bottom), corner(right, bottom), corner(right, top), corner(left, top)];
        Outline::of(&points, &[[0, 1, 2], [0, 2, 3]], seen)
    }

    /// Protects distances: nothing between squares in one place, a quarter of a pixel where an edge lies there, and what stands
    /// out is told from what is missing.
    #[test]
    fn distances_are_those_of_edges() {
        let seen = square();
        let pixels = |share: f64| share * (SIZE * SIZE) as f64;
        let same = of([0.0; 2], [0.0; 2], &seen);
        assert_eq!((same.overhang, same.underhang, pixels(same.length)), (0.0, 0.0, 32.0));
        let wider = of([0.0; 2], [0.25, 0.0], &seen);
        assert_eq!((pixels(wider.overhang), wider.underhang, wider.gap()), (2.0, 0.0, 2.0 / 32.0));
        let shifted = of([0.25, 0.0], [0.25, 0.0], &seen);
        assert_eq!((pixels(shifted.overhang), pixels(shifted.underhang)), (2.0, 2.0));
    }

    /// Protects runs that were stopped before there was a view.
    #[test]
    fn nothing_is_apart_without_views() {
        let seen = Seen { references: Arc::default(), size: SIZE, samples: 4 };
        assert_eq!(of([0.0; 2], [1.0; 2], &seen).gap(), 0.0);
    }
}
