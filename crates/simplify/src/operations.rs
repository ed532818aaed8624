//! The changes that keep a surface sound: collapses, flips, splits, moves and removals.
//!
//! ```text
//! collapse   ▷◁ → •      flip   ◺◹ → ◸◿      split   ◁▷ → ◁|▷      move   • → •
//! ```
//!
//! Contract: what is returned keeps the surface's topology where it had one (link condition, Dey et al. 1999),
//! turns no triangle by more than 90°, and makes no needle that was not there; else there is no change.

use crate::change::Change;
use crate::surface::Surface;
use crate::triangle::Triangle;
use glam::Vec3;

/// Least shape of a new triangle: 4√3 · area / sum of squared sides, 1 for an equilateral one.
const LEAST_SHAPE: f32 = 0.02;
/// How far a triangle may turn: least cosine.
const LEAST_COSINE: f32 = 0.1;

impl Change {
    /// Point `from` becomes `to`, which moves to `position`.
    pub fn collapse(surface: &Surface, from: u32, to: u32, position: Vec3) -> Option<Self> {
        if !links_agree(surface, from, to) {
            return None;
        }
        let mut removed: Vec<u32> = surface.around(from).to_vec();
        removed.extend(surface.around(to).iter().filter(|t| !surface.around(from).contains(t)));
        let mut change = Self { removed, added: Vec::new(), moved: Some((to, position)) };
        for &index in &change.removed {
            let before = surface.get(index)?;
            let corners = before.corners.map(|point| if point == from { to } else { point });
            if before.corners.contains(&from) && before.corners.contains(&to) {
                continue;
            }
            let after = Triangle { corners, ..before };
            if !keeps(surface.corners(before.corners), surface.corners_after(&change, &after)) {
                return None;
            }
            change.added.push(after);
        }
        Some(change)
    }

    /// The point moves to `position`.
    pub fn shift(surface: &Surface, point: u32, position: Vec3) -> Option<Self> {
        let removed = surface.around(point).to_vec();
        let added: Vec<Triangle> = removed.iter().filter_map(|&t| surface.get(t)).collect();
        let change = Self { removed, added, moved: Some((point, position)) };
        let is_kept = |t: &Triangle| keeps(surface.corners(t.corners), surface.corners_after(&change, t));
        change.added.iter().all(is_kept).then_some(change)
    }

    /// The edge between two triangles is replaced by the one across.
    pub fn flip(surface: &Surface, a: u32, b: u32) -> Option<Self> {
        let removed = surface.at_edge(a, b);
        let [first, second] = removed[..] else { return None };
        let (first, second) = (surface.get(first)?, surface.get(second)?);
        if first.material != second.material {
            return None;
        }
        // Counter-clockwise `a b c` and `b a d`.
        let [a, b, c] = rotated(first.corners, a, b)?;
        let d = second.corners.into_iter().find(|&p| p != a && p != b)?;
        if c == d || !surface.at_edge(c, d).is_empty() || !runs(second.corners, b, a) {
            return None;
        }
        let with = |corners| Triangle { corners, ..first };
        let added = vec![with([a, d, c]), with([d, b, c])];
        let old = normal(surface.corners(first.corners)) + normal(surface.corners(second.corners));
        let is_sound = |t: &Triangle| {
            let corners = surface.corners(t.corners);
            shape(corners) > LEAST_SHAPE
                && normal(corners).normalize_or_zero().dot(old.normalize_or_zero()) > 0.3
        };
        added.iter().all(is_sound).then_some(Self { removed, added, moved: None })
    }

    /// A new point on an edge halves the triangles there.
    pub fn split(surface: &Surface, a: u32, b: u32, position: Vec3) -> Option<Self> {
        let removed = surface.at_edge(a, b);
        let new = surface.points.len() as u32;
        let mut change = Self { removed, added: Vec::new(), moved: Some((new, position)) };
        for &index in &change.removed {
            let before = surface.get(index)?;
            for replaced in [a, b] {
                let corners = before.corners.map(|point| if point == replaced { new } else { point });
                let after = Triangle { corners, ..before };
                let at = surface.corners_after(&change, &after);
                if normal(at).dot(normal(surface.corners(before.corners))) <= 0.0 || shape(at) < LEAST_SHAPE {
                    return None;
                }
                change.added.push(after);
            }
        }
        Some(change)
    }

    /// These triangles go.
    pub fn removal(triangles: Vec<u32>) -> Self {
        Self { removed: triangles, added: Vec::new(), moved: None }
    }
}

/// The link condition: the only points next to both are those across the shared triangles; and an edge inside of
/// an open surface does not join two of its borders.
fn links_agree(surface: &Surface, a: u32, b: u32) -> bool {
    let shared = surface.at_edge(a, b);
    let across = |&t: &u32| surface.get(t)?.corners.into_iter().find(|&p| p != a && p != b);
    let mut across: Vec<u32> = shared.iter().filter_map(across).collect();
    across.sort_unstable();
    across.dedup();
    let of_b = surface.neighbours(b);
    let common = surface.neighbours(a).into_iter().filter(|point| of_b.binary_search(point).is_ok());
    if !common.eq(across) {
        return false;
    }
    shared.len() < 2 || !(surface.is_border(a) && surface.is_border(b))
}

/// Whether a triangle may become another one.
fn keeps(before: [Vec3; 3], after: [Vec3; 3]) -> bool {
    let (old, new) = (normal(before), normal(after));
    let turned = old.dot(new) < LEAST_COSINE * old.length() * new.length();
    // What had no direction may get any.
    (!turned || old == Vec3::ZERO) && new != Vec3::ZERO && shape(after) > LEAST_SHAPE.min(0.9 * shape(before))
}

fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}

/// 1 for an equilateral triangle, 0 for one without area.
fn shape(corners: [Vec3; 3]) -> f32 {
    let [a, b, c] = corners;
    let squares = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
    2.0 * 3.0f32.sqrt() * normal(corners).length() / squares.max(f32::MIN_POSITIVE)
}

/// The corners from `a` or `b` on, so that the edge between them is the first one.
fn rotated([x, y, z]: [u32; 3], a: u32, b: u32) -> Option<[u32; 3]> {
    [[x, y, z], [y, z, x], [z, x, y]]
        .into_iter()
        .find(|t| (t[0] == a && t[1] == b) || (t[0] == b && t[1] == a))
}

/// Whether a triangle goes from `a` to `b`.
fn runs([x, y, z]: [u32; 3], a: u32, b: u32) -> bool {
    [[x, y], [y, z], [z, x]].contains(&[a, b])
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::Mesh;

    /// A square of two triangles, and a third one that stands on its diagonal if asked for.
    fn square(with_fin: bool) -> Surface {
        let positions = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0), (0.5, 0.5, 1.0)];
        let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
        triangles.extend(with_fin.then_some([0, 2, 4]));
        Surface::new(&Mesh {
            positions: positions.map(|(x, y, z)| Vec3::new(x, y, z)).to_vec(),
            triangle_materials: vec![0; triangles.len()],
            triangles,
            ..Mesh::default()
        })
    }

    /// Protects flips: the other diagonal, with the same orientation; none where an edge has three triangles or
    /// separates materials.
    #[test]
    fn flips_take_the_other_diagonal() {
        let surface = square(false);
        let change = Change::flip(&surface, 0, 2);
        let added: Vec<[u32; 3]> = change.iter().flat_map(|c| &c.added).map(|t| t.corners).collect();
        assert_eq!(added.len(), 2);
        for corners in added {
            assert!(normal(surface.corners(corners)).z > 0.0, "{corners:?}");
            assert!(corners.contains(&1) && corners.contains(&3));
        }
        assert_eq!(Change::flip(&surface, 0, 1), None, "a border has no other side");
        assert_eq!(Change::flip(&square(true), 0, 2), None);
    }

    /// Protects orientation: a point may not cross the edge on its other side, nor come to lie on it.
    #[test]
    fn triangles_do_not_turn_over() {
        let surface = square(false);
        assert!(Change::shift(&surface, 1, Vec3::new(1.2, -0.2, 0.0)).is_some());
        assert_eq!(Change::shift(&surface, 1, Vec3::new(0.0, 1.0, 0.0)), None);
        assert_eq!(Change::shift(&surface, 1, Vec3::new(0.5, 0.5, 0.0)), None);
    }

    /// Protects sheets from being pinched: the edge inside joins two borders and may not collapse, those of the
    /// border may.
    #[test]
    fn borders_are_not_joined() {
        let surface = square(false);
        assert_eq!(Change::collapse(&surface, 2, 0, Vec3::new(0.5, 0.5, 0.0)), None);
        let change = Change::collapse(&surface, 1, 0, Vec3::ZERO);
        assert_eq!(change.map(|c| (c.removed.len(), c.added.len())), Some((2, 1)));
    }
}
