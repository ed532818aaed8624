//! Messages of a run for whoever draws them, and the question whether to stop. The library
//! never prints.

use crate::snapshot::Snapshot;
use crate::stage::Stage;

/// One message.
///
/// A run with a plan sends it first; messages of stages that are not in it change no estimate.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// `done` of `total` steps of a stage are finished.
    Progress {
        /// Which stage.
        stage: Stage,
        /// Steps finished.
        done: usize,
        /// Steps in all.
        total: usize,
    },
    /// The stages that are to come, in their order, with weights: what each takes as a rule, in any unit.
    Plan(Vec<(Stage, f64)>),
    /// A part of a longer run begins, as a level of a chain; plans that follow are its own.
    Part {
        /// What a person reads: "level 2 of 3".
        name: String,
        /// Work that is done, this part's own, and all, in any one unit; they may be revised from part to part.
        work: [f64; 3],
    },
    /// Something that the user should know and that stops nothing.
    Warning(String),
    /// What a stage minimises, after one of its steps.
    Loss {
        /// Which stage.
        stage: Stage,
        /// In a unit of the stage's own, above 0: only those of one descent can be compared.
        value: f64,
        /// Whether a descent begins with it.
        is_first: bool,
    },
    /// What there is to see of the run; sent only where it was [wanted](Watcher::wants_snapshot).
    Snapshot(Box<Snapshot>),
}

/// Receives messages and may stop a run; called from several threads at once.
pub trait Watcher: Sync {
    /// Takes a message.
    fn message(&self, message: Message) {
        let _ = message;
    }

    /// Reports that `done` of `total` steps of a stage are finished.
    fn progress(&self, stage: Stage, done: usize, total: usize) {
        self.message(Message::Progress { stage, done, total });
    }

    /// Shows the state of a stage; after [`Watcher::wants_snapshot`] said so.
    fn snapshot(&self, snapshot: Snapshot) {
        self.message(Message::Snapshot(Box::new(snapshot)));
    }

    /// Whether someone wants to see the state of the run now. To be asked before each snapshot, since that takes time.
    fn wants_snapshot(&self) -> bool {
        false
    }

    /// True once the run shall end with the best state so far.
    fn stopped(&self) -> bool {
        false
    }

    /// Seconds until [`Watcher::stopped`] will be true, where that is known: long
    /// stages then leave time to those after them.
    fn seconds_left(&self) -> Option<f64> {
        None
    }
}

/// Nobody watches.
impl Watcher for () {}
