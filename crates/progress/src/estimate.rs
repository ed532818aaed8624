//! How long a whole run will still take: the stages that are to come, weighted by what they take as a
//! rule, and scaled by what those so far have taken.
//!
//! With W the weight of all stages, w that of what is done and t the time since the run began, the rest
//! takes t·(W − w)/w. A run of several parts, as a chain of levels, has their work for weights; the stages of a part
//! share its own.

use crate::message::Message;
use crate::stage::Stage;

/// Share of the work below which an estimate would be a guess.
const TOO_EARLY: f64 = 0.02;

/// Follows the messages of a run.
#[derive(Clone, Debug, Default)]
pub struct Estimate {
    /// Stages in their order, each with its weight.
    plan: Vec<(Stage, f64)>,
    /// The stage that runs, by its place in the plan.
    current: usize,
    /// How much of it is done, 0 to 1.
    share: f64,
    /// Of a longer run the work before this part, this part's, and all; none where there are no parts.
    part: Option<[f64; 3]>,
}

impl Estimate {
    /// Takes note of a message.
    pub fn note(&mut self, message: &Message) {
        match message {
            Message::Plan(plan) => *self = Self { plan: plan.clone(), part: self.part, ..Self::default() },
            Message::Part { work, .. } => *self = Self { part: Some(*work), ..Self::default() },
            Message::Progress { stage, done, total } => {
                // A stage that reports in several runs never goes back.
                let Some(place) = self.plan.iter().position(|(own, _)| own == stage) else { return };
                let share = (*done as f64 / (*total).max(1) as f64).clamp(0.0, 1.0);
                if place > self.current || (place == self.current && share > self.share) {
                    (self.current, self.share) = (place, share);
                }
            }
            Message::Warning(_) | Message::Loss { .. } | Message::Snapshot(_) => {}
        }
    }

    /// The share of the whole run that is done, 0 to 1; none without a plan.
    pub fn done(&self) -> Option<f64> {
        let all: f64 = self.plan.iter().map(|(_, weight)| weight).sum();
        let before: f64 = self.plan.iter().take(self.current).map(|(_, weight)| weight).sum();
        let own = self.plan.get(self.current).map_or(0.0, |(_, weight)| weight * self.share);
        let of_plan = (all > 0.0).then(|| (before + own) / all);
        let Some([before, own, all]) = self.part else { return of_plan };
        (all > 0.0).then(|| ((before + own * of_plan.unwrap_or(0.0)) / all).clamp(0.0, 1.0))
    }

    /// Seconds until the end of a run that began so many seconds ago; none where it is too early to tell.
    pub fn seconds_left(&self, since_begin: f64) -> Option<f64> {
        self.done().filter(|done| *done >= TOO_EARLY).map(|done| since_begin * (1.0 - done) / done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the time that is shown: it is that of the whole run, goes by weights, and a stage that
    /// is told of late does not turn it back.
    #[test]
    fn the_time_left_is_that_of_the_whole_run() {
        let mut estimate = Estimate::default();
        assert_eq!(estimate.seconds_left(5.0), None);
        estimate.note(&Message::Plan(vec![
            (Stage::Shape, 1.0),
            (Stage::Reference, 1.0),
            (Stage::Solve, 2.0),
        ]));
        assert_eq!(estimate.seconds_left(5.0), None, "too early");
        let at = |stage, done| Message::Progress { stage, done, total: 10 };
        estimate.note(&at(Stage::Shape, 10));
        assert_eq!(estimate.seconds_left(5.0), Some(15.0));
        estimate.note(&at(Stage::Solve, 5));
        assert_eq!(estimate.seconds_left(9.0), Some(3.0));
        estimate.note(&at(Stage::Shape, 2));
        estimate.note(&at(Stage::Read, 1));
        assert_eq!(estimate.done(), Some(0.75));
    }

    /// Protects the time that is shown of a chain: plans of its parts do not begin it anew, and a part without a plan
    /// counts once it is over.
    #[test]
    fn parts_share_one_estimate() {
        let mut estimate = Estimate::default();
        let part = |work| Message::Part { name: "level".into(), work };
        estimate.note(&part([0.0, 3.0, 4.0]));
        assert_eq!(estimate.done(), Some(0.0));
        estimate.note(&Message::Plan(vec![(Stage::Simplify, 1.0), (Stage::Solve, 1.0)]));
        estimate.note(&Message::Progress { stage: Stage::Simplify, done: 2, total: 2 });
        assert_eq!(estimate.seconds_left(6.0), Some(10.0));
        estimate.note(&part([3.0, 1.0, 4.0]));
        assert_eq!(estimate.seconds_left(9.0), Some(3.0));
        // What was to come may turn out to be less.
        estimate.note(&part([4.0, 0.0, 4.0]));
        assert_eq!(estimate.done(), Some(1.0));
    }
}
