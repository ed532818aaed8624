//! Distances between two surfaces, sampled: Chamfer, Hausdorff and root mean square, as Cignoni, Rocchini and
//! Scopigno ("Metro", 1998) measure them.
//!
//! With d(p, S) the distance of a point from the closest point of a surface, and p over one surface's samples:
//!
//! - mean: the mean of d, by area; root mean square likewise;
//! - greatest: the largest d, over the samples and the corners of all triangles;
//! - *Chamfer distance*: the mean of both ways' means, of distances and not of their squares;
//! - *Hausdorff distance*: the greater of both ways' greatest; a lower bound, since a surface is more than its
//!   samples.
//!
//! One way finds what sticks out, the other what is missing.
//!
//! Samples are stratified: the surface in the order of its triangles is cut into strata of equal area, and each has
//! one sample at its middle, whose place in its triangle is the next of an evenly spread sequence.
//!
//! Contract: both meshes are moved into the first one's common frame for the search, and results are in the unit of
//! the files. The result depends on the meshes and the number of samples alone.

use crate::deviation::spread;
use crate::projection::HighSurface;
use parbake_model::glam::Vec3;
use parbake_model::{Bounds, Mesh, Placement};
use rayon::prelude::*;
use serde::Serialize;

/// Points that are taken together: sums are made in this order, whatever the number of threads.
const BATCH: usize = 4096;

/// How distances are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DistanceOptions {
    /// Samples on each surface; 200,000 by default, at least 1.
    pub samples: usize,
}

impl Default for DistanceOptions {
    fn default() -> Self {
        Self { samples: 200_000 }
    }
}

/// Distances of one surface's points from the other, in the unit of the files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct OneWay {
    /// Mean by area.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// The greatest.
    pub max: f64,
}

/// Distances between two surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SurfaceDistance {
    /// Samples on each surface.
    pub samples: usize,
    /// Diagonal of the first surface's bounding box, in the unit of the files.
    pub diagonal: f64,
    /// From the first surface's points to the second.
    pub forward: OneWay,
    /// From the second surface's points to the first.
    pub backward: OneWay,
    /// Mean of both ways' means, in the unit of the files.
    pub chamfer: f64,
    /// The greater of both ways' greatest.
    pub hausdorff: f64,
    /// The greater of both ways' root mean square.
    pub rms: f64,
    /// The same three as shares of the diagonal.
    pub chamfer_share: f64,
    /// Of `hausdorff`.
    pub hausdorff_share: f64,
    /// Of `rms`.
    pub rms_share: f64,
}

/// Distances between two surfaces in the first one's frame; none where either has no area.
pub fn surface_distance(first: &Mesh, second: &Mesh, options: DistanceOptions) -> Option<SurfaceDistance> {
    let bounds = Bounds::of(first)?;
    let placement = Placement::unit_box(&bounds)?;
    let unit = 1.0 / f64::from(placement.scale);
    let moved = [first, second].map(|mesh| {
        let (positions, triangles) = (mesh.positions.clone(), mesh.triangles.clone());
        let mut mesh = Mesh { positions, triangles, ..Mesh::default() };
        placement.apply(&mut mesh);
        mesh
    });
    let surfaces = [HighSurface::new(&moved[0]), HighSurface::new(&moved[1])];
    let samples = options.samples.max(1);
    let forward = one_way(&moved[0], &surfaces[1], samples, unit)?;
    let backward = one_way(&moved[1], &surfaces[0], samples, unit)?;
    let diagonal = bounds.size().as_dvec3().length();
    let chamfer = 0.5 * (forward.mean + backward.mean);
    let hausdorff = forward.max.max(backward.max);
    let rms = forward.rms.max(backward.rms);
    Some(SurfaceDistance {
        samples,
        diagonal,
        forward,
        backward,
        chamfer,
        hausdorff,
        rms,
        chamfer_share: chamfer / diagonal,
        hausdorff_share: hausdorff / diagonal,
        rms_share: rms / diagonal,
    })
}

fn one_way(from: &Mesh, to: &HighSurface, samples: usize, unit: f64) -> Option<OneWay> {
    let points = stratified(from, samples)?;
    let distance = |p: Vec3| to.closest(p, f32::INFINITY).map(|found| unit * f64::from(found.distance));
    let sums: Option<Vec<[f64; 3]>> = points
        .par_chunks(BATCH)
        .map(|batch| {
            batch.iter().try_fold([0.0; 3], |[sum, square, max]: [f64; 3], &p| {
                let d = distance(p)?;
                Some([sum + d, square + d * d, max.max(d)])
            })
        })
        .collect();
    let [sum, square, max] = sums?
        .iter()
        .fold([0.0; 3], |[s, q, m]: [f64; 3], [sum, square, max]| [s + sum, q + square, m.max(*max)]);
    let mut used = vec![false; from.positions.len()];
    from.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let at_corners = (from.positions.par_iter().zip(&used))
        .filter(|(_, used)| **used)
        .filter_map(|(&p, _)| distance(p))
        .reduce(|| 0.0, f64::max);
    let count = points.len() as f64;
    Some(OneWay { mean: sum / count, rms: (square / count).sqrt(), max: max.max(at_corners) })
}

/// One point for each of `count` strata of equal area; none of a surface without area.
fn stratified(mesh: &Mesh, count: usize) -> Option<Vec<Vec3>> {
    let mut total = 0.0;
    let ends: Vec<f64> = (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
            let area = (b - a).cross(c - a).length();
            total += if area.is_finite() { area } else { 0.0 };
            total
        })
        .collect();
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let point = |k: usize| {
        let at = (k as f64 + 0.5) / count as f64 * total;
        let triangle = ends.partition_point(|&end| end <= at).min(ends.len() - 1);
        spread(mesh.corners(triangle), k)
    };
    Some((0..count).into_par_iter().map(point).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of this side in the plane z, of two triangles.
    fn square(side: f32, z: f32) -> Mesh {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        Mesh {
            positions: corners.iter().map(|&(x, y)| Vec3::new(side * x, side * y, z)).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_materials: vec![0; 2],
            ..Mesh::default()
        }
    }

    /// Protects the unit and the shares: two squares of side 30 that are 6 apart.
    #[test]
    fn parallel_squares_are_as_far_apart_as_they_are() {
        let found =
            surface_distance(&square(30.0, 0.0), &square(30.0, 6.0), DistanceOptions::default()).unwrap();
        for value in [found.chamfer, found.hausdorff, found.rms, found.forward.mean, found.backward.max] {
            assert!((value - 6.0).abs() < 1e-4, "{found:?}");
        }
        assert!((found.diagonal - 30.0 * 2f64.sqrt()).abs() < 1e-4);
        assert!((found.hausdorff_share - 6.0 / found.diagonal).abs() < 1e-6);
        let same =
            surface_distance(&square(30.0, 0.0), &square(30.0, 0.0), DistanceOptions::default()).unwrap();
        assert!(same.hausdorff < 1e-5, "{same:?}");
    }

    /// Protects both ways: all of a small square lies on a large one, of which 3/4 are away from the small one. The
    /// large one's far corner is √2 away; the mean over it is (2 · ∫∫ over the sides + the corner's) / 4, and over
    /// [0, 2]² that is (2 · 1/2 + (√2 + asinh 1) / 3) / 4.
    #[test]
    fn what_is_missing_counts() {
        let found =
            surface_distance(&square(2.0, 0.0), &square(1.0, 0.0), DistanceOptions::default()).unwrap();
        assert!((found.hausdorff - 2f64.sqrt()).abs() < 1e-5 && found.backward.max < 1e-5, "{found:?}");
        let mean = (1.0 + (2f64.sqrt() + 1f64.asinh()) / 3.0) / 4.0;
        assert!((found.forward.mean - mean).abs() < 1e-3, "{found:?} {mean}");
        assert!((found.chamfer - 0.5 * mean).abs() < 1e-3);
    }

    /// Protects small triangles from having no say, and large ones from having too little: samples go by area.
    #[test]
    fn samples_go_by_area() {
        let mut mesh = square(1.0, 0.0);
        // The second triangle becomes nine times the first.
        mesh.positions.extend([Vec3::new(9.0, 0.0, 5.0), Vec3::new(0.0, 1.0, 5.0), Vec3::new(0.0, 0.0, 5.0)]);
        mesh.triangles[1] = [6, 4, 5];
        let points = stratified(&mesh, 1000).unwrap();
        assert_eq!(points.iter().filter(|p| p.z == 0.0).count(), 100);
        let centre = points.iter().filter(|p| p.z == 5.0).sum::<Vec3>() / 900.0;
        assert!((centre - Vec3::new(3.0, 1.0 / 3.0, 5.0)).abs().max_element() < 0.05, "{centre}");
        assert!(stratified(&Mesh::default(), 5).is_none());
        let nothing = surface_distance(&mesh, &Mesh::default(), DistanceOptions::default());
        assert!(nothing.is_none());
    }

    /// Protects figures from depending on the machine: the same bits for 1, 2 and 5 threads.
    #[test]
    fn threads_change_nothing() {
        let (a, b) = (crate::demo_model().mesh, crate::wall_low());
        let of = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| surface_distance(&a, &b, DistanceOptions { samples: 20_000 }))
        };
        let one = of(1);
        assert!(one.is_some() && one == of(2) && one == of(5));
    }
}
