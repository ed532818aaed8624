//! How long the stages of a run take.

use crate::stage::Stage;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Seconds that a stage took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageTime {
    /// Which stage.
    pub stage: Stage,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// Measures the stages of a run.
pub struct Clock {
    since: Instant,
    /// In the order in which they first ended; a stage that ran in parts has the sum.
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
        match self.stages.iter_mut().find(|time| time.stage == stage) {
            Some(time) => time.seconds += seconds,
            None => self.stages.push(StageTime { stage, seconds }),
        }
    }
}
