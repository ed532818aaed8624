//! The fit of the shape: vertices, and a provisional texture of colours and normals, follow
//! the gradient of rendered views together.
//!
//! Textures that were fitted first would hold the vertices where they are, so both move at
//! once (Adam for all, each with its rate). The texture is only there to tell the vertices
//! what the inside of the silhouette asks for; it is thrown away. Its normals are world
//! space's, with a constant identity for the tangent frame, so that a vertex that moves
//! does not turn what the texture says.
//!
//! Backgrounds are black, white and saturated colours, another in each view and step
//! ([`Background::Random`]), and coverage has its own loss: a vertex that overshoots behind
//! a black background, where nobody would see it, is seen here.
//!
//! How far vertices go depends on how far outlines are apart at first: the step, what holds a
//! vertex near its rest position, and the discount on overhang all follow that one length. A mesh whose
//! outlines fit already stays as it is, and so does one whose outlines did not come closer in views that it was not
//! fitted to: those that it was fitted to would always say so. Where outlines are more than a pixel apart, steps begin with views of half the size, which show the
//! way as well and take a third of the time.
//!
//! Gradients are those of a quarter of the pixels, chosen at random for each view and step
//! (`parbake_render::gradient_pixels`); those at silhouettes are whole. docs/algorithms/vertices.md has what that is worth.
//!
//! Contract: the mesh has texture coordinates and lies in the common frame; triangles stay
//! sane (`triangle_quality.rs`), vertices at one position stay together. The result does not depend on
//! the number of threads.

use crate::laplacian::Laplacian;
use crate::moving_points::MovingPoints;
use crate::outline::Outline;
use crate::points::{Motion, Points};
use crate::provisional::{MovingTexture, Provisional};
use crate::seen::{Seen, ShapeViews};
use crate::views::{Judgement, Views};
use crate::walls::crossings;
use glam::{Vec3, Vec4};
use parbake_image::display::Display;
use parbake_model::Mesh;
use parbake_progress::{Message, Snapshot, Stage, Watcher};
use parbake_render::background::Background;
use parbake_render::camera::Camera;
use parbake_render::edges::EdgeAdjacency;
use parbake_render::loss::LossValue;
use parbake_render::surface::{Surface, Textures};
use parbake_solve::adam::rate_at;
use parbake_solve::random::mixed;
use parbake_views::reference::Reference as Rendered;
use rayon::prelude::*;

/// How the shape is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeOptions {
    /// Where vertices may go.
    pub motion: Motion,
    /// Steps of Adam where outlines are a pixel apart or more; down to half as many where they are closer.
    pub steps: usize,
    /// Share of the steps, at most, that look at views of half the size: the first ones, and as
    /// large a share as outlines are further apart than a pixel, in pixels.
    pub coarse: f64,
    /// Views that a step looks at.
    pub views_per_step: usize,
    /// How far a vertex moves in a step at first, at most, in the common frame, in which a
    /// model is 2 long.
    pub rate: f32,
    /// Steps of that length in which a vertex goes as far as outlines are apart: where they are
    /// close, steps are smaller.
    pub steps_in_gap: f32,
    /// The same for the texture, whose values go from 0 to 1.
    pub texture_rate: f32,
    /// Weight of the coverage loss beside the picture's.
    pub coverage: f32,
    /// How much less overhang counts, 0 … 1, where outlines are a pixel apart or more: what
    /// stands out can be cut out, what is missing cannot be put there.
    pub overhang_discount: f32,
    /// How far apart outlines are taken to be at least, in the common frame.
    pub least_gap: f32,
    /// How many gaps between outlines a vertex may move before that costs as much as the
    /// picture's loss at first.
    pub reach: f32,
    /// Weight of the Laplacian term (`laplacian.rs`); 0 leaves it out.
    pub laplacian: f32,
    /// Vertices stay where they are unless outlines differ by this share or less of what they differed before, in views
    /// that they were not fitted to: those
    /// that agree hardly better are not worth another shape than the artist's. 0 to 1.
    pub worth_moving: f64,
    /// Whether a thin wall whose sides would cross (`walls.rs`) moves less where pictures are better for it: for textures that
    /// take from the high-poly only what faces as they do.
    pub keeps_sides: bool,
    /// What is behind the model.
    pub background: Background,
    /// Chooses views' order and backgrounds.
    pub seed: u64,
}

impl Default for ShapeOptions {
    fn default() -> Self {
        Self {
            motion: Motion::Free,
            steps: 160,
            coarse: 0.5,
            views_per_step: 12,
            rate: 4e-3,
            steps_in_gap: 7.0,
            texture_rate: 0.02,
            coverage: 1.0,
            overhang_discount: 0.0,
            least_gap: 0.0,
            reach: 8.0,
            laplacian: 0.0,
            worth_moving: 0.9,
            keeps_sides: false,
            background: Background::Random,
            seed: 0,
        }
    }
}

/// Where the vertices came to lie.
#[derive(Clone, Debug)]
pub struct Shaped {
    /// V positions in the common frame.
    pub positions: Vec<Vec3>,
    /// Mean loss of the views of each step.
    pub losses: Vec<LossValue>,
    /// How far points moved: mean and most, in the common frame.
    pub moved: [f32; 2],
    /// How outlines differed before and after.
    pub outline: [Outline; 2],
    /// How far they were apart in the mean before and after, in the common frame.
    pub gap: [f32; 2],
}

/// What stays through a fit.
struct Fit<'a> {
    mesh: &'a Mesh,
    edges: EdgeAdjacency,
    points: &'a Points,
    /// The identity's columns, for every vertex.
    frames: (Vec<Vec3>, Vec<Vec4>),
    views: Views<'a>,
}

impl<'a> Fit<'a> {
    fn new(mesh: &'a Mesh, points: &'a Points, views: Views<'a>) -> Self {
        let count = mesh.positions.len();
        Self {
            mesh,
            edges: EdgeAdjacency::new(&mesh.positions, &mesh.triangles),
            points,
            frames: (vec![Vec3::Z; count], vec![Vec4::new(1.0, 0.0, 0.0, 1.0); count]),
            views,
        }
    }

    fn look(&self, at: &[Vec3], texture: &Provisional, views: &[(usize, u64)]) -> Judgement {
        self.with_surface(at, texture, |surface, textures| self.views.look(surface, textures, views))
    }

    fn picture_loss(&self, at: &[Vec3], texture: &Provisional, views: &[(usize, u64)]) -> f64 {
        self.with_surface(at, texture, |surface, textures| self.views.picture_loss(surface, textures, views))
    }

    fn with_surface<T>(
        &self,
        at: &[Vec3],
        texture: &Provisional,
        look: impl FnOnce(&Surface, &Textures) -> T,
    ) -> T {
        let positions = self.points.vertices(at);
        let surface = Surface {
            positions: &positions,
            normals: &self.frames.0,
            tangents: &self.frames.1,
            uvs: &self.mesh.uvs,
            triangles: &self.mesh.triangles,
            edges: &self.edges,
        };
        let [color, normal] = texture.pyramids();
        look(&surface, &Textures::new(&color, Some(&normal)))
    }

    fn snapshot(&self, at: &[Vec3], texture: &Provisional) -> Snapshot {
        let mesh = Mesh { positions: self.points.vertices(at), ..self.mesh.clone() };
        Snapshot::Surface { mesh, color: Some(texture.color.clone()) }
    }
}

/// Side in pixels of a view of half the size at least: smaller ones show no outlines.
const LEAST_COARSE: usize = 64;
/// Share of the pictures' area in which walls may be seen inside out besides what was so before.
const INSIDE_OUT: f64 = 2e-4;
/// Times that points of walls inside out are put back at most: each may lay bare others.
const UNCROSSED: usize = 8;
/// Distance between outlines in pixels from which on overhang has the full discount.
const WIDE_GAP: f64 = 1.0;
/// The shortest distance that is told from rounding, in pixels.
const LEAST_GAP: f64 = 0.02;
/// Distance between outlines in pixels below which vertices stay: models whose outlines were this close gained or lost at most
/// 0.25 dB by moving.
const CLOSE_ENOUGH: f64 = 0.08;

/// What pictures of a mesh with this texture lack of the high-poly's, before anything moves: the mean squared difference in the
/// views whose outlines are measured.
pub fn picture_loss(
    mesh: &Mesh,
    texture: &Provisional,
    seen: &ShapeViews,
    display: Display,
    options: &ShapeOptions,
) -> f64 {
    let points = Points::new(&mesh.positions, &mesh.normals, &mesh.triangles);
    let views = seen.fitted.views(display, options.coverage, options.background);
    Fit::new(mesh, &points, views).picture_loss(&points.rest, texture, &seen.fitted.measured())
}

/// Fits the positions of a mesh to what was seen of the high-poly.
pub fn fit_shape(
    mesh: &Mesh,
    start: Provisional,
    seen: &ShapeViews,
    display: Display,
    options: &ShapeOptions,
    watcher: &dyn Watcher,
) -> Shaped {
    let points = Points::new(&mesh.positions, &mesh.normals, &mesh.triangles);
    let laplacian = Laplacian::new(points.rest.len(), &points.triangles);
    let mut fit = Fit::new(mesh, &points, seen.fitted.views(display, options.coverage, options.background));
    let Seen { references, size, .. } = &seen.fitted;
    let (measured, size) = (seen.fitted.measured(), *size);
    let outline = |at: &[Vec3], seen: &Seen| Outline::of(at, &points.triangles, seen);
    let before = outline(&points.rest, &seen.fitted);
    let pixel = seen.fitted.pixel_width();
    let least_gap = if pixel > 0.0 { f64::from(options.least_gap / pixel) } else { 0.0 };
    let gap_in_pixels = before.gap().max(LEAST_GAP).max(least_gap);
    let discount = options.overhang_discount * (gap_in_pixels / WIDE_GAP).min(1.0) as f32;
    fit.views.comparison.overhang_discount = discount;
    let gap = gap_in_pixels as f32 * pixel;

    let rate = options.rate.min(gap / options.steps_in_gap);
    let steps = if gap_in_pixels < CLOSE_ENOUGH { 0 } else { needed_steps(gap_in_pixels, options) };
    let loss = if steps == 0 { 0.0 } else { fit.picture_loss(&points.rest, &start, &measured) };
    let held = loss as f32 / (options.reach * gap).powi(2).max(1e-12);
    let mut moving = MovingPoints::new(&points, options.motion, rate);
    let projected = options.keeps_sides.then(|| start.clone());
    let mut provisional = MovingTexture::new(start, options.texture_rate, |n| n.normalize_or(Vec3::Z));
    let mut losses = Vec::new();
    let coarse_until = coarse_steps(gap_in_pixels, size, options);
    let halved: Vec<Rendered> = match coarse_until {
        0 => Vec::new(),
        _ => references.par_iter().map(Rendered::halved).collect(),
    };
    let fine = fit.views;
    let coarse = Views { references: &halved, size: size / 2, ..fine };
    for step in 0..steps {
        watcher.progress(Stage::Shape, step, steps);
        if references.is_empty() || watcher.stopped() {
            break;
        }
        // The pool's every prefix is well spread, and so is every run of it.
        let first = step * options.views_per_step;
        let views: Vec<(usize, u64)> = (first..first + options.views_per_step)
            .map(|i| (i % references.len(), mixed(options.seed ^ mixed(i as u64))))
            .collect();
        fit.views = if step < coarse_until { coarse } else { fine };
        let Judgement { loss, gradients } = fit.look(moving.at(), &provisional.texture, &views);
        let is_first = step == 0 || step == coarse_until;
        watcher.message(Message::Loss { stage: Stage::Shape, value: loss.image, is_first });
        losses.push(loss);
        let share = rate_at(step, steps);
        // Gradients are sums over the step's views.
        let summed = views.len() as f32;
        let smoothing = match options.laplacian {
            0.0 => Vec::new(),
            weight => scaled(laplacian.energy(&moving.ways()).1, weight * summed),
        };
        moving.step(&gradients.positions, &smoothing, held * summed, share);
        provisional.step(&gradients, share);
        if watcher.wants_snapshot() {
            watcher.snapshot(fit.snapshot(moving.at(), &provisional.texture));
        }
    }
    watcher.progress(Stage::Shape, steps, steps);
    fit.views = fine;
    if let Some(projected) = &projected {
        keep_sides(&mut moving, &fit, projected, &measured);
    }
    let has_moved = !losses.is_empty();
    let mut after = if has_moved { outline(moving.at(), &seen.fitted) } else { before };
    let cost = |at: &[Vec3]| {
        let outline = outline(at, &seen.checked);
        f64::from(1.0 - discount) * outline.overhang + outline.underhang
    };
    if has_moved && cost(moving.at()) > options.worth_moving * cost(&points.rest) {
        moving.reset();
        after = before;
    }
    let outline = [before, after];
    Shaped {
        positions: points.vertices(moving.at()),
        losses,
        moved: moving.moved(),
        outline,
        gap: outline.map(|o| o.gap() as f32 * pixel),
    }
}

/// Puts points back until hardly more of thin walls is seen inside out than before, if pictures with the `projected`
/// texture, in which each side keeps what is its own, are better for it.
fn keep_sides(moving: &mut MovingPoints, fit: &Fit, projected: &Provisional, views: &[(usize, u64)]) {
    let Views { references, size, .. } = fit.views;
    let cameras: Vec<Camera> = views.iter().map(|&(view, _)| references[view].view.camera).collect();
    let of = |at: &[Vec3]| crossings(at, &fit.points.triangles, &cameras, size);
    let noticed = INSIDE_OUT * (cameras.len() * size * size) as f64;
    let most = of(&fit.points.rest).pixels + noticed as usize;
    let mut now = of(moving.at());
    if now.pixels <= most {
        return;
    }
    let mut kept = moving.clone();
    for _ in 0..UNCROSSED {
        if now.pixels <= most || kept.put_back(&now.points) == 0 {
            break;
        }
        now = of(kept.at());
    }
    let loss = |at: &[Vec3]| fit.picture_loss(at, projected, views);
    if loss(kept.at()) < loss(moving.at()) {
        *moving = kept;
    }
}

/// How many steps look at views of half the size; none where such a view would not show the same
/// field, as half of an odd size does not.
fn coarse_steps(gap_in_pixels: f64, size: usize, options: &ShapeOptions) -> usize {
    if size < 2 * LEAST_COARSE || !size.is_multiple_of(2) {
        return 0;
    }
    ((gap_in_pixels - WIDE_GAP).clamp(0.0, options.coarse) * options.steps as f64).ceil() as usize
}

/// How many steps lead to where all would: outlines that are closer than a pixel need fewer, by up to a half.
fn needed_steps(gap_in_pixels: f64, options: &ShapeOptions) -> usize {
    (gap_in_pixels.clamp(0.5, 1.0) * options.steps as f64).ceil() as usize
}

fn scaled(mut gradient: Vec<Vec3>, by: f32) -> Vec<Vec3> {
    gradient.iter_mut().for_each(|g| *g *= by);
    gradient
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects time: outlines that agree nearly are not worth all steps.
    #[test]
    fn outlines_that_are_close_need_fewer_steps() {
        let options = ShapeOptions { steps: 100, ..ShapeOptions::default() };
        assert_eq!([0.1, 0.7, 3.0].map(|gap| needed_steps(gap, &options)), [50, 70, 100]);
    }

    /// Protects outlines that are close from coarse views, which would not show them, and all from
    /// views that are too small or show another field.
    #[test]
    fn coarse_views_serve_where_outlines_are_far_apart() {
        let options = ShapeOptions { steps: 100, coarse: 0.5, ..ShapeOptions::default() };
        let at = |gap, size| coarse_steps(gap, size, &options);
        assert_eq!([at(0.7, 160), at(1.25, 160), at(9.0, 160)], [0, 25, 50]);
        assert_eq!([at(9.0, 126), at(9.0, 128), at(9.0, 129)], [0, 50, 0]);
    }
}
