//! Directions of rays: evenly spread, each texel's turned by its own amount, the same in every run.
//!
//! Points are Hammersley's, ((i + ½) / n, Φ₂(i)) with Φ₂ the radical inverse of i to base 2, shifted modulo 1
//! (Cranley and Patterson 1976) by a hash of the texel. Directions are cosine-weighted by Malley's method:
//! an even point of the unit disc, raised onto the hemisphere.
//!
//! Contract: the samples of a texel share one set of n points between them, so that the texel's mean has
//! all of it; nothing depends on threads.

use parbake_model::glam::{Mat3, Vec3, vec3};
use std::f32::consts::TAU;

/// One sample's share of a texel's rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rays {
    first: u32,
    step: u32,
    count: u32,
    turn: [f32; 2],
}

impl Rays {
    /// Sample `index` of `samples` of a texel that has `count` rays at least: as many as give each sample
    /// the same number.
    pub fn new(count: usize, texel: usize, index: usize, samples: usize) -> Self {
        let step = samples.max(1) as u32;
        let hash = hashed(texel as u32);
        let fraction = |bits: u32| (bits >> 8) as f32 / (1u32 << 24) as f32;
        Self {
            first: index as u32,
            step,
            count: (count.max(1) as u32).div_ceil(step) * step,
            turn: [fraction(hash), fraction(hashed(hash))],
        }
    }

    /// No more than `most` rays a texel.
    pub fn at_most(self, most: usize) -> Self {
        let most = (most.max(1) as u32).div_ceil(self.step) * self.step;
        Self { count: self.count.min(most), ..self }
    }

    /// This sample's points of the unit square.
    pub fn points(self) -> impl Iterator<Item = [f32; 2]> {
        let Self { first, step, count, turn } = self;
        (first..count).step_by(step as usize).map(move |i| {
            let across = (i as f32 + 0.5) / count as f32;
            let inverse = (i.reverse_bits() >> 8) as f32 / (1u32 << 24) as f32;
            [(across + turn[0]).fract(), (inverse + turn[1]).fract()]
        })
    }

    /// This sample's directions about a unit normal, cosine-weighted. Those that lie below the plane across
    /// `above` are mirrored to its upper side: a ray never begins by going through its own triangle.
    pub fn directions(self, normal: Vec3, above: Vec3) -> impl Iterator<Item = Vec3> {
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let frame = Mat3::from_cols(tangent, bitangent, normal);
        self.points().map(move |[u, v]| {
            let (sin, cos) = (TAU * v).sin_cos();
            let radius = u.sqrt();
            let direction = frame * vec3(radius * cos, radius * sin, (1.0 - u).max(0.0).sqrt());
            let below = direction.dot(above).min(0.0);
            direction - 2.0 * below * above
        })
    }
}

/// A hash of 32 bits in which every bit depends on every other (finaliser of MurmurHash3, Appleby 2011).
fn hashed(mut bits: u32) -> u32 {
    bits = (bits ^ 0x9e37_79b9) ^ (bits >> 16);
    bits = bits.wrapping_mul(0x85eb_ca6b);
    bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
    bits ^ (bits >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the weights: the mean of cos θ over a cosine-weighted hemisphere is 2/3, and the mean direction
    /// is the normal's, whatever texel and however many samples share the rays.
    #[test]
    fn directions_are_cosine_weighted() {
        let normal = vec3(1.0, -2.0, 0.5).normalize();
        for (texel, samples) in [(0, 1), (17, 4), (123_456, 3)] {
            let all: Vec<Vec3> = (0..samples)
                .flat_map(|k| {
                    Rays::new(256, texel, k, samples).directions(normal, normal).collect::<Vec<_>>()
                })
                .collect();
            assert_eq!(all.len(), 256usize.div_ceil(samples) * samples);
            let mean = all.iter().sum::<Vec3>() / all.len() as f32;
            assert!((mean - normal * (2.0 / 3.0)).length() < 0.01, "{mean}");
        }
    }

    /// Protects smooth shading on coarse triangles: no direction goes into the triangle that it begins on.
    #[test]
    fn directions_stay_above_their_triangle() {
        let (normal, facet) = (Vec3::Z, vec3(0.6, 0.0, 0.8));
        assert!(Rays::new(128, 5, 0, 1).directions(normal, facet).all(|d| d.dot(facet) >= 0.0));
    }
}
