//! How long each stage of a run took, by its progress messages: what `--verbose` prints of commands that make several
//! bakes, or none.
//!
//! A stage lasts from its first message to the first of another stage. Stages that take turns are summed up.
//!
//! Contract: stages are listed in the order in which they began.

use parbake::Stage;
use std::time::{Duration, Instant};

/// The stages of a run, or of a part of it, so far.
#[derive(Default)]
pub struct StageTimes {
    times: Vec<(Stage, Duration)>,
    current: Option<(Stage, Instant)>,
}

impl StageTimes {
    /// Notes that this stage is at work.
    pub fn note(&mut self, stage: Stage, now: Instant) {
        if self.current.is_some_and(|(current, _)| current == stage) {
            return;
        }
        self.close(now);
        self.current = Some((stage, now));
    }

    /// A line for each stage, and forgets them.
    pub fn take_lines(&mut self, now: Instant) -> Vec<String> {
        self.close(now);
        let line = |(stage, time): (Stage, Duration)| stage_line(stage, time.as_secs_f64());
        std::mem::take(&mut self.times).into_iter().map(line).collect()
    }

    fn close(&mut self, now: Instant) {
        let Some((stage, since)) = self.current.take() else { return };
        let time = now.saturating_duration_since(since);
        match self.times.iter_mut().find(|(own, _)| *own == stage) {
            Some((_, sum)) => *sum += time,
            None => self.times.push((stage, time)),
        }
    }
}

/// What `--verbose` prints of a stage.
pub fn stage_line(stage: Stage, seconds: f64) -> String {
    format!("{:24} {seconds:7.3} s", stage.label())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects `--verbose`: stages that take turns are one line each, in the order in which they began, and a second
    /// part of a run begins anew.
    #[test]
    fn stages_that_take_turns_are_summed_up() {
        let (mut times, begin) = (StageTimes::default(), Instant::now());
        let at = |seconds: u64| begin + Duration::from_secs(seconds);
        for (stage, seconds) in [(Stage::Uv, 0), (Stage::Uv, 1), (Stage::Solve, 3), (Stage::Uv, 4)] {
            times.note(stage, at(seconds));
        }
        let lines = times.take_lines(at(6));
        assert_eq!(lines, [stage_line(Stage::Uv, 5.0), stage_line(Stage::Solve, 1.0)]);
        times.note(Stage::Write, at(7));
        assert_eq!(times.take_lines(at(9)), [stage_line(Stage::Write, 2.0)]);
        assert!(times.take_lines(at(10)).is_empty());
    }
}
