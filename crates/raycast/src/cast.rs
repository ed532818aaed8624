//! All maps of a low-poly by rays: each texel is sampled at several points of its area, and holds their mean.
//!
//! Points are Hammersley's, so that no two of them share a row or a column of the texel: (k + ½) / n across
//! and Φ₂(k) + ½ / n down, one alone in the centre. In the k-th pass the whole texture is rasterised with its
//! grid moved to the k-th point (`parbake_mesh::texel_map`), and each texel casts one ray. Points that lie on
//! no triangle count for nothing, so texels that a chart covers in part hold the mean of that part.
//!
//! Colours are averaged in linear light, weighted by their opacity, normals as vectors.
//!
//! Contract: as in `lib.rs`. Sums are taken in the order of the passes.

use crate::ambient::ambient;
use crate::curvature::curvature;
use crate::height::height;
use crate::map::GeometryMap;
use crate::object_normal::object_normal;
use crate::position::position;
use crate::rays::Rays;
use crate::sample::Sample;
use crate::thickness::thickness;
use parbake_image::{FloatImage, MapKind, MapSet};
use parbake_mesh::{smooth_normals, texel_map};
use parbake_model::Mesh;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_progress::{Stage, Watcher};
use parbake_views::gutter;
use parbake_views::high_poly::HighPoly;
use parbake_views::low_poly::LowPoly;
use parbake_views::projection::{Found, Projector, Search, finished};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What to cast. Lengths are in the common frame, in which the high-poly's longest side is 2.
#[derive(Clone, Debug, PartialEq)]
pub struct CastOptions {
    /// Points a texel, 1 to 64.
    pub samples: usize,
    /// Which point of the high-poly is meant.
    pub search: Search,
    /// Whether rays go along normals that are averaged across hard edges, and not along the low-poly's own.
    pub smooth_rays: bool,
    /// The maps of shape that are wanted.
    pub maps: Vec<GeometryMap>,
    /// Rays a texel of the maps that cast more of them.
    pub rays: usize,
    /// How far they look for what blocks the sky.
    pub occlusion_distance: f32,
    /// Scale of the curvature.
    pub curvature_radius: f32,
}

/// What was cast.
#[derive(Clone, Debug)]
pub struct CastMaps {
    /// Maps of the material, as [`parbake_views::projection::ProjectedMaps::maps`].
    pub maps: MapSet,
    /// Maps of shape in the common frame, in the order in which they were asked for. Grey ones have their
    /// value in x.
    pub geometry: Vec<(GeometryMap, FloatImage<Vec4>)>,
    /// Texels of which any point lies on the surface; the others are filled.
    pub known: Vec<bool>,
    /// Those among them of which most points found nothing within reach and took a point farther away.
    pub missed: usize,
}

/// Opacity below which a colour counts for hardly anything.
const LEAST_OPACITY: f32 = 1e-3;

/// Casts all maps; none where the watcher stopped it.
pub fn cast_maps(
    low: &LowPoly,
    high: &HighPoly,
    options: &CastOptions,
    watcher: &dyn Watcher,
) -> Option<CastMaps> {
    let size = low.map.size;
    let samples = options.samples.max(1);
    let kinds: Vec<MapKind> = high.kinds().collect();
    let mut projector = Projector::new(low, high, options.search, samples);
    if options.smooth_rays {
        projector = projector.along(averaged_normals(&low.placed));
    }
    let lanes = kinds.len() + options.maps.len();
    let mut sums = vec![Vec4::ZERO; size * size * lanes];
    let mut counts = vec![Count::default(); size * size];
    let rows = AtomicUsize::new(0);
    for index in 0..samples {
        // One sample is in the centre, for which there is a grid already.
        let own = (samples > 1).then(|| texel_map(&moved(&low.placed, point(index, samples), size), size));
        let grid = own.as_ref().unwrap_or(&low.map);
        let work = sums.par_chunks_mut(size * lanes).zip(counts.par_chunks_mut(size)).enumerate();
        work.for_each(|(row, (sums, counts))| {
            if watcher.stopped() {
                return;
            }
            for (column, (sums, count)) in sums.chunks_mut(lanes).zip(counts).enumerate() {
                let texel = row * size + column;
                let triangle = grid.triangle[texel] as usize;
                let Some(found) = projector.find(triangle, grid.barycentric[texel]) else { continue };
                count.found += 1;
                count.missed += u16::from(found.hit.distance > high.conventions.max_distance);
                let (of_material, of_shape) = sums.split_at_mut(kinds.len());
                for (kind, sum) in kinds.iter().zip(of_material) {
                    *sum += weighted(*kind, found.values[*kind]);
                }
                let rays = Rays::new(options.rays, texel, index, samples);
                add_shape(&found, high, options, rays, of_shape);
            }
            let done = rows.fetch_add(1, Ordering::Relaxed) + 1;
            watcher.progress(Stage::Start, done, size * samples);
        });
        if watcher.stopped() {
            return None;
        }
    }
    let known: Vec<bool> = counts.iter().map(|count| count.found > 0).collect();
    let mean = |texel: usize, lane: usize| {
        let found = counts[texel].found;
        (found > 0).then(|| sums[texel * lanes + lane] / f32::from(found))
    };
    // Gutters grow texel by texel, so maps are finished side by side.
    let of_material = |(lane, kind): (usize, &MapKind)| {
        let value = |texel: usize| mean(texel, lane).map(|sum| unweighted(*kind, sum));
        (*kind, finished(*kind, high, size, &known, value))
    };
    let finished_maps: Vec<_> = kinds.par_iter().enumerate().map(of_material).collect();
    let mut maps = MapSet::new(size);
    finished_maps.into_iter().for_each(|(kind, map)| maps.insert(kind, map));
    let of_shape = |(place, &map): (usize, &GeometryMap)| {
        let lane = kinds.len() + place;
        let value = |texel| mean(texel, lane).map_or(Vec4::ZERO, |sum| of_unit_length(map, sum));
        let mut image = FloatImage::square(size, (0..size * size).into_par_iter().map(value).collect());
        gutter::fill(&mut image, &known);
        (map, image)
    };
    let geometry = options.maps.par_iter().enumerate().map(of_shape).collect();
    Some(CastMaps {
        geometry,
        maps,
        known,
        missed: counts.iter().filter(|count| 2 * count.missed > count.found).count(),
    })
}

/// Least cosine between a vertex's own normal and an averaged one that is used for it.
const LEAST_COSINE: f32 = 0.2;

/// Normals averaged over all triangles at a position; a vertex's own where that is hardly on its side, as where
/// both sides of a sheet share their positions.
fn averaged_normals(low: &Mesh) -> Vec<Vec3> {
    let pairs = smooth_normals(low).into_iter().zip(&low.normals);
    pairs.map(|(averaged, own)| if averaged.dot(*own) > LEAST_COSINE { averaged } else { *own }).collect()
}

/// Samples of a texel.
#[derive(Clone, Copy, Default)]
struct Count {
    found: u16,
    missed: u16,
}

/// The k-th of n points of a texel, from its centre.
fn point(index: usize, samples: usize) -> Vec2 {
    let across = (index as f32 + 0.5) / samples as f32;
    let down = (index as u32).reverse_bits() as f32 / 2f32.powi(32) + 0.5 / samples as f32;
    Vec2::new(across - 0.5, down.fract() - 0.5)
}

/// The mesh with texel centres where this point of each texel was.
fn moved(mesh: &Mesh, point: Vec2, size: usize) -> Mesh {
    let shift = point / size as f32;
    Mesh {
        positions: mesh.positions.clone(),
        uvs: mesh.uvs.iter().map(|uv| *uv - shift).collect(),
        triangles: mesh.triangles.clone(),
        ..Mesh::default()
    }
}

/// A map's value as it is summed.
fn weighted(kind: MapKind, value: Vec4) -> Vec4 {
    match kind {
        MapKind::BaseColor => (value.truncate() * value.w.max(LEAST_OPACITY)).extend(value.w),
        _ => value,
    }
}

/// Of a mean of [`weighted`] values the mean that is meant.
fn unweighted(kind: MapKind, mean: Vec4) -> Vec4 {
    match kind {
        MapKind::BaseColor => (mean.truncate() / mean.w.max(LEAST_OPACITY)).extend(mean.w),
        _ => mean,
    }
}

/// Adds what the maps of shape have at a sample.
fn add_shape(found: &Found, high: &HighPoly, options: &CastOptions, rays: Rays, sums: &mut [Vec4]) {
    if options.maps.is_empty() {
        return;
    }
    let sample = Sample::new(found, high.scene.mesh(), &high.surface, rays);
    // Two maps come of the same rays.
    let mut sky = None;
    for (map, sum) in options.maps.iter().zip(sums) {
        let mut sky = || *sky.get_or_insert_with(|| ambient(&sample, options.occlusion_distance));
        let grey = |value: f32| Vec3::splat(value).extend(0.0);
        *sum += match map {
            GeometryMap::Occlusion => grey(sky().w),
            GeometryMap::BentNormal => sky().truncate().extend(0.0),
            GeometryMap::Curvature => grey(curvature(&sample, options.curvature_radius)),
            GeometryMap::Position => position(&sample).extend(0.0),
            GeometryMap::Thickness => grey(thickness(&sample)),
            GeometryMap::Height => grey(height(&sample)),
            GeometryMap::ObjectNormal => object_normal(&sample).extend(0.0),
        };
    }
}

/// Means of directions are directions again.
fn of_unit_length(map: GeometryMap, mean: Vec4) -> Vec4 {
    match map {
        GeometryMap::BentNormal | GeometryMap::ObjectNormal => {
            mean.truncate().normalize_or(Vec3::Z).extend(0.0)
        }
        _ => mean,
    }
}
