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
/// Samples along either side of the square, and triangles looked at for one.
const SAMPLES: usize = 512;
const MAX_LOOKS_OF_SAMPLE: usize = 500;

/// Where the search for pairs ends.
struct Limits {
    /// Pairs that are enough in all.
    pairs: usize,
    /// Pairs that are enough with one triangle and those after it.
    pairs_of_one: usize,
    /// Pairs to look at in all.
    looks: usize,
    /// Pairs to look at with one triangle and those after it.
    looks_of_one: usize,
}

impl Limits {
    /// Ordinary layouts need about ten looks a triangle.
    fn for_triangles(count: usize) -> Self {
        let looks = (64 * count).max(100_000_000);
        Self { pairs: 1_000_000, pairs_of_one: 4_000, looks, looks_of_one: 1_000_000 }
    }
}

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
        self.overlaps_within(texture_size, &Limits::for_triangles(self.corners.len()))
    }

    fn overlaps_within(&self, texture_size: usize, limits: &Limits) -> Overlaps {
        let mut found = Overlaps { complete: true, ..Overlaps::default() };
        let texels = (texture_size as f64).powi(2);
        let mut looks = 0;
        for start in (0..self.corners.len()).step_by(BLOCK) {
            let end = (start + BLOCK).min(self.corners.len());
            let block: Vec<Of> =
                (start..end).into_par_iter().map(|i| self.overlaps_of(i, texels, limits)).collect();
            for of in block {
                found.pairs += of.pairs;
                found.area += of.area;
                found.complete &= !of.cut_short;
                looks += of.looks;
                let room = super::FIRST - found.first.len();
                found.first.extend(of.first.into_iter().take(room));
            }
            if (found.pairs > limits.pairs || looks > limits.looks) && end < self.corners.len() {
                found.complete = false;
                break;
            }
        }
        found.texels = found.area * texels;
        found
    }

    /// The overlaps of a triangle with those after it.
    fn overlaps_of(&self, i: usize, texels: f64, limits: &Limits) -> Of {
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
                keep_first(&mut of.first);
            }
            of.cut_short = of.pairs >= limits.pairs_of_one || of.looks >= limits.looks_of_one;
            if of.cut_short { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat2;

    /// A layout of triangles that share no points, each a chart of its own.
    fn interiors(corners: &[[DVec2; 3]]) -> Interiors {
        let count = corners.len();
        Interiors::new(&Layout {
            points: corners.concat(),
            triangles: (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            rest: vec![DMat2::IDENTITY; count],
            charts: (0..count as u32).collect(),
            point_of_vertex: Vec::new(),
        })
    }

    /// A triangle of an area of 1/32, with a box that reaches half as far again.
    const ONE: [DVec2; 3] = [dvec2(0.25, 0.25), dvec2(0.5, 0.25), dvec2(0.25, 0.5)];
    /// In the box of `ONE`, not on it.
    const BESIDE: [DVec2; 3] = [dvec2(0.5, 0.375), dvec2(0.5, 0.5), dvec2(0.375, 0.5)];
    const NO_LIMITS: Limits =
        Limits { pairs: usize::MAX, pairs_of_one: usize::MAX, looks: usize::MAX, looks_of_one: usize::MAX };

    /// Protects the limits of ordinary and of very large layouts.
    #[test]
    fn looks_grow_with_large_layouts() {
        let limits = Limits::for_triangles(1_562_500);
        assert_eq!((limits.pairs, limits.pairs_of_one), (1_000_000, 4_000));
        assert_eq!((limits.looks, limits.looks_of_one), (100_000_000, 1_000_000));
        assert_eq!(Limits::for_triangles(0).looks, 100_000_000);
        assert_eq!(Limits::for_triangles(2_000_000).looks, 128_000_000);
    }

    /// Protects the end of one triangle's search: the pair that reaches a limit is
    /// counted, the search is cut short, and one pair less is a complete search.
    #[test]
    fn one_triangle_s_search_ends_at_its_limits() {
        let heap = interiors(&[ONE; 4]);
        let search = |limits: Limits| {
            let of = heap.overlaps_of(0, 64.0, &limits);
            (of.pairs, of.looks, of.cut_short)
        };
        assert_eq!(search(NO_LIMITS), (3, 3, false));
        assert_eq!(search(Limits { pairs_of_one: 4, ..NO_LIMITS }), (3, 3, false));
        assert_eq!(search(Limits { pairs_of_one: 3, ..NO_LIMITS }), (3, 3, true));
        assert_eq!(search(Limits { pairs_of_one: 2, ..NO_LIMITS }), (2, 2, true));
        assert_eq!(search(Limits { looks_of_one: 4, ..NO_LIMITS }), (3, 3, false));
        assert_eq!(search(Limits { looks_of_one: 3, ..NO_LIMITS }), (3, 3, true));
        assert_eq!(search(Limits { looks_of_one: 2, ..NO_LIMITS }), (2, 2, true));
        // Looks that find nothing count as well.
        let of = interiors(&[ONE, BESIDE]).overlaps_of(0, 64.0, &NO_LIMITS);
        assert_eq!((of.pairs, of.looks, of.area), (0, 1, 0.0));
    }

    /// Protects the end of the whole search: a limit is looked at after each block, has
    /// to be exceeded, and what it leaves out is said; nothing is left out after the
    /// last block.
    #[test]
    fn the_search_ends_after_the_block_that_exceeds_a_limit() {
        // Pairs side by side, each of which overlaps itself alone: a pair for two
        // triangles, 128 for a block.
        let tile = |i: usize| {
            let low = dvec2((i / 2 % 32) as f64, (i / 64) as f64) / 32.0;
            [low, low + dvec2(0.03125, 0.0), low + dvec2(0.0, 0.03125)]
        };
        let tiles = |blocks: usize| interiors(&(0..blocks * BLOCK).map(tile).collect::<Vec<_>>());
        let three = tiles(3);
        let search = |limits: Limits| {
            let found = three.overlaps_within(64, &limits);
            (found.pairs, found.complete)
        };
        assert_eq!(search(NO_LIMITS), (384, true));
        assert_eq!(search(Limits { pairs: 128, ..NO_LIMITS }), (256, false));
        assert_eq!(search(Limits { pairs: 127, ..NO_LIMITS }), (128, false));
        assert_eq!(search(Limits { pairs: 256, ..NO_LIMITS }), (384, true));
        assert_eq!(search(Limits { looks: 128, ..NO_LIMITS }), (256, false));
        assert_eq!(search(Limits { looks: 127, ..NO_LIMITS }), (128, false));
        assert_eq!(search(Limits { looks: 256, ..NO_LIMITS }), (384, true));
        let found = three.overlaps_within(64, &Limits { pairs_of_one: 1, ..NO_LIMITS });
        assert_eq!((found.pairs, found.complete), (384, false));
        // A last block that is not full, with a pair of its own and one across.
        let mut corners: Vec<_> = (0..BLOCK).map(tile).collect();
        corners.extend([tile(BLOCK - 1), tile(BLOCK), tile(BLOCK)]);
        let found = interiors(&corners).overlaps(64);
        assert_eq!((found.pairs, found.complete), (128 + 2 + 1, true));
    }

    /// Protects numbers, areas and order of pairs, of which the first few are named.
    #[test]
    fn the_first_pairs_are_named_in_order() {
        let heap = interiors(&[[ONE; 5].as_slice(), &[BESIDE; 2]].concat());
        let found = heap.overlaps(64);
        let area = 10.0 / 32.0 + 1.0 / 128.0;
        assert_eq!((found.pairs, found.complete), (11, true));
        assert!((found.area - area).abs() < 1e-15 && (found.texels - 4096.0 * area).abs() < 1e-9);
        let triangles: Vec<_> = found.first.iter().map(|o| o.triangles).collect();
        assert_eq!(triangles, [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2]]);
        assert!(found.first.iter().all(|o| (o.texels - 128.0).abs() < 1e-9));
        // Those that the tree finds last come first.
        let small = |i: u32| BESIDE.map(|p| (p - BESIDE[0]) * 0.01 + 0.3 - 0.001 * f64::from(i));
        let found =
            interiors(&[[ONE].as_slice(), &[0, 1, 2, 3, 4, 5, 6, 7].map(small)].concat()).overlaps(64);
        let with_one: Vec<_> = found.first.iter().map(|o| o.triangles).filter(|t| t[0] == 0).collect();
        assert_eq!(with_one, [[0, 1], [0, 2], [0, 3], [0, 4], [0, 5]]);
        let found = interiors(&[BESIDE; 2]).overlaps(64);
        assert_eq!((found.pairs, found.first.len()), (1, 1));
        // Not where the boxes alone meet.
        assert_eq!(
            interiors(&[ONE, BESIDE]).overlaps(64),
            Overlaps { complete: true, ..Overlaps::default() }
        );
    }

    /// Protects the sample points: one in each cell, within it.
    #[test]
    fn samples_lie_in_their_cells() {
        assert_eq!(sample(0, 0), DVec2::splat(0.49 / 512.0));
        assert_eq!(sample(511, 2), dvec2(511.49, 2.49) / 512.0);
    }

    /// Protects the covered share: edges belong to triangles, points in a box of a
    /// triangle and not on it do not, and each point has looks enough for many
    /// triangles around it, but not for any number.
    #[test]
    fn covered_points_are_found_among_many_triangles() {
        let both = interiors(&[ONE, BESIDE]);
        for covered in [dvec2(0.26, 0.26), dvec2(0.3, 0.45), dvec2(0.375, 0.375), dvec2(0.49, 0.49)] {
            assert!(both.covers(covered), "{covered}");
        }
        for free in [dvec2(0.24, 0.3), dvec2(0.3, 0.24), dvec2(0.4, 0.4), dvec2(0.49, 0.37), dvec2(0.6, 0.6)]
        {
            assert!(!both.covers(free), "{free}");
        }
        assert!((both.sampled_cover() - (1.0 / 32.0 + 1.0 / 128.0)).abs() < 5e-4);
        // In the order of the tree, the one that covers comes last.
        let last = |others: usize| {
            let mut corners = vec![ONE; others];
            corners.push(BESIDE);
            let tree = interiors(&corners);
            let mut order = Vec::new();
            let p = dvec2(0.49, 0.49);
            tree.tree.overlapping(&Bounds { low: p, high: p }, |i| {
                order.push(i as usize);
                ControlFlow::Continue(())
            });
            (order.iter().position(|&i| i == others).unwrap(), tree.covers(p))
        };
        let (place, covered) = last(400);
        assert!(place < MAX_LOOKS_OF_SAMPLE && covered, "{place}");
        let (place, covered) = last(2_000);
        assert!(place >= MAX_LOOKS_OF_SAMPLE && !covered, "{place}");
    }
}
