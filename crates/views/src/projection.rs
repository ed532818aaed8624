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

use crate::extension_values::tangent_frame;
use crate::gutter;
use crate::high_poly::HighPoly;
use crate::low_poly::LowPoly;
use parbake_image::{Domain, FloatImage, MapKind, MapSet, MapValues};
use parbake_mesh::SurfacePoint;
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

/// Which point of the high-poly a point of the low-poly shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Search {
    /// Along the ray the nearest one, to either side ([`parbake_mesh::HighSurface::project_facing`]).
    #[default]
    Nearest,
    /// Along the ray the outermost one ([`parbake_mesh::HighSurface::project_from_outside`]).
    Outermost,
    /// The closest one in space, whatever the direction.
    ClosestPoint,
}

/// Finds what a high-poly shows at points of a low-poly.
pub struct Projector<'a> {
    low: &'a Mesh,
    high: &'a HighPoly,
    search: Search,
    /// V directions of rays, of any length; none for the low-poly's own normals.
    directions: Option<Vec<Vec3>>,
    /// How wide one sample is on each triangle, in the common frame.
    widths: Vec<f32>,
}

/// What a point of the low-poly finds; all of it in the common frame.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// The point of the low-poly.
    pub point: Vec3,
    /// The unit direction along which it looked, outwards.
    pub direction: Vec3,
    /// Tangent, bitangent and normal of the low-poly, interpolated and not of unit length.
    pub frame: Mat3,
    /// The high-poly's point.
    pub hit: SurfacePoint,
    /// The high-poly's unit normal there, with its normal map, on the side that the low-poly shows.
    pub normal: Vec3,
    /// The high-poly's maps there; the normal is in the low-poly's tangent frame.
    pub values: MapValues,
}

impl<'a> Projector<'a> {
    /// For samples each of which stands for 1 / `samples` of a texel.
    pub fn new(low: &'a LowPoly, high: &'a HighPoly, search: Search, samples: usize) -> Self {
        let narrower = 1.0 / (samples.max(1) as f32).sqrt();
        let widths = texel_widths(&low.placed, low.map.size).iter().map(|width| width * narrower).collect();
        Self { low: &low.placed, high, search, directions: None, widths }
    }

    /// With rays along these V directions instead of the low-poly's own normals.
    pub fn along(self, directions: Vec<Vec3>) -> Self {
        Self { directions: Some(directions), ..self }
    }

    /// What the point at these weights of corners 1 and 2 of a triangle finds; nothing where there is no such
    /// triangle, or no high-poly.
    pub fn find(&self, triangle: usize, barycentric: [f32; 2]) -> Option<Found> {
        let Self { low, high, .. } = self;
        let HighPoly { scene, surface, .. } = high;
        let corners = low.triangles.get(triangle)?.map(|i| i as usize);
        let reach = high.conventions.max_distance;
        let weights = corner_weights(barycentric);
        let point = interpolate(corners.map(|i| low.positions[i]), weights);
        let normal = interpolate(corners.map(|i| low.normals[i]), weights);
        let side = low.area_normal(triangle);
        let along = match &self.directions {
            Some(directions) => interpolate(corners.map(|i| directions[i]), weights),
            None => normal,
        };
        let direction = along.normalize_or_zero();
        let hit = match self.search {
            Search::Nearest => surface.project_facing(point, direction, side, reach),
            Search::Outermost => surface.project_from_outside(point, direction, side, reach),
            Search::ClosestPoint => surface.closest_on_side(point, side, reach),
        }?;
        let own = corner_weights(hit.barycentric);
        let mut values = scene.look(hit.triangle as usize, own, self.widths[triangle]);
        let mut found = values[MapKind::Normal].truncate();
        // A sheet seen from its back: the side that faces out is meant.
        if found.dot(normal) < 0.0 {
            found = -found;
        }
        let frame = tangent_frame(low, triangle, weights);
        values[MapKind::Normal] = in_frame(&frame, found).extend(0.0);
        Some(Found { point, direction, frame, hit, normal: found, values })
    }
}

/// Weights of a triangle's corners, from those of the second and the third.
pub(crate) fn corner_weights([second, third]: [f32; 2]) -> [f32; 3] {
    [1.0 - second - third, second, third]
}

/// A direction of space in a tangent frame, so that `frame` · result is that direction; +Z where the frame is
/// flat.
pub fn in_frame(frame: &Mat3, direction: Vec3) -> Vec3 {
    if frame.determinant().abs() < 1e-6 { Vec3::Z } else { frame.inverse() * direction }
}

/// Projects the high-poly onto each texel of the map.
///
/// A texel looks [`Conventions::max_distance`](crate::high_poly::Conventions) to either side.
pub fn project(low: &LowPoly, high: &HighPoly) -> ProjectedMaps {
    let LowPoly { map, atlas, .. } = low;
    let reach = high.conventions.max_distance;
    let projector = Projector::new(low, high, Search::Nearest, 1);
    let projected: Vec<Option<(MapValues, f32)>> = (0..map.size * map.size)
        .into_par_iter()
        .map(|texel| {
            let found = projector.find(map.triangle[texel] as usize, map.barycentric[texel])?;
            Some((found.values, found.hit.distance))
        })
        .collect();
    let missed = (projected.iter().zip(&atlas.covered))
        .filter(|(p, covered)| **covered && p.is_none_or(|(_, distance)| distance > reach))
        .count();
    let known: Vec<bool> = projected.iter().map(Option::is_some).collect();
    let mut maps = MapSet::new(map.size);
    for kind in high.kinds() {
        let value = |texel: usize| projected[texel].as_ref().map(|(values, _)| values[kind]);
        maps.insert(kind, finished(kind, high, map.size, &known, value));
    }
    ProjectedMaps { maps, missed }
}

/// A map of what each texel found, brought into its domain; texels that found nothing, which are not `known`,
/// are filled from those around.
pub fn finished(
    kind: MapKind,
    high: &HighPoly,
    size: usize,
    known: &[bool],
    value: impl Fn(usize) -> Option<Vec4> + Sync,
) -> FloatImage<Vec4> {
    let domain = kind.spec().domain;
    let none = if domain == Domain::Hemisphere { kind.spec().neutral } else { NOTHING_FOUND };
    let of = |value: Vec4| match kind {
        MapKind::BaseColor if high.is_whole_material => domain.clamp(value),
        MapKind::BaseColor => domain.clamp(value.truncate().extend(1.0)),
        _ => domain.clamp(value.truncate().extend(0.0)),
    };
    let texels = (0..size * size).into_par_iter().map(|texel| value(texel).map_or(none, of)).collect();
    let mut map = FloatImage::square(size, texels);
    gutter::fill(&mut map, known);
    map
}

/// How wide one texel is on each triangle, in the common frame.
fn texel_widths(low: &Mesh, size: usize) -> Vec<f32> {
    (0..low.triangles.len()).map(|triangle| texel_width(low, triangle, size)).collect()
}

/// How wide one texel is on a triangle, in the common frame.
pub(crate) fn texel_width(low: &Mesh, triangle: usize, size: usize) -> f32 {
    let [a, b, c] = low.corner_uvs(triangle);
    let texels = (b - a).perp_dot(c - a).abs() * (size * size) as f32;
    (low.area_normal(triangle).length() / texels.max(1e-6)).sqrt()
}
