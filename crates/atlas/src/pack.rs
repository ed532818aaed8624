//! Packing: the charts of a layout moved, turned and scaled into the unit square, so
//! that they cover as much of it as possible and keep a gutter.
//!
//! Charts are packed by shape, on a grid at least as fine as the texels, and may lie in
//! each other's bays and holes. See `pack/search.rs` for the search, `pack/board.rs` for
//! how a place is found and `pack/mask.rs` for why the gutter is kept exactly.

mod board;
pub(crate) mod free_space;
mod mask;
mod pieces;
mod polygon;
mod rounding;
mod search;
mod shelves;

use crate::{AtlasError, Layout};
use glam::{DVec2, dvec2};
pub(crate) use pieces::LEAST_EXTENT;
use pieces::Piece;
use search::{Arrangement, Square, search};

/// How charts are scaled relative to each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ChartScale {
    /// As they are in the layout.
    #[default]
    Keep,
    /// All charts get the same number of texels per unit of surface.
    Equal,
    /// For each chart a factor on its size in the layout, finite and positive.
    Given(Vec<f64>),
}

/// What [`pack()`] aims at.
#[derive(Clone, Debug, PartialEq)]
pub struct PackOptions {
    /// Side of the texture in texels, at least 1.
    pub texture_size: usize,
    /// Least distance between charts in texels, at least 0. Half of it, and no less than
    /// half a texel, stays free along the border.
    pub gutter_texels: f64,
    /// Whether charts may be turned.
    pub rotate: bool,
    /// How long to search for a denser packing: 0 takes what a coarse grid gives, 1 some
    /// tenths of a second for tens of charts and seconds for a thousand. More tries more
    /// sizes, and more directions of each chart.
    pub effort: usize,
    /// The charts' relative scales.
    pub chart_scale: ChartScale,
}

impl Default for PackOptions {
    fn default() -> Self {
        Self {
            texture_size: 1024,
            gutter_texels: 2.0,
            rotate: true,
            effort: 1,
            chart_scale: ChartScale::Keep,
        }
    }
}

/// From this number of charts on they are packed by their boxes.
const MOST_SHAPES: usize = 4000;

/// Cells along a side of the coarsest grid.
const COARSE_CELLS: usize = 256;

/// Packs a layout's charts into the unit square.
///
/// Charts are moved, turned and scaled, never mirrored; charts that share a point move
/// as one. Any two pieces end at least the gutter apart, in Euclidean distance, also
/// where they overlapped before. All scales are relative (see [`ChartScale`]), but no
/// piece's longer side gets shorter than 1e-4 of the square. The result is rounded
/// ([`Layout::round`]), with no triangle turned over by that.
///
/// # Errors
///
/// [`AtlasError::InvalidOption`] for options out of range, [`AtlasError::NoRoom`] where
/// the gutters alone fill the square, [`AtlasError::TooThin`] where rounding turns a
/// triangle over.
pub fn pack(layout: &Layout, options: &PackOptions) -> Result<Layout, AtlasError> {
    if options.texture_size == 0 {
        return Err(AtlasError::InvalidOption { name: "texture_size", wanted: "at least 1" });
    }
    if !(options.gutter_texels >= 0.0 && options.gutter_texels.is_finite()) {
        return Err(AtlasError::InvalidOption { name: "gutter_texels", wanted: "finite and at least 0" });
    }
    let pieces = pieces::pieces(layout, options)?;
    let mut packed = layout.clone();
    if pieces.is_empty() {
        return Ok(packed);
    }
    let size = options.texture_size as f64;
    let no_room = || AtlasError::NoRoom {
        charts: pieces.len(),
        texture_size: options.texture_size,
        gutter_texels: options.gutter_texels,
    };
    let border = (0.5 * options.gutter_texels).max(0.5) / size;
    // What may be packed is the square inside the border.
    let inner = 1.0 - 2.0 * border;
    if inner <= 0.0 {
        return Err(no_room());
    }
    // Rounding takes up to 3e-8 of each coordinate, touching cells up to 1e-7 of a cell.
    let gutter = (options.gutter_texels / size + 1e-6) / inner;
    let arrangement = arrange(&pieces, size * inner, gutter, options).ok_or_else(no_room)?;
    for (piece, points) in pieces.iter().zip(stretched(&pieces, &arrangement)) {
        for (&index, point) in piece.indices.iter().zip(points) {
            packed.points[index as usize] = point * inner + border;
        }
    }
    rounding::round(&mut packed)?;
    Ok(packed)
}

/// Places for all pieces in the unit square with a gutter in parts of it; `texels` is its
/// side.
fn arrange(pieces: &[Piece], texels: f64, gutter: f64, options: &PackOptions) -> Option<Arrangement> {
    if pieces.len() > MOST_SHAPES {
        let (scale, corners) = shelves::shelves(pieces, gutter)?;
        let axes = pieces.iter().map(|piece| piece.directions[0]).collect();
        return Some(Arrangement { scale, axes, corners });
    }
    // As fine as the texels; on smaller textures up to 64 charts of average size are at least some 64 cells wide.
    let by_charts = (64.0 * (pieces.len() as f64).sqrt()).clamp(256.0, 512.0);
    let cells = texels.max(by_charts).ceil() as usize;
    let doubled = std::iter::successors(Some(COARSE_CELLS), |grid| Some(2 * grid));
    // Coarser grids have less than two thirds of the finest one's cells along a side.
    let mut grids: Vec<usize> = doubled.take_while(|grid| 3 * grid < 2 * cells).chain([cells]).collect();
    if options.effort == 0 {
        grids.truncate(1);
    }
    let square = |cells| Square { cells, gutter, rotate: options.rotate };
    let squares: Vec<Square> = grids.into_iter().map(square).collect();
    search(pieces, &squares, options.effort)
}

/// The pieces' points, the whole arrangement scaled up about the corner until it touches
/// a far side, and centred along the other. Growing together moves nothing closer.
fn stretched(pieces: &[Piece], arrangement: &Arrangement) -> Vec<Vec<DVec2>> {
    let place = |factor: f64| -> Vec<Vec<DVec2>> {
        pieces
            .iter()
            .enumerate()
            .map(|(i, piece)| {
                let corner = arrangement.corners[i];
                piece
                    .placed(arrangement.scale, arrangement.axes[i])
                    .iter()
                    .map(|&p| (p + corner) * factor)
                    .collect()
            })
            .collect()
    };
    let reach = polygon::bounds(place(1.0).into_iter().flatten()).1;
    let factor = if reach.max_element() > 0.0 { 1.0 / reach.max_element() } else { 1.0 };
    let rest = (DVec2::ONE - reach * factor).max(dvec2(0.0, 0.0)) * 0.5;
    let mut placed = place(factor);
    for p in placed.iter_mut().flatten() {
        *p = (*p + rest).min(DVec2::ONE);
    }
    placed
}
