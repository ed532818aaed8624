//! A watcher that completes the snapshots of a stage on their way to a front end.
//!
//! ```text
//! stage ─ Surface, Maps ─ Showing (whoever called the stage) ─ Model ─ front end
//! ```
//!
//! Contract: nothing that a run computes depends on whether it is watched, but on the time that a budget leaves it.

use crate::message::{Message, Watcher};
use crate::snapshot::Snapshot;

/// Passes all on, and completes a stage's snapshots on their way.
pub struct Showing<'a, F> {
    watcher: &'a dyn Watcher,
    complete: F,
    is_seen: bool,
}

impl<'a, F: Fn(Snapshot) -> Option<Snapshot> + Sync> Showing<'a, F> {
    /// With what completes a snapshot, or leaves it out.
    pub fn new(watcher: &'a dyn Watcher, complete: F) -> Self {
        Self { watcher, complete, is_seen: true }
    }

    /// The same where the stage is to be seen; otherwise it is never asked for a snapshot.
    pub fn only_if(self, is_seen: bool) -> Self {
        Self { is_seen, ..self }
    }
}

impl<F: Fn(Snapshot) -> Option<Snapshot> + Sync> Watcher for Showing<'_, F> {
    fn message(&self, message: Message) {
        match message {
            Message::Snapshot(snapshot) => {
                if let Some(complete) = (self.complete)(*snapshot) {
                    self.watcher.snapshot(complete);
                }
            }
            other => self.watcher.message(other),
        }
    }

    fn stopped(&self) -> bool {
        self.watcher.stopped()
    }

    fn seconds_left(&self) -> Option<f64> {
        self.watcher.seconds_left()
    }

    fn wants_snapshot(&self) -> bool {
        self.is_seen && self.watcher.wants_snapshot()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::{Portion, ProgressScope};
    use parbake_image::MapSet;
    use parbake_model::{Mesh, Model};
    use std::sync::Mutex;
    use std::time::Instant;

    #[derive(Default)]
    struct Onlooker(Mutex<Vec<Message>>);

    impl Watcher for Onlooker {
        fn message(&self, message: Message) {
            self.0.lock().unwrap().push(message);
        }

        fn wants_snapshot(&self) -> bool {
            true
        }
    }

    /// Protects the picture of a running bake: the wish for it reaches a stage through whatever lies between, what the
    /// stage shows comes back as a model, and a stage that is not to be seen is not asked.
    #[test]
    fn snapshots_become_models_on_their_way() {
        let onlooker = Onlooker::default();
        let scope = ProgressScope::new(&onlooker, Instant::now(), None);
        let named = |snapshot: Snapshot| match snapshot {
            Snapshot::Surface { mesh, .. } => {
                Some(Snapshot::Model(Model { name: "low".into(), mesh, ..Model::default() }))
            }
            _ => None,
        };
        let showing = Showing::new(&scope, named);
        let part = Portion::new(&showing, 0.0..0.5);
        assert!(part.wants_snapshot() && !().wants_snapshot());
        part.snapshot(Snapshot::Surface { mesh: Mesh::default(), color: None });
        part.snapshot(Snapshot::Maps { maps: MapSet::new(1), parallax: None });
        let model = Model { name: "low".into(), ..Model::default() };
        assert_eq!(*onlooker.0.lock().unwrap(), [Message::Snapshot(Box::new(Snapshot::Model(model)))]);
        assert!(!Showing::new(&scope, Some).only_if(false).wants_snapshot());
    }
}
