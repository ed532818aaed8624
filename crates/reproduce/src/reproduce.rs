//! The run: experiments one after the other, those that are kept taken from the cache, then
//! everything drawn.

use crate::cache::{Cache, digest_of};
use crate::catalogue::Catalogue;
use crate::error::ReproduceError;
use crate::exhibit::Exhibit;
use crate::exhibits::drawn::Drawn;
use crate::experiment::{Experiment, Recipe};
use crate::guard::Record;
use crate::observer::{Event, Observer};
use crate::options::ReproduceOptions;
use crate::outcome::Outcome;
use crate::perform::perform;
use crate::report;
use crate::results::Results;
use crate::scope::Scope;
use parbake::write_file;
use parbake_report::page::text::decimal;
use std::path::Path;

/// What a run leaves besides its files.
#[derive(Clone, Debug)]
pub struct Reproduced {
    /// All tables as text for a terminal.
    pub terminal: String,
    /// Gains for the guard.
    pub gains: Record,
    /// Experiments that were made, and that were taken from the cache.
    pub made: [usize; 2],
    /// Experiments that failed, a sentence each.
    pub failed: Vec<String>,
    /// Whether it was asked to stop before its end.
    pub stopped: bool,
}

/// Runs what the options ask for on a data folder and writes `report.html`, `tables.md` and
/// `gains.json` into `output`, beside the cache. `program` is the running program's file, which
/// outcomes are kept under. Runs on rayon's current thread pool.
///
/// An experiment that fails is told and left out, since users' folders may hold anything.
///
/// # Errors
/// An option out of range; a data folder that cannot be read or holds nothing; an output folder
/// that cannot be written.
pub fn reproduce(
    data: &Path,
    output: &Path,
    program: &Path,
    options: &ReproduceOptions,
    observer: &impl Observer,
) -> Result<Reproduced, ReproduceError> {
    options.check()?;
    let exhibits = exhibits(options);
    let mut catalogue = Catalogue::of(data, &options.models)?;
    if exhibits.contains(&Exhibit::Figure14) {
        catalogue.keep_mapped();
    }
    for reason in &catalogue.left_out {
        observer.event(Event::Note(reason.clone()));
    }
    std::fs::create_dir_all(output).map_err(ReproduceError::disk(output))?;
    let scope = Scope { catalogue, options: options.clone() };
    let mut cache = Cache::new(output, digest_of(program)?, options.any_build);
    let plan = plan(&scope, &exhibits);
    let mut state = State::default();
    for (done, experiment) in plan.iter().enumerate() {
        if observer.stopped() {
            break;
        }
        if let Err(error) = state.take(&mut cache, &scope, &plan, done, experiment, observer) {
            observer.event(Event::Note(error.to_string()));
            state.failed.push(error.to_string());
        }
    }
    observer.event(Event::Drawing);
    let mut drawn: Vec<(Exhibit, Drawn)> = Vec::new();
    for exhibit in exhibits {
        drawn.push((exhibit, exhibit.draw(&scope, &state.results)?));
    }
    drawn.sort_by_key(|(exhibit, _)| report::order(*exhibit));
    let stopped = state.results.all().count() + state.failed.len() < plan.len();
    let facts = report::Facts {
        scope: &scope,
        planned: plan.len(),
        results: &state.results,
        failed: &state.failed,
        build: cache.build(),
    };
    let gains = Record(drawn.iter().flat_map(|(_, drawn)| drawn.gains.iter().cloned()).collect());
    write_file(&output.join("report.html"), report::html(&facts, &drawn).as_bytes())?;
    write_file(&output.join("tables.md"), report::markdown(&facts, &drawn).as_bytes())?;
    write_file(&output.join("gains.json"), gains.text().as_bytes())?;
    let terminal = report::terminal(&drawn);
    Ok(Reproduced { terminal, gains, made: state.made, failed: state.failed, stopped })
}

/// What was asked for, in the order in which it is made.
fn exhibits(options: &ReproduceOptions) -> Vec<Exhibit> {
    let all: &[Exhibit] = if options.quick { &Exhibit::QUICK } else { &Exhibit::ALL };
    match options.only.as_slice() {
        [] => all.to_vec(),
        only => Exhibit::ALL.into_iter().filter(|exhibit| only.contains(exhibit)).collect(),
    }
}

/// Every experiment once, in the order of the exhibits.
fn plan(scope: &Scope, exhibits: &[Exhibit]) -> Vec<Experiment> {
    let mut plan: Vec<Experiment> = Vec::new();
    for experiment in exhibits.iter().flat_map(|exhibit| exhibit.experiments(scope)) {
        if !plan.iter().any(|e| e.subject == experiment.subject && e.recipe == experiment.recipe) {
            plan.push(experiment);
        }
    }
    plan
}

/// What came so far.
#[derive(Default)]
struct State {
    results: Results,
    made: [usize; 2],
    failed: Vec<String>,
    /// Seconds of experiments by their kinds.
    spent: Vec<(String, f64)>,
}

impl State {
    fn take(
        &mut self,
        cache: &mut Cache,
        scope: &Scope,
        plan: &[Experiment],
        done: usize,
        experiment: &Experiment,
        observer: &impl Observer,
    ) -> Result<(), ReproduceError> {
        let evaluate = scope.options.evaluate();
        let place = cache.place(experiment, &evaluate)?;
        let kept = cache.kept(&place);
        let is_kept = kept.is_some();
        let outcome = match kept {
            Some(outcome) => outcome,
            None => {
                let seconds_left = self.seconds_left(&plan[done..]);
                let (total, title) = (plan.len(), experiment.title());
                observer.event(Event::Begin { done, total, title, seconds_left });
                let Some(mut made) = perform(experiment, &place, &evaluate, observer)? else {
                    return Ok(());
                };
                made.build = cache.build().into();
                cache.keep(&place, &made)?;
                made
            }
        };
        self.made[usize::from(is_kept)] += 1;
        self.spent.push((kind(experiment), outcome.seconds_in_all));
        let (total, title) = (plan.len(), experiment.title());
        let words = words(&outcome);
        observer.event(Event::End { done: done + 1, total, title, outcome: words, kept: is_kept });
        self.results.add(experiment.clone(), place, outcome);
        Ok(())
    }

    /// Judged by the mean of those of the same kind, or of all; none before the first.
    fn seconds_left(&self, rest: &[Experiment]) -> Option<f64> {
        let mean = |of: &dyn Fn(&str) -> bool| {
            let all: Vec<f64> = self.spent.iter().filter(|(k, _)| of(k)).map(|(_, s)| *s).collect();
            (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
        };
        let overall = mean(&|_| true)?;
        Some(rest.iter().map(|e| mean(&|k| k == kind(e)).unwrap_or(overall)).sum())
    }
}

/// Experiments that take alike.
fn kind(experiment: &Experiment) -> String {
    let name = match &experiment.recipe {
        Recipe::Bake { .. } => "bake",
        Recipe::Compress { .. } => "compress",
        Recipe::Picture { .. } => "picture",
        Recipe::Downsample { .. } => "downsample",
        Recipe::Relit { .. } => "relit",
        Recipe::Variants { .. } => "variants",
    };
    format!("{name} {} {}", experiment.label, experiment.texture_size())
}

/// Its figures in a few words.
fn words(outcome: &Outcome) -> String {
    let seconds = format!("{:.1} s", outcome.seconds);
    match outcome.scores.len() {
        0 => seconds,
        _ => format!("{} dB, {seconds}", decimal(outcome.psnr(), 2)),
    }
}
