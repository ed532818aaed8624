//! The normals of clearcoats for the low-poly.
//!
//! A coat without a normal map has the normals of the mesh. A coarse mesh has other normals than a fine one, so reflections
//! move. Therefore each texel takes the coat's normal `N` at the high-poly's point that it shows, be it a map's or
//! the mesh's, into the low-poly's tangent frame `F`: `m = F⁻¹ N`, as `projection.rs` does for the surface below.
//!
//! Contract: an image of unit normals on the low-poly's own coordinates, or none where the low-poly's mesh has about the same.

use crate::extension_values::tangent_frame;
use crate::gutter;
use crate::high_poly::HighPoly;
use crate::low_poly::LowPoly;
use crate::projection::{corner_weights, in_frame, texel_width};
use parbake_image::quantise::to_image;
use parbake_image::{FloatImage, MapKind};
use parbake_mesh::SurfacePoint;
use parbake_model::Image;
use parbake_model::glam::{Vec3, Vec4};
use rayon::prelude::*;

/// Mean of 1 − cos of the angle to the mesh's normals below which these do: about one degree.
const ALIKE: f32 = 1.5e-4;

/// The normals of the coat of those triangles of the low-poly that have one; `points` has the high-poly's point for each of
/// size² texels.
pub(crate) fn coat_normals(
    low: &LowPoly,
    high: &HighPoly,
    points: &[Option<SurfacePoint>],
    is_coated: impl Fn(usize) -> bool + Sync,
) -> Option<Image> {
    let (mesh, size) = (&low.placed, low.map.size);
    let normal = |texel: usize| -> Option<Vec4> {
        let triangle = low.map.triangle[texel] as usize;
        let hit = points[texel].filter(|_| is_coated(triangle))?;
        let (width, own) = (texel_width(mesh, triangle, size), corner_weights(hit.barycentric));
        let mut found = high.extensions.coat_normal(high.scene.mesh(), hit.triangle as usize, own, width)?;
        let frame = tangent_frame(mesh, triangle, corner_weights(low.map.barycentric[texel]));
        // A sheet seen from its back: the side that faces out is meant.
        if found.dot(frame.z_axis) < 0.0 {
            found = -found;
        }
        Some(in_frame(&frame, found).normalize_or(Vec3::Z).extend(0.0))
    };
    let found: Vec<Option<Vec4>> = (0..size * size).into_par_iter().map(normal).collect();
    let known: Vec<bool> = found.iter().map(Option::is_some).collect();
    let turned: f32 = found.iter().flatten().map(|normal| 1.0 - normal.z).sum();
    let count = known.iter().filter(|&&is_known| is_known).count();
    if turned <= ALIKE * count as f32 {
        return None;
    }
    let texels = found.into_iter().map(|normal| normal.unwrap_or(Vec4::Z)).collect();
    let mut canvas = FloatImage::square(size, texels);
    gutter::fill(&mut canvas, &known);
    Some(Image { name: "clearcoat normal".into(), ..to_image(MapKind::Normal, &canvas, false) })
}
