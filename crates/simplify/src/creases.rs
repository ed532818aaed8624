//! Which edges of a chosen low-poly are hard: those at which the high-poly has an edge too.
//!
//! Smooth normals over an edge of a box lean by 45° on all of its sides, and a normal map has to turn them back over whole
//! triangles, which takes many texels. So vertices are split where the high-poly's normals, a little to either side of
//! the low-poly's edge, differ by most of the angle between its triangles. Where the high-poly is round they do not.

use parbake_mesh::creases::split_at_hard_edges;
use parbake_model::Mesh;
use parbake_model::glam::Vec3;
use parbake_render::interpolate::interpolate;
use parbake_views::high_poly::HighPoly;

/// Angle between two triangles below which an edge is never hard, in radians: 55°.
const LEAST: f32 = 0.96;
/// Share of that angle by which the high-poly's normals have to differ.
const SHARE: f32 = 0.75;
/// How far from the edge it is looked at: share of the way to the opposite corner.
const BESIDE: f32 = 0.15;

/// A chosen low-poly in the common frame with its normals.
pub(crate) fn with_normals(mesh: &Mesh, high: &HighPoly) -> Mesh {
    let unit = |triangle: usize| mesh.area_normal(triangle).normalize_or_zero();
    split_at_hard_edges(mesh, |[one, other], edge| {
        let angle = unit(one).angle_between(unit(other));
        let seen = |triangle: usize| normal_beside(mesh, high, triangle, edge);
        angle > LEAST && seen(one).zip(seen(other)).is_some_and(|(a, b)| a.angle_between(b) > SHARE * angle)
    })
}

/// The unit normal of the high-poly's mesh beside an edge of a triangle, on the side that the triangle shows.
fn normal_beside(mesh: &Mesh, high: &HighPoly, triangle: usize, edge: [u32; 2]) -> Option<Vec3> {
    let opposite = mesh.triangles[triangle].into_iter().find(|v| !edge.contains(v))?;
    let [a, b, c] = [edge[0], edge[1], opposite].map(|v| mesh.positions[v as usize]);
    let face = mesh.area_normal(triangle);
    let point = (0.5 * (a + b)).lerp(c, BESIDE);
    let direction = face.try_normalize()?;
    let hit = high.surface.project_facing(point, direction, face, high.conventions.max_distance)?;
    let surface = high.scene.mesh();
    let [second, third] = hit.barycentric;
    let corners = surface.triangles[hit.triangle as usize].map(|v| surface.normals[v as usize]);
    let normal = interpolate(corners, [1.0 - second - third, second, third]).try_normalize()?;
    Some(if normal.dot(face) < 0.0 { -normal } else { normal })
}
