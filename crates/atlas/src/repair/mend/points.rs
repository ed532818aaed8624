//! Slivers given an area where they are: one of their points moves by a part of a texel.
//!
//! A point may lie anywhere in the kernel of the triangles around it, the intersection of the half-planes
//! to the left of the edges that face it: there all of them are positive. It moves into the middle of what
//! is within reach of that.

use crate::Layout;
use crate::predicates::orientation;
use glam::{DVec2, dvec2};

/// How far a point may move along each axis, in texels.
const REACH_TEXELS: f64 = 0.25;
/// Texels that a sliver would cover at its chart's scale, at most; a larger triangle is laid out afresh.
const MOST_TEXELS: f64 = 2.0;

/// Moves points of those `faulty` triangles (ascending) that are slivers until they have an area. Returns
/// the triangles that have one now.
pub(super) fn open_slivers(
    layout: &mut Layout,
    faulty: &[u32],
    scales: &[f64],
    texture_size: usize,
) -> Vec<u32> {
    let size = texture_size as f64;
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); layout.points.len()];
    let mut is_near = vec![false; layout.points.len()];
    faulty
        .iter()
        .for_each(|&t| layout.triangles[t as usize].iter().for_each(|&p| is_near[p as usize] = true));
    for (t, corners) in layout.triangles.iter().enumerate() {
        corners.iter().filter(|&&p| is_near[p as usize]).for_each(|&p| around[p as usize].push(t as u32));
    }
    let sign = |layout: &Layout, t: u32| {
        let [a, b, c] = layout.corners(t as usize);
        orientation(a, b, c)
    };
    let mut opened = Vec::new();
    for &t in faulty {
        let scale = scales[layout.charts[t as usize] as usize] * size;
        if sign(layout, t) <= 0.0 && layout.rest_area(t as usize) * scale * scale > MOST_TEXELS {
            continue;
        }
        // The point that the fewest triangles share changes least.
        let mut points = layout.triangles[t as usize];
        points.sort_by_key(|&p| around[p as usize].len());
        for point in points {
            if sign(layout, t) > 0.0 {
                break;
            }
            let before = layout.points[point as usize];
            if let Some(place) = inside_kernel(layout, point, &around[point as usize], REACH_TEXELS / size) {
                layout.points[point as usize] = place;
                let all = &around[point as usize];
                if !all.iter().all(|&t| sign(layout, t) > 0.0) {
                    layout.points[point as usize] = before;
                }
            }
        }
        if sign(layout, t) > 0.0 {
            opened.push(t);
        }
    }
    opened
}

/// The middle of the kernel within reach of a point, as a file holds it.
fn inside_kernel(layout: &Layout, point: u32, around: &[u32], reach: f64) -> Option<DVec2> {
    let at = layout.points[point as usize];
    // Relative to the point, in units of the reach.
    let corner = |i: u32| (layout.points[i as usize] - at) / reach;
    let mut polygon = vec![dvec2(-1.0, -1.0), dvec2(1.0, -1.0), dvec2(1.0, 1.0), dvec2(-1.0, 1.0)];
    for &t in around {
        let triangle = layout.triangles[t as usize];
        let k = triangle.iter().position(|&p| p == point)?;
        let (from, to) = (corner(triangle[(k + 1) % 3]), corner(triangle[(k + 2) % 3]));
        let edge = (to - from).try_normalize()?;
        let side = |p: DVec2| edge.perp_dot(p - from);
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let (at_p, at_q) = (side(p), side(q));
            if at_p >= 0.0 {
                kept.push(p);
            }
            if (at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0) {
                kept.push(p + (q - p) * (at_p / (at_p - at_q)));
            }
        }
        polygon = kept;
    }
    if polygon.len() < 3 {
        return None;
    }
    let middle = polygon.iter().sum::<DVec2>() / polygon.len() as f64;
    let place = (at + middle * reach).clamp(DVec2::ZERO, DVec2::ONE);
    Some(place.as_vec2().as_dvec2())
}
