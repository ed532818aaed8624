//! The pieces that are packed: charts in a frame of their own, with their relative
//! scales and the directions in which they may lie.

use super::polygon::{best_box_direction, bounds, convex_hull};
use super::{ChartScale, PackOptions};
use crate::{AtlasError, Layout};
use glam::{DVec2, dvec2};

/// No piece's longer side gets shorter than this part of the texture, so that 32-bit
/// coordinates can hold its triangles.
pub(crate) const LEAST_EXTENT: f64 = 1e-4;

/// What moves as one: a chart, or several that share points.
pub(super) struct Piece {
    /// Indices of its points in the layout.
    pub indices: Vec<u32>,
    /// Their places, relative to each other; all pieces together have an area of 1.
    pub points: Vec<DVec2>,
    /// Triangles between these points.
    pub triangles: Vec<[u32; 3]>,
    /// Edges that have a triangle on one side only.
    pub outline: Vec<[u32; 2]>,
    /// Area at scale 1.
    pub area: f64,
    /// The least scale that it is drawn at.
    pub least_scale: f64,
    /// Unit vectors that may become the x axis, the best first; quarter turns of these
    /// are not listed.
    pub directions: Vec<DVec2>,
}

impl Piece {
    /// The points at a scale, `axis` turned into the x axis; the corner of their box at
    /// the origin.
    pub fn placed(&self, scale: f64, axis: DVec2) -> Vec<DVec2> {
        let scale = scale.max(self.least_scale);
        let turned: Vec<DVec2> =
            self.points.iter().map(|&p| dvec2(p.dot(axis), p.dot(axis.perp())) * scale).collect();
        let (low, _) = bounds(turned.iter().copied());
        turned.into_iter().map(|p| p - low).collect()
    }
}

/// The pieces of a layout, in the order of their first triangles.
pub(super) fn pieces(layout: &Layout, options: &PackOptions) -> Result<Vec<Piece>, AtlasError> {
    let chart_count = layout.charts.iter().max().map_or(0, |&c| c as usize + 1);
    if let ChartScale::Given(scales) = &options.chart_scale
        && (scales.len() != chart_count || scales.iter().any(|s| !(s.is_finite() && *s > 0.0)))
    {
        return Err(AtlasError::InvalidOption {
            name: "chart_scale",
            wanted: "one finite, positive number a chart",
        });
    }
    let mut pieces = Vec::new();
    for triangles in grouped(layout, chart_count) {
        let mut piece = outline_piece(layout, &triangles);
        let factor = match &options.chart_scale {
            ChartScale::Keep => 1.0,
            ChartScale::Given(scales) => scales[layout.charts[triangles[0] as usize] as usize],
            ChartScale::Equal => {
                let space: f64 = triangles.iter().map(|&t| layout.rest_area(t as usize)).sum();
                (space / piece.area).sqrt()
            }
        };
        piece.least_scale = factor;
        pieces.push(piece);
    }
    normalise(&mut pieces);
    let count = pieces.len();
    for piece in &mut pieces {
        piece.directions =
            if options.rotate { directions(&piece.points, count, options.effort) } else { vec![DVec2::X] };
    }
    Ok(pieces)
}

/// Triangles by piece: charts that share a point are one.
fn grouped(layout: &Layout, chart_count: usize) -> Vec<Vec<u32>> {
    let mut leader: Vec<u32> = (0..chart_count as u32).collect();
    let find = |leader: &mut Vec<u32>, mut c: u32| {
        while leader[c as usize] != c {
            leader[c as usize] = leader[leader[c as usize] as usize];
            c = leader[c as usize];
        }
        c
    };
    let mut chart_of_point = vec![u32::MAX; layout.points.len()];
    for (triangle, &chart) in layout.triangles.iter().zip(&layout.charts) {
        for &p in triangle {
            let other = &mut chart_of_point[p as usize];
            if *other == u32::MAX {
                *other = chart;
            } else {
                let (a, b) = (find(&mut leader, *other), find(&mut leader, chart));
                leader[a.max(b) as usize] = a.min(b);
            }
        }
    }
    let mut groups: Vec<Vec<u32>> = vec![Vec::new(); chart_count];
    for (t, &chart) in layout.charts.iter().enumerate() {
        groups[find(&mut leader, chart) as usize].push(t as u32);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// A piece with its points centred and neither scales nor directions.
fn outline_piece(layout: &Layout, triangles: &[u32]) -> Piece {
    let mut indices: Vec<u32> = triangles.iter().flat_map(|&t| layout.triangles[t as usize]).collect();
    indices.sort_unstable();
    indices.dedup();
    let local = |p: u32| indices.partition_point(|&i| i < p) as u32;
    let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| layout.triangles[t as usize].map(local)).collect();
    let (low, high) = bounds(indices.iter().map(|&i| layout.points[i as usize]));
    let centre = low * 0.5 + high * 0.5;
    let points: Vec<DVec2> = indices.iter().map(|&i| layout.points[i as usize] - centre).collect();
    // Only an edge between two unmirrored triangles, one on each side, is inside.
    let mut edges: Vec<([u32; 2], bool, bool)> = Vec::with_capacity(3 * corners.len());
    for (triangle, &t) in corners.iter().zip(triangles) {
        let sound = layout.doubled_area(t as usize) > 0.0;
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            edges.push(([a.min(b), a.max(b)], a < b, sound));
        }
    }
    edges.sort_unstable();
    let outline = edges
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|run| !(run.len() == 2 && run[0].1 != run[1].1 && run.iter().all(|edge| edge.2)))
        .map(|run| run[0].0)
        .collect();
    let area = triangles.iter().map(|&t| 0.5 * layout.doubled_area(t as usize).abs()).sum();
    Piece { indices, points, triangles: corners, outline, area, least_scale: 0.0, directions: Vec::new() }
}

/// Applies the factors that stand in `least_scale`, brings the sum of all areas to 1 and
/// sets the least scales.
fn normalise(pieces: &mut [Piece]) {
    let extent = |piece: &Piece| {
        let (low, high) = bounds(piece.points.iter().copied());
        (high - low).max_element()
    };
    // Pieces without area in space or texture have no scale: they take the smallest.
    let usable = |p: &Piece| p.least_scale.is_finite() && p.least_scale > 0.0 && extent(p) > 0.0;
    let total: f64 =
        pieces.iter().filter(|p| usable(p)).map(|p| p.area * p.least_scale * p.least_scale).sum();
    let largest = pieces.iter().filter(|p| usable(p)).map(|p| extent(p) * p.least_scale).fold(0.0, f64::max);
    // Pieces that are mere lines have an extent, though no area.
    let unit = if total > 1e-9 * largest * largest { total.sqrt() } else { largest };
    for piece in pieces {
        let factor = if usable(piece) && unit > 0.0 { piece.least_scale / unit } else { 0.0 };
        let size = extent(piece);
        let factor = if factor * size > 0.0 { factor } else { LEAST_EXTENT / size.max(f64::MIN_POSITIVE) };
        for p in &mut piece.points {
            *p *= factor;
        }
        piece.area *= factor * factor;
        let size = size * factor;
        piece.least_scale = if size > 0.0 { LEAST_EXTENT / size } else { 0.0 };
    }
}

/// Directions to try: of the smallest box, and more of them the fewer the pieces are.
fn directions(points: &[DVec2], count: usize, effort: usize) -> Vec<DVec2> {
    let hull = convex_hull(points);
    let best = best_box_direction(&hull, |w, h| w * h);
    let mut directions = vec![best];
    if count == 1 {
        directions.insert(0, best_box_direction(&hull, f64::max));
    }
    let more = match count.checked_div(effort).unwrap_or(usize::MAX) {
        0..=2 => 15,
        3..=8 => 7,
        9..=16 => 3,
        17..=64 => 1,
        _ => 0,
    };
    for k in 1..=more {
        let angle = std::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(more + 1);
        directions.push(best.rotate(DVec2::from_angle(angle)));
    }
    directions
}
