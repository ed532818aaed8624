//! The proof that a texture layout is sound, and how good it is.
//!
//! A layout is sound if each point of the texture belongs to one point of the surface
//! at most: every triangle keeps its orientation and an area, none lies on another one,
//! all lie in the square. These are decided exactly ([`crate::predicates`]), on the
//! numbers that the layout holds; lengths, areas and statistics are rounded.
//!
//! ```text
//! orientations   flipped, mirrored, without area, outside
//! overlaps       triangles on each other, and the covered share     ┐ on
//! gutter         distances between charts and to the border         ┘ box_tree
//! distortion     stretch, area scale, anisotropy
//! sentences      the problems in words
//! ```

pub(crate) mod box_tree;
mod distortion;
pub(crate) mod gutter;
mod orientations;
mod overlaps;
mod sentences;

use crate::Layout;
use serde::{Deserialize, Serialize};

/// Triangles, charts and pairs that a [`UvCheck`] names at most of each kind.
pub const FIRST: usize = 5;

/// What [`check`] found out about a layout.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UvCheck {
    /// Texels along either side of the texture for which lengths are given.
    pub texture_size: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of charts.
    pub charts: usize,
    /// Flipped, mirrored, degenerate and outlying triangles.
    pub orientations: Orientations,
    /// Triangles that lie on each other.
    pub overlaps: Overlaps,
    /// Distances between charts; `None` where there are not two of them.
    pub gutter: Option<Gutter>,
    /// The smallest distance from a triangle to the border of the square, in texels;
    /// negative where one lies outside; `None` without triangles.
    pub border: Option<f64>,
    /// The share of the square that triangles cover, 0 to 1: the sum of their areas
    /// where no overlaps were found and nothing lies outside, else counted at 512 × 512
    /// points.
    pub utilisation: f64,
    /// Stretch, area scale and anisotropy; `None` where nothing has an area.
    pub distortion: Option<Distortion>,
}

/// How many there are, and which.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Found {
    /// Number of all.
    pub count: usize,
    /// The indices of the first [`FIRST`] of them.
    pub first: Vec<u32>,
}

/// Triangles by the exact signs of their areas.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Orientations {
    /// Triangles with a negative area, in charts that are not mirrored as a whole.
    pub flipped: Found,
    /// Charts of which all triangles that have an area have a negative one.
    pub mirrored_charts: Found,
    /// Triangles with a negative area in mirrored charts.
    pub mirrored_triangles: usize,
    /// Triangles with an area in space and none in the texture.
    pub degenerate: Found,
    /// Triangles without an area in space, which nobody sees. They may be flipped and
    /// overlap like others; that they have no area in the texture either is no fault.
    pub without_surface: Found,
    /// Triangles with a corner outside the square [0, 1]².
    pub outside: Found,
    /// Triangles with a coordinate that is not a finite number. Nothing else is said
    /// of them.
    pub not_finite: Found,
}

/// Pairs of triangles whose interiors meet.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Overlaps {
    /// Number of pairs; at least so many where not `complete`.
    pub pairs: usize,
    /// Whether all pairs have been looked at. The search ends early on layouts with
    /// more than about a million overlaps.
    pub complete: bool,
    /// Sum of the areas that the found pairs have in common, in squares.
    pub area: f64,
    /// The same in texels.
    pub texels: f64,
    /// The first [`FIRST`] found pairs.
    pub first: Vec<Overlap>,
}

/// Two triangles that lie on each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Overlap {
    /// Their indices, the smaller one first.
    pub triangles: [u32; 2],
    /// The centre of what they have in common, in the layout's coordinates.
    pub place: [f64; 2],
    /// The area that they have in common, in texels.
    pub texels: f64,
}

/// Distances between boundary edges of different charts, in texels.
///
/// Charts of triangles that have an area neither in space nor in the texture do not
/// count.
///
/// A chart inside another one is apart from its boundary; that is an overlap, not a
/// narrow gutter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gutter {
    /// The smallest distance; 0 where charts touch or their boundaries cross.
    pub texels: f64,
    /// Whether all searches came to their ends; where not, the distances are lower
    /// bounds. Only layouts with very many edges equally far from each other are so.
    pub complete: bool,
    /// 5 % of the boundaries' length belongs to edges that come as near as this to
    /// another chart, or nearer.
    pub quantile_5: f64,
    /// The two charts that come nearest, the smaller index first.
    pub charts: [u32; 2],
    /// Where they do, in the layout's coordinates.
    pub place: [f64; 2],
}

/// How unevenly the texels are shared out; formulas at the module `distortion`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distortion {
    /// L² texture stretch of Sander et al. 2001, 1 or more, over the triangles that
    /// have an area in the texture.
    pub stretch_l2: f64,
    /// L^∞ texture stretch, likewise.
    pub stretch_max: f64,
    /// Symmetric Dirichlet energy, 4 or more, likewise; 0 in reports of before it was measured.
    #[serde(default)]
    pub symmetric_dirichlet: f64,
    /// Texels along a unit of length on the surface: the root of texels of texture area
    /// for a unit of surface, in the mean.
    pub texels_per_unit: f64,
    /// Texels for a unit of surface, relative to the mean; 0 for triangles without
    /// area in the texture.
    pub area_scale: Quantiles,
    /// Ratio of the larger to the smaller scale, 1 or more, over the triangles that
    /// have an area in the texture.
    pub anisotropy: Quantiles,
}

/// Values up to which shares of the surface lie.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// For 1 %.
    pub q1: f64,
    /// For 5 %.
    pub q5: f64,
    /// For 50 %.
    pub q50: f64,
    /// For 95 %.
    pub q95: f64,
    /// For 99 %.
    pub q99: f64,
}

/// Checks a layout, for a texture of `texture_size` × `texture_size` texels.
///
/// The cost is that of sorting the triangles for layouts in which few overlap, and
/// bounded for all others ([`Overlaps::complete`]). The result is the same for any
/// number of threads.
pub fn check(layout: &Layout, texture_size: usize) -> UvCheck {
    let orientations = orientations::orientations(layout);
    let interiors = overlaps::Interiors::new(layout);
    let overlaps = interiors.overlaps(texture_size);
    let sum_is_cover = overlaps.pairs == 0 && orientations.outside.count == 0;
    UvCheck {
        texture_size,
        triangles: layout.triangles.len(),
        charts: layout.charts.iter().max().map_or(0, |&c| c as usize + 1),
        gutter: gutter::gutter(layout, texture_size),
        border: gutter::border(layout, texture_size),
        utilisation: if sum_is_cover { interiors.total_area().min(1.0) } else { interiors.sampled_cover() },
        distortion: distortion::distortion(layout, texture_size),
        orientations,
        overlaps,
    }
}

impl UvCheck {
    /// Whether the layout is sound: nothing flipped or mirrored, no triangle of the
    /// surface without area in the texture, no overlaps, nothing outside the square.
    pub fn is_bijective(&self) -> bool {
        let o = &self.orientations;
        let faults = [&o.flipped, &o.mirrored_charts, &o.degenerate, &o.outside, &o.not_finite];
        faults.iter().all(|found| found.count == 0) && self.overlaps.pairs == 0 && self.overlaps.complete
    }

    /// One sentence for each kind of problem, for people; none exactly where
    /// [`UvCheck::is_bijective`].
    pub fn problems(&self) -> Vec<String> {
        sentences::problems(self)
    }
}
