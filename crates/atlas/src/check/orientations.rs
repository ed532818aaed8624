//! Which triangles are flipped, mirrored, without area or outside the square.

use super::{Found, Orientations};
use crate::{Layout, predicates};
use glam::DVec2;

/// Sorts the triangles of a layout by the exact signs of their areas. Triangles
/// without finite coordinates are in no other class than that.
pub(super) fn orientations(layout: &Layout) -> Orientations {
    let mut found = Orientations::default();
    let charts = layout.charts.iter().max().map_or(0, |&c| c as usize + 1);
    let (mut has_positive, mut has_negative) = (vec![false; charts], vec![false; charts]);
    let mut negative = Vec::new();
    for (t, &chart) in layout.charts.iter().enumerate() {
        let index = t as u32;
        let corners = layout.corners(t);
        if !corners.iter().all(|p| p.is_finite()) {
            found.not_finite.add(index);
            continue;
        }
        let inside = |p: &DVec2| p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::ONE).all();
        if !corners.iter().all(inside) {
            found.outside.add(index);
        }
        let has_surface = layout.rest_area(t) > 0.0;
        if !has_surface {
            found.without_surface.add(index);
        }
        let [a, b, c] = corners;
        let area = predicates::orientation(a, b, c);
        if area > 0.0 {
            has_positive[chart as usize] = true;
        } else if area < 0.0 {
            has_negative[chart as usize] = true;
            negative.push(index);
        } else if has_surface {
            found.degenerate.add(index);
        }
    }
    let is_mirrored = |chart: usize| has_negative[chart] && !has_positive[chart];
    (0..charts).filter(|&c| is_mirrored(c)).for_each(|c| found.mirrored_charts.add(c as u32));
    for index in negative {
        if is_mirrored(layout.charts[index as usize] as usize) {
            found.mirrored_triangles += 1;
        } else {
            found.flipped.add(index);
        }
    }
    found
}

impl Found {
    fn add(&mut self, index: u32) {
        self.count += 1;
        if self.first.len() < super::FIRST {
            self.first.push(index);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the indices: the first five and no more, and the number of all.
    #[test]
    fn the_first_five_are_named() {
        let mut found = Found::default();
        for index in 0..5 {
            found.add(10 * index);
        }
        assert_eq!(found, Found { count: 5, first: vec![0, 10, 20, 30, 40] });
        found.add(50);
        assert_eq!(found, Found { count: 6, first: vec![0, 10, 20, 30, 40] });
    }
}
