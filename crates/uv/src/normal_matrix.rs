//! The normal matrix of a bilinear texture that is clamped at its borders: nine points a
//! texel, symmetric, one number for all channels.
//!
//! Forward: [`NormalMatrix::product`] is `y = A x`, [`NormalMatrix::add_column`] adds it for an x that is
//! zero but for one texel. The matrix is its own adjoint.

use glam::Vec4;
use rayon::prelude::*;

/// A texel's coupling with itself and with the neighbours that come later.
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
}

/// A texel's row and right-hand side while samples are added, laid out for lanes of four.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    /// Centre, east, south, south-east.
    couplings: Vec4,
    right: Vec4,
    south_west: f32,
}

impl Row {
    fn add(&mut self, sum: &Sum) {
        self.centre += sum.couplings.x;
        self.east += sum.couplings.y;
        self.south_west += sum.south_west;
        self.south += sum.couplings.z;
        self.south_east += sum.couplings.w;
    }
}

/// A rectangle of texels that one run of triangles fills.
#[derive(Clone, Debug, Default)]
pub struct Patch {
    /// Its upper left texel.
    origin: [usize; 2],
    /// Texels in a row.
    width: usize,
    /// Its texels, row after row.
    sums: Vec<Sum>,
}

impl Patch {
    /// Nothing yet, from the texel `low` to `high` (exclusive).
    pub fn new(low: [usize; 2], high: [usize; 2]) -> Self {
        let width = high[0] - low[0];
        let texels = width * (high[1] - low[1]);
        Self { origin: low, width, sums: vec![Sum::default(); texels] }
    }

    /// Whether it has no texels.
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// Adds a sample of weight `weight` whose upper left texel is `texel`, with fractions `f`.
    #[inline]
    pub fn add_sample(&mut self, texel: [usize; 2], f: [f32; 2], weight: f32, target: Vec4) {
        let [fx, fy] = f;
        let (gx, gy) = (1.0 - fx, 1.0 - fy);
        // Upper left, upper right, lower left, lower right.
        let w = Vec4::new(gx, fx, gx, fx) * Vec4::new(gy, gy, fy, fy);
        let s = w * weight;
        let place = (texel[1] - self.origin[1]) * self.width + texel[0] - self.origin[0];
        let (upper, lower) = self.sums[place..].split_at_mut(self.width);
        let ([a, b, ..], [c, d, ..]) = (upper, lower) else {
            debug_assert!(false, "a patch has room for the four texels of each of its samples");
            return;
        };
        a.couplings += w * s.x;
        a.right += target * s.x;
        b.couplings += Vec4::new(w.y, 0.0, w.w, 0.0) * s.y;
        b.south_west += w.z * s.y;
        b.right += target * s.y;
        c.couplings += Vec4::new(w.z, w.w, 0.0, 0.0) * s.z;
        c.right += target * s.z;
        d.couplings += Vec4::new(w.w, 0.0, 0.0, 0.0) * s.w;
        d.right += target * s.w;
    }
}

/// The matrix of one level and its right-hand side.
#[derive(Clone, Debug, Default)]
pub struct NormalMatrix {
    /// Texels along a side, ≥ 2.
    pub size: usize,
    /// size² rows.
    pub rows: Vec<Row>,
    /// size² right-hand sides; a solver of several levels takes them out and gathers them.
    pub right: Vec<Vec4>,
}

/// Rows of texels that one task looks at.
const BAND: usize = 16;

impl NormalMatrix {
    /// The sum of patches, added in their order.
    pub fn sum<'a>(size: usize, patches: impl Iterator<Item = &'a Patch> + Clone + Sync) -> Self {
        let patches: Vec<&Patch> = patches.filter(|p| !p.is_empty()).collect();
        let mut rows = vec![Row::default(); size * size];
        let mut right = vec![Vec4::ZERO; size * size];
        rows.par_chunks_mut(size).zip(right.par_chunks_mut(size)).enumerate().for_each(
            |(y, (rows, right))| {
                for patch in &patches {
                    let (from, height) = (patch.origin[0], patch.sums.len() / patch.width);
                    if (patch.origin[1]..patch.origin[1] + height).contains(&y) {
                        let local = (y - patch.origin[1]) * patch.width;
                        let sums = &patch.sums[local..local + patch.width];
                        for ((row, right), sum) in rows[from..].iter_mut().zip(&mut right[from..]).zip(sums) {
                            row.add(sum);
                            *right += sum.right;
                        }
                    }
                }
            },
        );
        Self { size, rows, right }
    }

    /// The sum of all its entries.
    pub fn total(&self) -> f64 {
        let row = |r: &Row| r.centre + 2.0 * (r.east + r.south_west + r.south + r.south_east);
        self.rows.iter().map(|r| f64::from(row(r))).sum()
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

    /// `y = A x`.
    pub fn product(&self, x: &[Vec4], y: &mut [Vec4]) {
        y.par_chunks_mut(BAND * self.size).enumerate().for_each(|(band, out)| {
            for (row, out) in out.chunks_mut(self.size).enumerate() {
                self.product_row(band * BAND + row, x, out);
            }
        });
    }

    /// One row of texels. What lies before and after a row in memory is read as its neighbours,
    /// since couplings over the texture's border are zero.
    fn product_row(&self, y: usize, x: &[Vec4], out: &mut [Vec4]) {
        let size = self.size;
        if y < 2 || y + 2 >= size {
            out.iter_mut().enumerate().for_each(|(k, out)| *out = self.near_border(k, y, x));
            return;
        }
        let first = y * size;
        let beside = |first: usize| first - 1..first + size + 1;
        let (upper, own, lower) = (&x[beside(first - size)], &x[beside(first)], &x[beside(first + size)]);
        let (above, here) = (&self.rows[beside(first - size)], &self.rows[beside(first)]);
        for (k, out) in out.iter_mut().enumerate() {
            let row = &here[k + 1];
            *out = own[k] * here[k].east
                + own[k + 1] * row.centre
                + own[k + 2] * row.east
                + lower[k] * row.south_west
                + lower[k + 1] * row.south
                + lower[k + 2] * row.south_east
                + upper[k] * above[k].south_east
                + upper[k + 1] * above[k + 1].south
                + upper[k + 2] * above[k + 2].south_west;
        }
    }

    /// `y += A eᵢ v`: what texel i, in column and row `place`, adds where it is `v`.
    #[inline]
    pub fn add_column(&self, place: [usize; 2], v: Vec4, y: &mut [Vec4]) {
        let (size, rows) = (self.size, &self.rows);
        let at = place[1] * size + place[0];
        let (row, west, east) = (&rows[at], place[0] > 0, place[0] + 1 < size);
        if place[1] > 0 {
            let above = at - size;
            if west {
                y[above - 1] += v * rows[above - 1].south_east;
            }
            y[above] += v * rows[above].south;
            if east {
                y[above + 1] += v * rows[above + 1].south_west;
            }
        }
        if west {
            y[at - 1] += v * rows[at - 1].east;
        }
        y[at] += v * row.centre;
        if east {
            y[at + 1] += v * row.east;
        }
        if place[1] + 1 < size {
            let below = at + size;
            if west {
                y[below - 1] += v * row.south_west;
            }
            y[below] += v * row.south;
            if east {
                y[below + 1] += v * row.south_east;
            }
        }
    }

    /// One texel's product, wherever it lies.
    fn near_border(&self, column: usize, y: usize, x: &[Vec4]) -> Vec4 {
        let (size, rows) = (self.size, &self.rows);
        let at = y * size + column;
        let (west, east) = (column > 0, column + 1 < size);
        let mut sum = x[at] * rows[at].centre;
        if west {
            sum += x[at - 1] * rows[at - 1].east;
        }
        if east {
            sum += x[at + 1] * rows[at].east;
        }
        if y + 1 < size {
            let below = at + size;
            if west {
                sum += x[below - 1] * rows[at].south_west;
            }
            sum += x[below] * rows[at].south;
            if east {
                sum += x[below + 1] * rows[at].south_east;
            }
        }
        if y > 0 {
            let above = at - size;
            if west {
                sum += x[above - 1] * rows[above - 1].south_east;
            }
            sum += x[above] * rows[above].south;
            if east {
                sum += x[above + 1] * rows[above + 1].south_west;
            }
        }
        sum
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
        let mut patch = Patch::new([0; 2], [size; 2]);
        let mut want = 0.0;
        for k in 0..100 {
            let (i, j) = ((number(k + 50) * 4.0) as usize, (number(k + 250) * 4.0) as usize);
            let (fx, fy, w) = (number(k + 450), number(k + 650), number(k + 850));
            let place = j * size + i;
            patch.add_sample([i, j], [fx, fy], w, Vec4::ZERO);
            let row = |p: usize| x[p].x * (1.0 - fx) + x[p + 1].x * fx;
            want += w * (row(place) * (1.0 - fy) + row(place + size) * fy).powi(2);
        }
        let matrix = NormalMatrix::sum(size, std::iter::once(&patch));
        let mut y = vec![Vec4::ZERO; 25];
        matrix.product(&x, &mut y);
        let energy: f32 = x.iter().zip(&y).map(|(a, b)| a.x * b.x).sum();
        assert!((energy / want - 1.0).abs() < 1e-4);
        // Column by column it is the same.
        let mut by_columns = vec![Vec4::ZERO; 25];
        for (i, &v) in x.iter().enumerate() {
            matrix.add_column([i % size, i / size], v, &mut by_columns);
        }
        assert!(y.iter().zip(&by_columns).all(|(a, b)| (a.x - b.x).abs() < 1e-4));
    }
}
