//! The Hessian of distortion and contact, kept positive, for Newton's steps.
//!
//! Quasi-Newton directions know nothing of a barrier that is half a texel wide: they run into it,
//! and the first pair that would meet bounds the step of all charts. Newton's direction slides
//! along it (projected Newton as in Li et al. 2020, "Incremental Potential Contact").
//!
//! - A triangle, with the edges E from its first corner, J = E R⁻¹: the energy
//!   `A (α ‖J‖² + ‖M^½ J⁻¹‖²)` is a sum of squares, and `d J⁻¹ = −J⁻¹ dE E⁻¹`. Gauss and Newton's
//!   Hessian for edges i and j is `2 A (α (R⁻¹ R⁻ᵀ)ᵢⱼ I + 3 (E⁻¹ E⁻ᵀ)ᵢⱼ J⁻ᵀ M J⁻¹)`; they would have 1
//!   in place of the 3, which is exact for a length, 1 / x².
//! - A pair in contact: `b″ n nᵀ` with n the distance's gradient. What the bend of n would add is
//!   negative and left out.
//! - A shift κ I, small beside both, keeps charts without contact in place.
//!
//! Contract: positive definite; coordinates that are not free stay zero. Deterministic.

use crate::contact::Contact;
use crate::distortion::Distortion;
use crate::lbfgs::Preconditioner;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use glam::{DMat2, DVec2, dvec2};
use rayon::prelude::*;

/// κ relative to the mean of the diagonal.
const SHIFT: f64 = 1e-6;

/// `H⁻¹`, factorised.
pub struct Curvature {
    factors: Option<Llt<usize, f64>>,
}

/// Entries of the lower half, x and y of point i being rows 2 i and 2 i + 1.
struct Entries<'a> {
    free: &'a [DVec2],
    triplets: Vec<Triplet<usize, usize, f64>>,
    /// Sum of the diagonal's.
    trace: f64,
}

impl Curvature {
    /// Of distortion, and of contact times its weight, at these points, of which `free` tells what
    /// may move.
    pub fn new(
        distortion: &Distortion,
        triangles: &[[u32; 3]],
        (contact, contact_weight): (&Contact, f64),
        points: &[DVec2],
        free: &[DVec2],
    ) -> Self {
        let mut entries = Entries { free, triplets: Vec::with_capacity(24 * triangles.len()), trace: 0.0 };
        let blocks: Vec<[[DMat2; 2]; 2]> = distortion
            .elements
            .par_iter()
            .zip(triangles)
            .map(|(element, corners)| {
                let [a, b, c] = corners.map(|i| points[i as usize]);
                element.curvature(DMat2::from_cols(b - a, c - a))
            })
            .collect();
        for (edges, corners) in blocks.iter().zip(triangles) {
            entries.add_triangle(*corners, edges);
        }
        contact.for_each_curvature(points, |curvature, normal, parts| {
            entries.add_pair(contact_weight * curvature, normal, parts);
        });
        Self { factors: entries.factorised(points.len()) }
    }
}

impl Entries<'_> {
    /// The 2 × 2 block for points i ≥ j, or the half of it that lies on the diagonal.
    fn add(&mut self, i: u32, j: u32, block: DMat2) {
        let (i, j, block) = if i >= j { (i, j, block) } else { (j, i, block.transpose()) };
        let (rows, columns) = (self.free[i as usize], self.free[j as usize]);
        for column in 0..2 {
            for row in if i == j { column } else { 0 }..2 {
                let value = block.col(column)[row] * rows[row] * columns[column];
                if value != 0.0 {
                    let place = [2 * i as usize + row, 2 * j as usize + column];
                    if place[0] == place[1] {
                        self.trace += value;
                    }
                    self.triplets.push(Triplet::new(place[0], place[1], value));
                }
            }
        }
    }

    /// Blocks by edges become blocks by corners: an edge is its end less the first corner.
    fn add_triangle(&mut self, [a, b, c]: [u32; 3], [[ee, ef], [fe, ff]]: &[[DMat2; 2]; 2]) {
        if *ee == DMat2::ZERO {
            return;
        }
        self.add(a, a, *ee + *ef + *fe + *ff);
        self.add(b, b, *ee);
        self.add(c, c, *ff);
        self.add(b, a, -(*ee + *ef));
        self.add(c, a, -(*fe + *ff));
        self.add(c, b, *fe);
    }

    /// `curvature · n nᵀ`, n being `normal` times each point's part.
    fn add_pair(&mut self, curvature: f64, normal: DVec2, parts: &[(u32, f64)]) {
        let outer = DMat2::from_cols(normal * normal.x, normal * normal.y) * curvature;
        for (k, (i, p)) in parts.iter().enumerate() {
            for (j, q) in &parts[..=k] {
                self.add(*i, *j, outer * (p * q));
            }
        }
    }

    fn factorised(mut self, points: usize) -> Option<Llt<usize, f64>> {
        let shift = (SHIFT * self.trace / (2 * points).max(1) as f64).max(f64::MIN_POSITIVE);
        for (i, free) in self.free.iter().enumerate() {
            for axis in 0..2 {
                // A coordinate that is not free has no other entry.
                let own = if free[axis] == 0.0 { 1.0 } else { shift };
                self.triplets.push(Triplet::new(2 * i + axis, 2 * i + axis, own));
            }
        }
        let matrix = SparseColMat::try_new_from_triplets(2 * points, 2 * points, &self.triplets).ok()?;
        matrix.sp_cholesky(Side::Lower).ok()
    }
}

impl Preconditioner for Curvature {
    fn apply(&self, vector: &mut [DVec2]) {
        let Some(factors) = &self.factors else { return };
        let mut right = Mat::from_fn(2 * vector.len(), 1, |i, _| vector[i / 2][i % 2]);
        factors.solve_in_place(&mut right);
        for (i, v) in vector.iter_mut().enumerate() {
            *v = dvec2(right[(2 * i, 0)], right[(2 * i + 1, 0)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Border, ContactOptions};
    use crate::distortion::Element;
    use parbake_atlas::Layout;

    /// Two right triangles on top of each other, 1.2 texels of 10 apart: one pair of a vertex and an
    /// edge, (0.3, 0.52) over the side y = 0.4, is repelled.
    fn near() -> (Layout, Contact) {
        let points = vec![
            dvec2(0.2, 0.2),
            dvec2(0.6, 0.4),
            dvec2(0.2, 0.4),
            dvec2(0.3, 0.52),
            dvec2(0.5, 0.8),
            dvec2(0.2, 0.8),
        ];
        let triangles = vec![[0, 1, 2], [3, 4, 5]];
        let layout = Layout {
            rest: vec![DMat2::IDENTITY; 2],
            charts: vec![0, 1],
            point_of_vertex: (0..6).collect(),
            points,
            triangles,
        };
        let options = ContactOptions {
            texture_size: 10,
            gutter_texels: 1.0,
            activation_texels: 0.5,
            border: Border::Margin { margin_texels: 0.5 },
            ..ContactOptions::default()
        };
        let contact = Contact::new(&layout, &options);
        (layout, contact)
    }

    /// Protects the barrier's second derivative and each point's part of it, against central
    /// differences of its gradient across the gap, where the pair's normal does not turn.
    #[test]
    fn contact_by_central_differences() {
        let (layout, contact) = near();
        let gradient = |points: &[DVec2]| {
            let mut gradient = vec![DVec2::ZERO; points.len()];
            contact.energy_and_gradient(points, &mut gradient);
            gradient
        };
        let mut pairs = 0;
        contact.for_each_curvature(&layout.points, |curvature, normal, parts| {
            pairs += 1;
            let h = 1e-6;
            let (mut up, mut down) = (layout.points.clone(), layout.points.clone());
            up[parts[0].0 as usize] += normal * h;
            down[parts[0].0 as usize] -= normal * h;
            let (up, down) = (gradient(&up), gradient(&down));
            for (point, part) in parts {
                let want = (up[*point as usize] - down[*point as usize]) / (2.0 * h);
                let got = curvature * part * normal;
                assert!((want - got).length() < 1e-5 * curvature, "{point}: {got}, {want} wanted");
            }
        });
        assert_eq!(pairs, 1);
    }

    /// Protects the Hessian of distortion, which is exact for a triangle that gets longer along an axis.
    #[test]
    fn distortion_along_an_axis() {
        let element = Element::new(DMat2::from_diagonal(dvec2(1.5, 0.7)), 2.0, 0.4, DMat2::IDENTITY * 0.3);
        let edges = |x: f64| DMat2::from_diagonal(dvec2(x, 0.9));
        let h = 1e-6;
        let slope = |x: f64| element.evaluate(edges(x)).1.x_axis.x;
        let want = (slope(0.8 + h) - slope(0.8 - h)) / (2.0 * h);
        let got = element.curvature(edges(0.8))[0][0].x_axis.x;
        assert!((got - want).abs() < 1e-5 * want, "{got}, {want} wanted");
    }

    /// Protects the factorisation: definite, and without motion where nothing is free.
    #[test]
    fn positive_where_points_are_free() {
        let (layout, contact) = near();
        let distortion = Distortion::symmetric_dirichlet(&layout.rest, 1.0, |_| 1.0);
        let mut free = vec![DVec2::ONE; 6];
        free[1] = DVec2::X;
        let h = Curvature::new(&distortion, &layout.triangles, (&contact, 1.0), &layout.points, &free);
        for seed in 0..20 {
            let noise = |i: usize| (f64::from(seed) * 1.7 + i as f64 * 2.3).sin();
            let vector: Vec<DVec2> =
                (0..6).map(|i| dvec2(noise(2 * i), noise(2 * i + 1)) * free[i]).collect();
            let mut solved = vector.clone();
            h.apply(&mut solved);
            let product: f64 = vector.iter().zip(&solved).map(|(a, b)| a.dot(*b)).sum();
            assert!(product > 0.0, "{product}");
            assert_eq!(solved[1].y, 0.0);
        }
    }
}
