//! One view of a surface that changes: which triangle is seen at each pixel, how near it is and what error that makes,
//! and the triangles of each tile.
//!
//! Contract: after [`View::update`] the view is what [`View::new`] draws of the changed surface, but for which of
//! two triangles is seen where both are as near.

use crate::raster::{Edges, Rectangle, nearness_at};
use crate::surface::Surface;
use crate::target::{Target, projected};
use glam::Vec3;

/// Pixels along a side of a tile.
pub const TILE: usize = 4;
/// No triangle is seen.
pub const NOTHING: u32 = u32::MAX;

/// What a pixel shows. Together, since a change looks at all of it in a few pixels of many views, and each place in
/// memory that it goes to takes longer than what it computes there.
#[derive(Clone, Copy)]
pub struct Shown {
    /// Which triangle.
    pub triangle: u32,
    /// Its nearness; 0 where nothing is.
    pub nearness: f32,
    /// The error.
    pub error: f32,
}

/// One view of the surface.
#[derive(Clone)]
pub struct View {
    /// Each point's column, row and nearness.
    pub points: Vec<[f32; 3]>,
    /// Row 0 on top.
    pub pixels: Vec<Shown>,
    /// The least nearness in each tile: what lies behind that is not seen in it.
    pub farthest: Vec<f32>,
    /// Triangles that may cover a pixel of each tile.
    tiles: Vec<Vec<u32>>,
    /// Sum of the errors of all pixels.
    pub error: f64,
}

impl View {
    /// Draws a surface.
    pub fn new(target: &Target, surface: &Surface) -> Self {
        let (size, camera) = (target.size, &target.camera);
        let tiles = size.div_ceil(TILE);
        let mut view = Self {
            points: surface.points.iter().map(|&p| projected(camera, size, p)).collect(),
            pixels: vec![Shown { triangle: NOTHING, nearness: 0.0, error: 0.0 }; size * size],
            farthest: vec![0.0; tiles * tiles],
            tiles: vec![Vec::new(); tiles * tiles],
            error: 0.0,
        };
        for (index, triangle) in surface.triangles() {
            view.draw(index, triangle.corners, size);
        }
        for (shown, pixel) in view.pixels.iter_mut().zip(&target.pixels) {
            shown.error = pixel.error(shown.nearness);
            view.error += f64::from(shown.error);
        }
        view.measure(Rectangle { x0: 0, y0: 0, x1: size, y1: size }, size);
        view
    }

    /// A triangle's corners.
    pub fn corners(&self, points: [u32; 3]) -> [[f32; 3]; 3] {
        points.map(|point| self.points[point as usize])
    }

    /// Draws a triangle over what is there, and enters it into its tiles.
    fn draw(&mut self, index: u32, points: [u32; 3], size: usize) {
        let corners = self.corners(points);
        let within = Rectangle::of(&corners, size);
        self.tiles_of(within, size, |tile| tile.push(index));
        if let Some(edges) = Edges::new(&corners) {
            let pixels = &mut self.pixels;
            edges.each_pixel(within, |x, y, near| {
                let shown = &mut pixels[y * size + x];
                if near > shown.nearness {
                    (shown.nearness, shown.triangle) = (near, index);
                }
            });
        }
    }

    /// Visits the tiles that a triangle within this rectangle may cover.
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

    /// Visits the pixels at which a triangle is seen: column, row and what they show.
    pub fn seen_at(
        &self,
        index: u32,
        corners: &[[f32; 3]; 3],
        within: Rectangle,
        size: usize,
        mut on_each: impl FnMut(usize, usize, &Shown),
    ) {
        let Some(edges) = Edges::new(corners) else { return };
        edges.each_span(within, |span| {
            let shown = &self.pixels[span.row * size + span.first..span.row * size + span.end];
            let columns = (span.first..).zip(shown).filter(|(_, shown)| shown.triangle == index);
            columns.for_each(|(column, shown)| on_each(column, span.row, shown));
        });
    }

    /// The nearest of a tile's triangles at a pixel, but for some.
    pub fn behind(&self, surface: &Surface, size: usize, x: usize, y: usize, but: &[u32]) -> (u32, f32) {
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
                let of_row = |y: usize| self.pixels[y * size + columns.start..y * size + columns.end].iter();
                let shown = rows.flat_map(of_row);
                self.farthest[y * row + x] =
                    shown.fold(f32::INFINITY, |least, shown| least.min(shown.nearness));
            }
        }
    }

    /// Follows a change that the surface has made.
    pub fn update(
        &mut self,
        target: &Target,
        surface: &Surface,
        removed: &[(u32, [u32; 3])],
        added: &[u32],
        moved: Option<(u32, Vec3)>,
    ) {
        let size = target.size;
        let mut within = Rectangle::default();
        let mut lost = Vec::new();
        for &(index, points) in removed {
            let corners = self.corners(points);
            let own = Rectangle::of(&corners, size);
            within = within.around(own);
            self.tiles_of(own, size, |tile| tile.retain(|&other| other != index));
            self.seen_at(index, &corners, own, size, |x, y, _| lost.push((x, y)));
        }
        for &(x, y) in &lost {
            let shown = &mut self.pixels[y * size + x];
            (shown.triangle, shown.nearness) = (NOTHING, 0.0);
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
        for &(x, y) in &lost {
            let (triangle, nearness) = self.behind(surface, size, x, y, &[]);
            let shown = &mut self.pixels[y * size + x];
            (shown.triangle, shown.nearness) = (triangle, nearness);
        }
        for &index in added {
            if let Some(triangle) = surface.get(index) {
                self.draw(index, triangle.corners, size);
            }
        }
        for y in within.y0..within.y1 {
            for pixel in y * size + within.x0..y * size + within.x1 {
                let shown = &mut self.pixels[pixel];
                let now = target.pixels[pixel].error(shown.nearness);
                self.error += f64::from(now) - f64::from(std::mem::replace(&mut shown.error, now));
            }
        }
        self.measure(within, size);
    }
}
