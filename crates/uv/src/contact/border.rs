//! The border of the square: how near boundary vertices may come to its four sides.

use super::boundary::Boundary;
use super::constraints::Constraints;
use super::limits::Limits;
use super::pair::KEPT;
use glam::DVec2;

/// Limits of each boundary vertex to the sides x = 0, x = 1, y = 0, y = 1; `None` where
/// that coordinate is fixed.
#[derive(Clone, Debug)]
pub(super) struct BorderLimits {
    pub sides: Vec<[Option<Limits>; 4]>,
}

/// A side's inward normal, and a point's distance from the side, negative outside.
#[inline]
pub(super) fn inwards(at: DVec2, side: usize) -> (DVec2, f64) {
    match side {
        0 => (DVec2::X, at.x),
        1 => (DVec2::NEG_X, 1.0 - at.x),
        2 => (DVec2::Y, at.y),
        _ => (DVec2::NEG_Y, 1.0 - at.y),
    }
}

impl BorderLimits {
    /// The usual limits, or what the start allows; vertices that begin on the border or beyond it keep that
    /// coordinate.
    pub fn new(boundary: &Boundary, points: &[DVec2], usual: Limits, constraints: &mut Constraints) -> Self {
        let mut sides = Vec::with_capacity(boundary.vertices.len());
        for &v in &boundary.vertices {
            let mut limits = [0, 1, 2, 3].map(|side| usual.apart(inwards(points[v as usize], side).1));
            let mask = &mut constraints.masks[v as usize];
            if limits[0].is_none() || limits[1].is_none() {
                mask.x = 0.0;
                limits[0] = None;
                limits[1] = None;
            }
            if limits[2].is_none() || limits[3].is_none() {
                mask.y = 0.0;
                limits[2] = None;
                limits[3] = None;
            }
            sides.push(limits);
        }
        Self { sides }
    }

    /// The largest step up to which a boundary vertex keeps its limits and a share of
    /// each gap.
    pub fn step(&self, vertex: usize, at: DVec2, way: DVec2, limit: f64) -> f64 {
        let mut step = limit;
        for (side, limits) in self.sides[vertex].iter().enumerate() {
            let Some(limits) = limits else { continue };
            let (normal, distance) = inwards(at, side);
            let closing = -normal.dot(way);
            if closing > 0.0 {
                step = step.min((1.0 - KEPT) * (distance - limits.minimum).max(0.0) / closing);
            }
        }
        step
    }

    /// Whether a boundary vertex keeps its limits.
    pub fn keeps(&self, vertex: usize, at: DVec2) -> bool {
        self.sides[vertex]
            .iter()
            .enumerate()
            .all(|(side, limits)| limits.is_none_or(|limits| inwards(at, side).1 > limits.minimum))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    /// Protects the order of the sides and the signs of distances.
    #[test]
    fn sides_by_hand() {
        let at = dvec2(0.25, -1.0);
        let distances = [0, 1, 2, 3].map(|side| inwards(at, side).1);
        assert_eq!(distances, [0.25, 0.75, -1.0, 2.0]);
    }
}
