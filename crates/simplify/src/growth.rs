//! What a change of the surface would do to the error of one view.
//!
//! A change concerns the rectangle around what goes and what comes: pixels that a new triangle covers take the nearer of
//! both, pixels that lose theirs look for the next behind in their tile. Nothing is drawn, so what a trial
//! costs depends on its own size and not on the surface's.
//!
//! Contract: nothing that is asked for changes the view; where a new triangle lies behind the one that it replaces,
//! what may come to light between them is not looked for.

use crate::change::Change;
use crate::raster::{Edges, Rectangle, Span};
use crate::surface::Surface;
use crate::target::{Target, projected};
use crate::view::{NOTHING, TILE, View};

/// A pixel that was looked at; less than any nearness.
const DONE: f32 = -1.0;

/// Memory that evaluations reuse.
#[derive(Default)]
pub struct Scratch {
    triangles: Vec<Flat>,
    spans: Vec<Span>,
    nearness: Vec<f32>,
    hole: Hole,
}

/// The pixels of a view that lose their triangle: the same for all changes that remove the same triangles.
#[derive(Default)]
struct Hole {
    is_known: bool,
    pixels: Vec<Lost>,
}

/// A pixel that loses its triangle.
struct Lost {
    column: u32,
    row: u32,
    /// The error until now.
    error: f32,
    /// The nearness of what comes to light, once it was asked for.
    behind: Option<f32>,
}

/// A triangle on the screen.
struct Flat {
    /// Its index, if it is one of the surface.
    index: u32,
    /// Column, row and nearness.
    corners: [[f32; 3]; 3],
    /// Pixels that it may cover.
    within: Rectangle,
}

impl Flat {
    fn new(index: u32, corners: [[f32; 3]; 3], size: usize) -> Self {
        Self { index, corners, within: Rectangle::of(&corners, size) }
    }
}

impl View {
    /// By how much each of several changes would add to the error.
    pub fn growths<'a>(
        &self,
        target: &Target,
        surface: &Surface,
        changes: impl Iterator<Item = &'a Change>,
        scratch: &mut Scratch,
    ) -> Vec<f64> {
        let mut removed: Option<&[u32]> = None;
        let one = |change: &'a Change| {
            scratch.hole.is_known &= removed.replace(&change.removed) == Some(&change.removed[..]);
            self.growth(target, surface, change, scratch)
        };
        changes.map(one).collect()
    }

    /// Finds the pixels at which triangles are seen.
    fn open(&self, triangles: &[Flat], size: usize, hole: &mut Hole) {
        hole.is_known = true;
        hole.pixels.clear();
        for Flat { index, corners, within } in triangles {
            self.seen_at(*index, corners, *within, size, |column, row, shown| {
                let (column, row) = (column as u32, row as u32);
                hole.pixels.push(Lost { column, row, error: shown.error, behind: None });
            });
        }
    }

    /// By how much a change would add to the error.
    fn growth(&self, target: &Target, surface: &Surface, change: &Change, scratch: &mut Scratch) -> f64 {
        let size = target.size;
        let moved = change.moved.map(|(point, position)| (point, projected(&target.camera, size, position)));
        let place = |point: u32| match moved {
            Some((own, at)) if own == point => at,
            _ => self.points[point as usize],
        };
        let Scratch { triangles, spans, nearness, hole } = scratch;
        triangles.clear();
        let removed = change.removed.iter().filter_map(|&t| surface.get(t).map(|own| (t, own.corners)));
        triangles.extend(removed.map(|(index, points)| Flat::new(index, self.corners(points), size)));
        let (added, going) = (change.added.iter().map(|own| own.corners.map(place)), triangles.len());
        triangles.extend(added.map(|corners| Flat::new(NOTHING, corners, size)));
        let within = triangles.iter().fold(Rectangle::default(), |all, own| all.around(own.within));
        let corners = triangles.iter().flat_map(|own| &own.corners);
        let nearest = corners.fold(0.0f32, |nearest, [_, _, near]| nearest.max(*near));
        if self.is_hidden(within, nearest, size) {
            return 0.0;
        }
        let width = within.width();
        nearness.clear();
        nearness.resize(width * within.height(), 0.0);
        let at = |x: usize, y: usize| (y - within.y0) * width + x - within.x0;
        let (removed, added) = triangles.split_at(going);
        spans.clear();
        for triangle in added {
            let Some(edges) = Edges::new(&triangle.corners) else { continue };
            edges.each_span(triangle.within, |span| {
                let first = at(span.first, span.row);
                let news = &mut nearness[first..first + span.end - span.first];
                for (column, new) in (span.first..).zip(news) {
                    *new = new.max(edges.nearness_in(&span, column));
                }
                spans.push(span);
            });
        }
        let mut sum = 0.0f32;
        // What loses its triangle takes a new one, or what comes to light behind.
        if !hole.is_known {
            self.open(removed, size, hole);
        }
        for lost in &mut hole.pixels {
            let (x, y) = (lost.column as usize, lost.row as usize);
            let new = &mut nearness[at(x, y)];
            if *new == 0.0 {
                let behind = || self.behind(surface, size, x, y, &change.removed).1;
                *new = *lost.behind.get_or_insert_with(behind);
            }
            sum += target.pixels[y * size + x].error(*new) - lost.error;
            *new = DONE;
        }
        for span in spans {
            let (first, count) = (at(span.first, span.row), span.end - span.first);
            let pixels = span.row * size + span.first..span.row * size + span.end;
            let shown = self.pixels[pixels.clone()].iter();
            let news = nearness[first..first + count].iter_mut().zip(&target.pixels[pixels]);
            for ((new, pixel), shown) in news.zip(shown) {
                if *new > shown.nearness {
                    sum += pixel.error(*new) - shown.error;
                }
                *new = DONE;
            }
        }
        f64::from(sum)
    }

    /// Whether what is nowhere nearer than this is hidden in the whole rectangle.
    fn is_hidden(&self, within: Rectangle, nearest: f32, size: usize) -> bool {
        let row = size.div_ceil(TILE);
        within.is_empty()
            || (within.y0 / TILE..=(within.y1 - 1) / TILE).all(|y| {
                let tiles = y * row + within.x0 / TILE..=y * row + (within.x1 - 1) / TILE;
                self.farthest[tiles].iter().all(|&far| nearest < far)
            })
    }
}
