//! The steps of texture coordinates: counted, shown and kept for an animation.

use super::as_f32;
use glam::{DVec2, Vec2};
use parbake_atlas::Layout;
use parbake_model::Mesh;
use parbake_progress::{Message, Snapshot, Stage, Watcher};
use std::sync::atomic::{AtomicUsize, Ordering};

/// How far along the way is.
pub struct Steps<'a> {
    done: AtomicUsize,
    most: usize,
    mesh: &'a Mesh,
    start: &'a Layout,
    /// Who is told, and may stop it.
    pub watcher: &'a dyn Watcher,
}

/// The steps of one descent.
pub struct Descent<'a> {
    all: &'a Steps<'a>,
    is_first: bool,
    is_told: bool,
}

impl<'a> Steps<'a> {
    /// None done of this many at most; `start` is the layout of `mesh`, which lies in the common frame.
    pub fn new(most: usize, mesh: &'a Mesh, start: &'a Layout, watcher: &'a dyn Watcher) -> Self {
        Self { done: AtomicUsize::new(0), most, mesh, start, watcher }
    }

    /// A descent begins, whose losses cannot be compared with those of another. Of descents at the same time one `is_told`: the
    /// others' steps only count.
    pub fn descent(&'a self, is_told: bool) -> Descent<'a> {
        Descent { all: self, is_first: true, is_told }
    }

    /// Shows the mesh with these points, unless they are those of more triangles than it has.
    fn show(&self, points: &[DVec2]) {
        if points.len() == self.start.points.len() && self.watcher.wants_snapshot() {
            let layout = Layout { points: points.to_vec(), ..self.start.clone() };
            let mesh = Mesh { uvs: layout.uvs(), ..self.mesh.clone() };
            self.watcher.snapshot(Snapshot::Surface { mesh, color: None });
        }
    }
}

impl Descent<'_> {
    /// Notes a step that came to `points` with this loss; false to stop.
    pub fn step(&mut self, way: &mut Vec<Vec<Vec2>>, points: &[DVec2], loss: f64) -> bool {
        way.push(as_f32(points));
        let Steps { done, most, watcher, .. } = self.all;
        let done = (done.fetch_add(1, Ordering::Relaxed) + 1).min(*most);
        if self.is_told {
            let stage = Stage::Uv;
            watcher.message(Message::Progress { stage, done, total: *most });
            watcher.message(Message::Loss { stage, value: loss, is_first: self.is_first });
            self.is_first = false;
            self.all.show(points);
        }
        !watcher.stopped()
    }
}
