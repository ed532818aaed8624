//! What is wrong within charts, and what is done about it before all are packed.

use super::faulty_shares;
use crate::predicates::orientation;
use crate::unwrap::corners::{Corners, NONE, Surface};
use crate::unwrap::flatten::flatten;
use crate::unwrap::sound::by_chart;

/// A chart that falls into more pieces than this when cut along its folds is noise
/// rather than folded.
pub(crate) const MOST_PIECES: usize = 4;

/// A chart of which more than this share is at fault is laid out afresh as a whole.
pub(crate) const MOST_FAULTS: f64 = 0.05;

/// What was found.
#[derive(Default)]
pub(super) struct Found {
    /// Charts that were mirrored as a whole.
    pub mirrored: usize,
    /// Charts that were cut along folds.
    pub cut: usize,
    /// Triangles to be laid out afresh.
    pub fresh: Vec<u32>,
}

/// Mirrors charts back and cuts folded ones. Afterwards all triangles but the `fresh`
/// ones have a positive area.
pub(super) fn cut_along_folds(surface: &Surface, corners: &mut Corners) -> Found {
    let mut found = Found::default();
    let delivered = &surface.delivered;
    for triangles in by_chart(delivered) {
        let live: Vec<u32> = triangles.into_iter().filter(|&t| corners.chart[t as usize] != NONE).collect();
        let sign = |t: u32| {
            let [a, b, c] = delivered.corners(t as usize);
            orientation(a, b, c)
        };
        let mut negative: Vec<u32> = live.iter().copied().filter(|&t| sign(t) < 0.0).collect();
        let flat: Vec<u32> = live.iter().copied().filter(|&t| sign(t) == 0.0).collect();
        if negative.len() + flat.len() < live.len() && !negative.is_empty() {
            let label = corners.next;
            negative.iter().for_each(|&t| corners.chart[t as usize] = label);
            corners.next += 1;
            let pieces = surface.connected(corners, &live).1.into_iter().max().map_or(0, |p| p as usize + 1);
            if pieces > MOST_PIECES {
                found.fresh.extend(&live);
                continue;
            }
            found.cut += 1;
        } else if !negative.is_empty() {
            found.mirrored += 1;
        }
        for t in negative.drain(..) {
            corners.uv[t as usize].iter_mut().for_each(|p| p.x = -p.x);
        }
        found.fresh.extend(flat);
    }
    found
}

/// Lays out afresh what `found` names and what overlaps within its chart, at the mean
/// scale of the rest. Returns the number of triangles.
pub(super) fn fresh_triangles(
    surface: &Surface,
    corners: &mut Corners,
    found: &mut Found,
    max_chart_angle: f32,
) -> usize {
    found.fresh.iter().for_each(|&t| corners.chart[t as usize] = NONE);
    let (layout, live) = surface.layout(corners);
    let (faults, shares) = faulty_shares(&layout);
    let mut afresh = vec![false; live.len()];
    faults.iter().for_each(|&i| afresh[i as usize] = true);
    for (i, afresh) in afresh.iter_mut().enumerate() {
        *afresh |= shares[layout.charts[i] as usize] > MOST_FAULTS;
    }
    let (mut texture, mut space) = (0.0, 0.0);
    for (i, &t) in live.iter().enumerate() {
        if afresh[i] {
            found.fresh.push(t);
        } else {
            texture += 0.5 * layout.doubled_area(i);
            space += layout.rest_area(i);
        }
    }
    found.fresh.sort_unstable();
    if found.fresh.is_empty() {
        return 0;
    }
    flatten(surface, corners, &found.fresh, max_chart_angle);
    let scale = (texture / space).sqrt();
    if scale.is_finite() && scale > 0.0 {
        for &t in &found.fresh {
            corners.uv[t as usize].iter_mut().for_each(|p| *p *= scale);
        }
    }
    found.fresh.len()
}
