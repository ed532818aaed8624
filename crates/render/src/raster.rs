//! Rasterisation: which triangle is seen at each sample.
//!
//! Homogeneous (2D) rasterisation after Olano and Greer 1997: with the columns of
//! M the three vertices (X, Y, W), `s = M⁻¹ (x, y, 1)ᵀ` holds the barycentrics
//! divided by depth. A sample is inside where all three are ≥ 0, so triangles
//! that cross the camera's plane need no clipping; `Σ s = 1/W` orders by nearness.
//! There is no gradient here: visibility is piecewise constant. What moves with
//! the vertices is in `interpolate.rs` (inside) and `antialias.rs` (silhouettes).
//!
//! Contract: two-sided, nothing is culled; samples lie at pixel + 0.5 + offset;
//! on equal depth the first triangle wins, so the result is deterministic.

use crate::camera::{Camera, Projection, ScreenPoint};
use glam::{DVec3, Vec3};

/// No triangle is seen here.
pub const NOTHING: u32 = u32::MAX;

/// A triangle on the screen: the three planes of s = M⁻¹ (x, y, 1)ᵀ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScreenTriangle {
    /// Rows of M⁻¹: coefficients of x, y and 1 for each corner.
    pub planes: [DVec3; 3],
    /// Coefficients of the quantity that is larger where the surface is nearer.
    pub nearness: DVec3,
    /// Pixel bounds (x0, y0, x1, y1); x1 < x0 when the triangle cannot be seen.
    bounds: [f32; 4],
}

/// All triangles of a mesh, on the screen of one camera.
#[derive(Clone, Debug, Default)]
pub struct ScreenTriangles {
    /// In the mesh's order.
    pub triangles: Vec<ScreenTriangle>,
}

/// What each sample of a square image sees.
#[derive(Clone, Debug, Default)]
pub struct Visibility {
    /// Samples along a side.
    pub size: usize,
    /// size² triangle indices, [`NOTHING`] where nothing is seen.
    pub triangle: Vec<u32>,
    pub(crate) nearness: Vec<f32>,
}

/// Points nearer to the camera's plane than this are behind it.
pub(crate) const NEAR: f64 = 1e-4;

impl ScreenTriangles {
    /// Projects every vertex once and sets up every triangle.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]], camera: &Camera, size: usize) -> Self {
        let points: Vec<_> = positions.iter().map(|&p| camera.project(p, size)).collect();
        let triangles = triangles
            .iter()
            .map(|corners| {
                set_up(corners.map(|i| points[i as usize]), camera, size, None)
                    .unwrap_or(ScreenTriangle::HIDDEN)
            })
            .collect();
        Self { triangles }
    }
}

/// A triangle with these corners, as [`ScreenTriangles`] has it; none where it cannot be seen, or is
/// known to cover none of the samples at `offset`.
#[inline]
pub(crate) fn triangle_on_screen(
    corners: &[Vec3; 3],
    camera: &Camera,
    size: usize,
    offset: Option<(f32, f32)>,
) -> Option<ScreenTriangle> {
    set_up(corners.map(|p| camera.project(p, size)), camera, size, offset)
}

#[inline(always)]
fn set_up(
    p: [ScreenPoint; 3],
    camera: &Camera,
    size: usize,
    offset: Option<(f32, f32)>,
) -> Option<ScreenTriangle> {
    let v = p.map(|q| q.homogeneous);
    if p.iter().all(|q| q.depth < NEAR) {
        return None;
    }
    let bounds = if p.iter().any(|q| q.depth < NEAR) {
        [0.0, 0.0, size as f32, size as f32]
    } else {
        let xs = v.map(|q| (q.x / q.z) as f32);
        let ys = v.map(|q| (q.y / q.z) as f32);
        [
            xs[0].min(xs[1]).min(xs[2]),
            ys[0].min(ys[1]).min(ys[2]),
            xs[0].max(xs[1]).max(xs[2]),
            ys[0].max(ys[1]).max(ys[2]),
        ]
    };
    if let Some(offset) = offset {
        samples_within(bounds, size, offset)?;
    }
    let cofactors = [v[1].cross(v[2]), v[2].cross(v[0]), v[0].cross(v[1])];
    let determinant = v[0].dot(cofactors[0]);
    // A triangle seen exactly edge-on covers nothing.
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let planes = cofactors.map(|c| c / determinant);
    let nearness = if matches!(camera.projection, Projection::Orthographic(_)) {
        -(planes[0] * p[0].depth + planes[1] * p[1].depth + planes[2] * p[2].depth)
    } else {
        planes[0] + planes[1] + planes[2]
    };
    Some(ScreenTriangle { planes, nearness, bounds })
}

/// First and last column, first and last row of the samples within bounds; none where there are none.
#[inline(always)]
fn samples_within(bounds: [f32; 4], size: usize, offset: (f32, f32)) -> Option<[f32; 4]> {
    let [x0, y0, x1, y1] = bounds;
    let (cx, cy) = (0.5 + offset.0, 0.5 + offset.1);
    let last = size as f32 - 1.0;
    let (column0, column1) = ((x0 - cx).ceil().max(0.0), (x1 - cx).floor().min(last));
    let (row0, row1) = ((y0 - cy).ceil().max(0.0), (y1 - cy).floor().min(last));
    (column0 <= column1 && row0 <= row1).then_some([column0, column1, row0, row1])
}

impl ScreenTriangle {
    /// One that covers nothing.
    pub(crate) const HIDDEN: Self =
        Self { planes: [DVec3::ZERO; 3], nearness: DVec3::ZERO, bounds: [0.0, 0.0, -1.0, -1.0] };

    /// The rows, of `size`, on which its samples may lie.
    pub(crate) fn rows(&self, size: usize) -> std::ops::Range<usize> {
        let [x0, y0, x1, y1] = self.bounds;
        let first = (y0 - 0.5).ceil().max(0.0) as usize;
        let end = ((y1 - 0.5).floor() + 1.0).clamp(0.0, size as f32) as usize;
        if x1 < x0 { 0..0 } else { first..end.max(first) }
    }

    /// The samples of a row that lie on the triangle, of `size` along a side, with their nearness. A sample on an
    /// edge belongs to one of the two triangles beside it.
    pub(crate) fn on_row(&self, row: usize, size: usize) -> impl Iterator<Item = (usize, f64)> {
        let [x0, y0, x1, y1] = self.bounds;
        let y = row as f64 + 0.5;
        let is_beside = x1 < x0 || y < f64::from(y0) || y > f64::from(y1);
        let first = (x0 - 0.5).ceil().max(0.0) as usize;
        let end = if is_beside { first } else { ((x1 - 0.5).floor() + 1.0).clamp(0.0, size as f32) as usize };
        let is_inside = move |s: f64, plane: &DVec3| {
            s > 0.0 || s == 0.0 && (plane.x > 0.0 || plane.x == 0.0 && plane.y > 0.0)
        };
        (first..end).filter_map(move |column| {
            let x = column as f64 + 0.5;
            let s = self.at(x, y);
            let inside = s.iter().zip(&self.planes).all(|(s, plane)| is_inside(*s, plane));
            inside.then(|| (column, self.nearness_at(x, y)))
        })
    }

    /// What is larger where the surface is nearer.
    pub(crate) fn nearness_at(&self, x: f64, y: f64) -> f64 {
        self.nearness.x * x + self.nearness.y * y + self.nearness.z
    }

    /// s at this point of the screen: barycentrics divided by depth.
    #[inline(always)]
    pub fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let [a, b, c] = &self.planes;
        let along = |plane: &DVec3| plane.x * x + plane.y * y + plane.z;
        [along(a), along(b), along(c)]
    }
}

/// Finds the nearest triangle at each sample `(column + 0.5 + offset.0, row + 0.5
/// + offset.1)`; `seen` is reused between calls.
pub fn rasterise(screen: &ScreenTriangles, size: usize, offset: (f32, f32), seen: &mut Visibility) {
    fill(screen, size, offset, seen, |_, _| true);
}

/// The nearest triangle of a mesh at the middle of each of size² pixels. Of the triangles on the screen one at a time is kept, so that
/// it takes little memory whatever their number.
pub fn rasterised(positions: &[Vec3], triangles: &[[u32; 3]], camera: &Camera, size: usize) -> Visibility {
    let mut seen = Visibility::empty(size);
    for (index, corners) in (0..).zip(triangles) {
        let corners = corners.map(|vertex| positions[vertex as usize]);
        if let Some(triangle) = triangle_on_screen(&corners, camera, size, Some((0.0, 0.0))) {
            draw::<false>(&triangle, index, size, (0.0, 0.0), &mut seen, |_, _| true);
        }
    }
    seen
}

/// The same as [`rasterise`] of some triangles.
pub(crate) fn rasterise_some(
    screen: &ScreenTriangles,
    size: usize,
    is_meant: impl Fn(u32) -> bool,
    seen: &mut Visibility,
) {
    seen.clear(size);
    for (index, triangle) in (0..).zip(&screen.triangles).filter(|(index, _)| is_meant(*index)) {
        draw::<false>(triangle, index, size, (0.0, 0.0), seen, |_, _| true);
    }
}

/// Finds the nearest triangle at each sample among those that lie behind what `front` sees
/// there: depth peeling (Everitt 2001).
pub fn rasterise_behind(
    screen: &ScreenTriangles,
    size: usize,
    offset: (f32, f32),
    front: &Visibility,
    seen: &mut Visibility,
) {
    // The same sums in the same order: a triangle is never behind itself.
    fill(screen, size, offset, seen, |sample, nearness| nearness < front.nearness[sample]);
}

/// The same at offset 0 for the samples that are wanted, of size² ones. What is seen elsewhere has no meaning; triangles
/// that may reach no wanted sample are passed over.
pub fn rasterise_behind_some(
    screen: &ScreenTriangles,
    size: usize,
    front: &Visibility,
    wanted: &[bool],
    seen: &mut Visibility,
) {
    // How many are wanted above and to the left of each corner of a sample (Crow 1984).
    let side = size + 1;
    let mut above = vec![0u32; side * side];
    for (row, wanted) in wanted.chunks(size.max(1)).enumerate() {
        let mut before = 0;
        for (column, &wanted) in wanted.iter().enumerate() {
            before += u32::from(wanted);
            above[(row + 1) * side + column + 1] = above[row * side + column + 1] + before;
        }
    }
    seen.clear(size);
    for (index, triangle) in screen.triangles.iter().enumerate() {
        let Some(bounds) = samples_within(triangle.bounds, size, (0.0, 0.0)) else { continue };
        let [left, right, top, bottom] = bounds.map(|bound| bound as usize);
        let at = |row: usize, column: usize| above[row * side + column];
        if at(bottom + 1, right + 1) + at(top, left) > at(top, right + 1) + at(bottom + 1, left) {
            let passes = |sample: usize, nearness| nearness < front.nearness[sample];
            draw::<false>(triangle, index as u32, size, (0.0, 0.0), seen, passes);
        }
    }
}

impl Visibility {
    /// `size`² samples at which nothing is seen.
    pub fn empty(size: usize) -> Self {
        let mut seen = Self::default();
        seen.clear(size);
        seen
    }

    /// Forgets all, and makes room for `size`² samples.
    pub(crate) fn clear(&mut self, size: usize) {
        self.size = size;
        self.triangle.clear();
        self.triangle.resize(size * size, NOTHING);
        self.nearness.clear();
        self.nearness.resize(size * size, f32::NEG_INFINITY);
    }

    /// Puts what another sees at a sample into the place of what is seen there; nothing,
    /// without another.
    pub fn replace(&mut self, sample: usize, other: Option<&Self>) {
        self.triangle[sample] = other.map_or(NOTHING, |o| o.triangle[sample]);
        self.nearness[sample] = other.map_or(f32::NEG_INFINITY, |o| o.nearness[sample]);
    }
}

#[inline(always)]
fn fill(
    screen: &ScreenTriangles,
    size: usize,
    offset: (f32, f32),
    seen: &mut Visibility,
    passes: impl Fn(usize, f32) -> bool,
) {
    seen.clear(size);
    for (index, triangle) in screen.triangles.iter().enumerate() {
        draw::<false>(triangle, index as u32, size, offset, seen, &passes);
    }
}

/// Draws one triangle. Triangles come in the order of their indices, or, if `ANY_ORDER`, in any.
#[inline(always)]
pub(crate) fn draw<const ANY_ORDER: bool>(
    triangle: &ScreenTriangle,
    index: u32,
    size: usize,
    offset: (f32, f32),
    seen: &mut Visibility,
    passes: impl Fn(usize, f32) -> bool,
) {
    let Some([column0, column1, row0, row1]) = samples_within(triangle.bounds, size, offset) else {
        return;
    };
    let (cx, cy) = (0.5 + offset.0, 0.5 + offset.1);
    let inverse_slope = triangle.planes.map(|p| 1.0 / p.x);
    for row in row0 as usize..=row1 as usize {
        let y = row as f64 + f64::from(cy);
        let (mut first, mut end) = (f64::from(column0), f64::from(column1));
        for (plane, inverse) in triangle.planes.iter().zip(inverse_slope) {
            // The sign of x where this plane crosses zero bounds the span.
            let rest = plane.y * y + plane.z;
            if plane.x > 0.0 {
                first = first.max((-rest * inverse - f64::from(cx)).ceil());
            } else if plane.x < 0.0 {
                end = end.min((-rest * inverse - f64::from(cx)).floor());
            } else if rest < 0.0 {
                end = -1.0;
            }
        }
        if first > end {
            continue;
        }
        let (first, end) = (first as usize, end as usize);
        let n = triangle.nearness;
        let start = (n.x * (first as f64 + f64::from(cx)) + n.y * y + n.z) as f32;
        let step = n.x as f32;
        let range = row * size + first..row * size + end + 1;
        let begin = range.start;
        let nearness = &mut seen.nearness[range.clone()];
        let seen = &mut seen.triangle[range];
        for (i, (z, t)) in nearness.iter_mut().zip(seen).enumerate() {
            let here = start + step * i as f32;
            let is_nearer = here > *z || (ANY_ORDER && here == *z && index < *t && *t != NOTHING);
            if is_nearer && passes(begin + i, here) {
                *z = here;
                *t = index;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::towards_origin(Vec3::Z, 3.5, Projection::Perspective(0.4))
    }

    fn see(positions: &[Vec3], triangles: &[[u32; 3]], camera: &Camera, size: usize) -> Visibility {
        let mut seen = Visibility::default();
        let screen = ScreenTriangles::new(positions, triangles, camera, size);
        rasterise(&screen, size, (0.0, 0.0), &mut seen);
        seen
    }

    /// Protects against cracks and double cover between neighbours: a square of
    /// two triangles covers exactly its pixels.
    #[test]
    fn two_triangles_tile_a_square() {
        let p = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| Vec3::new(x, y, 0.0));
        for projection in [Projection::Orthographic(1.0), Projection::Perspective(1.0 / 3.5)] {
            let camera = Camera::towards_origin(Vec3::Z, 3.5, projection);
            let seen = see(&p, &[[0, 1, 2], [0, 2, 3]], &camera, 64);
            assert_eq!(seen.triangle.iter().filter(|&&t| t != NOTHING).count(), 32 * 32);
        }
    }

    /// Protects the depth order, from both sides: nothing is culled.
    #[test]
    fn the_nearer_triangle_wins_from_both_sides() {
        let quad = |z: f32| [(-9.0, -9.0), (9.0, -9.0), (0.0, 9.0)].map(|(x, y)| Vec3::new(x, y, z));
        let p: Vec<_> = quad(-0.5).into_iter().chain(quad(0.5)).collect();
        let front = see(&p, &[[0, 1, 2], [3, 4, 5]], &camera(), 8);
        assert!(front.triangle.iter().all(|&t| t == 1));
        let behind = Camera::towards_origin(-Vec3::Z, 3.5, Projection::Perspective(0.4));
        assert!(see(&p, &[[0, 1, 2], [3, 4, 5]], &behind, 8).triangle.iter().all(|&t| t == 0));
    }

    /// Protects triangles that reach behind the camera, which would wrap around
    /// with a plain division by depth.
    #[test]
    fn a_triangle_through_the_camera_plane_is_cut_there() {
        let p = [Vec3::new(-50.0, -1.0, -10.0), Vec3::new(50.0, -1.0, -10.0), Vec3::new(0.0, -1.0, 20.0)];
        let seen = see(&p, &[[0, 1, 2]], &camera(), 32);
        assert!(seen.triangle[..16 * 32].iter().all(|&t| t == NOTHING), "nothing above the horizon");
        assert!(seen.triangle[31 * 32..].iter().all(|&t| t == 0), "the floor fills the last row");
    }

    /// Protects the search for crossed walls: behind the samples that are wanted the same is seen as where all are.
    #[test]
    fn what_is_behind_some_samples_is_what_is_behind_all() {
        let mut positions = Vec::new();
        for i in 0..120u32 {
            let at = |k: u32| ((i * 37 + k * 61) % 97) as f32 / 48.5 - 1.0;
            let corner = Vec3::new(at(0), at(1), 0.5 * at(2));
            positions.extend([corner, corner + Vec3::new(0.3, 0.1 * at(3), 0.2), corner + Vec3::Y * 0.3]);
        }
        let triangles: Vec<[u32; 3]> = (0..120).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let size = 48;
        let screen = ScreenTriangles::new(&positions, &triangles, &camera(), size);
        let [mut front, mut all, mut some] = [(); 3].map(|()| Visibility::default());
        rasterise(&screen, size, (0.0, 0.0), &mut front);
        rasterise_behind(&screen, size, (0.0, 0.0), &front, &mut all);
        let wanted: Vec<bool> = front.triangle.iter().map(|&t| t < 9).collect();
        rasterise_behind_some(&screen, size, &front, &wanted, &mut some);
        let behind = |seen: &Visibility| -> Vec<u32> {
            seen.triangle.iter().zip(&wanted).filter(|(_, wanted)| **wanted).map(|(&t, _)| t).collect()
        };
        assert!(behind(&all).iter().filter(|&&t| t != NOTHING).count() > 20);
        assert_eq!(behind(&all), behind(&some));
    }
}
