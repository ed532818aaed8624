//! Which chart each texel belongs to, all over the texture, and shifts that stay in their chart.
//!
//! A shifted coordinate that lands in another chart shows what that chart has for its own
//! surface: right by luck, and wrong as soon as either is minified. So every texel belongs to
//! the chart that is nearest to it, and where a shift would cross the border, the
//! coefficients that made it are made smaller, until no pixel of any training view crosses.
//!
//! Contract: coefficients only shrink; a map without strays stays to the bit. The result does
//! not depend on the number of threads.

use parbake_model::glam::Vec2;
use parbake_render::directions::ViewDirection;
use parbake_render::parallax::ParallaxCoefficients;
use parbake_views::chart_labels::{Atlas, NO_CHART};
use parbake_views::view_sample::ViewSample;
use rayon::prelude::*;

/// The owners of a texture's texels.
#[derive(Clone, Debug)]
pub struct ChartOwnership {
    size: usize,
    owner: Vec<u32>,
}

impl ChartOwnership {
    /// From an atlas whose charts were grown until they met.
    pub fn new(grown: &Atlas) -> Self {
        Self { size: grown.size, owner: grown.label.clone() }
    }

    /// The owner of a coordinate; [`NO_CHART`] outside the texture.
    #[inline]
    pub fn owner(&self, uv: Vec2) -> u32 {
        let at = (uv * self.size as f32).floor();
        let inside = |x: f32| x >= 0.0 && x < self.size as f32;
        if !(inside(at.x) && inside(at.y)) {
            return NO_CHART;
        }
        self.owner[at.y as usize * self.size + at.x as usize]
    }

    /// Whether a shift leads from one owner to another.
    #[inline]
    fn crosses_a_border(&self, map: &ParallaxCoefficients, uv: Vec2, view_direction: &ViewDirection) -> bool {
        self.owner(uv + map.shift(uv, view_direction)) != self.owner(uv)
    }
}

/// By how much a texel's coefficients shrink when a shift of theirs crosses a border.
const SHRINK: f32 = 0.85;
/// Rounds at most: after these a shift is less than 1 % of what it was.
const ROUNDS: usize = 32;

/// Shrinks coefficients until no shift crosses a border, but for pixels that lie on one.
/// Returns the share of pixels whose shifts did at first, and at the end.
pub fn clamp_to_chart(
    views: &[Vec<ViewSample>],
    chart_ownership: &ChartOwnership,
    map: &mut ParallaxCoefficients,
) -> [f64; 2] {
    let (first, mut crossing_pixels) = crossing(views, chart_ownership, map);
    let count = map.basis.count();
    for _ in 0..ROUNDS {
        crossing_pixels
            .retain(|(uv, view_direction)| chart_ownership.crosses_a_border(map, *uv, view_direction));
        if crossing_pixels.is_empty() {
            break;
        }
        let mut shrink = vec![false; map.width * map.height];
        for texel in crossing_pixels.iter().flat_map(|(uv, _)| map.taps(*uv).index) {
            shrink[texel as usize] = true;
        }
        for (texel, _) in shrink.into_iter().enumerate().filter(|(_, shrink)| *shrink) {
            map.coefficients[texel * count..(texel + 1) * count].iter_mut().for_each(|c| *c *= SHRINK);
        }
    }
    // A shift that became smaller ends elsewhere, and that may be another chart's bay.
    [first, if first > 0.0 { crossing(views, chart_ownership, map).0 } else { 0.0 }]
}

/// The pixels whose shifts cross a border, and their share in all.
fn crossing(
    views: &[Vec<ViewSample>],
    chart_ownership: &ChartOwnership,
    map: &ParallaxCoefficients,
) -> (f64, Vec<(Vec2, ViewDirection)>) {
    let crossing_pixels: Vec<(Vec2, ViewDirection)> = (views.par_iter())
        .flat_map_iter(|view| {
            let pixels = view.iter().map(|pixel| (pixel.uv, pixel.view_direction()));
            pixels.filter(|(uv, view_direction)| chart_ownership.crosses_a_border(map, *uv, view_direction))
        })
        .collect();
    let all: usize = views.iter().map(Vec::len).sum();
    (crossing_pixels.len() as f64 / all.max(1) as f64, crossing_pixels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_model::Basis;
    use parbake_model::glam::Vec3;

    /// Protects other charts' colours: a border is seen, and so is the texture's edge.
    #[test]
    fn shifts_across_a_border_stray() {
        let label = (0..16).map(|i| u32::from(i % 4 >= 2)).collect();
        let chart_ownership = ChartOwnership::new(&Atlas { size: 4, label, covered: vec![true; 16] });
        let mut map = ParallaxCoefficients::zeros(Basis::Harmonics(0), 1);
        let view_direction = ViewDirection { direction: Vec3::Z, cosine: 1.0 };
        let mut strays = |x: f32, from: f32| {
            map.coefficients[0] = Vec2::new(x / 0.282_094_8, 0.0);
            chart_ownership.crosses_a_border(&map, Vec2::new(from, 0.5), &view_direction)
        };
        assert!(!strays(0.2, 0.25) && strays(0.3, 0.25));
        assert!(!strays(0.2, 0.75) && strays(0.3, 0.75));
    }

    /// Protects other charts' colours from shifted fetches, and shifts that end in their own chart from being
    /// made smaller: those stay to the bit.
    #[test]
    fn crossing_shifts_shrink_and_others_stay() {
        let label = (0..64).map(|i| u32::from(i % 8 >= 4)).collect();
        let chart_ownership = ChartOwnership::new(&Atlas { size: 8, label, covered: vec![true; 64] });
        let mut map = ParallaxCoefficients::zeros(Basis::Harmonics(0), 8);
        map.coefficients.fill(Vec2::new(0.05, 0.0));
        let before = map.clone();
        // Seen at a grazing angle, where a coefficient of 0.05 shifts by 0.056: only the last one crosses.
        let views = [vec![ViewSample::at(Vec2::new(0.2, 0.2)), ViewSample::at(Vec2::new(0.3, 0.2))]];
        assert_eq!(clamp_to_chart(&views, &chart_ownership, &mut map), [0.0, 0.0]);
        assert!(map == before);
        let views = [vec![ViewSample::at(Vec2::new(0.2, 0.2)), ViewSample::at(Vec2::new(0.47, 0.8))]];
        assert_eq!(clamp_to_chart(&views, &chart_ownership, &mut map), [0.5, 0.0]);
        let read = map.taps(Vec2::new(0.47, 0.8)).index;
        for (texel, (now, old)) in map.coefficients.iter().zip(&before.coefficients).enumerate() {
            let shrinks = read.contains(&(texel as u32));
            assert!(if shrinks { now.x > 0.0 && now.x < old.x } else { now == old }, "{texel}: {now}");
        }
    }
}
