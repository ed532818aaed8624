//! Texels that several parts of a surface share on purpose, recognised in a layout.
//!
//! Artists draw one half of a face and use it twice, stack equal screws on one drawing, and let a pattern
//! repeat. Such parts lie on each other with most of their area, where a fault is a few triangles.
//!
//! ```text
//! mirrored   parts of opposite orientation on each other: two halves
//! stacked    parts of one orientation on each other: copies
//! repeating  charts longer than the texture: tiling
//! ```

use crate::Layout;
use crate::conflicts::overlapping;
use crate::predicates::{counter_clockwise, intersection, orientation};
use glam::DVec2;
use parbake_model::Mesh;
use std::collections::BTreeMap;

/// Two parts share texels on purpose if so much of the smaller one's area lies on the other.
const MOST_OF_IT: f64 = 0.5;
/// Part of a chart's area that its mirrored part must be for the chart to have two halves.
const HALF: f64 = 0.2;

/// What was recognised, in numbers of charts, or of halves of charts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sharing {
    /// Parts that lie on their mirror images.
    pub mirrored: usize,
    /// Parts that lie on parts of the same orientation.
    pub stacked: usize,
    /// Charts longer than the texture, which repeats on them.
    pub repeating: usize,
}

/// Recognises shared texels in a mesh's first set of texture coordinates. Layouts in which more than some
/// hundred thousand pairs of triangles overlap are looked at for repetition alone.
pub fn sharing(mesh: &Mesh) -> Sharing {
    if mesh.uvs.is_empty() || !mesh.uvs.iter().all(|uv| uv.is_finite()) {
        return Sharing::default();
    }
    in_layout(&Layout::new(mesh))
}

pub(crate) fn in_layout(layout: &Layout) -> Sharing {
    let count = layout.charts.iter().max().map_or(0, |c| *c as usize + 1);
    let mut boxes = vec![[DVec2::INFINITY, DVec2::NEG_INFINITY]; count];
    // By chart, its triangles that are not mirrored and those that are.
    let mut area = vec![[0.0; 2]; count];
    let part = |t: usize| {
        let [a, b, c] = layout.corners(t);
        (layout.charts[t] as usize, usize::from(orientation(a, b, c) < 0.0))
    };
    for t in 0..layout.triangles.len() {
        let (chart, side) = part(t);
        area[chart][side] += 0.5 * layout.doubled_area(t).abs();
        let [low, high] = &mut boxes[chart];
        for p in layout.corners(t) {
            (*low, *high) = (low.min(p), high.max(p));
        }
    }
    let is_long = |[low, high]: &&[DVec2; 2]| (*high - *low).max_element() > 1.01;
    let mut found = Sharing { repeating: boxes.iter().filter(is_long).count(), ..Sharing::default() };
    let mut common: BTreeMap<[(usize, usize); 2], f64> = BTreeMap::new();
    for [a, b] in overlapping(layout).unwrap_or_default() {
        let (one, other) = (part(a as usize), part(b as usize));
        let corners = |t: u32| counter_clockwise(layout.corners(t as usize));
        // A few triangles of one side of a chart that lie on each other are no copies.
        if let (Some(a), Some(b)) = (corners(a), corners(b))
            && one != other
            && let Some((area, _)) = intersection(a, b)
        {
            *common.entry([one.min(other), one.max(other)]).or_default() += area;
        }
    }
    let (mut mirrored, mut stacked) = (Vec::new(), Vec::new());
    for ([one, other], common) in common {
        let of = |(chart, side): (usize, usize)| area[chart][side];
        let least = of(one).min(of(other));
        let halves = one.0 != other.0 || least > HALF * (of(one) + of(other));
        if common > MOST_OF_IT * least && halves {
            let list = if one.1 == other.1 { &mut stacked } else { &mut mirrored };
            list.extend([one, other]);
        }
    }
    let distinct = |mut parts: Vec<(usize, usize)>| {
        parts.sort_unstable();
        parts.dedup();
        parts.len()
    };
    (found.mirrored, found.stacked) = (distinct(mirrored), distinct(stacked));
    found
}

impl Sharing {
    /// One sentence; none where nothing is shared.
    pub fn sentence(&self) -> Option<String> {
        let mut parts = Vec::new();
        let mut say = |count: usize, one: &str, many: &str| match count {
            0 => {}
            1 => parts.push(format!("1 {one}")),
            _ => parts.push(format!("{count} {many}")),
        };
        say(self.mirrored, "part lies on its mirror image", "parts lie on their mirror images");
        say(
            self.stacked,
            "part lies on a copy of the same orientation",
            "parts lie on copies of the same orientation",
        );
        say(self.repeating, "chart repeats the texture", "charts repeat the texture");
        (!parts.is_empty()).then(|| {
            format!(
                "The delivered texture coordinates share texels, apparently on purpose: {}.",
                parts.join(", ")
            )
        })
    }
}
