//! Which point of the surface each texel shows: the triangles rasterised in the
//! texture instead of on the screen (Pineda, "A Parallel Algorithm for Polygon
//! Rasterization", SIGGRAPH 1988).
//!
//! A texel belongs to the triangle that its centre ((x + ½) / size, (y + ½) / size)
//! lies in. A centre on an edge goes to the triangle right of it or, for a level
//! edge, below it (the top-left rule), so that triangles which tile an area claim
//! each centre once. Coordinates outside [0, 1] repeat, texel by texel. Where
//! triangles overlap the first wins.
//!
//! Contract: coordinates are finite and v-down. Bands of rows are independent and
//! see the triangles in their order, so the result does not depend on threads.

use parbake_model::Mesh;
use parbake_model::glam::DVec2;
use rayon::prelude::*;

/// Rows per unit of parallel work.
const BAND: usize = 16;
/// How many repetitions of the texture one triangle is followed through along
/// each axis. Beyond, it only meets texels again that it has met before, unless it
/// is a sliver; the bound keeps absurd coordinates from absurd work.
const MAX_REPEATS: f64 = 32.0;

/// What each texel shows. Row 0 on top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TexelMap {
    /// Texels along each side.
    pub size: usize,
    /// size² triangle indices; `u32::MAX` where there is none.
    pub triangle: Vec<u32>,
    /// size² weights of the triangle's corners 1 and 2; corner 0 has the rest.
    /// Each is in 0 … 1, and so is the rest.
    pub barycentric: Vec<[f32; 2]>,
    /// Texel centres that more than one triangle claims.
    pub overlaps: usize,
}

/// Rasterises the texture layout of a mesh over `size` × `size` texels.
pub fn texel_map(mesh: &Mesh, size: usize) -> TexelMap {
    let mut map = TexelMap {
        size,
        triangle: vec![u32::MAX; size * size],
        barycentric: vec![[0.0; 2]; size * size],
        overlaps: 0,
    };
    if size == 0 || mesh.uvs.is_empty() {
        return map;
    }
    let bins = bins(mesh, size);
    map.overlaps = map
        .triangle
        .par_chunks_mut(BAND * size)
        .zip(map.barycentric.par_chunks_mut(BAND * size))
        .zip(&bins)
        .enumerate()
        .map(|(index, ((triangle, barycentric), bin))| {
            let count = triangle.len();
            let mut band = Band {
                first_row: index * BAND,
                size,
                triangle,
                barycentric,
                contested: vec![false; count],
                unsettled: count,
            };
            for &t in bin {
                band.fill(t, &TexelTriangle::new(mesh, t as usize, size));
                // Later triangles can change nothing: no first claim and no
                // second is left to be made.
                if band.unsettled == 0 {
                    break;
                }
            }
            band.contested.iter().filter(|&&c| c).count()
        })
        .sum();
    map
}

/// For each band the triangles that may touch it, in order.
fn bins(mesh: &Mesh, size: usize) -> Vec<Vec<u32>> {
    let count = size.div_ceil(BAND);
    let mut bins = vec![Vec::new(); count];
    for t in 0..mesh.triangles.len() {
        let Some((first, last)) = TexelTriangle::new(mesh, t, size).rows() else { continue };
        if last - first >= size as i64 {
            bins.iter_mut().for_each(|bin| bin.push(t as u32));
            continue;
        }
        let (start, end) = (first.rem_euclid(size as i64), last.rem_euclid(size as i64));
        let (start, end) = (start as usize / BAND, end as usize / BAND);
        let wraps = first.div_euclid(size as i64) != last.div_euclid(size as i64);
        for (band, bin) in bins.iter_mut().enumerate() {
            let inside = if wraps { band >= start || band <= end } else { band >= start && band <= end };
            if inside {
                bin.push(t as u32);
            }
        }
    }
    bins
}

/// A triangle in texels, turned so that its area is positive.
struct TexelTriangle {
    corners: [DVec2; 3],
    /// Whether corners 1 and 2 changed places.
    mirrored: bool,
}

impl TexelTriangle {
    fn new(mesh: &Mesh, triangle: usize, size: usize) -> Self {
        let [a, b, c] = mesh.corner_uvs(triangle).map(|uv| uv.as_dvec2() * size as f64);
        let mirrored = (b - a).perp_dot(c - a) < 0.0;
        Self { corners: if mirrored { [a, c, b] } else { [a, b, c] }, mirrored }
    }

    /// First and last row that a centre inside may lie in.
    fn rows(&self) -> Option<(i64, i64)> {
        let low = self.corners.iter().fold(f64::INFINITY, |m, c| m.min(c.y));
        let high = self.corners.iter().fold(f64::NEG_INFINITY, |m, c| m.max(c.y));
        centres(low, high)
    }

    /// First and last column on the line `y` that a centre inside may lie in,
    /// perhaps one too far at either end.
    fn columns(&self, y: f64) -> Option<(i64, i64)> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for k in 0..3 {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            if (a.y <= y) != (b.y <= y) || a.y == y {
                let t = if a.y == y { 0.0 } else { (y - a.y) / (b.y - a.y) };
                let x = a.x + t * (b.x - a.x);
                low = low.min(x);
                high = high.max(x);
            }
        }
        if low > high {
            return None;
        }
        Some((centres(low, high).map_or(low.floor() as i64, |c| c.0) - 1, high.floor() as i64 + 1))
    }

    /// The edges' functions at a point if it belongs to the triangle.
    fn weights(&self, p: DVec2) -> Option<[f64; 3]> {
        let mut weights = [0.0; 3];
        for (k, weight) in weights.iter_mut().enumerate() {
            let (a, b) = (self.corners[(k + 1) % 3], self.corners[(k + 2) % 3]);
            // Two triangles at an edge must compute the very same number: always
            // from the same end.
            let swapped = (b.x, b.y) < (a.x, a.y);
            let (from, to) = if swapped { (b, a) } else { (a, b) };
            let function = (to - from).perp_dot(p - from);
            *weight = if swapped { -function } else { function };
            // With v down and positive area the inside is on the right of a → b
            // as drawn: a left edge goes up, a top edge goes right.
            let top_left = b.y < a.y || (b.y == a.y && b.x > a.x);
            if *weight < 0.0 || (*weight == 0.0 && !top_left) {
                return None;
            }
        }
        Some(weights)
    }
}

/// Indices of the centres i + ½ in low … high, bounded in number.
fn centres(low: f64, high: f64) -> Option<(i64, i64)> {
    let (first, last) = ((low - 0.5).ceil(), (high - 0.5).floor());
    // The casts saturate; 2⁵² texels are beyond f32's resolution anyway.
    let limit = (1u64 << 52) as f64;
    (first <= last).then(|| (first.clamp(-limit, limit) as i64, last.clamp(-limit, limit) as i64))
}

/// Some rows of the map.
struct Band<'a> {
    first_row: usize,
    size: usize,
    triangle: &'a mut [u32],
    barycentric: &'a mut [[f32; 2]],
    /// Texels that a second triangle claimed.
    contested: Vec<bool>,
    /// Texels that are not contested.
    unsettled: usize,
}

impl Band<'_> {
    fn fill(&mut self, index: u32, triangle: &TexelTriangle) {
        let Some((first, last)) = triangle.rows() else { return };
        let size = self.size as i64;
        let longest = (MAX_REPEATS * self.size as f64) as i64;
        let last = last.min(first.saturating_add(longest));
        let band_rows = (self.triangle.len() / self.size) as i64;
        // Every repetition of the band's rows within the triangle's.
        let mut repeat = (first - self.first_row as i64).div_euclid(size) * size;
        while repeat + self.first_row as i64 <= last {
            let start = repeat + self.first_row as i64;
            for y in start.max(first)..=(start + band_rows - 1).min(last) {
                let Some((left, right)) = triangle.columns(y as f64 + 0.5) else { continue };
                for x in left..=right.min(left.saturating_add(longest)) {
                    if let Some(weights) = triangle.weights(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)) {
                        let texel = (y - start) * size + x.rem_euclid(size);
                        self.claim(texel as usize, index, triangle.mirrored, weights);
                    }
                }
            }
            repeat += size;
        }
    }

    fn claim(&mut self, texel: usize, index: u32, mirrored: bool, weights: [f64; 3]) {
        if self.triangle[texel] != u32::MAX {
            // A triangle may meet itself after wrapping round: not a conflict.
            if self.triangle[texel] != index && !self.contested[texel] {
                self.contested[texel] = true;
                self.unsettled -= 1;
            }
            return;
        }
        self.triangle[texel] = index;
        let sum = weights[0] + weights[1] + weights[2];
        let (one, two) = if mirrored { (weights[2], weights[1]) } else { (weights[1], weights[2]) };
        // The sum can overflow, for absurd coordinates only.
        let share = |w: f64| if sum.is_finite() { ((w / sum) as f32).clamp(0.0, 1.0) } else { 0.0 };
        let (one, two) = (share(one), share(two));
        self.barycentric[texel] = [one, two.min(1.0 - one)];
    }
}

#[cfg(test)]
#[path = "texel_map_tests.rs"]
mod tests;
