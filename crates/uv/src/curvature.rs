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
use crate::distortion::{Distortion, Element};
use crate::lbfgs::Preconditioner;
use glam::{DMat2, DVec2, dvec2};
use parbake_cholesky::{Cholesky, LowerHalf};
use rayon::prelude::*;

/// κ relative to the mean of the diagonal.
const SHIFT: f64 = 1e-6;

/// `H⁻¹`, factorised.
pub struct Curvature {
    factors: Option<Cholesky>,
}

/// A 2 × 2 block of the lower half: points i ≥ j, whose x and y are rows and columns 2 i and 2 i + 1, 2 j and 2 j + 1.
type Block = (u32, u32, DMat2);

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
        let of_triangle = |(element, corners): (&Element, &[u32; 3])| {
            let [a, b, c] = corners.map(|i| points[i as usize]);
            triangle_blocks(*corners, element.curvature(DMat2::from_cols(b - a, c - a)))
        };
        let mut blocks: Vec<Block> =
            distortion.elements.par_iter().zip(triangles).flat_map_iter(of_triangle).collect();
        for (curvature, pair) in contact.curvatures(points) {
            blocks.extend(pair_blocks(contact_weight * curvature, pair.normal, pair.parts()));
        }
        let matrix = Columns::new(&blocks, points.len()).matrix(free);
        Self { factors: Cholesky::new(matrix) }
    }
}

/// The block in the lower half: transposed if i < j.
fn lower(i: u32, j: u32, value: DMat2) -> Block {
    if i >= j { (i, j, value) } else { (j, i, value.transpose()) }
}

/// Blocks by edges become blocks by corners: an edge is its end less the first corner.
fn triangle_blocks(
    [a, b, c]: [u32; 3],
    [[ee, ef], [fe, ff]]: [[DMat2; 2]; 2],
) -> impl Iterator<Item = Block> {
    let blocks = [
        lower(a, a, ee + ef + fe + ff),
        lower(b, b, ee),
        lower(c, c, ff),
        lower(b, a, -(ee + ef)),
        lower(c, a, -(fe + ff)),
        lower(c, b, fe),
    ];
    blocks.into_iter().take(if ee == DMat2::ZERO { 0 } else { 6 })
}

/// `curvature · n nᵀ`, n being `normal` times each point's part.
fn pair_blocks(curvature: f64, normal: DVec2, parts: &[(u32, f64)]) -> impl Iterator<Item = Block> {
    let outer = DMat2::from_cols(normal * normal.x, normal * normal.y) * curvature;
    let pairs = parts.iter().enumerate().flat_map(|(k, p)| parts[..=k].iter().map(move |q| (p, q)));
    pairs.map(move |((i, p), (j, q))| lower(*i, *j, outer * (p * q)))
}

/// The lower half as compressed sparse columns of blocks.
struct Columns {
    /// For each point where its column begins, and where the last one ends.
    pointers: Vec<usize>,
    /// Ascending in each column, which begins on the diagonal.
    rows: Vec<u32>,
    values: Vec<DMat2>,
}

impl Columns {
    /// Sums blocks of one place. A counting sort by column, then by row and index: they are summed in the order in which
    /// they come, so the bits are the same each time.
    fn new(blocks: &[Block], points: usize) -> Self {
        let mut begin = vec![0; points + 1];
        blocks.iter().for_each(|&(_, j, _)| begin[j as usize + 1] += 1);
        for j in 0..points {
            begin[j + 1] += begin[j];
        }
        let (mut next, mut by_column) = (begin.clone(), vec![(0u32, 0u32); blocks.len()]);
        for (index, &(i, j, _)) in blocks.iter().enumerate() {
            by_column[next[j as usize]] = (i, index as u32);
            next[j as usize] += 1;
        }
        let capacity = blocks.len() + points;
        let (mut pointers, mut rows) = (Vec::with_capacity(points + 1), Vec::with_capacity(capacity));
        let mut values = Vec::with_capacity(capacity);
        for j in 0..points {
            pointers.push(rows.len());
            rows.push(j as u32);
            values.push(DMat2::ZERO);
            let column = &mut by_column[begin[j]..begin[j + 1]];
            column.sort_unstable();
            for &(i, index) in &*column {
                let value = blocks[index as usize].2;
                match (rows.last(), values.last_mut()) {
                    (Some(&last), Some(sum)) if last == i => *sum += value,
                    _ => {
                        rows.push(i);
                        values.push(value);
                    }
                }
            }
        }
        pointers.push(rows.len());
        Self { pointers, rows, values }
    }

    /// The matrix of what is free, shifted.
    fn matrix(&self, free: &[DVec2]) -> LowerHalf {
        let own = |(&pointer, free): (&usize, &DVec2)| {
            let (block, free) = (self.values[pointer], *free * *free);
            block.x_axis.x * free.x + block.y_axis.y * free.y
        };
        let trace: f64 = self.pointers.iter().zip(free).map(own).sum();
        let size = 2 * free.len();
        let shift = (SHIFT * trace / size.max(1) as f64).max(f64::MIN_POSITIVE);
        let mut pointers = Vec::with_capacity(size + 1);
        let mut rows = Vec::with_capacity(4 * self.rows.len());
        let mut values = Vec::with_capacity(4 * self.rows.len());
        for (j, &free_here) in free.iter().enumerate() {
            let range = self.pointers[j]..self.pointers[j + 1];
            for axis in 0..2 {
                pointers.push(rows.len());
                // A coordinate that is not free has no other entry.
                let added = if free_here[axis] == 0.0 { 1.0 } else { shift };
                for (&i, block) in self.rows[range.clone()].iter().zip(&self.values[range.clone()]) {
                    let mut column = block.col(axis) * free_here[axis] * free[i as usize];
                    let is_diagonal = i as usize == j;
                    if is_diagonal {
                        column[axis] += added;
                    }
                    for row in if is_diagonal { axis } else { 0 }..2 {
                        if column[row] != 0.0 {
                            rows.push(2 * i as usize + row);
                            values.push(column[row]);
                        }
                    }
                }
            }
        }
        pointers.push(rows.len());
        LowerHalf { pointers, rows, values }
    }
}

impl Preconditioner for Curvature {
    fn apply(&self, vector: &mut [DVec2]) {
        let Some(factors) = &self.factors else { return };
        let mut right: Vec<f64> = vector.iter().flat_map(|v| v.to_array()).collect();
        factors.solve([&mut right]);
        for (v, solved) in vector.iter_mut().zip(right.chunks_exact(2)) {
            *v = dvec2(solved[0], solved[1]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Border, ContactOptions};
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
        for (curvature, pair) in contact.curvatures(&layout.points) {
            let (normal, parts) = (pair.normal, pair.parts());
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
        }
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

    /// Protects the assembly: each block lands in its own rows and columns, blocks of one place add up, and what is not
    /// free, or has no block, has its diagonal alone.
    #[test]
    fn blocks_are_summed_where_they_belong() {
        let (points, mut all) = (9u32, Vec::new());
        let mut dense = vec![[0f64; 20]; 20];
        let number = |k: u32| (f64::from(k) * 1.3).sin();
        let free: Vec<DVec2> = (0..=points)
            .map(|i| dvec2(f64::from(u8::from(i != 4)), f64::from(u8::from(i % 4 != 0))))
            .collect();
        for k in 0..60u32 {
            let (i, j) = (k * 7 % points, k * k % points);
            let (x, y) = (dvec2(number(k), number(k + 7)), dvec2(number(k + 3), number(k + 5)));
            let symmetric = DMat2::from_cols(x, dvec2(x.y, y.y)) + DMat2::IDENTITY * 3.0;
            let own = if i == j { symmetric } else { DMat2::from_cols(x, y) };
            all.push(lower(i, j, own));
            for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let value = own.col(column)[row] * free[i as usize][row] * free[j as usize][column];
                let [a, b] = [2 * i as usize + row, 2 * j as usize + column];
                dense[a][b] += value;
                if i != j {
                    dense[b][a] += value;
                }
            }
        }
        let matrix = Columns::new(&all, points as usize + 1).matrix(&free);
        let get = |i: usize, j: usize| {
            let range = matrix.pointers[j]..matrix.pointers[j + 1];
            let rows = &matrix.rows[range.clone()];
            rows.binary_search(&i).ok().map(|place| matrix.values[range.start + place])
        };
        let trace: f64 = (0..20).map(|i| dense[i][i]).sum();
        for (i, row) in dense.iter().enumerate() {
            for (j, &value) in row[..=i].iter().enumerate() {
                let is_fixed = i == j && free[i / 2][i % 2] == 0.0;
                let own = if is_fixed {
                    1.0
                } else if i == j {
                    SHIFT * trace / 20.0
                } else {
                    0.0
                };
                let found = get(i, j).unwrap_or(0.0);
                assert!((found - value - own).abs() < 1e-9, "{i} {j}: {found}, {value} wanted");
                assert!(i == j || get(j, i).is_none(), "{i} {j}");
            }
        }
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
