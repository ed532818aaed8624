//! What shows through glass: a picture of all that is solid, looked up where a bent ray leaves the glass, and blurred by how
//! rough the glass is.
//!
//! Forward: a ray from the viewer, direction −v, meets a surface with normal n, index of refraction η, roughness and thickness
//! d. It is bent by Snell's law, goes straight for the length d, and what the picture shows there is what is seen; it does not
//! meet a second surface (`KHR_materials_transmission` and `KHR_materials_volume`, as glTF's sample viewer and three.js show
//! them; the idea is Wyman's, "An Approximate Image-Space Approach for Interactive Refraction", 2005):
//!
//! ```text
//! r = refract(−v, n, 1 / η),  exit = p + d r
//! level = log₂(size) · roughness · min(max(2 η − 2, 0), 1)
//! ```
//!
//! Size is that of the picture in pixels, whatever their samples. Each mip level is filtered by the uniform cubic B-spline, and the two nearest levels are mixed. Other glass and blended
//! surfaces are not in the picture.
//!
//! Contract: colours are linear light, premultiplied, with coverage in the fourth channel. Beyond its edges a picture goes on as
//! at its edge.

use crate::picture::Picture;
use glam::{Vec2, Vec3, Vec4};

/// What a pane does to the light that comes through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refraction {
    /// Index of refraction, from 1, up to infinity.
    pub index: f32,
    /// How far a bent ray goes inside, in the unit of the mesh; 0 for a thin sheet.
    pub thickness: f32,
}

impl Default for Refraction {
    /// A thin sheet of glTF's usual dielectric.
    fn default() -> Self {
        Self { index: 1.5, thickness: 0.0 }
    }
}

impl Refraction {
    /// Where a ray leaves that entered at `point`; `normal` and `to_viewer` are unit vectors.
    pub fn exit(&self, point: Vec3, normal: Vec3, to_viewer: Vec3) -> Vec3 {
        let ratio = 1.0 / self.index.max(1.0);
        let cosine = normal.dot(to_viewer);
        let square = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
        let bent = normal * (ratio * cosine - square.max(0.0).sqrt()) - to_viewer * ratio;
        point + bent * self.thickness
    }

    /// How rough glass of this index blurs: a share of all mip levels.
    fn blur(&self, roughness: f32) -> f32 {
        roughness * (2.0 * self.index - 2.0).clamp(0.0, 1.0)
    }
}

/// The picture, with its mip levels.
pub(crate) struct Behind {
    /// Each half as wide as the one before, down to one pixel; at least one.
    levels: Vec<Picture>,
}

impl Behind {
    pub fn new(picture: Picture) -> Self {
        let next = |picture: &Picture| (picture.size > 1).then(|| halved(picture));
        Self { levels: std::iter::successors(Some(picture), next).collect() }
    }

    /// What is seen at a place, from (0, 0) at the top left to (1, 1), through glass of this roughness.
    pub fn through(&self, at: Vec2, refraction: &Refraction, roughness: f32) -> Vec4 {
        let level = (self.levels[0].size as f32).log2() * refraction.blur(roughness);
        let lower = level.floor();
        let of = |level: f32| smooth(&self.levels[(level as usize).min(self.levels.len() - 1)], at);
        match level - lower {
            0.0 => of(lower),
            share => of(lower).lerp(of(lower + 1.0), share),
        }
    }
}

/// The next mip level: each of its pixels is looked up, bilinear, at its middle.
fn halved(picture: &Picture) -> Picture {
    let size = picture.size / 2;
    let taps: Vec<(usize, f32)> = (0..size)
        .map(|i| {
            let at = (i as f32 + 0.5) * picture.size as f32 / size as f32 - 0.5;
            (at as usize, at.fract())
        })
        .collect();
    let row = |y: usize, (x, share): (usize, f32)| {
        let [a, b] = [x, x + 1].map(|x| Vec4::from(picture.rgba[y * picture.size + x]));
        a.lerp(b, share)
    };
    let pixel = |(y, down): (usize, f32), x: (usize, f32)| row(y, x).lerp(row(y + 1, x), down).to_array();
    let rgba = taps.iter().flat_map(|&y| taps.iter().map(move |&x| pixel(y, x))).collect();
    Picture { size, rgba }
}

/// A level at a place, filtered by the cubic B-spline.
fn smooth(picture: &Picture, at: Vec2) -> Vec4 {
    let size = picture.size as f32;
    // Far outside all is as at the edge, and places stay finite.
    let place = (at.clamp(Vec2::splat(-1.0), Vec2::splat(2.0)) * size - 0.5).to_array();
    let [columns, rows] = place.map(|place| {
        let first = place.floor() as i64 - 1;
        let index = |k: i64| (first + k).clamp(0, picture.size as i64 - 1) as usize;
        ([0, 1, 2, 3].map(index), spline(place - place.floor()))
    });
    let mut sum = Vec4::ZERO;
    for (y, down) in rows.0.into_iter().zip(rows.1) {
        for (x, across) in columns.0.into_iter().zip(columns.1) {
            sum += Vec4::from(picture.rgba[y * picture.size + x]) * (down * across);
        }
    }
    sum
}

/// Weights of the four nearest, `t` past the second.
fn spline(t: f32) -> [f32; 4] {
    let rest = 1.0 - t;
    let near = |t: f32| (t * t * (3.0 * t - 6.0) + 4.0) / 6.0;
    [rest * rest * rest / 6.0, near(t), near(rest), t * t * t / 6.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture whose left half is red, its right half nothing.
    fn halves(size: usize) -> Picture {
        let red = |i: usize| if i % size < size / 2 { [1.0, 0.0, 0.0, 1.0] } else { [0.0; 4] };
        Picture { size, rgba: (0..size * size).map(red).collect() }
    }

    /// Protects agreement with viewers: a ray is bent by Snell's law towards the normal, and a sheet without thickness
    /// shifts nothing.
    #[test]
    fn rays_are_bent_by_snells_law() {
        let to_viewer = Vec3::new(0.6, 0.0, 0.8);
        let glass = Refraction { index: 1.5, thickness: 2.0 };
        let exit = glass.exit(Vec3::ZERO, Vec3::Z, to_viewer);
        assert!((exit.length() - 2.0).abs() < 1e-6 && (exit.x / 2.0 + 0.6 / 1.5).abs() < 1e-6, "{exit}");
        let straight = Refraction { index: 1.0, thickness: 1.0 }.exit(Vec3::ONE, Vec3::Z, to_viewer);
        assert!((straight - (Vec3::ONE - to_viewer)).length() < 1e-6);
        assert_eq!(Refraction::default().exit(Vec3::ONE, Vec3::Z, to_viewer), Vec3::ONE);
    }

    /// Protects frosted glass: smooth glass shows what is behind it, rough glass a blur of it, fully rough glass the mean; glass
    /// of index 1 is clear however rough. Sizes that are not powers of two lose nothing.
    #[test]
    fn rough_glass_blurs() {
        for size in [64, 50] {
            let behind = Behind::new(halves(size));
            let glass = Refraction::default();
            let left = Vec2::new(0.25, 0.5);
            let red = |at, roughness| behind.through(at, &glass, roughness).x;
            assert!((red(left, 0.0) - 1.0).abs() < 1e-5 && red(Vec2::new(0.75, 0.5), 0.0) < 1e-5);
            let blurred = red(left, 0.6);
            assert!(blurred < 0.99 && blurred > 0.51, "{blurred}");
            let mean = behind.through(left, &glass, 1.0);
            assert!((mean - Vec4::new(0.5, 0.0, 0.0, 0.5)).length() < 0.02, "{mean}");
            let clear = Refraction { index: 1.0, ..glass };
            assert!((behind.through(left, &clear, 1.0).x - 1.0).abs() < 1e-5);
            assert_eq!(
                behind.through(Vec2::new(-7.0, f32::MAX), &glass, 0.0),
                behind.through(Vec2::new(-0.5, 1.5), &glass, 0.0)
            );
        }
    }

    /// Protects brightness: weights of the spline add up to one, and are those of its definition at the ends.
    #[test]
    fn the_spline_keeps_what_is_even() {
        for t in [0.0, 0.3, 0.5, 0.99] {
            assert!((spline(t).iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
        let [a, b, c, d] = spline(0.0);
        assert!(
            (a - 1.0 / 6.0).abs() < 1e-6 && (b - 2.0 / 3.0).abs() < 1e-6 && (c - a).abs() < 1e-6 && d == 0.0
        );
    }
}
