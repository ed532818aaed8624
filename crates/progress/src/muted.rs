//! Watchers that hear less than the one behind them, for runs that are a part of a longer one.
//!
//! Contract: whether to stop, and the time that is left, are passed on.

use crate::message::{Message, Watcher};

/// Hears nothing: a run that is one step of another.
pub struct Muted<'a>(pub &'a dyn Watcher);

impl Watcher for Muted<'_> {
    fn message(&self, _: Message) {}

    fn stopped(&self) -> bool {
        self.0.stopped()
    }

    fn seconds_left(&self) -> Option<f64> {
        self.0.seconds_left()
    }
}

/// Hears all but warnings: a run whose result may not be taken.
pub struct WithoutWarnings<'a>(pub &'a dyn Watcher);

impl Watcher for WithoutWarnings<'_> {
    fn message(&self, message: Message) {
        if !matches!(message, Message::Warning(_)) {
            self.0.message(message);
        }
    }

    fn wants_snapshot(&self) -> bool {
        self.0.wants_snapshot()
    }

    fn stopped(&self) -> bool {
        self.0.stopped()
    }

    fn seconds_left(&self) -> Option<f64> {
        self.0.seconds_left()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::stage::Stage;
    use std::sync::Mutex;

    #[derive(Default)]
    struct Heard(Mutex<Vec<Message>>);

    impl Watcher for Heard {
        fn wants_snapshot(&self) -> bool {
            true
        }

        fn message(&self, message: Message) {
            self.0.lock().unwrap().push(message);
        }

        fn stopped(&self) -> bool {
            true
        }

        fn seconds_left(&self) -> Option<f64> {
            Some(2.0)
        }
    }

    /// Protects people from warnings of what is thrown away, and from runs that cannot be stopped.
    #[test]
    fn stops_are_passed_on_and_warnings_are_not() {
        let heard = Heard::default();
        for watcher in [&Muted(&heard) as &dyn Watcher, &WithoutWarnings(&heard)] {
            watcher.message(Message::Warning("odd".into()));
            watcher.progress(Stage::Shape, 1, 2);
            assert!(watcher.stopped() && watcher.seconds_left() == Some(2.0));
        }
        assert!(!Muted(&heard).wants_snapshot() && WithoutWarnings(&heard).wants_snapshot());
        let progress = Message::Progress { stage: Stage::Shape, done: 1, total: 2 };
        assert_eq!(*heard.0.lock().unwrap(), [progress]);
    }
}
