//! What a coarse mesh should look like from one camera, before it has a texture: where the high-poly lies at each
//! pixel, and how much a difference there would show.
//!
//! A baked low-poly differs from its high-poly in two ways that no texture can mend. Its outline is another one:
//! a pixel is covered that should not be, or is not covered that should be. And its surface lies elsewhere: the
//! texture shows a point at a place that is right from one side and shifted from all others. A surface that is
//! off by Δ along a view ray, on a surface that is seen at the angle θ, shifts the picture by about
//! `s = Δ · sin θ · cos θ`, seen from the mean direction. Of a picture whose values have the variance σ² within a
//! few pixels, a shift of s pixels leaves the error
//!
//! ```text
//! 2 σ² · s² / (s² + L²)
//! ```
//!
//! which is quadratic for small shifts and ends where both pictures have nothing to do with each other. Where the
//! other side of a wall is seen, that shows what the texture has for that side: some other color of the model.
//!
//! Contract: all errors are squared differences of display values, means over channels. A target depends on the
//! high-poly, the kind of layer, the camera and the size only.

use glam::{Vec2, Vec3};
use parbake_image::MapKind;
use parbake_image::display::encode_srgb;
use parbake_render::camera::{Camera, Projection};
use parbake_render::interpolate::interpolate;
use parbake_render::on_screen::Raster;
use parbake_render::raster::{NOTHING, ScreenTriangle, ScreenTriangles, Visibility};
use parbake_views::high_poly::HighPoly;

/// The shift in pixels at which half of what can be lost is lost.
const HALF_LOST: f32 = 1.5;
/// Pixels to either side within which values vary.
const WINDOW: usize = 3;
/// Variance that even an even surface has: what lies elsewhere always shows a little.
const LEAST_VARIANCE: f32 = 2e-4;
/// What is left on black of the error of what stands out.
const LEARNT: f32 = 0.4;
/// The error of the other side of a wall at least.
const LEAST_OTHER_SIDE: f32 = 0.01;
/// Least sin θ · cos θ: a surface that is seen from the front shows what is off too, if little.
const LEAST_SHIFT: f32 = 0.08;
/// Display values of what may lie behind: black, grey and white.
pub const BACKGROUNDS: [f32; 3] = [0.0, 0.735, 1.0];
/// Weights of backgrounds that count alike.
pub const EQUAL: [f32; BACKGROUNDS.len()] = [1.0 / BACKGROUNDS.len() as f32; BACKGROUNDS.len()];

/// What one pixel shows of the high-poly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetPixel {
    /// Distance along the viewing axis; infinite where nothing is seen.
    pub depth: f32,
    /// Pixels by which the picture shifts for each unit that the surface is off along that axis.
    shift: f32,
    /// The error of a surface that is far off.
    most: f32,
    /// The error where only one of both surfaces is seen.
    outline: f32,
    /// The error where the other side of a surface is seen.
    other_side: f32,
    /// Whether the front is seen, as in the last bit of a nearness ([`crate::raster`]).
    front: u32,
}

impl TargetPixel {
    /// The error of a surface at this nearness (1 / depth), whose last bit tells the side; 0 is no surface.
    #[inline]
    pub fn error(&self, nearness: f32) -> f32 {
        match (self.depth.is_finite(), nearness > 0.0) {
            (false, false) => 0.0,
            (true, true) if nearness.to_bits() & 1 != self.front => self.other_side,
            (true, true) => {
                let shift = (nearness.recip() - self.depth) * self.shift;
                let square = shift * shift;
                self.most * square / (square + HALF_LOST * HALF_LOST)
            }
            _ => self.outline,
        }
    }
}

/// The high-poly from one camera.
pub struct Target {
    /// From where.
    pub camera: Camera,
    /// Pixels along a side.
    pub size: usize,
    /// size² pixels, row 0 on top.
    pub pixels: Vec<TargetPixel>,
    /// The error of each pixel where only one of both surfaces is seen, on each of [`BACKGROUNDS`].
    outlines: Vec<[f32; BACKGROUNDS.len()]>,
}

/// What is seen at a pixel.
#[derive(Clone, Copy)]
struct Look {
    depth: f32,
    shift: f32,
    color: Vec3,
    is_front: bool,
    /// How much what is seen counts.
    importance: f32,
}

impl Target {
    /// Looks at those triangles of the high-poly that are named, at all if none are. All
    /// backgrounds count the same.
    pub fn new(high: &HighPoly, triangles: Option<&[u32]>, camera: Camera, size: usize) -> Self {
        let mesh = high.scene.mesh();
        let mut seen = Visibility::default();
        let looks: Vec<Option<Look>> = match triangles {
            None => {
                let screen = high.scene.on_screen(&camera, size);
                screen.rasterise(size, (0.0, 0.0), None, &mut seen);
                look_at(high, &camera, &seen, |index| (index, screen.triangle(index)))
            }
            Some(named) => {
                let own: Vec<[u32; 3]> = named.iter().map(|&t| mesh.triangles[t as usize]).collect();
                let screen = ScreenTriangles::new(&mesh.positions, &own, &camera, size);
                screen.rasterise(size, (0.0, 0.0), None, &mut seen);
                look_at(high, &camera, &seen, |index| (named[index] as usize, screen.triangles[index]))
            }
        };
        let pixels = inside(&looks, size);
        let mut target = Self { camera, size, pixels, outlines: outlines(&looks) };
        target.weigh(EQUAL);
        target
    }

    /// From now on each of [`BACKGROUNDS`] counts by its weight; the sum of weights should be 1.
    pub fn weigh(&mut self, weights: [f32; BACKGROUNDS.len()]) {
        for (pixel, on) in self.pixels.iter_mut().zip(&self.outlines) {
            pixel.outline = on.iter().zip(weights).map(|(error, weight)| error * weight).sum();
        }
    }
}

fn look_at(
    high: &HighPoly,
    camera: &Camera,
    seen: &Visibility,
    triangle: impl Fn(usize) -> (usize, ScreenTriangle),
) -> Vec<Option<Look>> {
    let (mesh, size) = (high.scene.mesh(), seen.size);
    let look = |(pixel, &index): (usize, &u32)| {
        if index == NOTHING {
            return None;
        }
        let (triangle, on_screen) = triangle(index as usize);
        let at = ((pixel % size) as f64 + 0.5, (pixel / size) as f64 + 0.5);
        let near = on_screen.at(at.0, at.1);
        let sum: f64 = near.iter().sum();
        let weights = near.map(|n| (n / sum) as f32);
        let corners = mesh.triangles[triangle].map(|i| i as usize);
        let point: Vec3 = interpolate(corners.map(|i| mesh.positions[i]), weights);
        let depth = (camera.eye - point).dot(camera.back);
        let values = high.scene.material(camera, &on_screen, triangle, at, 1.0);
        let to_viewer = camera.view_direction(point);
        let facing = values[MapKind::Normal].truncate().dot(to_viewer).clamp(0.0, 1.0);
        let light = values[MapKind::BaseColor].truncate() * facing + values[MapKind::Emissive].truncate();
        let side = mesh.area_normal(triangle).normalize_or(to_viewer).dot(to_viewer);
        let (is_front, geometric) = (side >= 0.0, side.abs());
        let slant = (geometric * (1.0 - geometric * geometric).max(0.0).sqrt()).max(LEAST_SHIFT);
        let color = Vec3::from(light.to_array().map(|x| encode_srgb(x.clamp(0.0, 1.0))));
        let importance = high.importances.get(triangle).copied().unwrap_or(1.0);
        Some(Look { depth, shift: slant * pixels_per_unit(camera, depth, size), color, is_front, importance })
    };
    seen.triangle.iter().enumerate().map(look).collect()
}

/// How many pixels a unit spans at this depth.
fn pixels_per_unit(camera: &Camera, depth: f32, size: usize) -> f32 {
    let width = match camera.projection {
        Projection::Perspective(half) => 2.0 * half * depth,
        Projection::Orthographic(half) => 2.0 * half,
    };
    size as f32 / width.max(1e-6)
}

/// Errors of outlines. What stands out over the high-poly's outline shows some color of the model; on black, which
/// is what textures are fitted on there, they learn to be dark.
fn outlines(looks: &[Option<Look>]) -> Vec<[f32; BACKGROUNDS.len()]> {
    let before = |color: Vec3| BACKGROUNDS.map(|b| (color - Vec3::splat(b)).length_squared() / 3.0);
    let covered = || looks.iter().flatten().map(|look| before(look.color));
    let count = covered().count().max(1) as f32;
    let mut outside = [0.0; BACKGROUNDS.len()];
    for on in covered() {
        outside.iter_mut().zip(on).for_each(|(sum, error)| *sum += error / count);
    }
    outside[0] *= LEARNT;
    looks
        .iter()
        .map(|look| look.map_or(outside, |look| before(look.color).map(|e| e * look.importance)))
        .collect()
}

/// Errors within outlines, from what is seen around each pixel.
fn inside(looks: &[Option<Look>], size: usize) -> Vec<TargetPixel> {
    let count = looks.iter().flatten().count();
    let sums = looks.iter().flatten().fold((Vec3::ZERO, Vec3::ZERO), |(sum, squares), look| {
        (sum + look.color, squares + look.color * look.color)
    });
    let [mean, squares] = [sums.0, sums.1].map(|sum| sum / count.max(1) as f32);
    let other_side = 2.0 * (squares - mean * mean).dot(Vec3::ONE).max(0.0) / 3.0 + LEAST_OTHER_SIDE;
    let variance = |pixel: usize| {
        let (x, y) = (pixel % size, pixel / size);
        let range = |at: usize| at.saturating_sub(WINDOW)..(at + WINDOW + 1).min(size);
        let mut sums = (Vec3::ZERO, Vec3::ZERO, 0.0f32);
        for row in range(y) {
            for look in range(x).filter_map(|column| looks[row * size + column]) {
                sums.0 += look.color;
                sums.1 += look.color * look.color;
                sums.2 += 1.0;
            }
        }
        let mean = sums.0 / sums.2.max(1.0);
        let of = sums.1 / sums.2.max(1.0) - mean * mean;
        (of.dot(Vec3::ONE) / 3.0).max(LEAST_VARIANCE)
    };
    let pixel = |(pixel, look): (usize, &Option<Look>)| match look {
        None => TargetPixel {
            depth: f32::INFINITY,
            shift: 0.0,
            most: 0.0,
            outline: 0.0,
            other_side: 0.0,
            front: 0,
        },
        Some(look) => TargetPixel {
            depth: look.depth,
            shift: look.shift,
            most: 2.0 * variance(pixel) * look.importance,
            outline: 0.0,
            other_side: other_side * look.importance,
            front: u32::from(look.is_front),
        },
    };
    looks.iter().enumerate().map(pixel).collect()
}

/// A point as a camera sees it: column, row and nearness (1 / depth).
#[inline]
pub fn projected(camera: &Camera, size: usize, point: Vec3) -> [f32; 3] {
    let from_eye = point - camera.eye;
    let depth = -from_eye.dot(camera.back);
    let at = Vec2::new(from_eye.dot(camera.right), -from_eye.dot(camera.up));
    let half = 0.5 * size as f32;
    let at = match camera.projection {
        Projection::Perspective(width) => at / (width * depth),
        Projection::Orthographic(width) => at / width,
    };
    [half + half * at.x, half + half * at.y, depth.max(1e-4).recip()]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects what is counted: nothing where both agree, little for a little shift, all where nothing is left, and
    /// outlines and sides by their own.
    #[test]
    fn errors_are_those_of_the_formula() {
        let pixel =
            TargetPixel { depth: 2.0, shift: 10.0, most: 0.08, outline: 0.3, other_side: 0.1, front: 1 };
        let near = |depth: f32, front: u32| f32::from_bits(depth.recip().to_bits() & !1 | front);
        assert!(pixel.error(near(2.0, 1)) < 1e-9);
        assert!((pixel.error(near(2.15, 1)) - 0.04).abs() < 1e-4, "half of it at 1.5 pixels");
        assert!(pixel.error(near(9.0, 1)) > 0.079);
        assert_eq!((pixel.error(near(2.0, 0)), pixel.error(0.0)), (0.1, 0.3));
        let empty = TargetPixel { depth: f32::INFINITY, ..pixel };
        assert_eq!((empty.error(0.0), empty.error(near(2.0, 1))), (0.0, 0.3));
    }
}
