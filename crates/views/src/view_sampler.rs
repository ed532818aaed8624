//! A training view's pixels as the low-poly sees them: where each falls on the texture, from
//! where it is seen, how the light meets it, and what it shall show.
//!
//! Forward: `raster → interpolate → frame`, once a pixel; everything a solver needs is left
//! in [`Fragment`], and nothing of the mesh.
//!
//! Contract: the low-poly has normals, tangents and texture coordinates.

use crate::reference::Reference;
use parbake_image::display::Display;
use parbake_model::glam::{Vec2, Vec3};
use parbake_model::{Basis, Mesh};
use parbake_render::camera::Camera;
use parbake_render::cutout::{CutoutCoefficients, rasterise_cut};
use parbake_render::directions::{VertexFrame, ViewDirection, view_direction};
use parbake_render::frame::{TangentLight, tangent_light};
use parbake_render::interpolate::{barycentrics, interpolate};
use parbake_render::raster::{
    NOTHING, ScreenTriangle, ScreenTriangles, Visibility, rasterise, rasterise_behind,
};

/// What a pixel of the low-poly shall look like where the high-poly leaves the
/// pixel, or part of it, empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UncoveredPixels {
    /// Nothing is asked of such pixels.
    Ignore,
    /// The high-poly before a background of this linear light, counting this much
    /// (0 … 1) against a pixel that the high-poly fills.
    Background([f32; 3], f32),
}

/// What every view of a fit has in common.
#[derive(Clone)]
pub struct ViewSampler<'a> {
    low: &'a Mesh,
    face_normals: Vec<Vec3>,
    /// Pixels along a side of each view.
    size: usize,
    display: &'a Display,
    beyond: UncoveredPixels,
    /// The functions of directions that fragments are for.
    basis: Basis,
    cutout: Option<&'a CutoutCoefficients>,
}

/// One pixel that shows the low-poly.
#[derive(Clone, Copy, Debug)]
pub struct Fragment {
    /// Where it falls on the texture.
    pub uv: Vec2,
    /// From where it is seen, as the sampler's basis has it.
    pub view_direction: ViewDirection,
    /// How the light meets it.
    pub light: TangentLight,
    /// Wanted display value, in 65535ths of 1.
    pub target: [u16; 3],
    /// How much it counts, in 65535ths.
    pub weight: u16,
}

impl<'a> ViewSampler<'a> {
    /// For views of `size`² pixels.
    pub fn new(low: &'a Mesh, size: usize, display: &'a Display, beyond: UncoveredPixels) -> Self {
        let face_normals = (0..low.triangles.len()).map(|t| low.area_normal(t)).collect();
        Self { low, face_normals, size, display, beyond, basis: Basis::Harmonics(0), cutout: None }
    }

    /// The same for maps of these functions: directions are those that [`view_direction`] gives.
    pub fn in_basis(self, basis: Basis) -> Self {
        Self { basis, ..self }
    }

    /// The same with what this leaves out.
    pub fn with_cutout(self, cutout: Option<&'a CutoutCoefficients>) -> Self {
        Self { cutout, ..self }
    }

    fn screen(&self, reference: &Reference) -> ScreenTriangles {
        ScreenTriangles::new(&self.low.positions, &self.low.triangles, &reference.view.camera, self.size)
    }

    /// Where a triangle's point at this place of the screen falls on the texture, and the
    /// direction it is seen from.
    fn look(&self, camera: &Camera, triangle: &ScreenTriangle, index: usize, at: (f64, f64)) -> (Vec2, Vec3) {
        let b = barycentrics(triangle, at.0, at.1).weights;
        let corners = self.low.triangles[index].map(|i| i as usize);
        let point = interpolate(corners.map(|i| self.low.positions[i]), b);
        let direction =
            view_direction(self.basis, &self.frame(corners, b), camera.view_direction(point)).direction;
        (interpolate(corners.map(|i| self.low.uvs[i]), b), direction)
    }

    fn frame(&self, corners: [usize; 3], weights: [f32; 3]) -> VertexFrame {
        VertexFrame {
            normal: interpolate(corners.map(|i| self.low.normals[i]), weights),
            tangent: interpolate(corners.map(|i| self.low.tangents[i].truncate()), weights),
            handedness: self.low.tangents[corners[0]].w,
        }
    }

    /// Hands over all layers of the view's pixels, the nearest first: the high-poly's coverage
    /// of the pixel, the layer's number, its coordinate and the direction to the viewer.
    pub fn fragment_layers(&self, reference: &Reference, mut each: impl FnMut(f32, usize, Vec2, Vec3)) {
        let (camera, jitter, size) = (&reference.view.camera, reference.view.jitter, self.size);
        let screen = self.screen(reference);
        let (mut seen, mut next) = (Visibility::default(), Visibility::default());
        rasterise(&screen, size, (jitter[0], jitter[1]), &mut seen);
        for layer in 0..MOST_LAYERS {
            for (pixel, &triangle) in seen.triangle.iter().enumerate().filter(|(_, t)| **t != NOTHING) {
                let at = place(pixel, size, jitter);
                let triangle = triangle as usize;
                let (uv, direction) = self.look(camera, &screen.triangles[triangle], triangle, at);
                each(reference.pixels[pixel][3].to_f32(), layer, uv, direction);
            }
            rasterise_behind(&screen, size, (jitter[0], jitter[1]), &seen, &mut next);
            std::mem::swap(&mut seen, &mut next);
        }
    }

    /// Hands over the view's pixels, row by row.
    pub fn fragments(&self, reference: &Reference, mut each: impl FnMut(Fragment)) {
        let Self { low, size, .. } = *self;
        let (camera, jitter) = (&reference.view.camera, reference.view.jitter);
        let screen = self.screen(reference);
        let mut seen = Visibility::default();
        let offset = (jitter[0], jitter[1]);
        match self.cutout {
            None => rasterise(&screen, size, offset, &mut seen),
            Some(map) => rasterise_cut(&screen, size, offset, &mut seen, |triangle, at| {
                let (uv, direction) = self.look(camera, &screen.triangles[triangle], triangle, at);
                map.opacity(uv, direction) >= 0.0
            }),
        }
        for (index, (&triangle, pixel)) in seen.triangle.iter().zip(reference.linear()).enumerate() {
            if triangle == NOTHING {
                continue;
            }
            let Some((target, weight)) = target(pixel, self.display, self.beyond) else {
                continue;
            };
            let at = place(index, size, jitter);
            let b = barycentrics(&screen.triangles[triangle as usize], at.0, at.1).weights;
            let corners = low.triangles[triangle as usize].map(|i| i as usize);
            let point = interpolate(corners.map(|i| low.positions[i]), b);
            let frame = self.frame(corners, b);
            let VertexFrame { normal, tangent, handedness } = frame;
            let direction = camera.view_direction(point);
            let facing = if direction.dot(self.face_normals[triangle as usize]) < 0.0 { -1.0 } else { 1.0 };
            each(Fragment {
                uv: interpolate(corners.map(|i| low.uvs[i]), b),
                view_direction: view_direction(self.basis, &frame, direction),
                light: tangent_light(normal, tangent, handedness, direction, facing),
                target,
                weight,
            });
        }
    }
}

/// Layers of the low-poly that are looked at: more are only met where it is rolled up.
const MOST_LAYERS: usize = 4;

/// A pixel's sample on the screen.
fn place(pixel: usize, size: usize, jitter: [f32; 2]) -> (f64, f64) {
    let along = |i: usize, shift: f32| i as f64 + 0.5 + f64::from(shift);
    (along(pixel % size, jitter[0]), along(pixel / size, jitter[1]))
}

/// Less than this share of a pixel beyond the silhouette is rounding.
const UNCOVERED: f32 = 1e-3;

/// What the display shall show and how much that counts; `None` when nothing is
/// asked of this pixel.
fn target(pixel: [f32; 4], display: &Display, beyond: UncoveredPixels) -> Option<([u16; 3], u16)> {
    let [r, g, b, coverage] = pixel;
    let rest = 1.0 - coverage;
    let (light, weight) = match beyond {
        _ if rest < UNCOVERED => ([r, g, b], 1.0),
        UncoveredPixels::Ignore => return None,
        UncoveredPixels::Background(behind, weight) => {
            // The background is light that has passed the gain already.
            let behind = behind.map(|x| x * rest / display.gain);
            ([r + behind[0], g + behind[1], b + behind[2]], weight)
        }
    };
    let shown = light.map(|x| (display.encode(x.max(0.0)).min(1.0) * 65535.0 + 0.5) as u16);
    Some((shown, (weight.clamp(0.0, 1.0) * 65535.0 + 0.5) as u16))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the two ways of treating what lies beyond the silhouette.
    #[test]
    fn a_half_covered_pixel_is_ignored_or_blended() {
        let display = Display { gain: 1.0, curve: parbake_image::display::Curve::Linear };
        let pixel = [0.25, 0.25, 0.25, 0.5];
        assert_eq!(target(pixel, &display, UncoveredPixels::Ignore), None);
        let white = target(pixel, &display, UncoveredPixels::Background([1.0; 3], 0.5));
        assert_eq!(white, Some(([49151; 3], 32768)));
    }
}
