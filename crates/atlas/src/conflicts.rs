//! Which charts lie on each other, or nearer to each other than they may.

use crate::Layout;
use crate::check::box_tree::{Bounds, BoxTree};
use crate::check::gutter::{Segment, squared_distance};
use crate::predicates::{counter_clockwise, positive_triangles_overlap};
use glam::DVec2;
use std::ops::ControlFlow;

/// Pairs of triangles that are enough: a layout with more is packed anew.
pub(crate) const MOST_PAIRS: usize = 400_000;
/// Pairs of boxes to look at.
const MOST_LOOKS: usize = 60_000_000;

/// Pairs of triangles, of one chart or of two, whose interiors meet; the smaller index first, ascending.
/// None where there are too many.
pub(crate) fn overlapping(layout: &Layout) -> Option<Vec<[u32; 2]>> {
    let (indices, corners): (Vec<u32>, Vec<[DVec2; 3]>) = (0..layout.triangles.len())
        .filter(|&t| layout.corners(t).iter().all(|p| p.is_finite()))
        .filter_map(|t| Some((t as u32, counter_clockwise(layout.corners(t))?)))
        .unzip();
    let tree = BoxTree::new(corners.iter().map(|c| (Bounds::of(c), 0)));
    let (mut pairs, mut looks) = (Vec::new(), 0);
    for (i, &a) in corners.iter().enumerate() {
        tree.overlapping(&Bounds::of(&a), |j| {
            looks += 1;
            if j as usize > i && positive_triangles_overlap(a, corners[j as usize]) {
                pairs.push([indices[i], indices[j as usize]]);
            }
            if pairs.len() > MOST_PAIRS || looks > MOST_LOOKS {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        if pairs.len() > MOST_PAIRS || looks > MOST_LOOKS {
            return None;
        }
    }
    pairs.sort_unstable();
    Some(pairs)
}

/// Pairs of triangles of different charts whose outlines are nearer than this, in parts of the square.
pub(crate) fn close(layout: &Layout, gutter: f64) -> Option<Vec<[u32; 2]>> {
    let edges: Vec<(Segment, u32)> =
        layout.boundary().iter().map(|e| (e.points.map(|p| layout.points[p as usize]), e.triangle)).collect();
    let tree =
        BoxTree::new(edges.iter().map(|(s, t)| (Bounds::of(s).grown(gutter), layout.charts[*t as usize])));
    let (mut pairs, mut looks) = (Vec::new(), 0);
    for (i, (segment, t)) in edges.iter().enumerate() {
        tree.overlapping(&Bounds::of(segment).grown(f64::MIN_POSITIVE), |j| {
            looks += 1;
            let (other, o) = edges[j as usize];
            if j as usize > i
                && layout.charts[o as usize] != layout.charts[*t as usize]
                && squared_distance(*segment, other) < gutter * gutter
            {
                pairs.push([*t.min(&o), *t.max(&o)]);
            }
            if looks > MOST_LOOKS { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        if pairs.len() > MOST_PAIRS || looks > MOST_LOOKS {
            return None;
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    Some(pairs)
}
