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
        let until = budget.map(|seconds| begin + Duration::from_secs_f64(seconds.min(1e9)));
        Self { watcher, until, told: Arc::default() }
    }

    /// The same run without the last `seconds` of its time, which what cannot be stopped at its end takes.
    /// Where neither a budget nor the watcher limits the time, nothing changes.
    pub fn keeping_back(mut self, seconds: f64) -> Self {
        let seconds = Duration::from_secs_f64(seconds.clamp(0.0, 1e9));
        let watchers = self
            .watcher
            .seconds_left()
            .map(|left| Instant::now() + Duration::from_secs_f64(left.clamp(0.0, 1e9)));
        let until = self.until.into_iter().chain(watchers).min();
        self.until = until.map(|until| until.checked_sub(seconds).unwrap_or_else(Instant::now));
        self
    }

    /// Whether a stage was told to stop.
    pub fn stopped_a_stage(&self) -> bool {
        self.told.load(Ordering::Relaxed)
    }

    /// The same for a stage that may take this share of the time that is left.
    pub fn share(&self, share: f64) -> Self {
        let own = self.until.map(|until| until.saturating_duration_since(Instant::now()).as_secs_f64());
        let left = own.into_iter().chain(self.watcher.seconds_left()).reduce(f64::min);
        let until = left.map(|left| Instant::now() + Duration::from_secs_f64((left * share).clamp(0.0, 1e9)));
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
}
