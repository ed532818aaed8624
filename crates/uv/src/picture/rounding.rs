//! Coordinates as a file holds them: in two bytes each where that halves it, else in four.

use parbake_atlas::Layout;
use parbake_atlas::predicates::orientation;
use parbake_model::glam::DVec2;
use parbake_model::{short_uv, short_uvs_pay};

/// The layout at coordinates that a file of it holds; None where a triangle turns over by that.
pub fn as_written(mut layout: Layout) -> Option<Layout> {
    let is_upright = |[a, b, c]: [DVec2; 3]| orientation(a, b, c) > 0.0;
    let is_sound = |layout: &Layout| (0..layout.triangles.len()).all(|t| is_upright(layout.corners(t)));
    if short_uvs_pay(layout.points.len()) {
        let points = layout.points.iter().map(|p| short_uv(p.as_vec2()).as_dvec2()).collect();
        let short = Layout { points, ..layout.clone() };
        if is_sound(&short) {
            return Some(short);
        }
    }
    layout.round();
    is_sound(&layout).then_some(layout)
}

#[cfg(test)]
mod tests {
    use super::super::plane::Plane;
    use super::*;
    use parbake_model::glam::dvec2;

    fn moved(cells: usize, by: impl Fn(usize) -> DVec2) -> Layout {
        let plane = Plane { cells };
        let points = plane.points().into_iter().enumerate().map(|(i, p)| p.as_dvec2() * 0.5 + by(i));
        plane.layout(points.collect())
    }

    /// Protects what is written: coordinates of large planes fit into two bytes, unless that turned a
    /// triangle over, those of small ones stay, and a plane that is not sound is refused.
    #[test]
    fn large_planes_are_rounded_while_they_stay_sound() {
        let is_short = |layout: &Layout| layout.uvs().iter().all(|&uv| short_uv(uv) == uv);
        let shift = dvec2(1e-7, 0.1234567);
        assert!(is_short(&as_written(moved(120, |_| shift)).unwrap()));
        assert!(!is_short(&as_written(moved(20, |_| shift)).unwrap()));
        // A point a hair off the edge between its neighbours, which rounding moves across it.
        let cell = 0.5 / 120.0;
        let squeezed = |i: usize| shift + if i == 122 { dvec2(0.0, -cell + 1e-6) } else { DVec2::ZERO };
        let kept = as_written(moved(120, squeezed)).unwrap();
        assert!(!is_short(&kept));
        assert!(
            as_written(moved(120, |i| shift + if i == 122 { dvec2(0.0, -1.5 * cell) } else { DVec2::ZERO }))
                .is_none()
        );
    }
}
