//! What a person sees while waiting, and the two ways of ending early: Ctrl-C and
//! the time budget.

use crate::arguments::{Reading, Talk};
use crate::stage_times::StageTimes;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use parbake::{Estimate, Limits, Message, Stage, Watcher};
use parbake_viewer::Live;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static HANDLER: OnceLock<()> = OnceLock::new();

/// True after Ctrl-C (or SIGTERM).
pub fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// The first Ctrl-C asks for a clean stop, the second ends at once.
fn catch_interrupts(what_becomes: &'static str) {
    HANDLER.get_or_init(|| {
        // Without a handler the bake still works; it only cannot stop cleanly.
        let _ = ctrlc::set_handler(move || {
            if INTERRUPTED.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
            eprintln!("\nstopping: {what_becomes} (Ctrl-C again to give up)");
        });
    });
}

/// Draws messages on standard error.
pub struct Console {
    talk: Talk,
    limits: Limits,
    deadline: Option<Instant>,
    begin: Instant,
    bar: ProgressBar,
    state: Mutex<State>,
    /// Whether work ends at the deadline by itself, and is told of nothing but of interrupts.
    keeps_time: bool,
    /// The page that is told of everything as well.
    page: Option<Arc<Live>>,
    /// Whether `--verbose` prints what stages took by the progress that they tell.
    times_stages: bool,
}

/// What the bar shows.
#[derive(Default)]
struct State {
    stage: Option<Stage>,
    /// Of a longer run, as a chain of levels; the bar is then that of the run.
    part: Option<String>,
    estimate: Estimate,
    times: StageTimes,
}

/// Kept back from a time budget for encoding and writing, as a share and at least
/// so many seconds.
const RESERVE: (f64, f64) = (0.15, 0.12);

impl Console {
    /// For work that has nothing to show before its end: Ctrl-C ends it at once.
    pub fn new(talk: Talk) -> Self {
        Self::with_deadline(talk, None)
    }

    /// The same, with models that may keep reading to their own folders.
    pub fn confined(mut self, reading: Reading) -> Self {
        self.limits.confine = reading.confine;
        self
    }

    /// The same with a page that is told of everything as well.
    pub fn with_page(mut self, page: Option<Arc<Live>>) -> Self {
        self.page = page;
        self
    }

    /// The same for a command that prints no list of stages itself: `--verbose` prints what each took.
    pub fn with_stage_times(mut self) -> Self {
        self.times_stages = self.talk.verbose;
        self
    }

    /// The page that follows the run.
    pub fn page(&self) -> Option<&Live> {
        self.page.as_deref()
    }

    /// What models may ask for.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// For a bake, which Ctrl-C ends with the best state so far. Begins the clock of
    /// the time budget.
    pub fn for_bake(talk: Talk, time_budget: Option<f64>) -> Self {
        catch_interrupts("the best state so far is being written");
        Self::with_deadline(talk, time_budget)
    }

    /// For levels of detail, which Ctrl-C ends with those that are finished. Begins the clock of the time budget,
    /// which they share among them.
    pub fn for_levels(talk: Talk, time_budget: Option<f64>) -> Self {
        catch_interrupts("the level in hand is finished quickly, no further one begins");
        let console = Self { keeps_time: true, ..Self::with_deadline(talk, time_budget) };
        if let Ok(style) = ProgressStyle::with_template("{msg:52} {bar:30} {pos:>3} %{prefix}") {
            console.bar.set_style(style);
        }
        console.bar.set_length(100);
        console
    }

    /// For a film, of which a part is no use: Ctrl-C ends without a file, not even a temporary one.
    pub fn for_film(talk: Talk) -> Self {
        catch_interrupts("no film is written");
        Self::with_deadline(talk, None)
    }

    /// For work of which a part is no use: Ctrl-C ends without a file.
    pub fn for_whole(talk: Talk) -> Self {
        catch_interrupts("nothing is written");
        Self::with_deadline(talk, None)
    }

    /// For many runs one after the other, which Ctrl-C ends with what is finished.
    pub fn for_many(talk: Talk) -> Self {
        Self::of_runs(talk, "what is finished is being drawn")
    }

    /// For a batch, which Ctrl-C ends at once with what is finished.
    pub fn for_batch(talk: Talk) -> Self {
        Self::of_runs(talk, "running jobs end, what is finished stays")
    }

    fn of_runs(talk: Talk, what_becomes: &'static str) -> Self {
        catch_interrupts(what_becomes);
        let console = Self::with_deadline(talk, None);
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {prefix}{msg}") {
            console.bar.set_style(style);
        }
        console
    }

    /// Shows how many of many runs are finished, which one runs, and how long the rest will take.
    pub fn show_run(&self, done: usize, total: usize, title: &str, seconds_left: Option<f64>) {
        let left = seconds_left.map_or(String::new(), |s| format!("{} left: ", minutes(s)));
        self.bar.set_prefix(left);
        self.bar.set_message(title.to_string());
        self.bar.set_length(total as u64);
        self.bar.set_position(done as u64);
    }

    fn with_deadline(talk: Talk, time_budget: Option<f64>) -> Self {
        let begin = Instant::now();
        let deadline = time_budget.map(|seconds| {
            let work = (seconds - (seconds * RESERVE.0).clamp(RESERVE.1, 2.0)).max(0.0);
            begin + Duration::from_secs_f64(work.min(1e9))
        });
        let bar = ProgressBar::new(1);
        if talk.quiet {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        if let Ok(style) = ProgressStyle::with_template("{msg:24} {bar:30} {pos}/{len}{prefix}") {
            bar.set_style(style);
        }
        Self {
            talk,
            limits: Limits::default(),
            deadline,
            begin,
            bar,
            state: Mutex::default(),
            keeps_time: false,
            page: None,
            times_stages: false,
        }
    }

    /// A line that was asked for, also of a quiet command.
    pub fn announce(&self, text: &str) {
        self.bar.suspend(|| eprintln!("{text}"));
    }

    /// A line for people, unless they asked for quiet.
    pub fn say(&self, text: &str) {
        if !self.talk.quiet {
            self.bar.suspend(|| eprintln!("{text}"));
        }
    }

    /// A line for people who asked for more.
    pub fn detail(&self, text: &str) {
        if self.talk.verbose {
            self.say(text);
        }
    }

    /// Seconds since the run began.
    pub fn seconds(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    /// Takes the bar away, and tells what stages took where that was asked for.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
        if let Ok(mut state) = self.state.lock() {
            self.tell_times(&mut state);
        }
    }

    fn tell_times(&self, state: &mut State) {
        if self.times_stages {
            let lines = state.times.take_lines(Instant::now());
            lines.iter().for_each(|line| self.say(line));
        }
    }
}

/// "3 min", "40 s".
fn minutes(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{s:.0} s"),
        s => format!("{:.0} min", s / 60.0),
    }
}

impl Watcher for Console {
    fn message(&self, message: Message) {
        if let Some(page) = &self.page {
            if let Message::Snapshot(_) = message {
                return page.message(message);
            }
            page.message(message.clone());
        }
        let Ok(mut state) = self.state.lock() else { return };
        match &message {
            Message::Progress { stage, .. } => state.times.note(*stage, Instant::now()),
            Message::Part { .. } => self.tell_times(&mut state),
            _ => {}
        }
        let State { stage: current, part, estimate, .. } = &mut *state;
        estimate.note(&message);
        match message {
            Message::Plan(_) => {}
            Message::Part { name, .. } => {
                self.bar.set_length(100);
                self.bar.set_message(name.clone());
                *part = Some(name);
            }
            // They are for the page.
            Message::Loss { .. } | Message::Snapshot(_) => {}
            Message::Warning(text) => self.say(&format!("warning: {text}")),
            Message::Progress { stage, done, total } => {
                // Of the whole run where its stages are known, else of this stage.
                let (left, place) = match (estimate.done(), &*part) {
                    (Some(share), Some(part)) => {
                        self.bar.set_message(format!("{part}: {}", stage.label()));
                        let own = estimate.seconds_left(self.seconds());
                        let most =
                            self.deadline.map(|d| d.saturating_duration_since(Instant::now()).as_secs_f64());
                        (own.into_iter().chain(most).reduce(f64::min), (100.0 * share) as u64)
                    }
                    (share, _) => {
                        if *current != Some(stage) {
                            *current = Some(stage);
                            self.bar.reset();
                            self.bar.set_message(stage.label());
                        }
                        self.bar.set_length(total as u64);
                        let own = || Some(self.bar.eta().as_secs_f64());
                        (share.map_or_else(own, |_| estimate.seconds_left(self.seconds())), done as u64)
                    }
                };
                self.bar.set_position(place);
                let left = left.map_or(String::new(), |left| format!(", {} left", minutes(left)));
                self.bar.set_prefix(left);
            }
        }
    }

    fn wants_snapshot(&self) -> bool {
        self.page.as_ref().is_some_and(|page| page.wants_snapshot())
    }

    fn stopped(&self) -> bool {
        interrupted() || (!self.keeps_time && self.deadline.is_some_and(|d| Instant::now() >= d))
    }

    fn seconds_left(&self) -> Option<f64> {
        self.deadline.map(|d| d.saturating_duration_since(Instant::now()).as_secs_f64())
    }
}
