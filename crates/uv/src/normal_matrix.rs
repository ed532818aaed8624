//! The normal matrix of a bilinear texture that is clamped at its borders: nine points a
//! texel, symmetric, one number for all channels.
//!
//! Forward: [`NormalMatrix::add_product`] is `y += A x`. The matrix is its own adjoint.

use glam::Vec4;
use rayon::prelude::*;

/// A texel's row: with itself and the neighbours that come later, and the right-hand side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Coupling with itself.
    pub centre: f32,
    /// With the texel to the right.
    pub east: f32,
    /// With the one below to the left.
    pub south_west: f32,
    /// With the one below.
    pub south: f32,
    /// With the one below to the right.
    pub south_east: f32,
    /// Right-hand side.
    pub right: Vec4,
}

impl Row {
    fn add(&mut self, other: &Self) {
        self.centre += other.centre;
        self.east += other.east;
        self.south_west += other.south_west;
        self.south += other.south;
        self.south_east += other.south_east;
        self.right += other.right;
    }
}

/// Adds a sample of weight `weight` at `place` with fractions `f` to rows of `width`.
#[inline]
pub fn add_sample(rows: &mut [Row], width: usize, place: usize, f: [f32; 2], weight: f32, target: Vec4) {
    let [fx, fy] = f;
    let (gx, gy) = (1.0 - fx, 1.0 - fy);
    let w = [gx * gy, fx * gy, gx * fy, fx * fy];
    let s = w.map(|w| w * weight);
    let (upper, lower) = rows[place..].split_at_mut(width);
    upper[0].centre += s[0] * w[0];
    upper[0].east += s[0] * w[1];
    upper[0].south += s[0] * w[2];
    upper[0].south_east += s[0] * w[3];
    upper[0].right += target * s[0];
    upper[1].centre += s[1] * w[1];
    upper[1].south_west += s[1] * w[2];
    upper[1].south += s[1] * w[3];
    upper[1].right += target * s[1];
    lower[0].centre += s[2] * w[2];
    lower[0].east += s[2] * w[3];
    lower[0].right += target * s[2];
    lower[1].centre += s[3] * w[3];
    lower[1].right += target * s[3];
}

/// A rectangle of rows that one run of triangles fills.
#[derive(Clone, Debug, Default)]
pub struct Patch {
    /// Its upper left texel.
    pub origin: [usize; 2],
    /// Texels in a row.
    pub width: usize,
    /// Its rows, one after another.
    pub rows: Vec<Row>,
}

/// The matrix of one level.
#[derive(Clone, Debug, Default)]
pub struct NormalMatrix {
    /// Texels along a side, ≥ 2.
    pub size: usize,
    /// size² rows.
    pub rows: Vec<Row>,
}

impl NormalMatrix {
    /// The sum of patches, added in their order.
    pub fn sum<'a>(size: usize, patches: impl Iterator<Item = &'a Patch> + Clone + Sync) -> Self {
        let patches: Vec<&Patch> = patches.filter(|p| !p.rows.is_empty()).collect();
        let mut rows = vec![Row::default(); size * size];
        rows.par_chunks_mut(size).enumerate().for_each(|(y, out)| {
            for patch in &patches {
                let height = patch.rows.len() / patch.width;
                if (patch.origin[1]..patch.origin[1] + height).contains(&y) {
                    let local = &patch.rows[(y - patch.origin[1]) * patch.width..][..patch.width];
                    for (out, add) in out[patch.origin[0]..].iter_mut().zip(local) {
                        out.add(add);
                    }
                }
            }
        });
        Self { size, rows }
    }

    /// Adds `weight · Σ |Tᵢ − Tⱼ|²` over neighbours in rows and columns.
    pub fn add_smoothness(&mut self, weight: f32) {
        let size = self.size;
        let share = |yes: bool| if yes { weight } else { 0.0 };
        self.rows.par_chunks_mut(size).enumerate().for_each(|(y, out)| {
            for (x, row) in out.iter_mut().enumerate() {
                let (east, south) = (share(x + 1 < size), share(y + 1 < size));
                row.centre += east + south + share(x > 0) + share(y > 0);
                row.east -= east;
                row.south -= south;
            }
        });
    }

    /// `y += A x`.
    pub fn add_product(&self, x: &[Vec4], y: &mut [Vec4]) {
        y.par_chunks_mut(self.size).enumerate().for_each(|(row, out)| self.add_row(row, x, out));
    }

    fn add_row(&self, y: usize, x: &[Vec4], out: &mut [Vec4]) {
        let size = self.size;
        let here = y * size;
        let own = &self.rows[here..here + size];
        let x1 = &x[here..here + size];
        for ((out, x), row) in out.iter_mut().zip(x1).zip(own) {
            *out += *x * row.centre;
        }
        for i in 0..size - 1 {
            out[i] += x1[i + 1] * own[i].east;
            out[i + 1] += x1[i] * own[i].east;
        }
        if y + 1 < size {
            let x2 = &x[here + size..here + 2 * size];
            for i in 0..size - 1 {
                out[i] += x2[i] * own[i].south + x2[i + 1] * own[i].south_east;
                out[i + 1] += x2[i] * own[i + 1].south_west;
            }
            out[size - 1] += x2[size - 1] * own[size - 1].south;
        }
        if y > 0 {
            let upper = &self.rows[here - size..here];
            let x0 = &x[here - size..here];
            for i in 0..size - 1 {
                out[i] += x0[i] * upper[i].south + x0[i + 1] * upper[i + 1].south_west;
                out[i + 1] += x0[i] * upper[i].south_east;
            }
            out[size - 1] += x0[size - 1] * upper[size - 1].south;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the assembly and the product at once: `xᵀ A x = Σ ω (Σ wᵢ xᵢ)²`.
    #[test]
    fn energy_equals_the_samples_sum() {
        let size = 5;
        let number = |i: usize| ((i * 2_654_435_761) % 1009) as f32 / 1009.0;
        let x: Vec<Vec4> = (0..25).map(|i| Vec4::splat(number(i + 1))).collect();
        let mut patch = Patch { origin: [0; 2], width: size, rows: vec![Row::default(); 25] };
        let mut want = 0.0;
        for k in 0..100 {
            let (i, j) = ((number(k + 50) * 4.0) as usize, (number(k + 250) * 4.0) as usize);
            let (fx, fy, w) = (number(k + 450), number(k + 650), number(k + 850));
            let place = j * size + i;
            add_sample(&mut patch.rows, size, place, [fx, fy], w, Vec4::ZERO);
            let row = |p: usize| x[p].x * (1.0 - fx) + x[p + 1].x * fx;
            want += w * (row(place) * (1.0 - fy) + row(place + size) * fy).powi(2);
        }
        let matrix = NormalMatrix::sum(size, std::iter::once(&patch));
        let mut y = vec![Vec4::ZERO; 25];
        matrix.add_product(&x, &mut y);
        let energy: f32 = x.iter().zip(&y).map(|(a, b)| a.x * b.x).sum();
        assert!((energy / want - 1.0).abs() < 1e-4);
    }
}
