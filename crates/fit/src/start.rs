//! The start: the high-poly's colour and normal, projected onto the texture.
//!
//! Each texel on the surface asks the high-poly along its normal, to either side, and
//! where that finds nothing, for its closest point (`parbake_mesh::projection`); normals go into the texel's tangent frame,
//! `m = F⁻¹ N` with F as in `frame.rs`, so that an evaluation there finds N again.
//! Texels off the surface take the value of the nearest chart.
//!
//! This is also what an ordinary ray-cast baker would deliver: the fit reports how
//! far it gets beyond it.

use crate::atlas::Atlas;
use crate::canvas::Canvas;
use crate::gutter;
use crate::normal::upright;
use parbake_mesh::projection::HighSurface;
use parbake_mesh::texel_map::TexelMap;
use parbake_model::Mesh;
use parbake_model::glam::{Mat3, Vec3, Vec4};
use parbake_render::interpolate::interpolate;
use parbake_render::scene::Scene;
use rayon::prelude::*;

/// Projected textures.
#[derive(Clone, Debug)]
pub struct Start {
    /// Albedo in the scene's interpretation, 0 … 1.
    pub color: Canvas,
    /// Unit tangent-space normals.
    pub normal: Canvas,
    /// Texels on the surface that found nothing within reach along their normal and had
    /// to take a point farther away.
    pub missed: usize,
}

/// Projects the high-poly onto each texel of the map.
///
/// `reach` is how far to either side of the surface a texel looks, in the common frame.
pub fn project(
    low: &Mesh,
    map: &TexelMap,
    atlas: &Atlas,
    high: &Scene,
    surface: &HighSurface,
    reach: f32,
) -> Start {
    let size = map.size;
    let texel_width = texel_widths(low, size);
    let projected: Vec<Option<(Vec4, Vec4, f32)>> = (0..size * size)
        .into_par_iter()
        .map(|texel| {
            let triangle = map.triangle[texel] as usize;
            let corners = low.triangles.get(triangle)?.map(|i| i as usize);
            let [second, third] = map.barycentric[texel];
            let weights = [1.0 - second - third, second, third];
            let point = interpolate(corners.map(|i| low.positions[i]), weights);
            let normal = interpolate(corners.map(|i| low.normals[i]), weights);
            let hit = surface.project(point, normal.normalize_or_zero(), reach)?;
            let [b1, b2] = hit.barycentric;
            let (color, mut found) =
                high.look(hit.triangle as usize, [1.0 - b1 - b2, b1, b2], texel_width[triangle]);
            // A sheet seen from its back: the side that faces out is meant.
            if found.dot(normal) < 0.0 {
                found = -found;
            }
            let tangent = interpolate(corners.map(|i| low.tangents[i].truncate()), weights);
            let bitangent = normal.cross(tangent) * low.tangents[corners[0]].w;
            let frame = Mat3::from_cols(tangent, bitangent, normal);
            let flat = frame.determinant().abs() < 1e-6;
            let mapped = if flat { Vec3::Z } else { frame.inverse() * found };
            let color = color.clamp(Vec3::ZERO, Vec3::ONE).extend(0.0);
            Some((color, upright(mapped.extend(0.0)), hit.distance))
        })
        .collect();
    let known: Vec<bool> = projected.iter().map(Option::is_some).collect();
    let missed = (projected.iter().zip(&atlas.covered))
        .filter(|(p, covered)| **covered && p.is_none_or(|(.., distance)| distance > reach))
        .count();
    let plane = |of: fn(&(Vec4, Vec4, f32)) -> Vec4, none: Vec4| {
        let texels = projected.iter().map(|p| p.as_ref().map_or(none, of)).collect();
        let mut canvas = Canvas { size, texels };
        gutter::fill(&mut canvas, &known);
        canvas
    };
    Start {
        color: plane(|p| p.0, Vec4::new(0.5, 0.5, 0.5, 0.0)),
        normal: plane(|p| p.1, Vec4::new(0.0, 0.0, 1.0, 0.0)),
        missed,
    }
}

/// How wide one texel is on each triangle, in the common frame.
fn texel_widths(low: &Mesh, size: usize) -> Vec<f32> {
    (0..low.triangles.len())
        .map(|t| {
            let [a, b, c] = low.corner_uvs(t);
            let texels = (b - a).perp_dot(c - a).abs() * (size * size) as f32;
            (low.area_normal(t).length() / texels.max(1e-6)).sqrt()
        })
        .collect()
}
