//! Between a bake and its stages: messages go out, the question whether to stop comes in, and
//! each stage's time is noted.

use crate::message::{Message, Stage, Watcher};
use crate::report::StageTime;
use parbake_fit::watch;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The shares of stages in the time that a budget leaves them: textures are worth most, and
/// what reference pictures show must be solved for.
pub(crate) mod shares {
    pub const SHAPE: f64 = 0.2;
    pub const UNFOLD: f64 = 0.15;
    pub const REFERENCE: f64 = 0.25;
    pub const DEPTH: f64 = 0.35;
}

/// Passes the stages' messages on, and their question whether to stop.
pub(crate) struct Bridge<'a, W> {
    watcher: &'a W,
    /// When a budget is spent, besides what the watcher says.
    until: Option<Instant>,
    /// Set once a stage was told to stop; one for all stages.
    told: Arc<AtomicBool>,
}

impl<'a, W: Watcher> Bridge<'a, W> {
    /// For a run that may take so many seconds from `begin` on.
    pub fn new(watcher: &'a W, begin: Instant, budget: Option<f64>) -> Self {
        let until = budget.map(|seconds| begin + Duration::from_secs_f64(seconds.min(1e9)));
        Self { watcher, until, told: Arc::default() }
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

impl<W: Watcher> Watcher for Bridge<'_, W> {
    fn message(&self, message: Message) {
        self.watcher.message(message);
    }

    fn stopped(&self) -> bool {
        watch::Watch::should_stop(self)
    }
}

impl<W: Watcher> watch::Watch for Bridge<'_, W> {
    fn progress(&self, stage: watch::Stage, done: usize, total: usize) {
        let stage = match stage {
            watch::Stage::Shape => Stage::Shape,
            watch::Stage::Reference => Stage::Reference,
            watch::Stage::Start => Stage::Start,
            watch::Stage::Sampling => Stage::Sampling,
            watch::Stage::Cutout => Stage::Cutout,
            watch::Stage::Parallax => Stage::Parallax,
            watch::Stage::Solve => Stage::Solve,
        };
        self.watcher.message(Message::Progress { stage, done, total });
    }

    fn should_stop(&self) -> bool {
        let stop = self.watcher.stopped() || self.until.is_some_and(|until| Instant::now() >= until);
        if stop {
            self.told.store(true, Ordering::Relaxed);
        }
        stop
    }
}

/// Notes how long stages take.
pub(crate) struct Clock {
    since: Instant,
    /// In the order in which they ended.
    pub stages: Vec<StageTime>,
}

impl Clock {
    /// The first stage begins.
    pub fn new(since: Instant) -> Self {
        Self { since, stages: Vec::new() }
    }

    /// A stage ends and the next begins.
    pub fn lap(&mut self, stage: Stage) {
        let seconds = self.since.elapsed().as_secs_f64();
        self.since = Instant::now();
        self.stages.push(StageTime { stage, seconds });
    }
}
