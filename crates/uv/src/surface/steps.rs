//! The steps of texture coordinates: counted, shown and kept for an animation.

use super::as_f32;
use glam::{DVec2, Vec2};
use parbake_atlas::Layout;
use parbake_model::Mesh;
use parbake_progress::{Message, Snapshot, Stage, Watcher};

/// How far along the way is.
pub struct Steps<'a> {
    done: usize,
    most: usize,
    is_first: bool,
    mesh: &'a Mesh,
    start: &'a Layout,
    /// Who is told, and may stop it.
    pub watcher: &'a dyn Watcher,
}

impl<'a> Steps<'a> {
    /// None done of this many at most; `start` is the layout of `mesh`, which lies in the common frame.
    pub fn new(most: usize, mesh: &'a Mesh, start: &'a Layout, watcher: &'a dyn Watcher) -> Self {
        Self { done: 0, most, is_first: true, mesh, start, watcher }
    }

    /// A descent begins, whose losses cannot be compared with those of the one before.
    pub fn begin(&mut self) {
        self.is_first = true;
    }

    /// Notes a step that came to `points` with this loss; false to stop.
    pub fn step(&mut self, way: &mut Vec<Vec<Vec2>>, points: &[DVec2], loss: f64) -> bool {
        way.push(as_f32(points));
        self.done = self.most.min(self.done + 1);
        let stage = Stage::Uv;
        self.watcher.message(Message::Progress { stage, done: self.done, total: self.most });
        self.watcher.message(Message::Loss { stage, value: loss, is_first: self.is_first });
        self.is_first = false;
        self.show(points);
        !self.watcher.stopped()
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
