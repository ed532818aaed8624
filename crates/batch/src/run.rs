//! The order of a batch: which jobs are finished, which begin when, and what becomes of them.

use crate::digest::Digests;
use crate::error::BatchError;
use crate::job::{Abilities, Commands, Job};
use crate::memory::{available, has_room};
use crate::observer::{Event, Observer};
use crate::options::BatchOptions;
use crate::outcome::{Batch, Ended, Outcome};
use crate::page;
use crate::place::Place;
use crate::record::Record;
use crate::worker::{Done, Task, Worker};
use parbake_files::write_atomically;
use std::collections::VecDeque;
use std::path::Path;
use std::time::Duration;

/// How often workers are looked after: a job takes a second or more.
const PAUSE: Duration = Duration::from_millis(30);

/// Runs jobs with this program and writes results, records and the page to the output folder.
///
/// # Errors
/// When the output folder cannot be written or another batch writes to it, or an option is out of range. What goes
/// wrong in a job is in its outcome.
pub fn run_batch(
    jobs: Vec<Job>,
    output: &Path,
    program: &Path,
    options: &BatchOptions,
    commands: &dyn Commands,
    observer: &impl Observer,
) -> Result<Batch, BatchError> {
    options.check()?;
    let is_whole = options.only.is_empty();
    let jobs = chosen(jobs, &options.only)?;
    let place = Place::hold(output, is_whole)?;
    let digests = Digests::new(program).map_err(BatchError::disk(program))?;
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
    let mut run = Run {
        outcomes: vec![Outcome::Waiting; jobs.len()],
        jobs,
        place,
        program,
        commands,
        observer,
        threads: (cores / options.workers).max(1),
        waiting: VecDeque::new(),
        running: Vec::new(),
        peak: None,
        seconds: Vec::new(),
        workers: options.workers,
        limit: options.memory.map(|gigabytes| (gigabytes * 1e9) as u64),
    };
    run.take_stock(digests);
    while !observer.stopped() && (!run.waiting.is_empty() || !run.running.is_empty()) {
        run.begin();
        std::thread::sleep(PAUSE);
        run.look();
    }
    for (_, worker) in run.running.drain(..) {
        let folder = worker.folder().to_path_buf();
        // Killed first, so that nothing is written there any more.
        drop(worker);
        let _ = std::fs::remove_dir_all(folder);
    }
    let (place, stopped) = (run.place, run.outcomes.contains(&Outcome::Waiting));
    let jobs = run.jobs.into_iter().zip(run.outcomes).map(|(job, outcome)| Ended { job, outcome }).collect();
    let mut batch = Batch { jobs, stopped, page: None };
    if is_whole {
        let path = place.output().join("batch.html");
        write_atomically(&path, page::html(&batch, &place).as_bytes())?;
        write_atomically(&place.output().join("batch.json"), page::json(&batch).as_bytes())?;
        batch.page = Some(path);
    }
    Ok(batch)
}

/// Those that were asked for, or all.
fn chosen(jobs: Vec<Job>, only: &[String]) -> Result<Vec<Job>, BatchError> {
    if let Some(name) = only.iter().find(|name| jobs.iter().all(|job| job.name != **name)) {
        return Err(BatchError::Option(format!("--only {name}: there is no job of this name")));
    }
    Ok(jobs.into_iter().filter(|job| only.is_empty() || only.contains(&job.name)).collect())
}

/// A job that may begin: its place among all, what its command can do, and its key.
struct Next {
    index: usize,
    abilities: Abilities,
    key: String,
}

struct Run<'a, O: Observer> {
    jobs: Vec<Job>,
    outcomes: Vec<Outcome>,
    place: Place,
    program: &'a Path,
    commands: &'a dyn Commands,
    observer: &'a O,
    threads: usize,
    workers: usize,
    limit: Option<u64>,
    waiting: VecDeque<Next>,
    running: Vec<(Next, Worker<'a>)>,
    /// The most memory that a job took.
    peak: Option<u64>,
    /// Of jobs that were run now.
    seconds: Vec<f64>,
}

impl<O: Observer> Run<'_, O> {
    /// Finds out which jobs are finished.
    fn take_stock(&mut self, mut digests: Digests) {
        for index in 0..self.jobs.len() {
            if self.observer.stopped() {
                return;
            }
            let job = &self.jobs[index];
            let abilities = self.commands.abilities(&job.command).unwrap_or_default();
            match digests.key(job, abilities) {
                Err(reason) => self.end(index, Outcome::Failed(reason)),
                Ok(key) => match Record::kept(&self.place.of(&job.name), &key) {
                    Some(record) => self.end(index, Outcome::Kept(record)),
                    None => self.waiting.push_back(Next { index, abilities, key }),
                },
            }
        }
    }

    /// Starts what may start.
    fn begin(&mut self) {
        let mut is_news = false;
        while self.running.len() < self.workers {
            let held = self.running.iter().map(|(_, worker)| worker.held()).sum();
            if !has_room(self.running.len(), self.peak, held, available(), self.limit) {
                break;
            }
            let Some(next) = self.waiting.pop_front() else { break };
            let job = &self.jobs[next.index];
            let started =
                self.place.begin(next.index).map_err(|error| error.to_string()).and_then(|folder| {
                    let output = job.output.as_deref();
                    let task = Task {
                        program: self.program,
                        command: job.command_line(next.abilities),
                        picture: output.and_then(|output| self.commands.picture(output, page::PICTURE)),
                        folder,
                        messages: self.place.messages(&job.name),
                        threads: self.threads,
                    };
                    Worker::start(task).map_err(|error| format!("the program could not be started: {error}"))
                });
            match started {
                Ok(worker) => {
                    self.running.push((next, worker));
                    is_news = true;
                }
                Err(reason) => self.end(next.index, Outcome::Failed(reason)),
            }
        }
        if is_news {
            self.tell();
        }
    }

    /// Takes in what has ended.
    fn look(&mut self) {
        let mut at = 0;
        while at < self.running.len() {
            let Some(ended) = self.running[at].1.poll() else {
                at += 1;
                continue;
            };
            let (next, worker) = self.running.remove(at);
            let index = next.index;
            let outcome = match ended.and_then(|done| self.keep(next, worker.folder(), done)) {
                Ok(record) => Outcome::Made(record),
                Err(reason) => {
                    let _ = std::fs::remove_dir_all(worker.folder());
                    Outcome::Failed(reason)
                }
            };
            self.end(index, outcome);
            self.tell();
        }
    }

    /// Puts a job's files in their place and writes its record.
    fn keep(&mut self, next: Next, folder: &Path, done: Done) -> Result<Record, String> {
        let job = &self.jobs[next.index];
        self.peak = self.peak.max(done.peak);
        self.seconds.push(done.seconds);
        let record = Record {
            version: 0,
            name: job.name.clone(),
            key: next.key,
            command_line: job.command_line(next.abilities),
            files: Record::files(folder).map_err(|error| error.to_string())?,
            seconds: done.seconds,
            peak_memory: done.peak,
        };
        self.place.finish(folder, &job.name).map_err(|error| error.to_string())?;
        record.write(&self.place.of(&job.name)).map_err(|error| error.to_string())
    }

    fn done(&self) -> usize {
        self.outcomes.iter().filter(|outcome| **outcome != Outcome::Waiting).count()
    }

    fn end(&mut self, index: usize, outcome: Outcome) {
        if let Some(record) = outcome.record() {
            self.peak = self.peak.max(record.peak_memory);
        }
        let failed = matches!(outcome, Outcome::Failed(_));
        let words = match &outcome {
            Outcome::Failed(reason) => reason.clone(),
            Outcome::Kept(record) | Outcome::Made(record) => format!("{:.1} s", record.seconds),
            Outcome::Waiting => String::new(),
        };
        let kept = matches!(outcome, Outcome::Kept(_));
        self.outcomes[index] = outcome;
        let (done, total, name) = (self.done(), self.jobs.len(), self.jobs[index].name.clone());
        self.observer.event(Event::Ended { done, total, name, outcome: words, kept, failed });
    }

    fn tell(&self) {
        let names = self.running.iter().map(|(next, _)| self.jobs[next.index].name.clone()).collect();
        let left = (self.waiting.len() + self.running.len()) as f64;
        let mean = self.seconds.iter().sum::<f64>() / self.seconds.len() as f64;
        let seconds_left = (!self.seconds.is_empty()).then(|| mean * left / self.workers as f64);
        let (done, total) = (self.done(), self.jobs.len());
        self.observer.event(Event::Running { done, total, names, seconds_left });
    }
}
