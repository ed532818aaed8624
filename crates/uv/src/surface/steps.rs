//! The steps of texture coordinates: counted, shown and kept for an animation.

use super::as_f32;
use glam::{DVec2, Vec2};
use parbake_progress::{Message, Stage, Watcher};

/// How far along the way is.
pub struct Steps<'a, W> {
    done: usize,
    most: usize,
    /// Who is told, and may stop it.
    pub watcher: &'a W,
}

impl<'a, W: Watcher> Steps<'a, W> {
    /// None done of this many at most.
    pub fn new(most: usize, watcher: &'a W) -> Self {
        Self { done: 0, most, watcher }
    }

    /// Notes a step; false to stop.
    pub fn step(&mut self, way: &mut Vec<Vec<Vec2>>, points: &[DVec2]) -> bool {
        way.push(as_f32(points));
        self.done = self.most.min(self.done + 1);
        self.watcher.message(Message::Progress { stage: Stage::Uv, done: self.done, total: self.most });
        !self.watcher.stopped()
    }
}
