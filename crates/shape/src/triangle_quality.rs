//! What keeps a moving mesh sane: no triangle turns over, collapses or becomes a needle.
//!
//! A triangle is sane where, compared with how it was at rest, its normal turned by less
//! than [`TriangleQuality::LEAST_COSINE`] allows, and its area and its least altitude kept at least
//! [`TriangleQuality::LEAST_SHARE`]. Points of triangles that a step would spoil stay where they
//! were before the step; since that can spoil a neighbour, the question is asked again until
//! nothing is spoilt. Staying is always an answer: a sane mesh stays sane.
//!
//! Contract: triangles that were degenerate at rest are not looked at.

use glam::Vec3;

/// The triangles' shapes at rest.
#[derive(Clone, Debug)]
pub struct TriangleQuality {
    triangles: Vec<[u32; 3]>,
    rest: Vec<Shape>,
}

#[derive(Clone, Copy, Debug)]
struct Shape {
    /// Twice the area.
    area: f32,
    normal: Vec3,
    altitude: f32,
}

fn shape([a, b, c]: [Vec3; 3]) -> Shape {
    let cross = (b - a).cross(c - a);
    let area = cross.length();
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    Shape { area, normal: cross.normalize_or_zero(), altitude: area / longest.max(1e-20) }
}

impl TriangleQuality {
    /// Cosine of how far a triangle may turn: about 72°.
    pub const LEAST_COSINE: f32 = 0.3;
    /// Share of its area and of its least altitude that a triangle keeps.
    pub const LEAST_SHARE: f32 = 0.25;

    /// Remembers what the triangles are like.
    pub fn new(rest: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let shapes = triangles.iter().map(|t| shape(t.map(|i| rest[i as usize]))).collect();
        Self { triangles: triangles.to_vec(), rest: shapes }
    }

    fn is_sane(&self, triangle: usize, points: &[Vec3]) -> bool {
        let rest = &self.rest[triangle];
        if rest.area <= 1e-12 {
            return true;
        }
        let now = shape(self.triangles[triangle].map(|i| points[i as usize]));
        now.normal.dot(rest.normal) >= Self::LEAST_COSINE
            && now.area >= Self::LEAST_SHARE * rest.area
            && now.altitude >= Self::LEAST_SHARE * rest.altitude
    }

    /// Triangles that are not sane.
    pub fn invalid<'a>(&'a self, points: &'a [Vec3]) -> impl Iterator<Item = usize> + 'a {
        (0..self.triangles.len()).filter(|&t| !self.is_sane(t, points))
    }

    /// Takes back what spoils a triangle. Returns how many points stayed where they were.
    pub fn revert(&self, before: &[Vec3], after: &mut [Vec3]) -> usize {
        let mut held = 0;
        loop {
            let invalid: Vec<usize> = self.invalid(after).collect();
            let mut any = false;
            for corner in invalid.iter().flat_map(|&t| self.triangles[t]).map(|i| i as usize) {
                if after[corner] != before[corner] {
                    after[corner] = before[corner];
                    held += 1;
                    any = true;
                }
            }
            if !any {
                return held;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)];
    const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [1, 3, 2]];

    /// Protects from flips, needles and collapse, whatever the step.
    #[test]
    fn a_step_never_spoils_a_triangle() {
        let quality = TriangleQuality::new(&REST, &TRIANGLES);
        let mut points = REST.to_vec();
        for step in 0..2000u32 {
            let before = points.clone();
            for (i, p) in points.iter_mut().enumerate() {
                let noise = |k: u32| ((step * 97 + i as u32 * 31 + k * 17) % 41) as f32 / 20.0 - 1.0;
                *p += 0.4 * Vec3::new(noise(0), noise(1), noise(2));
            }
            quality.revert(&before, &mut points);
            assert_eq!(quality.invalid(&points).count(), 0, "step {step}");
        }
        assert!(points.iter().zip(REST).any(|(p, h)| p.distance(h) > 0.1), "nothing could move");
    }

    /// Protects harmless motion from being held back.
    #[test]
    fn small_steps_pass() {
        let quality = TriangleQuality::new(&REST, &TRIANGLES);
        let mut after = REST.map(|p| p * 1.1);
        let want = after;
        assert_eq!(quality.revert(&REST, &mut after), 0);
        assert_eq!(after, want);
    }
}
