//! Charts that are too long for the square: the strip around a rim or along a wire, unrolled, decides
//! alone how large all charts may be drawn, and leaves most of the square empty. Such charts are cut
//! across.
//!
//! With charts of total area A, a straight one of length L holds the covered part of the square at
//! A / L² or less (√2 times as long along a diagonal, which few others can share).

use super::corners::{Corners, Surface};
use super::sound::by_chart;
use crate::{ChartScale, Layout};
use glam::{DVec2, dvec2};

/// What one chart, or a shrunk layout, must let be covered of the square, or more is changed: packing
/// reaches about two thirds.
pub(crate) const LEAST_COVER: f64 = 0.4;
/// Parts are as long as the square with this share of it covered.
const GOOD_COVER: f64 = 0.6;
/// A triangle longer than this share of a part cannot be cut around.
const LONGEST_TRIANGLE: f64 = 0.5;
/// A chart that falls into more pieces than this for each part is not straight.
const MOST_PIECES: usize = 4;

/// Cuts them; returns how many were cut.
pub(crate) fn cut_across(surface: &Surface, corners: &mut Corners, scale: &ChartScale) -> usize {
    let (layout, live) = surface.layout(corners);
    let charts = by_chart(&layout);
    let scales: Vec<f64> = charts.iter().map(|c| drawn_scale(&layout, c, scale)).collect();
    let area: f64 = charts.iter().zip(&scales).map(|(c, s)| drawn_area(&layout, c) * s * s).sum();
    let (longest, good) = ((area / LEAST_COVER).sqrt(), (area / GOOD_COVER).sqrt());
    let mut cut = 0;
    for (triangles, scale) in charts.iter().zip(scales) {
        let axis = long_axis(&layout, triangles);
        let along = |p: DVec2| p.dot(axis) * scale;
        let range = |points: &mut dyn Iterator<Item = DVec2>| {
            points.map(along).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
        };
        let (low, high) = range(&mut triangles.iter().flat_map(|t| layout.corners(*t as usize)));
        let length = high - low;
        // Also false for what has no extent or none that is finite.
        if !(length > longest && length.is_finite()) {
            continue;
        }
        let parts = (length / good).ceil();
        let part = length / parts;
        let is_short = |t: &u32| {
            let (from, to) = range(&mut layout.corners(*t as usize).into_iter());
            to - from <= LONGEST_TRIANGLE * part
        };
        if !triangles.iter().all(is_short) {
            continue;
        }
        let before = corners.clone();
        for &t in triangles {
            let [a, b, c] = layout.corners(t as usize).map(along);
            let band = (((a + b + c) / 3.0 - low) / part).clamp(0.0, parts - 1.0) as u32;
            corners.chart[live[t as usize] as usize] = corners.next + band;
        }
        corners.next += parts as u32;
        let own: Vec<u32> = triangles.iter().map(|t| live[*t as usize]).collect();
        let pieces = surface.connected(corners, &own).1.into_iter().max().map_or(0, |p| p as usize + 1);
        if pieces > MOST_PIECES * parts as usize {
            *corners = before;
        } else {
            cut += 1;
        }
    }
    cut
}

fn drawn_area(layout: &Layout, triangles: &[u32]) -> f64 {
    triangles.iter().map(|t| 0.5 * layout.doubled_area(*t as usize).abs()).sum()
}

/// How large a chart is to be drawn relative to its size in the layout.
fn drawn_scale(layout: &Layout, triangles: &[u32], scale: &ChartScale) -> f64 {
    let space: f64 = triangles.iter().map(|t| layout.rest_area(*t as usize)).sum();
    let factor = match scale {
        ChartScale::Equal => (space / drawn_area(layout, triangles)).sqrt(),
        ChartScale::Keep | ChartScale::Given(_) => 1.0,
    };
    if factor.is_finite() { factor } else { 0.0 }
}

/// The principal axis of a chart's corners, by area.
fn long_axis(layout: &Layout, triangles: &[u32]) -> DVec2 {
    let weighted = || {
        triangles.iter().flat_map(|t| {
            let weight = layout.doubled_area(*t as usize).abs();
            layout.corners(*t as usize).map(|p| (p, weight))
        })
    };
    let (sum, weight) = weighted().fold((DVec2::ZERO, 0.0), |(s, all), (p, w)| (s + p * w, all + w));
    let middle = sum / weight;
    let [xx, xy, yy] = weighted().fold([0.0; 3], |[xx, xy, yy], (p, w)| {
        let d = p - middle;
        [xx + w * d.x * d.x, xy + w * d.x * d.y, yy + w * d.y * d.y]
    });
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    dvec2(angle.cos(), angle.sin())
}
