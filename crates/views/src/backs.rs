//! Which materials of a low-poly show the backs of their triangles.
//!
//! Open sheets show them, closed surfaces do not. What is closed may be shown from both sides, so that small holes of a
//! low-poly do not show; an open sheet whose material is single-sided must not be, since viewers see through it from
//! behind. Engines draw single-sided materials faster.

use crate::alpha_layers::{LayerKind, high_kind, high_layers};
use crate::high_poly::{HighPoly, ViewSet};
use crate::layer_factors::Shares;
use crate::reference::Sampling;
use parbake_model::AlphaMode;
use parbake_render::on_screen::Raster;
use parbake_render::raster::{NOTHING, Visibility};
use rayon::prelude::*;

/// Views that are asked, and their size in pixels.
const VIEWS: usize = 16;
const SIZE: usize = 96;
/// A layer is an open sheet where more than this share of what is seen of it are backs. Where nearly all are, its
/// triangles only wind the other way.
const SHEET: std::ops::Range<f64> = 0.1..0.9;

/// Layers of the high-poly, and whether their materials are to be double-sided; those that are not in the list are.
/// Open sheets and what is seen through are as most of their area in the high-poly, with `keeps` all layers are.
pub fn sides(high: &HighPoly, keeps: bool) -> Vec<(LayerKind, bool)> {
    if !keeps && !high.is_whole_material {
        return Vec::new();
    }
    let of = |(kind, triangles): (LayerKind, Vec<u32>)| {
        let shows_through = kind.transmits || kind.mode == AlphaMode::Blend;
        let is_kept = keeps || shows_through || shows_backs(high, kind);
        (kind, !is_kept || Shares::of(&triangles, high).double_sided(high))
    };
    high_layers(high).into_iter().map(of).collect()
}

/// Whether a layer is an open sheet: a part of what views see of it, but not nearly all, are backs.
pub(crate) fn shows_backs(high: &HighPoly, kind: LayerKind) -> bool {
    let sampling = Sampling { size: SIZE, filter: 1.0, samples: 1 };
    let set = ViewSet { count: VIEWS, seed: 0, jitter: false, sampling };
    let mesh = high.scene.mesh();
    let seen = set.views(&high.conventions.rig).into_par_iter().map(|view| {
        let mut seen = Visibility::default();
        high.scene.on_screen(&view.camera, SIZE).rasterise(SIZE, (0.0, 0.0), None, &mut seen);
        let own = seen.triangle.iter().filter(|&&t| t != NOTHING).map(|&t| t as usize);
        own.filter(|&t| high_kind(high, t) == kind).fold([0usize; 2], |[backs, all], t| {
            let corner = mesh.positions[mesh.triangles[t][0] as usize];
            let is_back = view.camera.view_direction(corner).dot(mesh.area_normal(t)) < 0.0;
            [backs + usize::from(is_back), all + 1]
        })
    });
    let [backs, all] = seen.reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    SHEET.contains(&(backs as f64 / all.max(1) as f64))
}
