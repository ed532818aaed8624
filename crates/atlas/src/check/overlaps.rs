//! Which triangles lie on each other, decided exactly, and the covered share.
//!
//! Pairs whose boxes meet come from a [`BoxTree`]; [`predicates`] decides each of them.
//! On a layout where everything lies on everything there are F² / 2 pairs, so the
//! search ends once it has found, or looked at, more than enough; what it says is a
//! lower bound then. It proceeds in blocks of triangles and adds in their order, so
//! where it ends does not depend on the number of threads.

use super::box_tree::{Bounds, BoxTree};
use super::{Overlap, Overlaps};
use crate::{Layout, predicates};
use glam::{DVec2, dvec2};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Triangles between two looks at the limits.
const BLOCK: usize = 256;
/// Pairs that are enough in all, and with one triangle.
const MAX_PAIRS: usize = 1_000_000;
const MAX_PAIRS_OF_ONE: usize = 4_000;
/// Pairs to look at; ordinary layouts need about ten a triangle.
const MAX_LOOKS: usize = 100_000_000;
const MAX_LOOKS_OF_ONE: usize = 1_000_000;
/// Samples along either side of the square, and triangles looked at for one.
const SAMPLES: usize = 512;
const MAX_LOOKS_OF_SAMPLE: usize = 500;

/// The triangles of a layout that have an interior, counter-clockwise, with a tree.
pub(super) struct Interiors {
    indices: Vec<u32>,
    corners: Vec<[DVec2; 3]>,
    tree: BoxTree,
}

/// What one triangle overlaps.
#[derive(Default)]
struct Of {
    pairs: usize,
    looks: usize,
    area: f64,
    cut_short: bool,
    first: Vec<Overlap>,
}

impl Interiors {
    pub(super) fn new(layout: &Layout) -> Self {
        let (indices, corners): (Vec<u32>, Vec<_>) = (0..layout.triangles.len())
            .filter(|&t| layout.corners(t).iter().all(|p| p.is_finite()))
            .filter_map(|t| Some((t as u32, predicates::counter_clockwise(layout.corners(t))?)))
            .unzip();
        let tree = BoxTree::new(corners.iter().map(|c| (Bounds::of(c), 0)));
        Self { indices, corners, tree }
    }

    /// All overlapping pairs, or enough of them.
    pub(super) fn overlaps(&self, texture_size: usize) -> Overlaps {
        let mut found = Overlaps { complete: true, ..Overlaps::default() };
        let texels = (texture_size as f64).powi(2);
        let max_looks = MAX_LOOKS.max(64 * self.corners.len());
        let mut looks = 0;
        for start in (0..self.corners.len()).step_by(BLOCK) {
            let end = (start + BLOCK).min(self.corners.len());
            let block: Vec<Of> = (start..end).into_par_iter().map(|i| self.overlaps_of(i, texels)).collect();
            for of in block {
                found.pairs += of.pairs;
                found.area += of.area;
                found.complete &= !of.cut_short;
                looks += of.looks;
                let room = super::FIRST - found.first.len();
                found.first.extend(of.first.into_iter().take(room));
            }
            if (found.pairs > MAX_PAIRS || looks > max_looks) && end < self.corners.len() {
                found.complete = false;
                break;
            }
        }
        found.texels = found.area * texels;
        found
    }

    /// The overlaps of a triangle with those after it.
    fn overlaps_of(&self, i: usize, texels: f64) -> Of {
        let mut of = Of::default();
        let a = self.corners[i];
        self.tree.overlapping(&Bounds::of(&a), |j| {
            let b = self.corners[j as usize];
            if j as usize <= i {
                return ControlFlow::Continue(());
            }
            of.looks += 1;
            if predicates::positive_triangles_overlap(a, b) {
                // The exact answer counts, even where the rounded area is nothing.
                let (area, place) = predicates::intersection(a, b).unwrap_or((0.0, a[0]));
                of.pairs += 1;
                of.area += area;
                let triangles = [self.indices[i], self.indices[j as usize]];
                of.first.push(Overlap { triangles, place: place.to_array(), texels: area * texels });
                if of.first.len() > 2 * super::FIRST {
                    keep_first(&mut of.first);
                }
            }
            of.cut_short = of.pairs >= MAX_PAIRS_OF_ONE || of.looks >= MAX_LOOKS_OF_ONE;
            if of.cut_short { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        keep_first(&mut of.first);
        of
    }

    /// The sum of all areas.
    pub(super) fn total_area(&self) -> f64 {
        self.corners.iter().fold(0.0, |sum, &[a, b, c]| sum + 0.5 * predicates::orientation(a, b, c))
    }

    /// The share of the square's sample points, one in each of equal cells, that lie in
    /// a triangle.
    pub(super) fn sampled_cover(&self) -> f64 {
        let covered: usize = (0..SAMPLES)
            .into_par_iter()
            .map(|row| (0..SAMPLES).filter(|&column| self.covers(sample(column, row))).count())
            .sum();
        covered as f64 / (SAMPLES * SAMPLES) as f64
    }

    fn covers(&self, p: DVec2) -> bool {
        let (mut covered, mut looks) = (false, 0);
        self.tree.overlapping(&Bounds { low: p, high: p }, |i| {
            let [a, b, c] = self.corners[i as usize];
            covered = [(a, b), (b, c), (c, a)].iter().all(|&(q, r)| (r - q).perp_dot(p - q) >= 0.0);
            looks += 1;
            if covered || looks >= MAX_LOOKS_OF_SAMPLE {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        covered
    }
}

/// Not in the middle of its cell, where many layouts have edges.
fn sample(column: usize, row: usize) -> DVec2 {
    dvec2(column as f64 + 0.49, row as f64 + 0.49) / SAMPLES as f64
}

fn keep_first(overlaps: &mut Vec<Overlap>) {
    overlaps.sort_unstable_by_key(|o| o.triangles);
    overlaps.truncate(super::FIRST);
}
