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
