//! How far charts keep from each other and from the border of the square.
//!
//! A chart ends at its boundary edges, so the distance between two charts that do not
//! overlap is the smallest one between boundary edges of the one and of the other.
//! Triangles that have an area neither in space nor in the texture show nothing and
//! have no boundary: files have them by the thousand, each collapsed onto some chart.

use super::Gutter;
use super::box_tree::{Bounds, BoxTree, Nearest};
use super::distortion::weighted_quantiles;
use crate::{Layout, predicates};
use glam::DVec2;
use rayon::prelude::*;

/// Nodes and edges that all searches together may look at, and one of them always may;
/// ordinary ones need about a hundred. Beyond it a distance is a lower bound.
const MAX_LOOKS: usize = 200_000_000;
const LOOKS_OF_ONE: std::ops::RangeInclusive<usize> = 256..=8_192;

pub(crate) type Segment = [DVec2; 2];

/// The distances between charts; `None` where there is but one chart or none.
pub(super) fn gutter(layout: &Layout, texture_size: usize) -> Option<Gutter> {
    let edges: Vec<(Segment, u32)> = layout
        .boundary_among(|t| shows(layout, t))
        .iter()
        .map(|e| (e.points.map(|p| layout.points[p as usize]), layout.charts[e.triangle as usize]))
        .filter(|([a, b], _)| a.is_finite() && b.is_finite())
        .collect();
    let tree = BoxTree::new(edges.iter().map(|(segment, chart)| (Bounds::of(segment), *chart)));
    let max_looks = looks_of_one(edges.len());
    let nearest: Vec<Option<Nearest>> = edges
        .par_iter()
        .map(|&(segment, chart)| {
            tree.nearest(&Bounds::of(&segment), chart, max_looks, |other| {
                squared_distance(segment, edges[other as usize].0)
            })
        })
        .collect();
    // Where one edge has another chart to be far from, all have.
    let nearest: Vec<Nearest> = nearest.into_iter().flatten().collect();
    let (index, least) = nearest.iter().enumerate().min_by(|a, b| a.1.squared.total_cmp(&b.1.squared))?;
    let size = texture_size as f64;
    let distances = nearest
        .iter()
        .zip(&edges)
        .map(|(near, ([a, b], _))| (near.squared.sqrt() * size, a.distance(*b)))
        .collect();
    let (segment, chart) = edges[index];
    let (other, other_chart) = edges[least.item as usize];
    Some(Gutter {
        texels: least.squared.sqrt() * size,
        complete: nearest.iter().all(|near| near.exact),
        quantile_5: weighted_quantiles(distances).map_or(0.0, |q| q.q5),
        charts: [chart.min(other_chart), chart.max(other_chart)],
        place: place_between(segment, other).to_array(),
    })
}

/// Nodes and edges that one search may look at, of as many as there are edges.
fn looks_of_one(edges: usize) -> usize {
    (MAX_LOOKS / edges.max(1)).clamp(*LOOKS_OF_ONE.start(), *LOOKS_OF_ONE.end())
}

/// Whether a triangle is on the surface or takes a place in the texture.
fn shows(layout: &Layout, triangle: usize) -> bool {
    let [a, b, c] = layout.corners(triangle);
    // What is not finite is decided on by whoever wants edges.
    layout.rest_area(triangle) > 0.0 || predicates::orientation(a, b, c) != 0.0
}

/// The smallest distance from a triangle to the border of the square, in texels;
/// negative where one lies outside; `None` without triangles.
pub(super) fn border(layout: &Layout, texture_size: usize) -> Option<f64> {
    let to_border = |p: DVec2| p.min(DVec2::ONE - p).min_element();
    let corners = (0..layout.triangles.len()).flat_map(|t| layout.corners(t));
    corners
        .filter(|p| p.is_finite())
        .map(to_border)
        .min_by(f64::total_cmp)
        .map(|distance| distance * texture_size as f64)
}

/// Squared distance of two closed segments, 0 exactly where they meet.
pub(crate) fn squared_distance(a: Segment, b: Segment) -> f64 {
    if predicates::segments_meet(a, b) {
        return 0.0;
    }
    // Segments that do not meet are nearest at an end of one of them.
    let ends = [to_segment(a[0], b), to_segment(a[1], b), to_segment(b[0], a), to_segment(b[1], a)];
    ends.into_iter().map(|(p, q)| p.distance_squared(q)).fold(f64::INFINITY, f64::min)
}

/// A point and the point of a segment that is nearest to it.
fn to_segment(p: DVec2, [a, b]: Segment) -> (DVec2, DVec2) {
    let along = b - a;
    let length_squared = along.length_squared();
    let t = if length_squared > 0.0 { ((p - a).dot(along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    (p, a + along * t)
}

/// The middle of the shortest way between two segments, roughly where they meet.
fn place_between(a: Segment, b: Segment) -> DVec2 {
    [to_segment(a[0], b), to_segment(a[1], b), to_segment(b[0], a), to_segment(b[1], a)]
        .into_iter()
        .min_by(|x, y| x.0.distance_squared(x.1).total_cmp(&y.0.distance_squared(y.1)))
        .map_or(a[0], |(p, q)| p.midpoint(q))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat2, dvec2};

    /// Protects the bounds of all searches together and of one.
    #[test]
    fn looks_are_shared_out() {
        let looks = [0, 1, 24_414, 25_000, 100_000, 781_250, 1_000_000].map(looks_of_one);
        assert_eq!(looks, [8_192, 8_192, 8_192, 8_000, 2_000, 256, 256]);
    }

    /// Protects which triangles have a boundary: all but those without an area in both
    /// space and texture.
    #[test]
    fn triangles_that_show_have_an_area_somewhere() {
        let points = vec![DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        let shows = |corners: [u32; 3], rest: DMat2| {
            let mut layout = Layout { points: points.clone(), ..Layout::default() };
            layout.triangles.push(corners);
            layout.rest.push(rest);
            shows(&layout, 0)
        };
        assert!(shows([0, 1, 2], DMat2::IDENTITY) && shows([0, 2, 1], DMat2::IDENTITY));
        assert!(shows([0, 1, 2], DMat2::ZERO) && shows([0, 2, 1], DMat2::ZERO));
        assert!(shows([0, 0, 1], DMat2::IDENTITY));
        assert!(!shows([0, 0, 1], DMat2::ZERO));
    }

    /// Protects the border: each side of the square, from within and from without.
    #[test]
    fn every_side_of_the_square_is_a_border() {
        let distance = |low: DVec2, high: DVec2| {
            let layout = Layout {
                points: vec![low, dvec2(high.x, low.y), high],
                triangles: vec![[0, 1, 2]],
                ..Layout::default()
            };
            border(&layout, 16)
        };
        let (low, high) = (DVec2::splat(0.375), DVec2::splat(0.625));
        assert_eq!(distance(low, high), Some(6.0));
        assert_eq!(distance(dvec2(0.25, 0.375), high), Some(4.0));
        assert_eq!(distance(dvec2(0.375, 0.125), high), Some(2.0));
        assert_eq!(distance(low, dvec2(0.75, 0.625)), Some(4.0));
        assert_eq!(distance(low, dvec2(0.625, 0.875)), Some(2.0));
        assert_eq!(distance(dvec2(-0.25, 0.375), high), Some(-4.0));
        assert_eq!(distance(low, dvec2(0.625, 1.5)), Some(-8.0));
        assert_eq!(distance(dvec2(f64::NAN, 0.25), high), Some(4.0));
        assert_eq!(border(&Layout::default(), 16), None);
    }

    /// Protects the nearest point of a segment away from the origin: before it, along
    /// it, after it, and of a single point.
    #[test]
    fn nearest_points_of_segments() {
        let segment = [dvec2(1.0, 2.0), dvec2(3.0, 4.0)];
        let nearest = |p: DVec2, s: Segment| {
            let (same, nearest) = to_segment(p, s);
            assert_eq!(same, p);
            nearest
        };
        assert_eq!(nearest(dvec2(1.0, 4.0), segment), dvec2(2.0, 3.0));
        assert_eq!(nearest(dvec2(3.0, 3.0), segment), dvec2(2.5, 3.5));
        assert_eq!(nearest(dvec2(0.0, 0.0), segment), segment[0]);
        assert_eq!(nearest(dvec2(5.0, 4.5), segment), segment[1]);
        assert_eq!(nearest(DVec2::ONE, [segment[0]; 2]), segment[0]);
        // The smallest of the four, whichever end it is at.
        let other = [dvec2(2.0, 6.0), dvec2(3.0, 5.0)];
        for (a, b) in [(segment, other), (other, segment)] {
            assert_eq!(squared_distance(a, b), 1.0);
            assert_eq!(squared_distance([a[1], a[0]], b), 1.0);
            assert_eq!(place_between(a, b), dvec2(3.0, 4.5));
            assert_eq!(place_between([a[1], a[0]], [b[1], b[0]]), dvec2(3.0, 4.5));
        }
    }

    /// Protects the distances between segments on which the gutter rests.
    #[test]
    fn distances_between_segments() {
        let unit = [DVec2::ZERO, DVec2::X];
        assert_eq!(squared_distance(unit, [dvec2(0.5, -1.0), dvec2(0.5, 1.0)]), 0.0);
        assert_eq!(squared_distance(unit, [dvec2(0.2, 2.0), dvec2(0.7, 3.0)]), 4.0);
        assert_eq!(squared_distance(unit, [dvec2(4.0, 4.0), dvec2(5.0, 5.0)]), 25.0);
        assert_eq!(squared_distance([DVec2::X; 2], [DVec2::Y; 2]), 2.0);
        assert_eq!(place_between(unit, [dvec2(0.2, 2.0), dvec2(0.7, 3.0)]), dvec2(0.2, 1.0));
    }
}
