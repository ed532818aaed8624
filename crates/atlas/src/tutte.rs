//! Tutte's embedding ("How to Draw a Graph", 1963; with weights: Floater 1997): the
//! boundary of a disk on a convex curve, every other point in the weighted mean of its
//! neighbours. No triangle is mirrored and none overlap, whatever the mesh.
//!
//! What is no disk is cut into one: the triangles are joined along a spanning tree of
//! their neighbourhoods, and of the edges that are left those that end nowhere are
//! joined as well (tree and cotree; Erickson and Har-Peled 2004). Of a closed sphere a
//! path of two edges stays cut.

mod disk;
mod solve;

use crate::unwrap::corners::{Corners, NONE, Surface};
use crate::unwrap::sound::settled;
use crate::{AtlasError, ChartScale, PackOptions, UnwrappedMesh};
use disk::{Disk, disks};
use glam::{DVec2, dvec2};
use parbake_model::Mesh;

/// The curve on which the boundary is laid, by its length in space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TutteBoundary {
    /// A circle.
    #[default]
    Circle,
    /// A square whose sides bulge by a fiftieth, because triangles with all corners on
    /// a straight side would have no area.
    Square,
}

/// How much a neighbour counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TutteWeights {
    /// All alike, as in Tutte's paper.
    #[default]
    Uniform,
    /// By the edge's length in space: the nearer, the more.
    InverseLength,
}

/// What [`tutte()`] aims at.
#[derive(Clone, Debug, PartialEq)]
pub struct TutteOptions {
    /// The boundary's curve.
    pub boundary: TutteBoundary,
    /// The neighbours' weights.
    pub weights: TutteWeights,
    /// Whether what is no disk may be cut into one.
    pub cut: bool,
    /// Whether the result is drawn in the middle, in [0.25, 0.75]², with room around it;
    /// else it fills the square.
    pub in_the_middle: bool,
    /// Texture size, gutter and packing of several pieces, each as large as its surface.
    pub pack: PackOptions,
}

impl Default for TutteOptions {
    fn default() -> Self {
        Self {
            boundary: TutteBoundary::default(),
            weights: TutteWeights::default(),
            cut: true,
            in_the_middle: false,
            pack: PackOptions::default(),
        }
    }
}

/// Lays out each connected piece of a mesh by Tutte's embedding.
///
/// Pieces are connected along edges that two triangles share, running opposite ways; all
/// other edges are boundaries. Triangles that come out too small for 32-bit numbers are
/// cut out and packed by themselves, so that the result is sound in any case.
///
/// # Errors
///
/// [`AtlasError::NotADisk`] where a piece would have to be cut and may not, else as
/// [`crate::unwrap()`].
pub fn tutte(mesh: &Mesh, options: &TutteOptions) -> Result<UnwrappedMesh, AtlasError> {
    let surface = Surface::new(mesh);
    let count = mesh.triangles.len();
    let mut corners = Corners { uv: vec![[DVec2::ZERO; 3]; count], chart: vec![NONE; count], next: 0 };
    for disk in disks(&surface, options.cut)? {
        let points = embedded(&disk, options);
        let area: f64 = disk.triangles.iter().map(|&t| surface.delivered.rest_area(t as usize)).sum();
        for (&t, ids) in disk.triangles.iter().zip(&disk.points) {
            corners.uv[t as usize] = ids.map(|p| points[p as usize] * area.sqrt());
            corners.chart[t as usize] = corners.next;
        }
        corners.next += 1;
    }
    // What is drawn half as large keeps half of its gutters.
    let shrunk = if options.in_the_middle { 2.0 } else { 1.0 };
    let gutter_texels = shrunk * options.pack.gutter_texels;
    let pack = PackOptions { chart_scale: ChartScale::Keep, gutter_texels, ..options.pack.clone() };
    let mut corners = settled(&surface, corners, &pack)?;
    if options.in_the_middle {
        // Halving is exact; adding a quarter may round once more.
        corners.uv.iter_mut().flatten().for_each(|p| *p = *p * 0.5 + 0.25);
        let mesh = surface.mesh_with(&corners).0;
        let check = crate::check(&crate::Layout::new(&mesh), options.pack.texture_size);
        if !check.is_bijective() {
            let triangles = check.orientations.degenerate.count + check.orientations.flipped.count;
            return Err(AtlasError::Unsound { triangles });
        }
    }
    let (mesh, source) = surface.mesh_with(&corners);
    Ok(UnwrappedMesh { mesh, source })
}

/// Places for a disk's points.
fn embedded(disk: &Disk, options: &TutteOptions) -> Vec<DVec2> {
    let mut fixed = vec![None; disk.positions.len()];
    let length = |i: usize| {
        let [a, b] = [disk.boundary[i], disk.boundary[(i + 1) % disk.boundary.len()]];
        disk.positions[a as usize].distance(disk.positions[b as usize])
    };
    let lengths: Vec<f64> = (0..disk.boundary.len()).map(length).collect();
    let total: f64 = lengths.iter().sum();
    // No step so short that its ends fall together.
    let least = 1e-3 / lengths.len() as f64;
    let steps: Vec<f64> = lengths.iter().map(|l| if total > 0.0 { l / total } else { 0.0 } + least).collect();
    let total: f64 = steps.iter().sum();
    let mut at = 0.0;
    for (&p, step) in disk.boundary.iter().zip(&steps) {
        let circle = DVec2::from_angle(std::f64::consts::TAU * at / total);
        fixed[p as usize] = Some(match options.boundary {
            TutteBoundary::Circle => circle,
            TutteBoundary::Square => {
                let square = on_square(at / total);
                let bulge = dvec2(1.0 - square.y * square.y, 1.0 - square.x * square.x) * square;
                square + bulge * 0.02
            }
        });
        at += step;
    }
    let weight = |a: u32, b: u32| match options.weights {
        TutteWeights::Uniform => 1.0,
        TutteWeights::InverseLength => {
            let length = disk.positions[a as usize].distance(disk.positions[b as usize]);
            1.0 / length.max(1e-3 * disk.mean_edge)
        }
    };
    solve::balanced(&disk.points, &fixed, weight)
}

/// The point of the square [−1, 1]² a share of the way around, counter-clockwise.
fn on_square(share: f64) -> DVec2 {
    let side = (share * 4.0).min(4.0 - 1e-12);
    let along = side.fract() * 2.0 - 1.0;
    match side as u32 {
        0 => dvec2(along, -1.0),
        1 => dvec2(1.0, along),
        2 => dvec2(-along, 1.0),
        _ => dvec2(-1.0, -along),
    }
}
