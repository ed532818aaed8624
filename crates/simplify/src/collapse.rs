//! Fewer triangles: the change that costs least in the pictures, again and again (Lindstrom and Turk, "Image-Driven
//! Simplification", 2000, with errors that need no texture, `target.rs`).
//!
//! An edge may collapse into either end, its middle, or the point that keeps the planes around it best (Lindstrom
//! and Turk's memoryless quadrics, 1998). A part of a few triangles may also go as a whole. What is compared is the
//! growth of the error for each triangle that is saved, plus a little for triangles that would become long, so that
//! even surfaces, which cost nothing, stay well shaped.
//!
//! Costs go stale as their surroundings change. They are evaluated again when their turn comes (a lazy queue),
//! several at once on all cores.
//!
//! Contract: deterministic; no part loses the triangles that it has to keep (`surface.rs`), nor
//! its span unless nothing else can go; ends at the wanted number of triangles or one less; at fewer where only whole parts can
//! go, at more only where nothing can.

use crate::change::Change;
use crate::pictures::Pictures;
use crate::surface::Surface;
use glam::{DMat3, DVec3, Vec3};
use parbake_mesh::union_find::UnionFind;
use parbake_progress::{Stage, Watcher};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Evaluations at once.
const BATCH: usize = 16;
/// Parts of at most so many triangles may go as a whole.
const SMALL_PART: usize = 16;
/// The error that a squared length of 1 in the common frame is worth where pictures do not tell.
const LENGTH: f64 = 1e-7;

/// What may be done.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Candidate {
    Edge([u32; 2]),
    Part(u32),
}

/// A candidate in the queue; the greatest is the one that costs least.
struct Entry {
    cost: f64,
    candidate: Candidate,
    /// Of its surroundings when it was evaluated.
    version: u64,
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Entry {}
impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then_with(|| other.candidate.cmp(&self.candidate))
    }
}

/// A point of each part of a surface, ascending.
fn parts(surface: &Surface) -> Vec<u32> {
    let mut sets = UnionFind::new(surface.points.len());
    for (_, triangle) in surface.triangles() {
        let [a, b, c] = triangle.corners;
        sets.union(a, b);
        sets.union(b, c);
    }
    let is_first = |point: &u32| !surface.around(*point).is_empty() && sets.find(*point) == *point;
    (0..surface.points.len() as u32).filter(is_first).collect()
}

/// The triangles that hang together with this point, ascending, if they are few.
fn small_part(surface: &Surface, point: u32) -> Option<Vec<u32>> {
    let mut triangles: Vec<u32> = Vec::new();
    let mut points = vec![point];
    let mut next = 0;
    while next < points.len() {
        for &index in surface.around(points[next]) {
            if !triangles.contains(&index) {
                triangles.push(index);
                if triangles.len() > SMALL_PART {
                    return None;
                }
                let corners = surface.get(index)?.corners;
                points.extend(corners.into_iter().filter(|c| !points.contains(c)).collect::<Vec<_>>());
            }
        }
        next += 1;
    }
    triangles.sort_unstable();
    (!triangles.is_empty()).then_some(triangles)
}

/// Collapses until `target` triangles are left, or nothing can go any more, or the watcher says stop.
pub fn collapse_to(pictures: &mut Pictures, target: usize, watcher: &dyn Watcher) {
    let start = pictures.surface.count();
    if start <= target {
        return;
    }
    let mut versions = vec![0u64; pictures.surface.points.len()];
    let mut queue: BinaryHeap<Entry> =
        evaluate(pictures, candidates(&pictures.surface), &versions).into_iter().collect();
    // Parts with which more would go than is asked for; they go if nothing else can.
    let mut too_large: Vec<Candidate> = Vec::new();
    while pictures.surface.count() > target && !watcher.stopped() {
        let Some(top) = queue.pop() else {
            let Some(part) = too_large.pop() else {
                if !pictures.surface.forget_spans() {
                    break;
                }
                queue.extend(evaluate(pictures, candidates(&pictures.surface), &versions));
                continue;
            };
            if let Some((_, change)) = pictures.best_of(ways(&pictures.surface, &part)) {
                pictures.apply(&change);
            }
            continue;
        };
        if version(&pictures.surface, &top.candidate, &versions) == top.version {
            let ways = ways(&pictures.surface, &top.candidate);
            let Some((_, change)) = pictures.best_of(ways) else { continue };
            let excess = pictures.surface.count() - target;
            if change.added.is_empty() && change.removed.len() > excess + 1 {
                too_large.push(top.candidate);
                continue;
            }
            for point in
                change.removed.iter().filter_map(|&t| pictures.surface.get(t)).flat_map(|t| t.corners)
            {
                versions[point as usize] += 1;
            }
            let moved = change.moved;
            pictures.apply(&change);
            watcher.progress(Stage::Simplify, start - pictures.surface.count(), start - target);
            // Edges that are new: those of the point that stayed.
            if let Some((point, _)) = moved {
                let fresh = pictures.surface.neighbours(point).into_iter();
                let mut fresh: Vec<Candidate> =
                    fresh.map(|other| Candidate::Edge([point.min(other), point.max(other)])).collect();
                if small_part(&pictures.surface, point).is_some() {
                    fresh.push(Candidate::Part(point));
                }
                queue.extend(evaluate(pictures, fresh, &versions));
            }
            continue;
        }
        let mut stale = vec![top.candidate];
        while stale.len() < BATCH {
            let is_stale = |e: &Entry| version(&pictures.surface, &e.candidate, &versions) != e.version;
            match queue.peek().filter(|e| is_stale(e)) {
                Some(_) => stale.extend(queue.pop().map(|entry| entry.candidate)),
                None => break,
            }
        }
        stale.sort_unstable();
        stale.dedup();
        queue.extend(evaluate(pictures, stale, &versions));
    }
}

fn candidates(surface: &Surface) -> Vec<Candidate> {
    let edges = surface.edges().into_iter().map(Candidate::Edge);
    let parts = parts(surface).into_iter().filter(|&part| small_part(surface, part).is_some());
    edges.chain(parts.map(Candidate::Part)).collect()
}

/// Changes whenever a triangle around the candidate does.
fn version(surface: &Surface, candidate: &Candidate, versions: &[u64]) -> u64 {
    match candidate {
        Candidate::Edge([a, b]) => versions[*a as usize] + versions[*b as usize],
        Candidate::Part(point) => {
            let triangles = small_part(surface, *point).unwrap_or_default();
            let corners = triangles.iter().filter_map(|&t| surface.get(t)).flat_map(|t| t.corners);
            corners.map(|point| versions[point as usize]).sum()
        }
    }
}

/// Those that can be done, with what they cost.
fn evaluate(pictures: &Pictures, candidates: Vec<Candidate>, versions: &[u64]) -> Vec<Entry> {
    let surface = &pictures.surface;
    let best = pictures.best_of_each(candidates.par_iter().map(|own| ways(surface, own)).collect());
    let entry = |(candidate, best): (Candidate, Option<(f64, Change)>)| {
        let (gain, change) = best?;
        let cost = cost(surface, gain, &change);
        let version = version(surface, &candidate, versions);
        Some(Entry { cost, candidate, version })
    };
    candidates.into_iter().zip(best).filter_map(entry).collect()
}

/// The ways to do it.
fn ways(surface: &Surface, candidate: &Candidate) -> Vec<Change> {
    let mut changes: Vec<Change> = match candidate {
        Candidate::Part(point) => small_part(surface, *point).map(Change::removal).into_iter().collect(),
        Candidate::Edge([a, b]) => {
            let places = places(surface, *a, *b);
            places.into_iter().filter_map(|place| Change::collapse(surface, *b, *a, place)).collect()
        }
    };
    changes.retain(|change| change.saved() > 0 && surface.may(change));
    changes
}

/// What a change costs for each triangle that is saved.
fn cost(surface: &Surface, gain: f64, change: &Change) -> f64 {
    let lengths: f64 = change.added.iter().map(|t| squared_sides(surface.corners_after(change, t))).sum();
    (LENGTH * lengths - gain) / change.saved() as f64
}

fn squared_sides([a, b, c]: [Vec3; 3]) -> f64 {
    f64::from((b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared())
}

/// Where the point of a collapsed edge may lie.
fn places(surface: &Surface, a: u32, b: u32) -> Vec<Vec3> {
    let (at_a, at_b) = (surface.points[a as usize], surface.points[b as usize]);
    let middle = 0.5 * (at_a + at_b);
    let mut places = vec![at_a, at_b, middle];
    let planes = surface.around(a).iter().chain(surface.around(b)).filter_map(|&t| surface.get(t));
    let best = least_squares(planes.map(|t| surface.corners(t.corners)), middle);
    let reach = at_a.distance(at_b);
    places.extend(best.filter(|p| p.distance(middle) < 1.5 * reach));
    places
}

/// The point nearest to the planes of triangles, weighed by their areas, and a little to `middle`.
pub fn least_squares(triangles: impl Iterator<Item = [Vec3; 3]>, middle: Vec3) -> Option<Vec3> {
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    let origin = middle.as_dvec3();
    for corners in triangles {
        let [p, q, r] = corners.map(|corner| corner.as_dvec3() - origin);
        let normal = (q - p).cross(r - p);
        matrix += DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        right += normal * normal.dot(p);
    }
    let trace = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
    matrix += DMat3::from_diagonal(DVec3::splat(3e-3 * trace));
    let at = matrix.inverse() * right;
    (trace > 0.0 && at.is_finite()).then(|| (at + origin).as_vec3())
}
