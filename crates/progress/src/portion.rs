//! A part of a stage that reports as if it were all of it: its steps become those of the stage.
//!
//! Contract: passes all else on.

use crate::message::{Message, Watcher};
use crate::stage::Stage;
use std::ops::Range;

/// Steps that a stage has when its parts report.
const STEPS: f64 = 1000.0;

/// Passes a part's messages on.
pub struct Portion<'a> {
    watcher: &'a dyn Watcher,
    range: Range<f64>,
    /// The only stage whose progress counts, and the one that it is a part of; none where its messages say so.
    stages: Option<[Stage; 2]>,
}

impl<'a> Portion<'a> {
    /// For the part from `range.start` to `range.end` of the stage, 0 to 1.
    pub fn new(watcher: &'a dyn Watcher, range: Range<f64>) -> Self {
        Self { watcher, range, stages: None }
    }

    /// The same for a part whose progress is that of the stage `inner`, as a part of `outer`; other stages' is not told.
    pub fn of_stage(self, inner: Stage, outer: Stage) -> Self {
        Self { stages: Some([inner, outer]), ..self }
    }
}

impl Watcher for Portion<'_> {
    fn message(&self, message: Message) {
        self.watcher.message(match message {
            Message::Progress { stage, done, total } => {
                let [inner, outer] = self.stages.unwrap_or([stage; 2]);
                if stage != inner {
                    return;
                }
                let share = (done as f64 / total.max(1) as f64).clamp(0.0, 1.0);
                let share = self.range.start + (self.range.end - self.range.start) * share;
                let done = (STEPS * share).round() as usize;
                Message::Progress { stage: outer, done, total: STEPS as usize }
            }
            other => other,
        });
    }

    fn wants_snapshot(&self) -> bool {
        self.watcher.wants_snapshot()
    }

    fn stopped(&self) -> bool {
        self.watcher.stopped()
    }

    fn seconds_left(&self) -> Option<f64> {
        self.watcher.seconds_left()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    struct Notes(Mutex<Vec<Message>>);

    impl Watcher for Notes {
        fn message(&self, message: Message) {
            self.0.lock().unwrap().push(message);
        }
    }

    /// Protects the bar: the second half of a stage ends where the stage does, and begins in its middle.
    #[test]
    fn a_part_reports_as_the_whole() {
        let notes = Notes(Mutex::default());
        let half = Portion::new(&notes, 0.5..1.0);
        half.progress(Stage::Simplify, 0, 7);
        half.progress(Stage::Simplify, 7, 7);
        let of_shape = Portion::new(&notes, 0.0..0.5).of_stage(Stage::Reference, Stage::Shape);
        of_shape.progress(Stage::Sampling, 1, 1);
        of_shape.progress(Stage::Reference, 1, 1);
        let at = |stage, done| Message::Progress { stage, done, total: 1000 };
        let all = [at(Stage::Simplify, 500), at(Stage::Simplify, 1000), at(Stage::Shape, 500)];
        assert_eq!(*notes.0.lock().unwrap(), all);
    }
}
