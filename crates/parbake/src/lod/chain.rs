//! Progress and time of a whole chain: one estimate and one budget for all levels.
//!
//! Each level has a weight, what it takes as a rule. Shares of the time that is left go by the weights of what is left,
//! so what one level saves the next may spend.
//!
//! Contract: a budget cuts steps of levels short and leaves out none; a watcher that says stop ends the chain.

use super::options::LodOptions;
use crate::budget::{check_budget, stage_weights};
use crate::low_poly::{POLISHED, TOO_MANY};
use crate::options::BakeOptions;
use parbake_levels::search::MOST_BAKES;
use parbake_progress::{Message, Stage, Watcher};
use std::time::{Duration, Instant};

/// Bakes that a search takes as a rule.
const USUAL_BAKES: usize = 5;
/// Seconds that the figures of a level take as a rule.
const FIGURES: f64 = 3.0;
/// Shares of a level's time: of choosing triangles, and of its figures, which no budget shortens.
const SHARES: [f64; 2] = [0.35, 0.15];

/// What levels take as a rule, and when they have to be finished.
pub(crate) struct Chain<'a> {
    watcher: &'a dyn Watcher,
    until: Option<Instant>,
    /// Weights of a bake of each level.
    weights: Vec<Vec<(Stage, f64)>>,
    bakes: usize,
    done: f64,
}

/// A bake of a level: passes messages on, but for the plan of the bake itself, which is a part of the level's.
pub(crate) struct LevelWatcher<'a> {
    watcher: &'a dyn Watcher,
    /// When its triangles have to be chosen.
    until: Option<Instant>,
}

impl<'a> Chain<'a> {
    /// For levels of about so many triangles and texels along a side; the budget began at `begin`.
    pub fn new(
        watcher: &'a dyn Watcher,
        begin: Instant,
        options: &LodOptions,
        sizes: &[(usize, usize)],
    ) -> Self {
        let left = watcher.seconds_left().map(|left| Instant::now() + seconds(left));
        let own = options.time_budget.map(|budget| begin + seconds(budget));
        let weights = sizes.iter().map(|&(triangles, size)| weights(options, triangles, size)).collect();
        let bakes = if options.target_psnr.is_some() { USUAL_BAKES } else { 1 };
        Self { watcher, until: left.into_iter().chain(own).min(), weights, bakes, done: 0.0 }
    }

    /// Whether the watcher said stop.
    pub fn stopped(&self) -> bool {
        self.watcher.stopped()
    }

    /// Seconds that the levels from this one on may take; none without a budget.
    fn left(&self) -> Option<f64> {
        self.until.map(|until| until.saturating_duration_since(Instant::now()).as_secs_f64())
    }

    /// Until when a level should be finished.
    pub fn level_until(&self, level: usize) -> Option<Instant> {
        let share = self.work(level) / (level..self.weights.len()).map(|k| self.work(k)).sum::<f64>();
        self.left().map(|left| Instant::now() + seconds(left * share))
    }

    /// A bake of a level begins, the `bake`-th from 0; its triangles are to be chosen by a share of what is left until
    /// `until`.
    pub fn bake(&mut self, level: usize, bake: usize, until: Option<Instant>) -> LevelWatcher<'a> {
        self.done += self.tell(level, bake);
        let left = until.map(|until| until.saturating_duration_since(Instant::now()).as_secs_f64());
        LevelWatcher {
            watcher: self.watcher,
            until: left.map(|left| Instant::now() + seconds(SHARES[0] * left)),
        }
    }

    /// Says which bake of which level is to come, also where something else is tried first. Returns its weight.
    pub fn tell(&self, level: usize, bake: usize) -> f64 {
        let own: f64 = self.weights[level].iter().map(|(_, weight)| weight).sum();
        let to_come = self.bakes.saturating_sub(bake).max(1) as f64 * own;
        let later: f64 = (level + 1..self.weights.len()).map(|k| self.work(k)).sum();
        let mut name = format!("level {} of {}", level + 1, self.weights.len());
        if self.bakes > 1 {
            name += &format!(", bake {} of at most {MOST_BAKES}", bake + 1);
        }
        self.watcher.message(Message::Part { name, work: [self.done, own, self.done + to_come + later] });
        self.watcher.message(Message::Plan(self.weights[level].clone()));
        own
    }

    fn work(&self, level: usize) -> f64 {
        self.bakes as f64 * self.weights[level].iter().map(|(_, weight)| weight).sum::<f64>()
    }
}

/// The options of a bake that has to be finished, figures included, by `until`; with fewer texels where so many could
/// not be written in that time.
pub(crate) fn hurried(mut options: BakeOptions, until: Option<Instant>) -> BakeOptions {
    let Some(until) = until else { return options };
    let left = until.saturating_duration_since(Instant::now()).as_secs_f64();
    options.time_budget = Some(left * (1.0 - SHARES[1]));
    while check_budget(&options).is_err() && options.texture_size > 32 {
        options.texture_size /= 2;
    }
    options
}

impl<'a> LevelWatcher<'a> {
    /// The same once the triangles are chosen; a bake's options hold its own budget.
    pub fn after_triangles(&self) -> LevelWatcher<'a> {
        Self { watcher: self.watcher, until: None }
    }
}

impl Watcher for LevelWatcher<'_> {
    fn message(&self, message: Message) {
        if !matches!(message, Message::Plan(_)) {
            self.watcher.message(message);
        }
    }

    fn wants_snapshot(&self) -> bool {
        self.watcher.wants_snapshot()
    }

    fn stopped(&self) -> bool {
        self.watcher.stopped()
    }

    fn seconds_left(&self) -> Option<f64> {
        self.until.map(|until| until.saturating_duration_since(Instant::now()).as_secs_f64())
    }
}

/// What a bake of a level takes as a rule, triangles and figures included: seconds on two cores.
fn weights(options: &LodOptions, triangles: usize, texture_size: usize) -> Vec<(Stage, f64)> {
    // Few triangles are polished, many have larger views, very many are hardly chosen.
    let choosing = match triangles {
        0..=POLISHED => 9.0,
        _ if triangles < TOO_MANY => 7.0,
        _ => 3.0,
    };
    let mut weights = vec![(Stage::Simplify, choosing)];
    weights.extend(stage_weights(&options.bake(texture_size)).into_iter().filter(|w| w.0 != Stage::Evaluate));
    weights.push((Stage::Evaluate, FIGURES));
    weights
}

fn seconds(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds.clamp(0.0, 1e9))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[derive(Default)]
    struct Notes(Mutex<Vec<Message>>);

    impl Watcher for Notes {
        fn message(&self, message: Message) {
            if let Ok(mut notes) = self.0.lock() {
                notes.push(message);
            }
        }
    }

    /// Protects the time that is shown and the one that is spent: parts follow each other without a gap up to all work,
    /// plans of bakes do not begin the estimate anew, and levels share what a budget leaves.
    #[test]
    fn levels_share_time() {
        let notes = Notes::default();
        let options = LodOptions { time_budget: Some(100.0), ..LodOptions::default() };
        let mut chain = Chain::new(&notes, Instant::now(), &options, &[(500, 256), (500, 256)]);
        let left = |until: Option<Instant>| until.map_or(0.0, |at| (at - Instant::now()).as_secs_f64());
        let until = chain.level_until(0);
        assert!((left(until) - 50.0).abs() < 1.0, "{}", left(until));
        let first = chain.bake(0, 0, until);
        assert!(first.seconds_left().is_some_and(|left| (left - 17.5).abs() < 1.0));
        // A bake is not over when the triangles have to be chosen.
        assert_eq!(first.after_triangles().seconds_left(), None);
        first.message(Message::Plan(Vec::new()));
        chain.bake(1, 0, chain.level_until(1));
        let parts: Vec<[f64; 3]> = notes.0.lock().map_or(Vec::new(), |notes| {
            notes
                .iter()
                .filter_map(|m| if let Message::Part { work, .. } = m { Some(*work) } else { None })
                .collect()
        });
        assert!(
            matches!(parts[..], [a, b] if a[0] == 0.0 && b[0] == a[1] && b[0] + b[1] == b[2]),
            "{parts:?}"
        );
        let plans = notes.0.lock().map_or(0, |n| n.iter().filter(|m| matches!(m, Message::Plan(_))).count());
        assert_eq!(plans, 2);
    }

    /// Protects budgets that a texture cannot keep: the level has fewer texels, and is made.
    #[test]
    fn little_time_has_fewer_texels() {
        let soon = Some(Instant::now() + seconds(2.0));
        let options = hurried(LodOptions::default().bake(4096), soon);
        assert!(options.texture_size == 1024 && check_budget(&options).is_ok(), "{}", options.texture_size);
        assert_eq!(hurried(LodOptions::default().bake(4096), None).texture_size, 4096);
    }
}
