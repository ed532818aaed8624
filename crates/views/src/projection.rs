//! The start: the high-poly's colour and normal, projected onto the texture.
//!
//! Each texel on the surface asks the high-poly along its normal, to either side, for what faces as its
//! triangle does, and where that finds nothing, for the closest such point (`parbake_mesh::projection`):
//! a thin wall's other side is nearer at a rim, and is not what this side shows. Normals go into the texel's tangent frame,
//! `m = F⁻¹ N` with F as in `frame.rs`, so that an evaluation there finds N again.
//! Texels off the surface take the value of the nearest chart.
//!
//! This is also what an ordinary ray-cast baker would deliver: the fit reports how
//! far it gets beyond it.

use crate::gutter;
use crate::high_poly::HighPoly;
use crate::low_poly::LowPoly;
use parbake_image::{Domain, FloatImage, MapKind, MapSet, MapValues};
use parbake_model::Mesh;
use parbake_model::glam::{Mat3, Vec3, Vec4};
use parbake_render::interpolate::interpolate;
use rayon::prelude::*;

/// Projected maps.
#[derive(Clone, Debug)]
pub struct ProjectedMaps {
    /// In the scene's interpretation: unit normals in the tangent frame, all else within [0, 1].
    pub maps: MapSet,
    /// Texels on the surface that found nothing within reach along their normal and had
    /// to take a point farther away.
    pub missed: usize,
}

/// What a texel finds where neither it nor a neighbour finds anything.
const NOTHING_FOUND: Vec4 = Vec4::new(0.5, 0.5, 0.5, 1.0);

/// Projects the high-poly onto each texel of the map.
///
/// A texel looks [`Conventions::max_distance`](crate::high_poly::Conventions) to either side.
pub fn project(low: &LowPoly, high: &HighPoly) -> ProjectedMaps {
    let LowPoly { placed: low, map, atlas, .. } = low;
    let HighPoly { scene, surface, .. } = high;
    let reach = high.conventions.max_distance;
    let size = map.size;
    let texel_width = texel_widths(low, size);
    let projected: Vec<Option<(MapValues, f32)>> = (0..size * size)
        .into_par_iter()
        .map(|texel| {
            let triangle = map.triangle[texel] as usize;
            let corners = low.triangles.get(triangle)?.map(|i| i as usize);
            let [second, third] = map.barycentric[texel];
            let weights = [1.0 - second - third, second, third];
            let point = interpolate(corners.map(|i| low.positions[i]), weights);
            let normal = interpolate(corners.map(|i| low.normals[i]), weights);
            let side = low.area_normal(triangle);
            let hit = surface.project_facing(point, normal.normalize_or_zero(), side, reach)?;
            let [b1, b2] = hit.barycentric;
            let mut values =
                scene.look(hit.triangle as usize, [1.0 - b1 - b2, b1, b2], texel_width[triangle]);
            let mut found = values[MapKind::Normal].truncate();
            // A sheet seen from its back: the side that faces out is meant.
            if found.dot(normal) < 0.0 {
                found = -found;
            }
            let tangent = interpolate(corners.map(|i| low.tangents[i].truncate()), weights);
            let bitangent = normal.cross(tangent) * low.tangents[corners[0]].w;
            let frame = Mat3::from_cols(tangent, bitangent, normal);
            let flat = frame.determinant().abs() < 1e-6;
            let mapped = if flat { Vec3::Z } else { frame.inverse() * found };
            values[MapKind::Normal] = mapped.extend(0.0);
            Some((values, hit.distance))
        })
        .collect();
    let known: Vec<bool> = projected.iter().map(Option::is_some).collect();
    let missed = (projected.iter().zip(&atlas.covered))
        .filter(|(p, covered)| **covered && p.is_none_or(|(_, distance)| distance > reach))
        .count();
    let mut maps = MapSet::new(size);
    for kind in high.kinds() {
        let domain = kind.spec().domain;
        let none = if domain == Domain::Hemisphere { kind.spec().neutral } else { NOTHING_FOUND };
        let of = |(values, _): &(MapValues, f32)| match kind {
            MapKind::BaseColor if high.is_whole_material => domain.clamp(values[kind]),
            MapKind::BaseColor => domain.clamp(values[kind].truncate().extend(1.0)),
            _ => domain.clamp(values[kind].truncate().extend(0.0)),
        };
        let texels = projected.iter().map(|p| p.as_ref().map_or(none, of)).collect();
        let mut map = FloatImage::square(size, texels);
        gutter::fill(&mut map, &known);
        maps.insert(kind, map);
    }
    ProjectedMaps { maps, missed }
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
