//! A run's or a stage's share of the time: passes messages on to the caller's watcher, and tells the
//! stage to stop when the watcher says so or when its time is spent.

use crate::message::{Message, Watcher};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Passes the stages' messages on, and their question whether to stop.
pub struct ProgressScope<'a> {
    watcher: &'a dyn Watcher,
    /// When a budget is spent, besides what the watcher says.
    until: Option<Instant>,
    /// Set once a stage was told to stop; one for all stages.
    told: Arc<AtomicBool>,
}

impl<'a> ProgressScope<'a> {
    /// For a run that may take so many seconds from `begin` on.
    pub fn new(watcher: &'a dyn Watcher, begin: Instant, budget: Option<f64>) -> Self {
        let until = budget.map(|seconds| begin + duration(seconds));
        Self { watcher, until, told: Arc::default() }
    }

    /// The same run without the last `seconds` of its time, which what cannot be stopped at its end takes.
    /// Where neither a budget nor the watcher limits the time, nothing changes.
    pub fn keeping_back(self, seconds: f64) -> Self {
        let until = self.seconds_left().map(|left| after(left - seconds));
        Self { until, ..self }
    }

    /// Whether a stage was told to stop.
    pub fn stopped_a_stage(&self) -> bool {
        self.told.load(Ordering::Relaxed)
    }

    /// The same for a stage that may take this share of the time that is left.
    pub fn share(&self, share: f64) -> Self {
        let until = self.seconds_left().map(|left| after(left * share));
        Self { watcher: self.watcher, until, told: self.told.clone() }
    }
}

impl Watcher for ProgressScope<'_> {
    fn message(&self, message: Message) {
        self.watcher.message(message);
    }

    fn wants_snapshot(&self) -> bool {
        self.watcher.wants_snapshot()
    }

    fn stopped(&self) -> bool {
        let stop = self.watcher.stopped() || self.until.is_some_and(|until| Instant::now() >= until);
        if stop {
            self.told.store(true, Ordering::Relaxed);
        }
        stop
    }

    /// Of the budget, or of what the watcher leaves of its own.
    fn seconds_left(&self) -> Option<f64> {
        let own = self.until.map(|until| until.saturating_duration_since(Instant::now()).as_secs_f64());
        own.into_iter().chain(self.watcher.seconds_left()).reduce(f64::min)
    }
}

/// Seconds from now on.
fn after(seconds: f64) -> Instant {
    Instant::now() + duration(seconds)
}

/// Not more than what clocks can add.
fn duration(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds.clamp(0.0, 1e9))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects budgets of runs within runs: stages of the inner one share what the outer one leaves, and no budget is
    /// none.
    #[test]
    fn runs_within_runs_share_the_time() {
        let outer = ProgressScope::new(&(), Instant::now(), Some(100.0)).keeping_back(20.0);
        let inner = ProgressScope::new(&outer, Instant::now(), None);
        let left = |scope: &ProgressScope| scope.seconds_left().expect("there is a budget");
        assert!((left(&inner) - 80.0).abs() < 5.0);
        assert!((left(&inner.share(0.5)) - 40.0).abs() < 5.0);
        assert!((left(&ProgressScope::new(&inner, Instant::now(), Some(30.0))) - 30.0).abs() < 5.0);
        let spent = ProgressScope::new(&outer, Instant::now(), None).keeping_back(1e3);
        assert!(spent.stopped() && spent.seconds_left() == Some(0.0) && spent.stopped_a_stage());
        let free = ProgressScope::new(&(), Instant::now(), None);
        assert_eq!((free.seconds_left(), free.share(0.5).seconds_left()), (None, None));
    }
}
