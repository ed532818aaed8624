//! What moving a point costs, for the steps of variable projection:
//!
//! `H = μ/4 H_D + β (L + κ)`, β = SHARE · 2 Σₛ ωₛ |∇T|² / F,
//!
//! H_D the distortion's Hessian at the points (`curvature.rs`), L the graph's Laplacian.
//!
//! - Triangles that are nearly closed are stiffer than others by orders of magnitude, and few pairs
//!   of L-BFGS cannot tell which: without H_D all points take the small steps that those few ask for.
//! - The error's own Hessian with the texture held is `Σ ω ∇T ∇Tᵀ`. The best texture follows what
//!   moves smoothly and gives most of that back, so what is left is stiff against differences of
//!   neighbours: a Laplacian, of a share of the mean triangle's. Tensors of each triangle in β's
//!   place gain nothing, nor do shares of 0.02 or 0.2 or a κ of 0.1 or 1.
//!
//! Applied by a sweep of Gauss-Seidel (`gauss_seidel.rs`), made anew for each step: pictures at 128²
//! on 200 cells gain 0.4 to 1.0 dB over the Laplacian alone, on 400 cells 1.6 to 2.4 dB.

use crate::distortion::Distortion;
use crate::gauss_seidel::{GaussSeidel, Pattern};
use crate::least_squares_texture::ParameterizedSignal;
use crate::metric::steepness;
use glam::Vec4;
use glam::{DMat2, DVec2};
use parbake_image::FloatImage;

/// Share of the error's stiffness with the texture held that is left with the best one.
const SHARE: f64 = 0.06;
/// κ: holds charts and regions in place, relative to their neighbours.
const SHIFT: f64 = 0.3;

/// Keeps blocks invertible where neither error nor distortion says anything, as on a plain picture;
/// objectives are of the order of 1.
const LEAST_SHIFT: f64 = 1e-12;

/// H without its points.
pub struct Stiffness<'a> {
    distortion: &'a Distortion,
    /// μ / 4.
    distortion_weight: f64,
    triangles: &'a [[u32; 3]],
    /// β.
    error: f64,
    pattern: Pattern,
}

impl<'a> Stiffness<'a> {
    /// For an objective `scale · R + distortion_weight · D` whose error R the layout `mapped` leaves
    /// with `texture`.
    pub fn new(
        mapped: &ParameterizedSignal<'a>,
        texture: &FloatImage<Vec4>,
        scale: f64,
        (distortion, distortion_weight): (&'a Distortion, f64),
    ) -> Self {
        let triangles = mapped.triangles;
        Self {
            distortion,
            distortion_weight,
            triangles,
            error: SHARE * 2.0 * scale * steepness(mapped, texture) / triangles.len().max(1) as f64,
            pattern: Pattern::new(mapped.points.len(), triangles),
        }
    }

    /// H at these P points; `free` has 1 where a coordinate may move and 0 where not.
    pub fn at(&self, points: &[DVec2], free: &[DVec2]) -> GaussSeidel<'_> {
        // A side of a triangle is half an edge: |e|² + |f|² + |e − f|², e and f its edges from the
        // first corner.
        let side = DMat2::IDENTITY * (0.5 * self.error);
        let blocks = |t: usize| {
            let [a, b, c] = self.triangles[t].map(|i| points[i as usize]);
            let [[ee, ef], [fe, ff]] = self.distortion.elements[t].curvature(DMat2::from_cols(b - a, c - a));
            let weight = self.distortion_weight;
            [[ee * weight + side * 2.0, ef * weight - side], [fe * weight - side, ff * weight + side * 2.0]]
        };
        let shift = (SHIFT * self.error).max(LEAST_SHIFT);
        GaussSeidel::new(&self.pattern, self.triangles, blocks, shift, free)
    }
}
