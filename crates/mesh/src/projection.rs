//! Where a point of the coarse surface lies on the detailed one: rays and closest
//! points over a bounding volume hierarchy (obvhs: PLOC, Meister and Bittner 2018,
//! improved by reinsertion, Meister and Bittner 2018).
//!
//! Rays follow Möller and Trumbore (1997), closest points Ericson ("Real-Time
//! Collision Detection", 5.1.5). Edges are a few ulps thicker than they should be,
//! so that no ray slips between two triangles.
//!
//! Contract: coordinates are of moderate size, as in the common frame [−1, 1]³.
//! Triangles without area are left out. Answers do not depend on threads.

use crate::bvh::{Bvh, Corners, Near, Stack};
use crate::wide_nodes::{Line, WIDTH};
use parbake_model::Mesh;
use parbake_model::glam::{Vec3, Vec3A, Vec4};

/// A point of the detailed surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfacePoint {
    /// Index of the triangle in the mesh.
    pub triangle: u32,
    /// Weights of the triangle's corners 1 and 2, each in 0 … 1; corner 0 has the
    /// rest.
    pub barycentric: [f32; 2],
    /// How far it is from where the query began.
    pub distance: f32,
}

/// A detailed mesh, made ready for queries.
#[derive(Clone)]
pub struct HighSurface {
    bvh: Bvh,
}

impl HighSurface {
    /// Builds the hierarchy, in well under a second for a million triangles.
    pub fn new(mesh: &Mesh) -> Self {
        Self { bvh: Bvh::new(mesh) }
    }

    /// The first point that a ray meets within `max_distance`, on either side of
    /// the surface. The direction may have any length but zero; distances are in
    /// the mesh's unit.
    pub fn cast(&self, origin: Vec3, direction: Vec3, max_distance: f32) -> Option<SurfacePoint> {
        self.along_line::<false, false>(origin, direction.try_normalize()?, max_distance, |_, _| true)
    }

    /// Whether a ray meets anything within `max_distance`, on either side of the surface: what
    /// [`cast`](Self::cast) would find, without asking what comes first.
    pub fn blocks(&self, origin: Vec3, direction: Vec3, max_distance: f32) -> bool {
        let Some(direction) = direction.try_normalize() else { return false };
        self.along_line::<false, true>(origin, direction, max_distance, |_, _| true).is_some()
    }

    /// The nearest point of the surface within `max_distance`, which may be
    /// infinite.
    pub fn closest(&self, point: Vec3, max_distance: f32) -> Option<SurfacePoint> {
        self.nearest(point, max_distance, |_| true)
    }

    /// The nearest point within `max_distance` of what faces along `direction`: of triangles whose normals
    /// are within 90° of it.
    pub fn closest_facing(&self, point: Vec3, direction: Vec3, max_distance: f32) -> Option<SurfacePoint> {
        let direction = Vec3A::from(direction);
        self.nearest(point, max_distance, |slot| self.bvh.triangle(slot).normal().dot(direction) > 0.0)
    }

    fn nearest(
        &self,
        point: Vec3,
        max_distance: f32,
        is_meant: impl Fn(u32) -> bool,
    ) -> Option<SurfacePoint> {
        let point = Vec3A::from(point);
        let mut best = Near { square: max_distance * max_distance, ..Near::default() };
        let mut found = None;
        let lanes = point.to_array().map(Vec4::splat);
        let mut stack = Stack::default();
        let nodes = self.bvh.nodes();
        if let Some(root) = nodes.first() {
            let (squares, bits) = root.near(lanes, best.square);
            stack.push_nearest_last(0, squares, bits);
        }
        while let Some((child, square)) = stack.pop() {
            if square > best.square {
                continue;
            }
            let (node, k) = (&nodes[child as usize / WIDTH], child as usize % WIDTH);
            if node.count[k] == 0 {
                let (squares, bits) = nodes[node.first[k] as usize].near(lanes, best.square);
                stack.push_nearest_last(node.first[k], squares, bits);
                continue;
            }
            for slot in node.first[k]..node.first[k] + node.count[k] {
                let near = self.bvh.triangle(slot).closest(point);
                let nearer = near.square < best.square || (found.is_none() && near.square == best.square);
                if nearer && is_meant(slot) {
                    best = near;
                    found = Some(slot);
                }
            }
        }
        found.map(|slot| SurfacePoint {
            triangle: self.bvh.source(slot),
            barycentric: best.barycentric,
            distance: best.square.sqrt(),
        })
    }

    /// Where a point of a coarse surface, with its unit normal, lies on this one.
    ///
    /// The rule: on the segment point ± reach · normal, of all places where the
    /// surface faces outwards (its geometric normal is within 90° of the point's)
    /// the one nearest to the point. Facing keeps the two sides of a thin wall
    /// apart; nearness, instead of coming first from outside, keeps other parts of
    /// the model that reach into the cage from hiding what is under the point.
    /// Where the segment meets nothing that faces outwards: the closest point of
    /// the surface that does, up to `reach` farther than the closest of all, else that one,
    /// however far. `None` only for a surface without any area.
    pub fn project(&self, point: Vec3, normal: Vec3, reach: f32) -> Option<SurfacePoint> {
        self.project_facing(point, normal, normal, reach)
    }

    /// The same where the coarse surface's own side is known: `side` is the normal of its triangle, of any
    /// length, and places must face outwards by that too. At rims and creases an interpolated normal looks
    /// along the wall, where either side of it may pass for the outer one.
    pub fn project_facing(&self, point: Vec3, normal: Vec3, side: Vec3, reach: f32) -> Option<SurfacePoint> {
        let side_of_wall = Vec3A::from(side);
        let is_meant = |triangle: &Corners, ahead: bool| ahead && triangle.normal().dot(side_of_wall) > 0.0;
        let hit =
            normal.try_normalize().and_then(|n| self.along_line::<true, false>(point, n, reach, is_meant));
        hit.or_else(|| self.closest_on_side(point, side, reach))
    }

    /// The same, but of all places on the segment the outermost: what a ray meets first that comes from
    /// outside, at `point + reach · normal`. Parts that float over the surface hide what is under them.
    pub fn project_from_outside(
        &self,
        point: Vec3,
        normal: Vec3,
        side: Vec3,
        reach: f32,
    ) -> Option<SurfacePoint> {
        let side_of_wall = Vec3A::from(side);
        let is_meant = |triangle: &Corners, ahead: bool| !ahead && triangle.normal().dot(side_of_wall) > 0.0;
        let hit = normal.try_normalize().and_then(|n| {
            let hit = self.along_line::<false, false>(point + reach * n, -n, 2.0 * reach, is_meant)?;
            Some(SurfacePoint { distance: (reach - hit.distance).abs(), ..hit })
        });
        hit.or_else(|| self.closest_on_side(point, side, reach))
    }

    /// The closest point that faces along `side`, up to `reach` farther than the closest of all, else that
    /// one. `None` only for a surface without any area.
    pub fn closest_on_side(&self, point: Vec3, side: Vec3, reach: f32) -> Option<SurfacePoint> {
        let any = self.closest(point, f32::INFINITY)?;
        Some(self.closest_facing(point, side, any.distance + reach).unwrap_or(any))
    }

    /// The hit nearest to the origin on a line: only ahead of it or, if
    /// `BOTH_WAYS`, behind it too; or, if `ANY`, the first that is come across. Only of
    /// triangles that are meant, which are told whether their normals are within 90° of the
    /// direction.
    fn along_line<const BOTH_WAYS: bool, const ANY: bool>(
        &self,
        origin: Vec3,
        direction: Vec3,
        max_distance: f32,
        is_meant: impl Fn(&Corners, bool) -> bool,
    ) -> Option<SurfacePoint> {
        let (origin, direction) = (Vec3A::from(origin), Vec3A::from(direction));
        let line = Line::new(origin, direction);
        let nodes = self.bvh.nodes();
        let mut best = max_distance;
        let mut found = None;
        let mut stack = Stack::default();
        if let Some(root) = nodes.first() {
            let (distances, bits) = root.enter::<BOTH_WAYS>(&line, best);
            stack.push_nearest_last(0, distances, bits);
        }
        while let Some((child, distance)) = stack.pop() {
            if distance > best {
                continue;
            }
            let (node, k) = (&nodes[child as usize / WIDTH], child as usize % WIDTH);
            if node.count[k] == 0 {
                let (distances, bits) = nodes[node.first[k] as usize].enter::<BOTH_WAYS>(&line, best);
                stack.push_nearest_last(node.first[k], distances, bits);
                continue;
            }
            for slot in node.first[k]..node.first[k] + node.count[k] {
                let triangle = self.bvh.triangle(slot);
                let Some((t, barycentric, ahead)) = triangle.intersect(origin, direction) else {
                    continue;
                };
                let distance = if BOTH_WAYS { t.abs() } else { t };
                let nearer = distance < best || (found.is_none() && distance == best);
                if distance >= 0.0 && nearer && is_meant(triangle, ahead) {
                    best = distance;
                    found = Some((slot, barycentric));
                    if ANY {
                        break;
                    }
                }
            }
            if ANY && found.is_some() {
                break;
            }
        }
        found.map(|(slot, barycentric)| SurfacePoint {
            triangle: self.bvh.source(slot),
            barycentric,
            distance: best,
        })
    }
}

#[cfg(test)]
#[path = "projection_tests.rs"]
mod tests;
