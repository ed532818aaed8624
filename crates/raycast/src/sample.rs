//! One sample of a texel: where it lies on the low-poly and on the high-poly, and where rays of the maps of
//! shape begin.
//!
//! Rays leave a smooth surface, not its facets: the point is raised to where the tangent planes of the
//! triangle's vertices meet over it (Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, 2021), so
//! that neighbouring facets of a convex body do not shade it.

use crate::rays::Rays;
use parbake_mesh::{HighSurface, SurfacePoint};
use parbake_model::Mesh;
use parbake_model::glam::{Mat3, Vec3};
use parbake_render::interpolate::interpolate;
use parbake_views::projection::Found;

/// How far rays begin off the surface, in the common frame, whose longest side is 2.
pub const LIFT: f32 = 2e-5;

/// How far a point is raised over its triangle at most: where a box has the normals of a ball, more would leave
/// behind what stands on it.
const MOST_RAISED: f32 = 0.01;

/// A sample, in the common frame.
pub struct Sample<'a> {
    /// The high-poly.
    pub mesh: &'a Mesh,
    /// The same for rays.
    pub surface: &'a HighSurface,
    /// The low-poly's point.
    pub low: Vec3,
    /// The unit direction in which it looked, outwards.
    pub direction: Vec3,
    /// The low-poly's tangent frame; see [`Found::frame`].
    pub frame: Mat3,
    /// The high-poly's point.
    pub point: Vec3,
    /// The unit normal of the high-poly's triangle, on the side that the low-poly shows.
    pub facet: Vec3,
    /// The high-poly's interpolated unit normal without its normal map, on the same side.
    pub smooth: Vec3,
    /// The high-poly's unit normal with its normal map, on the same side.
    pub mapped: Vec3,
    /// Where rays to the outside begin.
    pub origin: Vec3,
    /// This sample's share of the texel's rays.
    pub rays: Rays,
}

impl<'a> Sample<'a> {
    /// Of what the low-poly found on a mesh.
    pub fn new(found: &Found, mesh: &'a Mesh, surface: &'a HighSurface, rays: Rays) -> Self {
        let triangle = found.hit.triangle as usize;
        let corners = mesh.triangles[triangle].map(|i| i as usize);
        let [second, third] = found.hit.barycentric;
        let weights = [1.0 - second - third, second, third];
        let positions = corners.map(|i| mesh.positions[i]);
        let point: Vec3 = interpolate(positions, weights);
        let outwards = found.frame.z_axis;
        let (facet, smooth) = normals_at(mesh, &found.hit, outwards);
        let of_vertices = corners.map(|i| mesh.normals[i]);
        let raised: [Vec3; 3] = std::array::from_fn(|k| {
            let normal = same_side(of_vertices[k], facet);
            point - (point - positions[k]).dot(normal).min(0.0) * normal
        });
        let raise = (interpolate::<Vec3>(raised, weights) - point).clamp_length_max(MOST_RAISED);
        let origin = point + raise + LIFT * facet;
        Self {
            mesh,
            surface,
            low: found.point,
            direction: found.direction,
            frame: found.frame,
            point,
            facet,
            smooth,
            mapped: found.normal,
            origin,
            rays,
        }
    }
}

/// The unit normals of a triangle and of the smooth surface at a point of a mesh, on the side that looks along
/// `outwards`.
pub fn normals_at(mesh: &Mesh, point: &SurfacePoint, outwards: Vec3) -> (Vec3, Vec3) {
    let triangle = point.triangle as usize;
    let facet = same_side(mesh.area_normal(triangle), outwards).normalize_or(outwards.normalize_or(Vec3::Z));
    let [second, third] = point.barycentric;
    let normals = mesh.triangles[triangle].map(|i| mesh.normals[i as usize]);
    let smooth: Vec3 = interpolate(normals, [1.0 - second - third, second, third]);
    // A normal that looks into its own triangle says nothing of the surface.
    (facet, same_side(smooth, facet).normalize_or(facet))
}

fn same_side(v: Vec3, other: Vec3) -> Vec3 {
    if v.dot(other) < 0.0 { -v } else { v }
}
