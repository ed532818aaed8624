//! The normal matrix of a bilinear texture: nine points a texel, symmetric, so
//! that each texel keeps only its own block and those towards east, south-west,
//! south and south-east.
//!
//! Forward: [`Stencil::product`] is `y = A x`, each row of texels by itself.
//! The matrix is its own adjoint.
//!
//! Colours need three independent channels ([`Diagonal`]), normals a symmetric
//! 3 × 3 block ([`Symmetric`]); both act on `Vec4` whose fourth lane is unused.

use crate::grid::block;
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// A block of the matrix.
pub trait Block: Copy + Default + Send + Sync {
    /// Block times vector.
    fn product(&self, v: Vec4) -> Vec4;
    /// Adds another block.
    fn add(&mut self, other: &Self);
    /// The inverse, zero where the block is (nearly) singular.
    fn inverse(&self) -> Self;
    /// This number on the diagonal.
    fn identity(scale: f32) -> Self;
    /// Sum of the diagonal over its three lanes.
    fn trace(&self) -> f32;
}

/// Independent channels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Diagonal(pub Vec4);

/// Symmetric 3 × 3: xx, yy, zz, xy, xz, yz.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Symmetric(pub [f32; 6]);

impl Block for Diagonal {
    #[inline]
    fn product(&self, v: Vec4) -> Vec4 {
        self.0 * v
    }

    #[inline]
    fn add(&mut self, other: &Self) {
        self.0 += other.0;
    }

    fn inverse(&self) -> Self {
        Self(Vec4::from(self.0.to_array().map(|d| if d > 1e-20 { 1.0 / d } else { 0.0 })))
    }

    fn identity(scale: f32) -> Self {
        Self(Vec4::new(scale, scale, scale, 0.0))
    }

    fn trace(&self) -> f32 {
        self.0.x + self.0.y + self.0.z
    }
}

impl Block for Symmetric {
    #[inline]
    fn product(&self, v: Vec4) -> Vec4 {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        Vec4::new(
            xx * v.x + xy * v.y + xz * v.z,
            xy * v.x + yy * v.y + yz * v.z,
            xz * v.x + yz * v.y + zz * v.z,
            0.0,
        )
    }

    #[inline]
    fn add(&mut self, other: &Self) {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a += b;
        }
    }

    fn inverse(&self) -> Self {
        let [xx, yy, zz, xy, xz, yz] = self.0.map(f64::from);
        let (a, b, c) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
        let determinant = xx * a + xy * b + xz * c;
        let size = (xx + yy + zz) / 3.0;
        if determinant <= 1e-12 * size * size * size {
            return Self::default();
        }
        let d = 1.0 / determinant;
        Self([a, xx * zz - xz * xz, xx * yy - xy * xy, b, c, xy * xz - xx * yz].map(|v| (v * d) as f32))
    }

    fn identity(scale: f32) -> Self {
        Self([scale, scale, scale, 0.0, 0.0, 0.0])
    }

    fn trace(&self) -> f32 {
        self.0[0] + self.0[1] + self.0[2]
    }
}

impl Symmetric {
    /// `scale · d dᵀ`.
    #[inline]
    pub fn outer(d: Vec3, scale: f32) -> Self {
        let s = d * scale;
        Self([s.x * d.x, s.y * d.y, s.z * d.z, s.x * d.y, s.x * d.z, s.y * d.z])
    }

    #[inline]
    fn add_scaled(&mut self, other: &Self, scale: f32) {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a += b * scale;
        }
    }
}

/// One texel's part of the matrix and of the right-hand side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Row<B> {
    /// Coupling with itself.
    pub centre: B,
    /// With the texel to the right.
    pub east: B,
    /// With the one below.
    pub south: B,
    /// With the one below to the right.
    pub south_east: B,
    /// With the one below to the left.
    pub south_west: B,
    /// Right-hand side.
    pub right: Vec4,
}

impl<B: Block> Row<B> {
    /// Adds another texel's sums.
    pub fn add(&mut self, other: &Self) {
        self.centre.add(&other.centre);
        self.east.add(&other.east);
        self.south.add(&other.south);
        self.south_east.add(&other.south_east);
        self.south_west.add(&other.south_west);
        self.right += other.right;
    }
}

/// Adds one bilinear sample with weights `w` (order of [`block`]) to the rows at
/// the four `places`: matrix `wᵢ wⱼ · J`, right-hand side `wᵢ · right`.
#[inline]
pub fn add_diagonal(rows: &mut [Row<Diagonal>], places: [usize; 4], w: [f32; 4], j: Vec4, right: Vec4) {
    let [a, b, c, d] = places;
    let s = w.map(|w| j * w);
    rows[a].centre.0 += s[0] * w[0];
    rows[a].east.0 += s[0] * w[1];
    rows[a].south.0 += s[0] * w[2];
    rows[a].south_east.0 += s[0] * w[3];
    rows[a].right += right * w[0];
    rows[b].centre.0 += s[1] * w[1];
    rows[b].south_west.0 += s[1] * w[2];
    rows[b].south.0 += s[1] * w[3];
    rows[b].right += right * w[1];
    rows[c].centre.0 += s[2] * w[2];
    rows[c].east.0 += s[2] * w[3];
    rows[c].right += right * w[2];
    rows[d].centre.0 += s[3] * w[3];
    rows[d].right += right * w[3];
}

/// The same with a symmetric block.
#[inline]
pub fn add_symmetric(
    rows: &mut [Row<Symmetric>],
    places: [usize; 4],
    w: [f32; 4],
    j: &Symmetric,
    right: Vec4,
) {
    let [a, b, c, d] = places;
    rows[a].centre.add_scaled(j, w[0] * w[0]);
    rows[a].east.add_scaled(j, w[0] * w[1]);
    rows[a].south.add_scaled(j, w[0] * w[2]);
    rows[a].south_east.add_scaled(j, w[0] * w[3]);
    rows[a].right += right * w[0];
    rows[b].centre.add_scaled(j, w[1] * w[1]);
    rows[b].south_west.add_scaled(j, w[1] * w[2]);
    rows[b].south.add_scaled(j, w[1] * w[3]);
    rows[b].right += right * w[1];
    rows[c].centre.add_scaled(j, w[2] * w[2]);
    rows[c].east.add_scaled(j, w[2] * w[3]);
    rows[c].right += right * w[2];
    rows[d].centre.add_scaled(j, w[3] * w[3]);
    rows[d].right += right * w[3];
}

/// The whole matrix, on a grid that repeats.
#[derive(Clone, Debug, Default)]
pub struct Stencil<B> {
    /// Texels along a side, ≥ 3 so that no two neighbours are the same texel.
    pub size: usize,
    /// size² rows.
    pub rows: Vec<Row<B>>,
}

impl<B: Block> Stencil<B> {
    /// `y = A x`; `y` has the size of `x`. Returns `xᵀ y`, summed by rows in order.
    pub fn product(&self, x: &[Vec4], y: &mut [Vec4]) -> f64 {
        let size = self.size;
        let dots: Vec<f64> = (y.par_chunks_mut(size).enumerate())
            .map(|(row, out)| {
                self.row_product(row, x, out);
                dot(&x[row * size..(row + 1) * size], out)
            })
            .collect();
        dots.iter().sum()
    }

    fn row_product(&self, row: usize, x: &[Vec4], out: &mut [Vec4]) {
        let size = self.size;
        let here = row * size;
        let above = if row == 0 { size * (size - 1) } else { here - size };
        let below = block(here, size)[2];
        let (own, upper) = (&self.rows[here..here + size], &self.rows[above..above + size]);
        let (x1, x0, x2) = (&x[here..here + size], &x[above..above + size], &x[below..below + size]);
        for (i, out) in out.iter_mut().enumerate() {
            let r = &own[i];
            // A texel that nothing pulls at is coupled to nothing: half a texture is empty.
            if r.centre.trace() == 0.0 {
                *out = Vec4::ZERO;
                continue;
            }
            let west = if i == 0 { size - 1 } else { i - 1 };
            let east = if i + 1 == size { 0 } else { i + 1 };
            *out = r.centre.product(x1[i])
                + r.east.product(x1[east])
                + own[west].east.product(x1[west])
                + r.south.product(x2[i])
                + r.south_east.product(x2[east])
                + r.south_west.product(x2[west])
                + upper[i].south.product(x0[i])
                + upper[west].south_east.product(x0[west])
                + upper[east].south_west.product(x0[east]);
        }
    }
}

/// `aᵀ b` in double precision.
pub fn dot(a: &[Vec4], b: &[Vec4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a.dot(*b))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::weights;
    use crate::random::unit_interval;

    fn random(i: u64) -> f32 {
        unit_interval(i) as f32
    }

    /// Protects the assembly and the product at once, wraps included:
    /// `xᵀ A x = Σ J (Σ wᵢ xᵢ)²` over the samples.
    #[test]
    fn energy_equals_the_samples_sum() {
        let size = 5;
        let x: Vec<Vec4> =
            (0..25).map(|i| Vec4::new(random(3 * i), random(3 * i + 1), random(3 * i + 2), 0.0)).collect();
        let mut d = Stencil { size, rows: vec![Row::<Diagonal>::default(); 25] };
        let mut s = Stencil { size, rows: vec![Row::<Symmetric>::default(); 25] };
        let (mut want_d, mut want_s) = (0.0, 0.0);
        for k in 0..200u64 {
            let texel = (random(1000 + k) * 25.0) as usize;
            let places = block(texel, size);
            let w = weights(random(2000 + k), random(3000 + k));
            let j = Vec4::new(random(4000 + k), random(5000 + k), random(6000 + k), 0.0);
            add_diagonal(&mut d.rows, places, w, j, Vec4::ZERO);
            add_symmetric(&mut s.rows, places, w, &Symmetric::outer(j.truncate(), 0.5), Vec4::ZERO);
            let v: Vec4 = (0..4).map(|i| x[places[i]] * w[i]).sum();
            want_d += (j * v * v).element_sum();
            want_s += 0.5 * j.dot(v).powi(2);
        }
        let energy = |y: &[Vec4]| -> f32 { x.iter().zip(y).map(|(a, b)| a.dot(*b)).sum() };
        let mut y = vec![Vec4::ZERO; 25];
        d.product(&x, &mut y);
        assert!((energy(&y) / want_d - 1.0).abs() < 1e-4);
        s.product(&x, &mut y);
        assert!((energy(&y) / want_s - 1.0).abs() < 1e-4);
    }

    /// Protects the preconditioner.
    #[test]
    fn inverse_blocks_invert() {
        let m = Symmetric([2.0, 3.0, 4.0, 0.5, -0.3, 0.2]);
        let v = Vec4::new(0.3, -0.8, 0.5, 0.0);
        assert!((m.inverse().product(m.product(v)) - v).length() < 1e-6);
        assert_eq!(Symmetric::outer(Vec3::X, 1.0).inverse(), Symmetric::default());
    }
}
