//! Where a triangle's samples fall: which mip level, which texels.
//!
//! As graphics hardware does it for a trilinear fetch: with the steps `dx`, `dy` in the
//! texture, in texels, that correspond to one pixel to the right and one pixel down, the
//! level is `λ = log₂ max(|dx|, |dy|)`, clamped; the fetch blends levels ⌊λ⌋ and ⌊λ⌋ + 1.
//! Both steps are constant on a triangle.

use crate::signal::Sample;
use glam::{DMat2, DVec2, Vec2};

/// A triangle in the texture.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    origin: DVec2,
    edges: DMat2,
}

/// Which levels a triangle is shown with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// The finer level.
    pub fine: usize,
    /// The share of the next coarser one, in [0, 1).
    pub coarse_share: f64,
    /// Derivative of λ for the triangle's two edges; zero where it is clamped.
    pub slope: DMat2,
}

/// A sample's place on a level: upper left texel, fractions, and 0 along each axis on
/// which the texture is clamped there.
pub type Place = ([usize; 2], [f32; 2], [f32; 2]);

impl Footprint {
    /// From the layout's points, in units of the square.
    #[inline]
    pub fn new(points: &[DVec2], corners: [u32; 3]) -> Self {
        let [a, b, c] = corners.map(|i| points[i as usize]);
        Self { origin: a, edges: DMat2::from_cols(b - a, c - a) }
    }

    /// The levels of a triangle whose pixels are `pixel` (see [`Pixels`](crate::signal::Pixels)) in a
    /// texture of `size`² texels with `levels` levels.
    pub fn level(&self, pixel: Option<&DMat2>, size: usize, levels: usize) -> Level {
        let still = Level { fine: 0, coarse_share: 0.0, slope: DMat2::ZERO };
        let Some(pixel) = pixel else { return still };
        let steps = self.edges * *pixel * size as f64;
        let (x, y) = (steps.x_axis.length_squared(), steps.y_axis.length_squared());
        let longest = x.max(y);
        if levels < 2 || longest <= 1.0 || !longest.is_finite() {
            return still;
        }
        let level = 0.5 * longest.log2();
        if level >= (levels - 1) as f64 {
            return Level { fine: levels - 1, ..still };
        }
        // λ = ½ log₂ |E p|² for the longer of the two steps E p.
        let (step, p) = if x >= y { (steps.x_axis, pixel.x_axis) } else { (steps.y_axis, pixel.y_axis) };
        let by_step = step * (size as f64 / (longest * std::f64::consts::LN_2));
        Level {
            fine: level as usize,
            coarse_share: level.fract(),
            slope: DMat2::from_cols(by_step * p.x, by_step * p.y),
        }
    }

    /// The same in texels of a level of `size`² texels.
    #[inline]
    pub fn on(&self, size: usize) -> OnLevel {
        let scale = size as f64;
        OnLevel {
            origin: (self.origin * scale - 0.5).as_vec2(),
            second: (self.edges.x_axis * scale).as_vec2(),
            third: (self.edges.y_axis * scale).as_vec2(),
            size,
        }
    }
}

/// A triangle in texels of one level.
#[derive(Clone, Copy, Debug)]
pub struct OnLevel {
    origin: Vec2,
    second: Vec2,
    third: Vec2,
    size: usize,
}

impl OnLevel {
    /// A triangle of half a box, whose bounds are those of all that lies in it.
    pub fn of_box(low: DVec2, high: DVec2, size: usize) -> Self {
        let edges = DMat2::from_diagonal(high - low);
        Footprint { origin: low, edges }.on(size)
    }

    /// Where a sample falls.
    #[inline]
    pub fn place(&self, sample: &Sample) -> Place {
        let [b, c] = sample.barycentric;
        let p = self.origin + self.second * b + self.third * c;
        let last = (self.size - 1) as f32;
        let axis = |p: f32| {
            let inside = p.clamp(0.0, last);
            // CPUs convert from and to an i32 at once.
            let texel = (inside as i32).min(self.size as i32 - 2);
            (texel as usize, inside - texel as f32, if p == inside { 1.0 } else { 0.0 })
        };
        let ((x, fx, dx), (y, fy, dy)) = (axis(p.x), axis(p.y));
        ([x, y], [fx, fy], [dx, dy])
    }

    /// The texels that samples of this triangle may touch: from, to (exclusive).
    pub fn bounds(&self) -> [[usize; 2]; 2] {
        let (a, b, c) = (self.origin, self.origin + self.second, self.origin + self.third);
        let (low, high) = (a.min(b).min(c) - 0.01, a.max(b).max(c) + 0.01);
        let from = |x: f32| (x.max(0.0) as usize).min(self.size - 2);
        let to = |x: f32| from(x) + 2;
        [[from(low.x), from(low.y)], [to(high.x), to(high.y)]]
    }
}

/// The levels that a triangle's samples of one scale touch, with their shares.
#[inline]
pub fn shares(level: &Level) -> impl Iterator<Item = (usize, f32)> + use<> {
    let coarse = level.coarse_share as f32;
    [(level.fine, 1.0 - coarse), (level.fine + 1, coarse)].into_iter().filter(|(_, share)| *share > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    /// Protects the level and its derivative against central differences.
    #[test]
    fn level_and_slope() {
        let points = [dvec2(0.1, 0.1), dvec2(0.6, 0.2), dvec2(0.2, 0.5)];
        let pixel = DMat2::from_cols(dvec2(0.1, 0.02), dvec2(-0.01, 0.08));
        let at = |edges: DMat2| {
            let l = Footprint { origin: points[0], edges }.level(Some(&pixel), 64, 7);
            (l.fine as f64 + l.coarse_share, l.slope)
        };
        let edges = Footprint::new(&points, [0, 1, 2]).edges;
        let (level, slope) = at(edges);
        assert!(level > 1.0 && level < 3.0, "{level}");
        for column in 0..2 {
            for row in 0..2 {
                let h = 1e-6;
                let (mut up, mut down) = (edges, edges);
                up.col_mut(column)[row] += h;
                down.col_mut(column)[row] -= h;
                let want = (at(up).0 - at(down).0) / (2.0 * h);
                assert!((want - slope.col(column)[row]).abs() < 1e-5);
            }
        }
        assert_eq!(Footprint { origin: points[0], edges: edges * 0.01 }.level(Some(&pixel), 64, 7).fine, 0);
    }
}
