//! The triangles of a coarse mesh: starts are collapsed to the wanted number, the best of them by its pictures is
//! polished.
//!
//! ```text
//! high-poly ─ targets (depth, contrast, outline of many views) ───────┬───────────────┐
//!    └ starts (start.rs), the level before ─ surface ─ collapse.rs ─ error ─ best ─ polish.rs ─ mesh
//! ```
//!
//! Contract: the result lies in the high-poly's common frame, has at most the wanted number of triangles, smooth
//! normals and no texture coordinates. It depends on the arguments alone, not on the number of threads.

use crate::collapse::collapse_to;
use crate::pictures::Pictures;
use crate::polish::{PolishOptions, polish};
use crate::start::{Start, quadrics};
use crate::surface::Surface;
use crate::target::{BACKGROUNDS, Target};
use parbake_mesh::smooth_normals;
use parbake_model::Mesh;
use parbake_progress::Watcher;
use parbake_views::high_poly::HighPoly;
use parbake_views::pool::view_pool;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How triangles are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChooseOptions {
    /// Triangles of the result, at most.
    pub triangles: usize,
    /// Triangles of a start for each that is wanted, 1 or more: those that are too many collapse by the pictures.
    pub room: usize,
    /// Views that errors are measured in.
    pub views: usize,
    /// Side of a view in pixels.
    pub view_size: usize,
    /// What is done with the best start.
    pub polish: PolishOptions,
    /// Random seed of the views.
    pub seed: u64,
}

/// How a start did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StartReport {
    /// Which.
    pub start: Start,
    /// Triangles it came to.
    pub triangles: usize,
    /// Mean squared display error of its pictures, as far as it can be told without a texture.
    pub error: f64,
}

/// What was chosen.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// In the common frame.
    pub mesh: Mesh,
    /// All starts that were tried; the first is the one that was taken.
    pub starts: Vec<StartReport>,
    /// The error after polishing.
    pub error: f64,
}

/// Views that tell one collapse from another well enough.
const FEW: usize = 24;
/// Chooses the triangles; `before` is the level before, if there is one.
pub fn choose_triangles(
    high: &HighPoly,
    before: Option<&Mesh>,
    options: &ChooseOptions,
    watcher: &impl Watcher,
) -> Chosen {
    let cameras = view_pool(options.views, &high.conventions.rig, options.seed);
    let mut targets: Vec<Target> =
        cameras.par_iter().map(|view| Target::new(high, None, view.camera, options.view_size)).collect();
    let mesh = high.scene.mesh();
    let mut starts: Vec<(Start, Mesh)> =
        vec![(Start::Quadrics, quadrics(mesh, options.room * options.triangles))];
    starts.extend(before.map(|mesh| (Start::Level, mesh.clone())));
    let mut tried: Vec<(StartReport, Surface)> = Vec::new();
    for (start, mesh) in starts {
        let mut pictures = Pictures::new(&targets[..targets.len().min(FEW)], Surface::new(&mesh));
        collapse_to(&mut pictures, options.triangles, watcher);
        let report = StartReport { start, triangles: pictures.surface.count(), error: pictures.error() };
        tried.push((report, pictures.surface));
    }
    tried.sort_by(|a, b| a.0.error.total_cmp(&b.0.error));
    let reports = tried.iter().map(|(report, _)| *report).collect();
    let surface = tried.swap_remove(0).1;
    weigh_backgrounds(&mut targets, &surface);
    let mut pictures = Pictures::new(&targets, surface);
    polish(&mut pictures, high, &options.polish, watcher);
    let mut mesh = pictures.surface.to_mesh();
    mesh.normals = smooth_normals(&mesh);
    Chosen { mesh, starts: reports, error: pictures.error() }
}

/// Lets backgrounds count by the reciprocals of their errors: as people count in decibels, a tenth less is as much on
/// one as on another.
fn weigh_backgrounds(targets: &mut [Target], surface: &Surface) {
    let mut weights = [0.0; BACKGROUNDS.len()];
    for background in 0..weights.len() {
        let mut only = [0.0; BACKGROUNDS.len()];
        only[background] = 1.0;
        targets.par_iter_mut().for_each(|target| target.weigh(only));
        weights[background] = 1.0 / Pictures::new(targets, surface.clone()).error().max(1e-9);
    }
    let sum: f64 = weights.iter().sum();
    let weights = weights.map(|weight| (weight / sum) as f32);
    targets.par_iter_mut().for_each(|target| target.weigh(weights));
}
