//! A run that the page follows while it lasts.
//!
//! ```text
//! run ─ messages ─ Live ─ state (told as soon as something happens, at the latest after half a second) ─ page
//!                    └─── the newest snapshot, as a GLB file
//! ```
//!
//! Contract: a run is asked for a snapshot only when a page is there that says it could show one, and so rarely that
//! snapshots take about one part in [`SHARE`] of its time at most. Only [`Live::hand_over`] waits for a page.

use bytes::Bytes;
use parbake_files::{Limits, quick_glb_bytes, read_self_contained};
use parbake_model::Model;
use parbake_progress::{Estimate, Message, Snapshot, Stage, Watcher};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// A run's time is at least so many times that of its snapshots…
const SHARE: u32 = 40;
/// …and there are never more of them than this apart.
const LEAST_APART: Duration = Duration::from_millis(400);
/// A page that has not asked for so long is gone.
const GONE: Duration = Duration::from_secs(8);
/// A browser that was opened so long ago would have asked by now.
const COMING: Duration = Duration::from_secs(10);
/// How long a page waits for news at most.
const NEWS: Duration = Duration::from_millis(500);
/// Points of a curve, at most.
const POINTS: usize = 240;

/// A run as the page sees it.
#[derive(Debug)]
pub struct Live {
    /// Name of the file that will be written.
    name: String,
    begin: Instant,
    state: Mutex<State>,
    /// Counts what has happened.
    version: watch::Sender<u64>,
}

#[derive(Debug, Default)]
struct State {
    stage: Option<Stage>,
    part: Option<String>,
    estimate: Estimate,
    curves: Vec<Curve>,
    warnings: Vec<String>,
    shown: Shown,
    ending: Option<Ending>,
    /// When a page last asked for anything.
    asked: Option<Instant>,
    /// Whether a page could show a new snapshot: one that is made before would be old by then.
    could_show: bool,
    /// When the run was last told that a snapshot is wanted.
    wanted: Option<Instant>,
    /// What making the newest snapshot took.
    cost: Duration,
    /// Whether a page has shown how it ended.
    is_handed_over: bool,
}

/// The newest snapshot.
#[derive(Debug, Default)]
struct Shown {
    /// Counted from 1; 0 is none.
    number: u64,
    /// The last one that a page has fetched.
    fetched: u64,
    model: Option<Arc<Model>>,
    glb: Option<Bytes>,
    /// Of the written file.
    bytes: Option<u64>,
}

#[derive(Debug)]
enum Ending {
    Finished,
    Failed(String),
}

/// What one descent minimises, over time.
#[derive(Debug)]
struct Curve {
    stage: Stage,
    /// Seconds and values, every `stride`th.
    points: Vec<(f64, f64)>,
    stride: usize,
    count: usize,
}

impl Curve {
    fn add(&mut self, seconds: f64, value: f64) {
        if self.count.is_multiple_of(self.stride) {
            self.points.push((seconds, value));
        }
        self.count += 1;
        if self.points.len() > POINTS {
            let mut index = 0;
            self.points.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.stride *= 2;
        }
    }
}

impl Live {
    /// A run that begins now and will write a file of this name.
    pub fn new(name: &str) -> Self {
        Self {
            name: name.into(),
            begin: Instant::now(),
            state: Mutex::default(),
            version: watch::Sender::new(0),
        }
    }

    /// The name of the file that will be written.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Says something on the page alone.
    pub fn warn(&self, text: &str) {
        self.message(Message::Warning(text.into()));
    }

    /// The run has written its file: the page shows that.
    pub fn finish(&self, written: &Path, limits: &Limits) {
        match read_self_contained(written, limits) {
            Ok(file) => {
                let mut state = self.state();
                state.shown = Shown {
                    number: state.shown.number + 1,
                    fetched: state.shown.fetched,
                    model: None,
                    glb: Some(file.glb.into()),
                    bytes: Some(file.bytes),
                };
                state.warnings.extend(file.warnings.into_iter().map(|warning| warning.text));
                state.ending = Some(Ending::Finished);
            }
            Err(error) => self.state().ending = Some(Ending::Failed(error.to_string())),
        }
        self.tell();
    }

    /// The run has failed, for this reason.
    pub fn fail(&self, reason: &str) {
        self.state().ending = Some(Ending::Failed(reason.into()));
        self.tell();
    }

    /// Waits until a page that is there, or on its way, has shown how the run ended, but no longer than `most`.
    pub fn hand_over(&self, most: Duration) {
        let until = Instant::now() + most;
        while Instant::now() < until {
            let state = self.state();
            let is_coming = state.asked.is_none() && self.begin.elapsed() < COMING;
            if state.is_handed_over || !(state.is_watched() || is_coming) {
                return;
            }
            drop(state);
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// What there is to say, as soon as it is more than at `version`; `could_show` tells that the page could show a new
    /// snapshot.
    pub(crate) async fn news(&self, version: u64, could_show: bool) -> Value {
        self.state().could_show |= could_show;
        let mut receiver = self.version.subscribe();
        // Whether news came or time is over: there is something to say in either case.
        let _ = tokio::time::timeout(NEWS, receiver.wait_for(|now| *now > version)).await;
        let version = *self.version.borrow();
        self.state().told(version, self.begin.elapsed().as_secs_f64())
    }

    /// The newest snapshot as a GLB file; none before the first, or where one cannot be written.
    pub(crate) async fn glb(&self) -> Option<Bytes> {
        let (number, model) = {
            let shown = &mut self.state().shown;
            if let Some(glb) = &shown.glb {
                let glb = glb.clone();
                shown.fetched = shown.number;
                return Some(glb);
            }
            (shown.number, shown.model.clone()?)
        };
        let begin = Instant::now();
        let glb =
            tokio::task::spawn_blocking(move || quick_glb_bytes(&model)).await.ok()?.ok().map(Bytes::from);
        let mut state = self.state();
        state.cost += begin.elapsed();
        state.shown.fetched = state.shown.fetched.max(number);
        if state.shown.number == number {
            state.shown.glb = glb.clone();
        }
        glb
    }

    /// A page has asked for something.
    pub(crate) fn note_page(&self) {
        self.state().asked = Some(Instant::now());
    }

    /// A page has shown how the run ended.
    pub(crate) fn take_over(&self) {
        self.state().is_handed_over = true;
    }

    fn tell(&self) {
        self.version.send_modify(|version| *version += 1);
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // Each change is whole before anything could panic.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn is_watched(&self) -> bool {
        self.asked.is_some_and(|asked| asked.elapsed() < GONE)
    }

    fn told(&self, version: u64, seconds: f64) -> Value {
        let of = |curve: &Curve| json!({ "stage": curve.stage.label(), "points": curve.points });
        let (is_finished, failure) = match &self.ending {
            None => (false, None),
            Some(Ending::Finished) => (true, None),
            Some(Ending::Failed(reason)) => (false, Some(reason)),
        };
        json!({
            "version": version,
            "seconds": seconds,
            "stage": self.stage.map(Stage::label),
            "part": self.part,
            "done": self.estimate.done(),
            "secondsLeft": self.estimate.seconds_left(seconds),
            "curves": self.curves.iter().map(of).collect::<Vec<_>>(),
            "warnings": self.warnings,
            "snapshot": self.shown.number,
            "bytes": self.shown.bytes,
            "isFinished": is_finished,
            "failure": failure,
        })
    }
}

impl Watcher for Live {
    fn message(&self, message: Message) {
        let seconds = self.begin.elapsed().as_secs_f64();
        let mut state = self.state();
        state.estimate.note(&message);
        match message {
            Message::Plan(_) => return,
            Message::Part { name, .. } => state.part = Some(name),
            Message::Progress { stage, .. } if state.stage == Some(stage) => return,
            Message::Progress { stage, .. } => state.stage = Some(stage),
            Message::Warning(text) => state.warnings.push(text),
            Message::Loss { stage, value, is_first } => {
                if is_first || state.curves.is_empty() {
                    state.curves.push(Curve { stage, points: Vec::new(), stride: 1, count: 0 });
                }
                if let Some(curve) = state.curves.last_mut() {
                    curve.add(seconds, value);
                }
                return;
            }
            Message::Snapshot(snapshot) => {
                let Snapshot::Model(model) = *snapshot else { return };
                state.cost = state.wanted.map_or(Duration::ZERO, |wanted| wanted.elapsed());
                let (number, fetched) = (state.shown.number + 1, state.shown.fetched);
                state.shown = Shown { number, fetched, model: Some(model.into()), glb: None, bytes: None };
            }
        }
        drop(state);
        self.tell();
    }

    fn wants_snapshot(&self) -> bool {
        let mut state = self.state();
        let apart = LEAST_APART.max(SHARE * state.cost);
        let is_due = state.wanted.is_none_or(|wanted| wanted.elapsed() >= apart);
        let is_wanted = is_due
            && state.could_show
            && state.is_watched()
            && state.ending.is_none()
            && state.shown.fetched == state.shown.number;
        if is_wanted {
            state.wanted = Some(Instant::now());
            state.could_show = false;
        }
        is_wanted
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn block<T>(future: impl Future<Output = T>) -> T {
        tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(future)
    }

    fn model() -> Model {
        Model { name: "low".into(), ..Model::default() }
    }

    /// Protects a bake's time: nobody asks for snapshots without a page, nor before the page has shown the last one, nor
    /// more often than their cost allows.
    #[test]
    fn snapshots_are_wanted_only_by_a_page_that_keeps_up() {
        let live = Live::new("baked.glb");
        assert!(!live.wants_snapshot(), "without a page");
        live.note_page();
        assert!(!live.wants_snapshot(), "a page that has not said what it could show");
        let before = block(live.news(0, true));
        assert_eq!((&before["snapshot"], &before["isFinished"]), (&json!(0), &json!(false)));
        assert!(live.wants_snapshot(), "with a page");
        live.snapshot(Snapshot::Model(model()));
        let later = |fetched: u64, could_show: bool| {
            let mut state = live.state();
            state.wanted = Some(Instant::now() - LEAST_APART);
            (state.shown.fetched, state.could_show) = (fetched, could_show);
        };
        later(0, true);
        assert!(!live.wants_snapshot(), "the page has not fetched the last one");
        later(1, false);
        assert!(!live.wants_snapshot(), "the page rests");
        later(1, true);
        assert!(live.wants_snapshot());
        assert!(!live.wants_snapshot(), "it wanted one");
        later(1, true);
        live.state().cost = Duration::from_millis(100);
        assert!(!live.wants_snapshot(), "the last one took 100 ms, so the next comes after 4 s");
    }

    /// Protects what the page says of a run: its stage, how far it is, curves that begin anew where losses cannot be
    /// compared, and how it ended.
    #[test]
    fn the_page_is_told_how_a_run_goes() {
        let live = Live::new("baked.glb");
        live.message(Message::Plan(vec![(Stage::Shape, 1.0), (Stage::Solve, 1.0)]));
        live.progress(Stage::Shape, 1, 2);
        for k in 0..1000 {
            live.message(Message::Loss { stage: Stage::Shape, value: 1.0, is_first: k == 0 });
        }
        live.message(Message::Loss { stage: Stage::Solve, value: 0.5, is_first: true });
        live.message(Message::Warning("odd".into()));
        let told = block(live.news(0, true));
        assert_eq!(told["stage"], "moving vertices");
        assert_eq!((&told["done"], &told["warnings"]), (&json!(0.25), &json!(["odd"])));
        let curves = told["curves"].as_array().unwrap();
        assert_eq!((curves.len(), &curves[1]["stage"]), (2, &json!("solving for textures")));
        assert!((POINTS / 2..=POINTS).contains(&curves[0]["points"].as_array().unwrap().len()));
        live.fail("no room");
        let told = block(live.news(told["version"].as_u64().unwrap(), false));
        assert_eq!((&told["failure"], &told["isFinished"]), (&json!("no room"), &json!(false)));
        live.note_page();
        live.take_over();
        let begin = Instant::now();
        live.hand_over(Duration::from_secs(5));
        assert!(begin.elapsed() < Duration::from_secs(1), "the page knows it already");
    }
}
