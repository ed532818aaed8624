//! What a surface looks like from all cameras, kept while it changes, and what a change of it would do to the
//! error (`target.rs`).
//!
//! Each view keeps which triangle is seen at each pixel, how near it is, and the triangles of each tile. A change
//! concerns the rectangle around what goes and what comes: pixels that a new triangle covers take the nearer of
//! both, pixels that lose theirs look for the next behind in their tile. Nothing else is drawn, so what a change
//! costs depends on its own size and not on the surface's.
//!
//! Contract: [`Pictures::error`] is the sum over all pixels of all views, divided by their number. What
//! [`Pictures::gain_of`] says of a change is what [`Pictures::apply`] does to it, up to rounding; where a new
//! triangle lies behind the one that it replaces, what may come to light between them is only looked for when it
//! is applied. Views are summed in order, so results do not depend on the number of threads.

use crate::change::Change;
use crate::raster::{Edges, Rectangle, Span, nearness_at};
use crate::surface::Surface;
use crate::target::{Target, projected};
use glam::Vec3;
use rayon::prelude::*;

/// Pixels along a side of a tile.
const TILE: usize = 4;
/// Of several changes the best is guessed from one view in so many.
const GUESSED_FROM: usize = 4;
/// Views that are worth a thread's while.
const VIEWS_AT_ONCE: usize = 8;
/// A pixel that was looked at; less than any nearness.
const DONE: f32 = -1.0;
/// No triangle is seen.
const NOTHING: u32 = u32::MAX;

/// One view of the surface.
#[derive(Clone)]
struct View {
    /// Each point's column, row and nearness.
    points: Vec<[f32; 3]>,
    /// The triangle at each pixel.
    triangle: Vec<u32>,
    /// Its nearness; 0 where nothing is.
    nearness: Vec<f32>,
    /// The error there.
    errors: Vec<f32>,
    /// The least nearness in each tile: what lies behind that is not seen in it.
    farthest: Vec<f32>,
    /// Triangles that may cover a pixel of each tile.
    tiles: Vec<Vec<u32>>,
    /// Sum of the errors of all pixels.
    error: f64,
}

/// The surface in all views.
#[derive(Clone)]
pub struct Pictures<'a> {
    targets: &'a [Target],
    views: Vec<View>,
    /// The surface that is seen.
    pub surface: Surface,
}

/// Memory that evaluations reuse.
#[derive(Default)]
pub struct Scratch {
    triangles: Vec<Flat>,
    spans: Vec<Span>,
    nearness: Vec<f32>,
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

impl<'a> Pictures<'a> {
    /// Draws a surface in the common frame.
    pub fn new(targets: &'a [Target], surface: Surface) -> Self {
        let views = targets.par_iter().map(|target| View::new(target, &surface)).collect();
        Self { targets, views, surface }
    }

    /// Looks at the surface from other cameras from now on.
    pub fn look_from(&mut self, targets: &'a [Target]) {
        if !std::ptr::eq(self.targets, targets) {
            *self = Self::new(targets, std::mem::take(&mut self.surface));
        }
    }

    /// The mean error of a pixel.
    pub fn error(&self) -> f64 {
        let sum: f64 = self.views.iter().map(|view| view.error).sum();
        sum / self.pixels()
    }

    /// Pixels of all views.
    pub fn pixels(&self) -> f64 {
        self.targets.iter().map(|target| target.pixels.len()).sum::<usize>().max(1) as f64
    }

    /// By how much a change would lessen the error; negative where it grows.
    pub fn gain_of(&self, change: &Change, scratch: &mut Scratch) -> f64 {
        self.gain(
            self.views.iter().zip(self.targets).map(|(view, of)| self.growth(view, of, change, scratch)),
        )
    }

    fn gain(&self, growths: impl Iterator<Item = f64>) -> f64 {
        -growths.sum::<f64>() / self.pixels()
    }

    fn growth(&self, view: &View, target: &Target, change: &Change, scratch: &mut Scratch) -> f64 {
        view.growth(target, &self.surface, change, scratch)
    }

    /// The change that gains most, with its gain. Where there are several, a few views rule out all but one.
    pub fn best_of(
        &self,
        changes: impl Iterator<Item = Change>,
        scratch: &mut Scratch,
    ) -> Option<(f64, Change)> {
        let mut trials: Vec<Trial> = changes.map(Trial::from).collect();
        if trials.len() > 1 {
            trials.iter_mut().for_each(|trial| trial.look(self, scratch));
        }
        let best = Trial::best(trials)?;
        let growths = self.views.iter().zip(self.targets).enumerate();
        let growths = growths.map(|(index, (view, target))| match best.known(index) {
            Some(growth) => growth,
            None => self.growth(view, target, &best.change, scratch),
        });
        Some((self.gain(growths), best.change))
    }

    /// The same, on all cores: for a caller that has nothing else to do meanwhile.
    pub fn best_of_on_all_cores(&self, changes: impl Iterator<Item = Change>) -> Option<(f64, Change)> {
        let mut trials: Vec<Trial> = changes.map(Trial::from).collect();
        if trials.len() > 1 {
            trials.par_iter_mut().for_each_init(Scratch::default, |scratch, trial| trial.look(self, scratch));
        }
        let best = Trial::best(trials)?;
        let views = self.views.par_iter().zip(self.targets).enumerate().with_min_len(VIEWS_AT_ONCE);
        let growths = views.map_init(Scratch::default, |scratch, (index, (view, target))| {
            best.known(index).unwrap_or_else(|| self.growth(view, target, &best.change, scratch))
        });
        let growths: Vec<f64> = growths.collect();
        Some((self.gain(growths.into_iter()), best.change))
    }

    /// Makes a change.
    pub fn apply(&mut self, change: &Change) {
        let removed = change.removed.iter().filter_map(|&t| Some((t, self.surface.get(t)?.corners)));
        let removed: Vec<_> = removed.collect();
        let added = self.surface.apply(change);
        let surface = &self.surface;
        let views = self.views.par_iter_mut().zip(self.targets);
        views.for_each(|(view, target)| view.update(target, surface, &removed, &added, change.moved));
    }

    /// Sum of the errors of the pixels at which each triangle is seen, by the triangles' indices.
    pub fn errors_by_triangle(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.surface.indices()];
        for view in &self.views {
            for (&triangle, &error) in view.triangle.iter().zip(&view.errors) {
                if triangle != NOTHING {
                    out[triangle as usize] += f64::from(error);
                }
            }
        }
        out
    }
}

/// A change that is compared with others.
struct Trial {
    change: Change,
    /// By how much the error grows in every so-manieth view, if it was looked at.
    growths: Vec<f64>,
}

impl From<Change> for Trial {
    fn from(change: Change) -> Self {
        Self { change, growths: Vec::new() }
    }
}

impl Trial {
    /// Looks at it from a few views.
    fn look(&mut self, pictures: &Pictures, scratch: &mut Scratch) {
        let views = pictures.views.iter().zip(pictures.targets).step_by(GUESSED_FROM);
        self.growths.extend(views.map(|(view, target)| pictures.growth(view, target, &self.change, scratch)));
    }

    /// What is known of a view.
    fn known(&self, view: usize) -> Option<f64> {
        self.growths.get(view / GUESSED_FROM).copied().filter(|_| view.is_multiple_of(GUESSED_FROM))
    }

    /// The one under which the error grows least, the last of those that are alike.
    fn best(trials: Vec<Self>) -> Option<Self> {
        let growth = |trial: &Self| trial.growths.iter().sum::<f64>();
        trials.into_iter().rev().min_by(|a, b| growth(a).total_cmp(&growth(b)))
    }
}

impl View {
    fn new(target: &Target, surface: &Surface) -> Self {
        let (size, camera) = (target.size, &target.camera);
        let tiles = size.div_ceil(TILE);
        let mut view = Self {
            points: surface.points.iter().map(|&p| projected(camera, size, p)).collect(),
            triangle: vec![NOTHING; size * size],
            nearness: vec![0.0; size * size],
            errors: Vec::new(),
            farthest: vec![0.0; tiles * tiles],
            tiles: vec![Vec::new(); tiles * tiles],
            error: 0.0,
        };
        for (index, triangle) in surface.triangles() {
            view.draw(index, triangle.corners, size);
        }
        let errors = target.pixels.iter().zip(&view.nearness).map(|(pixel, &near)| pixel.error(near));
        view.errors = errors.collect();
        view.error = view.errors.iter().map(|&error| f64::from(error)).sum();
        view.measure(Rectangle { x0: 0, y0: 0, x1: size, y1: size }, size);
        view
    }

    fn corners(&self, points: [u32; 3]) -> [[f32; 3]; 3] {
        points.map(|point| self.points[point as usize])
    }

    /// Draws a triangle over what is there, and enters it into its tiles.
    fn draw(&mut self, index: u32, points: [u32; 3], size: usize) {
        let corners = self.corners(points);
        let within = Rectangle::of(&corners, size);
        self.tiles_of(within, size, |tile| tile.push(index));
        if let Some(edges) = Edges::new(&corners) {
            let (nearness, triangle) = (&mut self.nearness, &mut self.triangle);
            edges.each_pixel(within, |x, y, near| {
                let pixel = y * size + x;
                if near > nearness[pixel] {
                    (nearness[pixel], triangle[pixel]) = (near, index);
                }
            });
        }
    }

    fn tiles_of(&mut self, within: Rectangle, size: usize, mut on_each: impl FnMut(&mut Vec<u32>)) {
        if within.is_empty() {
            return;
        }
        let row = size.div_ceil(TILE);
        for y in within.y0 / TILE..=(within.y1 - 1) / TILE {
            self.tiles[y * row + within.x0 / TILE..=y * row + (within.x1 - 1) / TILE]
                .iter_mut()
                .for_each(&mut on_each);
        }
    }

    /// The nearest of a tile's triangles at a pixel, but for some.
    fn behind(&self, surface: &Surface, size: usize, x: usize, y: usize, but: &[u32]) -> (u32, f32) {
        let tile = &self.tiles[y / TILE * size.div_ceil(TILE) + x / TILE];
        let mut nearest = (NOTHING, 0.0);
        for &index in tile.iter().filter(|index| !but.contains(index)) {
            let Some(triangle) = surface.get(index) else { continue };
            let corners = self.corners(triangle.corners);
            if let Some(near) = nearness_at(&corners, x, y).filter(|near| *near > nearest.1) {
                nearest = (index, near);
            }
        }
        nearest
    }

    /// By how much a change would add to the error.
    fn growth(&self, target: &Target, surface: &Surface, change: &Change, scratch: &mut Scratch) -> f64 {
        let size = target.size;
        let moved = change.moved.map(|(point, position)| (point, projected(&target.camera, size, position)));
        let place = |point: u32| match moved {
            Some((own, at)) if own == point => at,
            _ => self.points[point as usize],
        };
        let Scratch { triangles, spans, nearness } = scratch;
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
        for triangle in removed {
            let Some(edges) = Edges::new(&triangle.corners) else { continue };
            edges.each_span(triangle.within, |span| {
                for x in span.first..span.end {
                    let pixel = span.row * size + x;
                    if self.triangle[pixel] == triangle.index {
                        let new = &mut nearness[at(x, span.row)];
                        if *new == 0.0 {
                            *new = self.behind(surface, size, x, span.row, &change.removed).1;
                        }
                        sum += target.pixels[pixel].error(*new) - self.errors[pixel];
                        *new = DONE;
                    }
                }
            });
        }
        for span in spans {
            let (first, count) = (at(span.first, span.row), span.end - span.first);
            let pixels = span.row * size + span.first..span.row * size + span.end;
            let old = self.nearness[pixels.clone()].iter().zip(&self.errors[pixels.clone()]);
            let news = nearness[first..first + count].iter_mut().zip(&target.pixels[pixels]);
            for ((new, pixel), (old, error)) in news.zip(old) {
                if *new > *old {
                    sum += pixel.error(*new) - error;
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

    /// Looks how far what is seen in the tiles of a rectangle is.
    fn measure(&mut self, within: Rectangle, size: usize) {
        if within.is_empty() {
            return;
        }
        let row = size.div_ceil(TILE);
        for y in within.y0 / TILE..=(within.y1 - 1) / TILE {
            for x in within.x0 / TILE..=(within.x1 - 1) / TILE {
                let rows = y * TILE..((y + 1) * TILE).min(size);
                let columns = x * TILE..((x + 1) * TILE).min(size);
                let of_row =
                    |y: usize| self.nearness[y * size + columns.start..y * size + columns.end].iter();
                self.farthest[y * row + x] =
                    rows.flat_map(of_row).fold(f32::INFINITY, |least, &n| least.min(n));
            }
        }
    }

    /// Follows a change that the surface has made.
    fn update(
        &mut self,
        target: &Target,
        surface: &Surface,
        removed: &[(u32, [u32; 3])],
        added: &[u32],
        moved: Option<(u32, Vec3)>,
    ) {
        let size = target.size;
        let mut within = Rectangle::default();
        for &(index, points) in removed {
            let own = Rectangle::of(&self.corners(points), size);
            within = within.around(own);
            self.tiles_of(own, size, |tile| tile.retain(|&other| other != index));
        }
        if let Some((point, position)) = moved {
            let at = projected(&target.camera, size, position);
            match self.points.get_mut(point as usize) {
                Some(place) => *place = at,
                None => self.points.push(at),
            }
        }
        let rectangle = |index: &u32, view: &Self| {
            surface
                .get(*index)
                .map_or(Rectangle::default(), |t| Rectangle::of(&view.corners(t.corners), size))
        };
        for index in added {
            within = within.around(rectangle(index, self));
        }
        let mut lost = Vec::new();
        for y in within.y0..within.y1 {
            for x in within.x0..within.x1 {
                let pixel = y * size + x;
                if removed.iter().any(|(index, _)| *index == self.triangle[pixel]) {
                    (self.triangle[pixel], self.nearness[pixel]) = (NOTHING, 0.0);
                    lost.push((x, y));
                }
            }
        }
        for &(x, y) in &lost {
            let pixel = y * size + x;
            (self.triangle[pixel], self.nearness[pixel]) = self.behind(surface, size, x, y, &[]);
        }
        for &index in added {
            if let Some(triangle) = surface.get(index) {
                self.draw(index, triangle.corners, size);
            }
        }
        for y in within.y0..within.y1 {
            for pixel in y * size + within.x0..y * size + within.x1 {
                let now = target.pixels[pixel].error(self.nearness[pixel]);
                self.error += f64::from(now) - f64::from(std::mem::replace(&mut self.errors[pixel], now));
            }
        }
        self.measure(within, size);
    }
}
