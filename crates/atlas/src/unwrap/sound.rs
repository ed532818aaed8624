//! From charts that may have faults to a layout that has none, always.
//!
//! Triangles that are mirrored, have no area or lie on others of their own chart are cut
//! out and packed by themselves; the others are packed as they are. Packing rounds, and
//! triangles that touched may overlap by that: these are put where the packed layout has
//! room, or all is packed again without them. A triangle by itself cannot be at fault, so
//! this ends.

use super::corners::{Corners, NONE, Surface};
use crate::pack::LEAST_EXTENT;
use crate::pack::free_space::place;
use crate::predicates::{orientation, triangles_overlap};
use crate::{AtlasError, ChartScale, Layout, PackOptions, pack};
use glam::DVec2;

/// How much is taken apart, round by round: the triangles at fault, then the charts that
/// hold them, at last everything.
const ROUNDS: [Apart; 9] = {
    use Apart::{Charts, Everything, Triangles};
    [Triangles, Triangles, Triangles, Triangles, Charts, Charts, Charts, Everything, Everything]
};

#[derive(Clone, Copy, PartialEq)]
enum Apart {
    Triangles,
    Charts,
    Everything,
}

/// Packs corners into a layout without faults and returns the packed corners.
pub(crate) fn settled(
    surface: &Surface,
    mut corners: Corners,
    options: &PackOptions,
) -> Result<Corners, AtlasError> {
    let mut options = options.clone();
    if matches!(options.chart_scale, ChartScale::Given(_)) {
        options.chart_scale = ChartScale::Keep;
    }
    for apart in ROUNDS {
        let (layout, live) = surface.layout(&corners);
        let before = at_fault(&layout);
        if !before.is_empty() {
            cut_out(surface, &mut corners, &layout, &live, &before, apart);
            continue;
        }
        let faults = match pack(&layout, &options) {
            Ok(packed) => {
                let faults = at_fault(&packed);
                if faults.is_empty() {
                    return Ok(finished(surface, moved(corners, &packed, &live)));
                }
                let as_packed = moved(corners.clone(), &packed, &live);
                if let Some(placed) = set_apart(surface, as_packed, &packed, (&live, &faults), &options) {
                    return Ok(finished(surface, placed));
                }
                faults
            }
            Err(AtlasError::TooThin { triangles }) => triangles,
            Err(error) => return Err(error),
        };
        cut_out(surface, &mut corners, &layout, &live, &faults, apart);
    }
    let (layout, _) = surface.layout(&corners);
    Err(AtlasError::Unsound { triangles: at_fault(&layout).len() })
}

/// Corners where a layout of the `live` triangles has them, with its charts.
fn moved(mut corners: Corners, layout: &Layout, live: &[u32]) -> Corners {
    for (i, &t) in live.iter().enumerate() {
        corners.uv[t as usize] = layout.corners(i);
        corners.chart[t as usize] = layout.charts[i];
    }
    corners.next = corners.next.max(charts(layout) as u32);
    corners
}

/// Corners with those of triangles without area in space.
fn finished(surface: &Surface, mut corners: Corners) -> Corners {
    surface.place_dead(&mut corners);
    corners
}

/// Packed corners with the triangles at fault where there is room for them; what else is packed stays where it is. None where
/// there is no room, where they are smaller than packing makes them, and where a chart falls apart without them.
fn set_apart(
    surface: &Surface,
    mut corners: Corners,
    packed: &Layout,
    (live, faults): (&[u32], &[u32]),
    options: &PackOptions,
) -> Option<Corners> {
    cut_out(surface, &mut corners, packed, live, faults, Apart::Triangles);
    let extent = |[a, b, c]: [DVec2; 3]| (a.max(b).max(c) - a.min(b).min(c)).max_element();
    let is_large = |&i: &u32| extent(corners.uv[live[i as usize] as usize]) >= LEAST_EXTENT;
    let mut labels: Vec<u32> = live.iter().map(|&t| corners.chart[t as usize]).collect();
    labels.sort_unstable();
    labels.dedup();
    let (layout, _) = surface.layout(&corners);
    // Parts with one label that share no edge would be charts side by side.
    if charts(&layout) != labels.len() || !faults.iter().all(is_large) {
        return None;
    }
    let mut is_free = vec![false; charts(&layout)];
    faults.iter().for_each(|&i| is_free[layout.charts[i as usize] as usize] = true);
    let placed = place(&layout, &is_free, options).filter(|placed| placed.smaller == 0)?.layout;
    at_fault(&placed).is_empty().then(|| moved(corners, &placed, live))
}

fn charts(layout: &Layout) -> usize {
    layout.charts.iter().max().map_or(0, |&last| last as usize + 1)
}

/// Takes triangles out of their charts, or their whole charts apart.
fn cut_out(
    surface: &Surface,
    corners: &mut Corners,
    layout: &Layout,
    live: &[u32],
    faults: &[u32],
    how: Apart,
) {
    let charts = charts(layout);
    let mut area = vec![[0.0; 2]; charts];
    for i in 0..live.len() {
        let sums = &mut area[layout.charts[i] as usize];
        sums[0] += 0.5 * layout.doubled_area(i).abs();
        sums[1] += layout.rest_area(i);
    }
    let mut chosen = vec![how == Apart::Everything; charts];
    if how == Apart::Charts {
        faults.iter().for_each(|&i| chosen[layout.charts[i as usize] as usize] = true);
    }
    let chosen: Vec<u32> = if how == Apart::Triangles {
        faults.to_vec()
    } else {
        (0..live.len() as u32).filter(|&i| chosen[layout.charts[i as usize] as usize]).collect()
    };
    for i in chosen {
        let t = live[i as usize] as usize;
        let [texture, space] = area[layout.charts[i as usize] as usize];
        let scale = (texture / space).sqrt();
        corners.uv[t] = surface.alone(t, if scale.is_finite() && scale > 0.0 { scale } else { 1.0 });
        corners.chart[t] = corners.next;
        corners.next = corners.next.wrapping_add(1) % NONE;
    }
}

/// Triangles that are mirrored or without area, or that must go so that no two of one
/// chart overlap; ascending. Exact.
pub(crate) fn at_fault(layout: &Layout) -> Vec<u32> {
    let mut faulty: Vec<bool> = (0..layout.triangles.len())
        .map(|t| {
            let [a, b, c] = layout.corners(t);
            orientation(a, b, c) <= 0.0
        })
        .collect();
    for triangles in by_chart(layout) {
        for [a, b] in overlaps(layout, &triangles, &faulty) {
            if !faulty[a as usize] && !faulty[b as usize] {
                let smaller = layout.rest_area(a as usize) < layout.rest_area(b as usize);
                faulty[if smaller { a } else { b } as usize] = true;
            }
        }
    }
    (0..faulty.len() as u32).filter(|&t| faulty[t as usize]).collect()
}

/// The triangles of each chart.
pub(crate) fn by_chart(layout: &Layout) -> Vec<Vec<u32>> {
    let mut charts = vec![Vec::new(); charts(layout)];
    for (t, &chart) in layout.charts.iter().enumerate() {
        charts[chart as usize].push(t as u32);
    }
    charts
}

/// Overlapping pairs among triangles that are not `skipped`, by a sweep. What
/// is found is enough to know which triangles to take out: one that is found to lie on
/// an earlier one that stays is not looked at again.
fn overlaps(layout: &Layout, triangles: &[u32], skipped: &[bool]) -> Vec<[u32; 2]> {
    let mut boxes: Vec<([f64; 4], u32)> = triangles
        .iter()
        .filter(|&&t| !skipped[t as usize])
        .map(|&t| {
            let [a, b, c] = layout.corners(t as usize);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            ([low.x, low.y, high.x, high.y], t)
        })
        .collect();
    // Along the longer side, where fewer boxes are met at a time.
    let extent = |k: usize| {
        let low = boxes.iter().map(|b| b.0[k]).fold(f64::INFINITY, f64::min);
        boxes.iter().map(|b| b.0[k + 2]).fold(f64::NEG_INFINITY, f64::max) - low
    };
    if extent(1) > extent(0) {
        boxes.iter_mut().for_each(|([x, y, to_x, to_y], _)| {
            std::mem::swap(x, y);
            std::mem::swap(to_x, to_y);
        });
    }
    boxes.sort_by(|p, q| p.0[0].total_cmp(&q.0[0]).then(p.1.cmp(&q.1)));
    let mut pairs = Vec::new();
    let mut active: Vec<([f64; 4], u32)> = Vec::new();
    for &(bounds, t) in &boxes {
        active.retain(|(other, _)| other[2] > bounds[0]);
        let hit = active.iter().find(|(other, o)| {
            other[1] < bounds[3]
                && bounds[1] < other[3]
                && triangles_overlap(layout.corners(t as usize), layout.corners(*o as usize))
        });
        match hit {
            // It will be taken out, or the other one: then it comes back next round.
            Some(&(_, other)) => pairs.push([other, t]),
            None => active.push((bounds, t)),
        }
    }
    pairs
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::check;
    use crate::repair::corners_of;
    use parbake_model::Mesh;
    use parbake_model::glam::{Vec3, vec2};

    /// Squares in a row, two triangles each, in one chart that leaves a part of the texture.
    fn strip(squares: u32) -> Mesh {
        let mut mesh = Mesh::default();
        for (x, y) in (0..=squares).flat_map(|x| [(x, 0), (x, 1)]) {
            mesh.positions.push(Vec3::new(x as f32, -(y as f32), 0.0));
            mesh.uvs.push(vec2(0.1 + 0.1 * x as f32, 0.1 + 0.4 * y as f32));
        }
        let square = |v: u32| [[v, v + 1, v + 2], [v + 2, v + 1, v + 3]];
        mesh.triangles = (0..squares).flat_map(|x| square(2 * x)).collect();
        mesh.triangle_materials = vec![0; mesh.triangles.len()];
        mesh
    }

    /// Protects what is packed: a triangle at fault gets a place of its own, a gutter away, and nothing else moves. A chart
    /// whose parts would lie side by side without a gutter, and triangles that would be too small, are packed again.
    #[test]
    fn faults_of_rounding_are_set_apart() {
        let mesh = strip(7);
        let surface = Surface::new(&mesh);
        let own = || corners_of(&surface);
        let (packed, live) = surface.layout(&own());
        let options = PackOptions { texture_size: 16, gutter_texels: 2.0, ..PackOptions::default() };
        let apart = |fault: u32| set_apart(&surface, own(), &packed, (&live, &[fault]), &options);
        let placed = apart(13).unwrap();
        assert_eq!(placed.uv[..13], own().uv[..13]);
        let found = check(&surface.layout(&placed).0, 16);
        assert!(found.is_bijective() && found.gutter.as_ref().unwrap().texels >= 2.0, "{found:?}");
        assert!(apart(6).is_none(), "the strip would fall apart");
        let tiny = Mesh { uvs: mesh.uvs.iter().map(|uv| *uv * 1e-4).collect(), ..mesh.clone() };
        let surface = Surface::new(&tiny);
        let (packed, live) = surface.layout(&corners_of(&surface));
        assert!(set_apart(&surface, corners_of(&surface), &packed, (&live, &[13]), &options).is_none());
    }
}
