//! The triangles of a coarse mesh: surfaces to begin with are collapsed to the wanted number, the best of them by its
//! pictures is polished.
//!
//! ```text
//! high-poly ─ targets (depth, contrast, outline of many views) ───────┬───────────────┐
//!    └ starts (start.rs), the level before ─ surface ─ collapse.rs ─ error ─ best ─ polish.rs ─ mesh
//! ```
//!
//! Few triangles are chosen several times, each time from other views: where a search of single changes ends is a matter of luck.
//! Which of them is best, only a bake can tell: with a texture others win than without one.
//!
//! What is opaque, cut out, blended or transmits light are layers (`views/alpha_layers.rs`), and each is chosen by
//! itself: through glass one sees what is behind it, so that nothing of it is hidden. Layers share the triangles as
//! edge collapses of the whole model share them.
//!
//! Contract: the result lies in the high-poly's common frame, has at most the wanted number of triangles (but one at
//! least in each layer, and in each part what that has to keep), smooth normals and no texture coordinates; its materials are the high-poly's by index. It
//! depends on the arguments alone, not on the number of threads, unless the watcher has no seconds left: then polishing
//! ends early, but collapsing goes on down to the wanted number. Where the watcher says stop, quadrics alone take away what is too much.

use crate::at_once::collapsed_at_once;
use crate::collapse::collapse_to;
use crate::creases::with_normals;
use crate::pictures::Pictures;
use crate::polish::{PolishOptions, is_over, polish};
use crate::shares::shares;
use crate::start::{CoarseSurfaces, Start, counts_of_parts, with_lost_parts};
use crate::surface::Surface;
use crate::target::{BACKGROUNDS, EQUAL, Target};
use parbake_model::Mesh;
use parbake_progress::{Portion, Showing, Snapshot, Stage, Watcher};
use parbake_views::alpha_layers::{LayerKind, high_layers};
use parbake_views::high_poly::HighPoly;
use parbake_views::pool::{View, view_pool};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How triangles are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChooseOptions {
    /// Triangles of the result, at most.
    pub triangles: usize,
    /// Triangles that each part keeps at least, if it has as many; 0 where parts may go. All of them have to fit in
    /// ([`least_triangles`]).
    pub least: usize,
    /// Triangles of a start for each that is wanted, 1 or more: those that are too many collapse by the pictures.
    pub room: usize,
    /// Views that errors are measured in.
    pub views: usize,
    /// Sets of so many views that points are moved by in turn, 1 or more. With one alone they come to lie where its
    /// pixels do not see what is wrong.
    pub sets: usize,
    /// Times that collapsing and polishing are done, each time from another one of the sets, 1 to `sets`. They are ordered by
    /// their errors in views that none was fitted to.
    pub attempts: usize,
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
    /// Mean squared display error of its pictures as far as it can be told without a texture, all backgrounds alike.
    pub error: f64,
}

/// How the triangles of a layer were found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerReport {
    /// Triangles.
    pub triangles: usize,
    /// All starts that were tried, by each attempt; the first is the one that it has.
    pub starts: Vec<StartReport>,
    /// Mean squared display error of its pictures before and after polishing, each background weighed by the
    /// reciprocal of its own error.
    pub error: [f64; 2],
}

/// What was chosen.
#[derive(Clone, Debug, Default)]
pub struct Chosen {
    /// In the common frame.
    pub mesh: Mesh,
    /// In the order in which layers are drawn.
    pub layers: Vec<LayerReport>,
}

/// Share of the time that collapsing two starts takes, about; the rest is polishing.
const COLLAPSING: f64 = 0.4;

/// Views that tell one collapse from another well enough.
const FEW: usize = 24;

/// Views that attempts are compared in.
const JUDGES: usize = 96;

/// Chooses the triangles; `before` is the level before in the common frame, if there is one. `coarse` is of the
/// high-poly's mesh; its parts are those that move by themselves, and no triangle of the result lies on two. Where there
/// is one layer, all attempts are returned, that first whose pictures without a texture show most; else one, of the best of each layer.
/// Never empty.
pub fn choose_triangles(
    high: &HighPoly,
    before: Option<&Mesh>,
    coarse: &CoarseSurfaces,
    options: &ChooseOptions,
    watcher: &dyn Watcher,
) -> Vec<Chosen> {
    let (mesh, parts) = (high.scene.mesh(), &coarse.parts[..]);
    let start = coarse.collapsed_to(options.room * options.triangles);
    let whole = |start: Mesh, own: &Mesh| with_lost_parts(start, own, parts, options.least);
    let layers = high_layers(high);
    let mut chosen = Chosen::default();
    if let [_] = layers[..] {
        let start = whole(start, mesh);
        let starts = [Some((Start::Quadrics, start)), before.map(|mesh| (Start::Level, mesh.clone()))];
        let attempts = layer(high, None, parts, starts, options, watcher);
        return attempts.into_iter().map(|own| Chosen::of_one_layer(own, high)).collect();
    }
    let kind_of_material = kinds_of_materials(high, &layers);
    let own = |mesh: &Mesh, kind: usize| of_kind(mesh, kind, &kind_of_material);
    let begun: Vec<usize> = (0..layers.len()).map(|kind| own(&start, kind).triangles.len()).collect();
    let floors: Vec<usize> =
        (0..layers.len()).map(|kind| least_of(&own(mesh, kind), parts, options.least).max(1)).collect();
    let shares = shares(options.triangles, &begun, &floors);
    for (kind, (_, triangles)) in layers.iter().enumerate() {
        let start = own(&start, kind);
        let options = ChooseOptions { triangles: shares[kind], ..*options };
        // A layer of which edge collapses left nothing begins as it is.
        let start = if start.triangles.is_empty() { own(mesh, kind) } else { whole(start, &own(mesh, kind)) };
        let starts = [Some((Start::Quadrics, start)), before.map(|mesh| (Start::Level, own(mesh, kind)))];
        let part = |k: usize| k as f64 / layers.len() as f64;
        let own = Portion::new(watcher, part(kind)..part(kind + 1));
        let own = Showing::new(&own, |snapshot| Some(joined(&chosen.mesh, snapshot)));
        let found = layer(high, Some(triangles), parts, starts, &options, &own);
        found.into_iter().take(1).for_each(|best| chosen.add(best, high));
    }
    vec![chosen]
}

/// A layer that is being chosen beside those that are.
fn joined(chosen: &Mesh, snapshot: Snapshot) -> Snapshot {
    let Snapshot::Surface { mut mesh, color } = snapshot else { return snapshot };
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&chosen.positions);
    mesh.triangles.extend(chosen.triangles.iter().map(|t| t.map(|v| v + first)));
    mesh.triangle_materials.resize(mesh.triangles.len(), 0);
    mesh.normals.clear();
    Snapshot::Surface { mesh, color }
}

/// How many triangles there have to be where each part keeps `least`, or all that it has, in each layer.
pub fn least_triangles(high: &HighPoly, parts: &[u32], least: usize) -> usize {
    let (mesh, layers) = (high.scene.mesh(), high_layers(high));
    let kind_of_material = kinds_of_materials(high, &layers);
    let own = |kind| of_kind(mesh, kind, &kind_of_material);
    (0..layers.len()).map(|kind| least_of(&own(kind), parts, least).max(1)).sum()
}

/// What all parts of a mesh have to keep.
fn least_of(mesh: &Mesh, parts: &[u32], least: usize) -> usize {
    counts_of_parts(mesh, parts).values().map(|&count| count.min(least)).sum()
}

/// For each material the place of its layer; that of the first for one that no triangle has.
fn kinds_of_materials(high: &HighPoly, layers: &[(LayerKind, Vec<u32>)]) -> Vec<usize> {
    let materials = &high.scene.mesh().triangle_materials;
    let mut kinds = vec![0; materials.iter().max().map_or(0, |&last| last as usize + 1)];
    for (kind, (_, triangles)) in layers.iter().enumerate() {
        triangles.iter().for_each(|&t| kinds[materials[t as usize] as usize] = kind);
    }
    kinds
}

/// The triangles of a mesh whose materials are of this kind.
fn of_kind(mesh: &Mesh, kind: usize, kind_of_material: &[usize]) -> Mesh {
    let triangles = mesh.triangles.iter().zip(&mesh.triangle_materials);
    let own = triangles.filter(|(_, material)| kind_of_material.get(**material as usize) == Some(&kind));
    let (triangles, triangle_materials) = own.unzip();
    Mesh { positions: mesh.positions.clone(), triangles, triangle_materials, ..Mesh::default() }
}

impl Chosen {
    fn of_one_layer(own: (Mesh, LayerReport), high: &HighPoly) -> Self {
        let mut chosen = Self::default();
        chosen.add(own, high);
        chosen
    }

    fn add(&mut self, (mesh, report): (Mesh, LayerReport), high: &HighPoly) {
        let first = self.mesh.positions.len() as u32;
        // Smooth within the layer alone: a pane does not bend with its frame.
        let mesh = with_normals(&mesh, high);
        self.mesh.normals.extend(mesh.normals);
        self.mesh.positions.extend(mesh.positions);
        self.mesh.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
        self.mesh.triangle_materials.extend(mesh.triangle_materials);
        self.layers.push(report);
    }
}

/// Chooses the triangles of one layer, the high-poly's `triangles`, or of all: all attempts, the best first.
fn layer(
    high: &HighPoly,
    triangles: Option<&[u32]>,
    parts: &[u32],
    starts: [Option<(Start, Mesh)>; 2],
    options: &ChooseOptions,
    watcher: &dyn Watcher,
) -> Vec<(Mesh, LayerReport)> {
    let target = |view: &View| Target::new(high, triangles, view.camera, options.view_size);
    let set = |views: usize, seed: u64| -> Vec<Target> {
        view_pool(views, &high.conventions.rig, seed).par_iter().map(target).collect()
    };
    let mut sets: Vec<Vec<Target>> =
        (0..options.sets.max(1) as u64).map(|index| set(options.views, options.seed + index)).collect();
    let attempts = options.attempts.clamp(1, sets.len());
    let mut judges = if attempts > 1 { set(JUDGES, options.seed + options.sets as u64) } else { Vec::new() };
    let starts: Vec<(Start, Surface)> = (starts.into_iter().flatten())
        .filter(|(_, mesh)| !mesh.triangles.is_empty())
        .map(|(start, mesh)| {
            let mut surface = Surface::in_parts(&mesh, parts);
            surface.keep_of_each_part(options.least);
            (start, surface)
        })
        .collect();
    let mut tried: Vec<Attempt> = Vec::new();
    for first in 0..attempts {
        if !tried.is_empty() && is_over(watcher) {
            break;
        }
        let part = |k: f64| (first as f64 + k) / attempts as f64;
        let whole = &Portion::new(watcher, part(0.0)..part(1.0));
        sets.iter_mut().for_each(|set| weigh(set, EQUAL));
        let (reports, mut surface) = collapsed(&sets[first], &starts, options.triangles, whole);
        if !tried.is_empty() && is_over(watcher) {
            // It may have too many triangles still.
            break;
        }
        if surface.count() > options.triangles && watcher.stopped() {
            let few = collapsed_at_once(&surface.to_mesh(), options.triangles, parts, options.least);
            surface = Surface::in_parts(&few, parts);
        }
        // Its own: what is alike ends alike, and the more attempts differ, the better is the best of them.
        let weights = reciprocal_errors(&mut sets[0], &surface);
        sets.iter_mut().for_each(|set| weigh(set, weights));
        if tried.is_empty() {
            weigh(&mut judges, weights);
        }
        let mut pictures = Pictures::new(&sets[first], surface);
        let before = pictures.error();
        polish(&mut pictures, &sets, first, high, &options.polish, &Portion::new(whole, COLLAPSING..1.0));
        pictures.look_from(&sets[first]);
        let error = [before, pictures.error()];
        let judged = Pictures::new(&judges, pictures.surface.clone()).error();
        tried.push(Attempt { surface: pictures.surface, reports, error, judged });
    }
    watcher.progress(Stage::Simplify, 1, 1);
    tried.sort_by(|a, b| a.judged.total_cmp(&b.judged));
    (0..tried.len()).map(|own| finished(&tried, own)).collect()
}

/// An attempt with its report, which tells first what it began with.
fn finished(tried: &[Attempt], own: usize) -> (Mesh, LayerReport) {
    let Attempt { surface, error, .. } = &tried[own];
    let others = (0..tried.len()).filter(|&other| other != own);
    let starts = std::iter::once(own).chain(others).flat_map(|k| tried[k].reports.clone()).collect();
    let mesh = surface.to_mesh();
    let report = LayerReport { triangles: mesh.triangles.len(), starts, error: *error };
    (mesh, report)
}

/// A polished surface.
struct Attempt {
    surface: Surface,
    /// What it started from first.
    reports: Vec<StartReport>,
    /// Before and after polishing, in the first of its views.
    error: [f64; 2],
    /// In views that no attempt was fitted to.
    judged: f64,
}

/// The starts with so many triangles: what is told of each, the best first, and the surface of that one.
fn collapsed(
    targets: &[Target],
    starts: &[(Start, Surface)],
    triangles: usize,
    watcher: &dyn Watcher,
) -> (Vec<StartReport>, Surface) {
    let mut tried: Vec<(StartReport, Surface)> = Vec::new();
    for (k, (start, surface)) in starts.iter().enumerate() {
        let begun = |k: usize| 0.5 * COLLAPSING * k as f64;
        let watcher = &Portion::new(watcher, begun(k)..begun(k + 1));
        let mut pictures = Pictures::new(&targets[..targets.len().min(FEW)], surface.clone());
        collapse_to(&mut pictures, triangles, watcher);
        let (triangles, error) = (pictures.surface.count(), pictures.error());
        tried.push((StartReport { start: *start, triangles, error }, pictures.surface));
    }
    tried.sort_by(|a, b| a.0.error.total_cmp(&b.0.error));
    let (reports, surfaces): (Vec<_>, Vec<_>) = tried.into_iter().unzip();
    (reports, surfaces.into_iter().next().unwrap_or_default())
}

/// Weights of backgrounds by the reciprocals of a surface's errors: as people count in decibels, a tenth less is as much on
/// one as on another.
fn reciprocal_errors(targets: &mut [Target], surface: &Surface) -> [f32; BACKGROUNDS.len()] {
    let errors: [f64; BACKGROUNDS.len()] = std::array::from_fn(|background| {
        let mut only = [0.0; BACKGROUNDS.len()];
        only[background] = 1.0;
        weigh(targets, only);
        Pictures::new(targets, surface.clone()).error().max(1e-9)
    });
    let sum: f64 = errors.iter().map(|error| 1.0 / error).sum();
    errors.map(|error| (1.0 / error / sum) as f32)
}

/// Lets backgrounds count so much.
fn weigh(targets: &mut [Target], weights: [f32; BACKGROUNDS.len()]) {
    targets.par_iter_mut().for_each(|target| target.weigh(weights));
}
