//! The best texture for given texture coordinates: a linear least-squares problem.
//!
//! With a sample's place in the texture known, its colour is `Σ wᵢ Tᵢ` over four texels.
//! Forward: [`best_texture`] minimises `Σₛ ωₛ |Σ wᵢ Tᵢ − yₛ|² + ε Σ |Tᵢ − Tⱼ|²`, the
//! second sum over neighbouring texels, which settles texels that no sample reaches. The
//! normal matrix has nine points a texel and is shared by all channels.
//!
//! Adjoint: at the minimum the derivative of the error for a texture coordinate is the
//! explicit one alone, `2 ωₛ (Σ wᵢ Tᵢ − yₛ) · ∂(Σ wᵢ Tᵢ)/∂uv` (variable projection, Golub
//! and Pereyra 1973); [`error_and_gradient`] sums it up for the points.
//!
//! Textures are clamped at their borders here. All sums are made in an order that does
//! not depend on the number of threads.

use crate::runs::Runs;
use crate::signal::{Sample, Signal};
use glam::{DVec2, Vec2, Vec4};
use rayon::prelude::*;

/// A square texture of four channels, row 0 at v = 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Texture {
    /// Texels along a side, ≥ 2.
    pub size: usize,
    /// size² texels.
    pub texels: Vec<Vec4>,
}

impl Texture {
    /// One value everywhere.
    pub fn solid(size: usize, value: Vec4) -> Self {
        Self { size, texels: vec![value; size * size] }
    }
}

/// A texel's row of the normal matrix: with itself and the neighbours that come later.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    centre: f32,
    east: f32,
    south_west: f32,
    south: f32,
    south_east: f32,
    right: Vec4,
}

/// Where a triangle's samples fall: texel coordinates of its first point, and what the
/// barycentrics add.
#[derive(Clone, Copy)]
struct Footprint {
    origin: Vec2,
    second: Vec2,
    third: Vec2,
}

impl Footprint {
    fn new(points: &[DVec2], corners: [u32; 3], size: usize) -> Self {
        let [a, b, c] = corners.map(|i| points[i as usize] * size as f64);
        Self { origin: (a - 0.5).as_vec2(), second: (b - a).as_vec2(), third: (c - a).as_vec2() }
    }

    /// Upper left texel and fractions of a sample; the third value is 0 along an axis on
    /// which the texture is clamped.
    #[inline]
    fn place(&self, sample: &Sample, size: usize) -> ([usize; 2], [f32; 2], [f32; 2]) {
        let [b, c] = sample.barycentric;
        let p = self.origin + self.second * b + self.third * c;
        let last = (size - 1) as f32;
        let axis = |p: f32| {
            let inside = p.clamp(0.0, last);
            let texel = (inside as usize).min(size - 2);
            (texel, inside - texel as f32, if p == inside { 1.0 } else { 0.0 })
        };
        let ((x, fx, dx), (y, fy, dy)) = (axis(p.x), axis(p.y));
        ([x, y], [fx, fy], [dx, dy])
    }

    /// The texels that samples of this triangle may touch: from, to (exclusive).
    fn bounds(&self, size: usize) -> [[usize; 2]; 2] {
        let (a, b, c) = (self.origin, self.origin + self.second, self.origin + self.third);
        let (low, high) = (a.min(b).min(c) - 0.01, a.max(b).max(c) + 0.01);
        let from = |x: f32| (x.max(0.0) as usize).min(size - 2);
        let to = |x: f32| ((x.max(0.0) as usize) + 2).min(size);
        [[from(low.x), from(low.y)], [to(high.x), to(high.y)]]
    }
}

/// A run's part of the matrix: a rectangle of rows.
struct Patch {
    origin: [usize; 2],
    width: usize,
    rows: Vec<Row>,
}

/// Texture coordinates and the signal that they carry.
#[derive(Clone, Copy)]
pub struct Mapped<'a> {
    /// P points.
    pub points: &'a [DVec2],
    /// F triangles.
    pub triangles: &'a [[u32; 3]],
    /// Their samples.
    pub signal: &'a Signal,
    /// The same triangles, shared out.
    pub runs: &'a Runs,
}

/// How exactly a texture is solved for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solve {
    /// Stops once the residual's norm has fallen by this factor…
    pub tolerance: f64,
    /// …or after so many steps of conjugate gradients.
    pub steps: usize,
    /// Weight ε of the differences of neighbours, relative to the mean weight that a
    /// texel has of samples.
    pub smoothness: f32,
}

impl Default for Solve {
    fn default() -> Self {
        Self { tolerance: 1e-4, steps: 40, smoothness: 1e-5 }
    }
}

/// The best texture; begins at `start`.
pub fn best_texture(mapped: &Mapped, start: Texture, solve: &Solve) -> Texture {
    let system = System::assemble(mapped, start.size, solve.smoothness);
    system.solve(start, solve, None)
}

/// The best texture whose values lie in [0, 1]; begins at `start`.
///
/// Texels that leave the box are held at its border and the rest is solved again
/// (active set), until nothing changes.
pub fn best_texture_in_box(mapped: &Mapped, start: Texture, solve: &Solve) -> Texture {
    const PASSES: usize = 6;
    let system = System::assemble(mapped, start.size, solve.smoothness);
    let mut texture = system.solve(start, solve, None);
    for _ in 0..PASSES {
        let outside = |v: f32| !(0.0..=1.0).contains(&v);
        if !texture.texels.par_iter().any(|t| t.to_array().into_iter().any(outside)) {
            break;
        }
        for texel in &mut texture.texels {
            *texel = texel.clamp(Vec4::ZERO, Vec4::ONE);
        }
        // A lane at the border stays there while the error wants it further out.
        let slope = system.residual(&texture.texels);
        let free: Vec<Vec4> = texture
            .texels
            .par_iter()
            .zip(&slope)
            .map(|(t, r)| {
                let (t, r) = (t.to_array(), r.to_array());
                Vec4::from_array(std::array::from_fn(|k| {
                    let held = (t[k] <= 0.0 && r[k] <= 0.0) || (t[k] >= 1.0 && r[k] >= 0.0);
                    if held { 0.0 } else { 1.0 }
                }))
            })
            .collect();
        texture = system.solve(texture, solve, Some(&free));
    }
    for texel in &mut texture.texels {
        *texel = texel.clamp(Vec4::ZERO, Vec4::ONE);
    }
    texture
}

/// The normal equations.
struct System {
    size: usize,
    rows: Vec<Row>,
}

impl System {
    fn assemble(mapped: &Mapped, size: usize, smoothness: f32) -> Self {
        let patches: Vec<Patch> =
            (0..mapped.runs.count()).into_par_iter().map(|run| assemble_run(mapped, run, size)).collect();
        let mut rows = vec![Row::default(); size * size];
        // By rows of the texture, so that patches are added in the same order everywhere.
        rows.par_chunks_mut(size).enumerate().for_each(|(y, out)| {
            for patch in &patches {
                let height = patch.rows.len() / patch.width.max(1);
                if (patch.origin[1]..patch.origin[1] + height).contains(&y) {
                    let local = &patch.rows[(y - patch.origin[1]) * patch.width..][..patch.width];
                    for (out, add) in out[patch.origin[0]..].iter_mut().zip(local) {
                        out.centre += add.centre;
                        out.east += add.east;
                        out.south_west += add.south_west;
                        out.south += add.south;
                        out.south_east += add.south_east;
                        out.right += add.right;
                    }
                }
            }
        });
        let mean = mapped.signal.weight() as f32 / (size * size) as f32;
        let epsilon = (smoothness * mean).max(1e-20);
        rows.par_chunks_mut(size).enumerate().for_each(|(y, out)| {
            for (x, row) in out.iter_mut().enumerate() {
                let (east, south) = (x + 1 < size, y + 1 < size);
                row.centre += epsilon * (count(east) + count(south) + count(x > 0) + count(y > 0));
                row.east -= epsilon * count(east);
                row.south -= epsilon * count(south);
            }
        });
        Self { size, rows }
    }

    /// `b − A x`.
    fn residual(&self, x: &[Vec4]) -> Vec<Vec4> {
        let mut r = vec![Vec4::ZERO; x.len()];
        self.product(x, &mut r);
        r.par_iter_mut().zip(&self.rows).for_each(|(r, row)| *r = row.right - *r);
        r
    }

    /// `y = A x`; returns `xᵀ y` for each channel.
    fn product(&self, x: &[Vec4], y: &mut [Vec4]) -> Vec4 {
        let size = self.size;
        let dots: Vec<Vec4> = y
            .par_chunks_mut(size)
            .enumerate()
            .map(|(row, out)| {
                self.row_product(row, x, out);
                out.iter().zip(&x[row * size..]).map(|(a, b)| *a * *b).sum()
            })
            .collect();
        sum(&dots)
    }

    fn row_product(&self, y: usize, x: &[Vec4], out: &mut [Vec4]) {
        let size = self.size;
        let here = y * size;
        let own = &self.rows[here..here + size];
        let x1 = &x[here..here + size];
        for (i, out) in out.iter_mut().enumerate() {
            *out = x1[i] * own[i].centre;
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

    /// Conjugate gradients with the diagonal as preconditioner, each channel with its own
    /// step lengths (Hestenes and Stiefel 1952). `free` holds 0 in lanes that must stay.
    fn solve(&self, mut texture: Texture, solve: &Solve, free: Option<&[Vec4]>) -> Texture {
        let size = self.size;
        let x = &mut texture.texels;
        let inverse: Vec<f32> = self.rows.par_iter().map(|r| 1.0 / r.centre.max(1e-30)).collect();
        let mask = |i: usize| free.map_or(Vec4::ONE, |f| f[i]);
        let mut r = self.residual(x);
        r.par_iter_mut().enumerate().for_each(|(i, r)| *r *= mask(i));
        let mut p: Vec<Vec4> = r.par_iter().zip(&inverse).map(|(r, m)| *r * *m).collect();
        let mut q = vec![Vec4::ZERO; x.len()];
        let dots: Vec<Vec4> =
            r.par_chunks(size).zip(p.par_chunks(size)).map(|(r, p)| r.iter().zip(p).map(|(a, b)| *a * *b).sum()).collect();
        let mut rho = sum(&dots);
        // Measured against the right-hand side, not the start: a good start needs fewer steps.
        let dots: Vec<Vec4> = (self.rows.par_chunks(size).zip(inverse.par_chunks(size)))
            .map(|(rows, m)| rows.iter().zip(m).map(|(r, m)| r.right * r.right * *m).sum())
            .collect();
        let enough = sum(&dots) * (solve.tolerance * solve.tolerance) as f32;
        for _ in 0..solve.steps {
            if rho.cmple(enough).all() {
                break;
            }
            let curvature = self.product(&p, &mut q);
            let alpha = ratio(rho, curvature);
            let dots: Vec<Vec4> = (x.par_chunks_mut(size).zip(r.par_chunks_mut(size)))
                .enumerate()
                .map(|(row, (x, r))| {
                    let mut sum = Vec4::ZERO;
                    for (k, i) in (row * size..(row + 1) * size).enumerate() {
                        x[k] += p[i] * alpha;
                        r[k] -= q[i] * mask(i) * alpha;
                        sum += r[k] * r[k] * inverse[i];
                    }
                    sum
                })
                .collect();
            let next = sum(&dots);
            let beta = ratio(next, rho);
            p.par_iter_mut().zip(&r).zip(&inverse).for_each(|((p, r), m)| *p = *r * *m + *p * beta);
            rho = next;
        }
        texture
    }
}

fn count(yes: bool) -> f32 {
    if yes { 1.0 } else { 0.0 }
}

fn ratio(a: Vec4, b: Vec4) -> Vec4 {
    Vec4::select(b.cmpgt(Vec4::splat(1e-30)), a / b.max(Vec4::splat(1e-30)), Vec4::ZERO)
}

fn sum(rows: &[Vec4]) -> Vec4 {
    rows.iter().map(|v| v.as_dvec4()).sum::<glam::DVec4>().as_vec4()
}

fn assemble_run(mapped: &Mapped, run: usize, size: usize) -> Patch {
    let footprints: Vec<(usize, Footprint)> = mapped
        .runs
        .triangles(run)
        .map(|t| (t, Footprint::new(mapped.points, mapped.triangles[t], size)))
        .collect();
    let (mut low, mut high) = ([size; 2], [0; 2]);
    for (_, footprint) in &footprints {
        let [from, to] = footprint.bounds(size);
        for k in 0..2 {
            low[k] = low[k].min(from[k]);
            high[k] = high[k].max(to[k]);
        }
    }
    if footprints.is_empty() {
        return Patch { origin: [0; 2], width: 0, rows: Vec::new() };
    }
    let width = high[0] - low[0];
    let mut rows = vec![Row::default(); width * (high[1] - low[1])];
    for (t, footprint) in &footprints {
        for sample in mapped.signal.of(*t) {
            let ([x, y], [fx, fy], _) = footprint.place(sample, size);
            let (gx, gy) = (1.0 - fx, 1.0 - fy);
            let w = [gx * gy, fx * gy, gx * fy, fx * fy];
            let s = w.map(|w| w * sample.weight);
            let a = (y - low[1]) * width + x - low[0];
            let (upper, lower) = rows[a..].split_at_mut(width);
            upper[0].centre += s[0] * w[0];
            upper[0].east += s[0] * w[1];
            upper[0].south += s[0] * w[2];
            upper[0].south_east += s[0] * w[3];
            upper[0].right += sample.target * s[0];
            upper[1].centre += s[1] * w[1];
            upper[1].south_west += s[1] * w[2];
            upper[1].south += s[1] * w[3];
            upper[1].right += sample.target * s[1];
            lower[0].centre += s[2] * w[2];
            lower[0].east += s[2] * w[3];
            lower[0].right += sample.target * s[2];
            lower[1].centre += s[3] * w[3];
            lower[1].right += sample.target * s[3];
        }
    }
    Patch { origin: low, width, rows }
}

/// What is left with a texture, `Σₛ ωₛ |Σ wᵢ Tᵢ − yₛ|²`; adds its derivative for the
/// points, with the texture held, to `gradient`. `per_triangle`, if wanted, receives the
/// F triangles' shares.
pub fn error_and_gradient(
    mapped: &Mapped,
    texture: &Texture,
    gradient: &mut [DVec2],
    mut per_triangle: Option<&mut [f64]>,
) -> f64 {
    let parts: Vec<Vec<(usize, f64, [DVec2; 3])>> = (0..mapped.runs.count())
        .into_par_iter()
        .map(|run| {
            mapped.runs.triangles(run).map(|t| triangle_error(mapped, texture, t)).collect()
        })
        .collect();
    let mut error = 0.0;
    for (t, part, slopes) in parts.into_iter().flatten() {
        error += part;
        if let Some(shares) = per_triangle.as_deref_mut() {
            shares[t] = part;
        }
        for (corner, slope) in mapped.triangles[t].into_iter().zip(slopes) {
            gradient[corner as usize] += slope;
        }
    }
    error
}

fn triangle_error(mapped: &Mapped, texture: &Texture, t: usize) -> (usize, f64, [DVec2; 3]) {
    let size = texture.size;
    let footprint = Footprint::new(mapped.points, mapped.triangles[t], size);
    let (mut error, mut whole, mut second, mut third) = (0.0f64, Vec2::ZERO, Vec2::ZERO, Vec2::ZERO);
    for sample in mapped.signal.of(t) {
        let ([x, y], [fx, fy], [dx, dy]) = footprint.place(sample, size);
        let place = y * size + x;
        let (a, b) = (texture.texels[place], texture.texels[place + 1]);
        let (c, d) = (texture.texels[place + size], texture.texels[place + size + 1]);
        let (upper, lower) = (a + (b - a) * fx, c + (d - c) * fx);
        let residual = upper + (lower - upper) * fy - sample.target;
        let weighted = residual * sample.weight;
        error += f64::from(weighted.dot(residual));
        let along_x = (b - a) + ((d - c) - (b - a)) * fy;
        let slope = Vec2::new(weighted.dot(along_x) * dx, weighted.dot(lower - upper) * dy);
        whole += slope;
        second += slope * sample.barycentric[0];
        third += slope * sample.barycentric[1];
    }
    let scale = 2.0 * size as f64;
    let (whole, second, third) = (whole.as_dvec2(), second.as_dvec2(), third.as_dvec2());
    (t, error, [(whole - second - third) * scale, second * scale, third * scale])
}
