//! The order of the texture solve: maps take turns, each with the others held; then the normals are
//! rounded to what a file holds and the others solved once more against those, so that rounding costs
//! as little as it can.
//!
//! Every step first measures the loss of the state that it found; the best state is
//! kept, so a run that is stopped, or a step that goes wrong, never ends worse. Best is by
//! the loss that is minimised (`robust_loss.rs`); plain squares are what is reported.

use crate::backend::Backend;
use crate::membrane::Membrane;
use crate::problem::{Problem, ShadedProblem};
use crate::robust_loss::{Cauchy, Loss};
use crate::step::{StepOptions, Workspace, fit_step};
use parbake_image::display::Display;
use parbake_image::display_table::DisplayTable;
use parbake_image::quantise::{from_image, to_image};
use parbake_image::reduced::all_at_most;
use parbake_image::{Domain, FloatImage, MapKind, MapSet};
use parbake_model::Image;
use parbake_model::glam::Vec4;
use parbake_progress::{MOST_TEXELS, Message, Snapshot, Stage, Watcher};
use parbake_render::shade::Brdf;
use parbake_solve::conjugate_gradient::Effort;
use parbake_solve::grid::block;
use parbake_views::chart_labels::{Atlas, NO_CHART};
use parbake_views::gutter;
use parbake_views::samples::{Fetched, SampleSet};
use std::time::Instant;

/// How much work the fit does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Alternations between the solves of the maps.
    pub rounds: usize,
    /// Gauss–Newton steps of each map in a box (colours, emission, …) in each round.
    pub color_steps: usize,
    /// Levenberg–Marquardt steps of the normals in each round; 0 keeps the projected ones.
    pub normal_steps: usize,
    /// Steps of the maps in a box after the normals were rounded.
    pub final_steps: usize,
    /// Limits of the linear solver: few steps, since the next linearisation asks
    /// for something else anyway, and stopping early regularises.
    pub effort: Effort,
    /// Its limits in the final steps.
    pub final_effort: Effort,
    /// What holds texels in a box that few views see.
    pub color_membrane: Membrane,
    /// What holds normals that few views see.
    pub normal_membrane: Membrane,
    /// First damping of the normals, a share of the samples' mean pull.
    pub damping: f32,
    /// Length of a pixel's display differences at which it counts half where it is too bright
    /// ([`Cauchy`]), more than 0; infinity for least squares.
    pub robust_scale: f32,
}

impl Default for Schedule {
    fn default() -> Self {
        Self {
            rounds: 5,
            color_steps: 1,
            normal_steps: 2,
            final_steps: 2,
            effort: Effort { steps: 6, tolerance: 0.05 },
            final_effort: Effort { steps: 30, tolerance: 1e-3 },
            color_membrane: Membrane { stiffness: 1e-2, least: 0.0, tether: 1e-5 },
            normal_membrane: Membrane { stiffness: 0.2, least: 0.0, tether: 1e-3 },
            damping: 6.0,
            robust_scale: f32::INFINITY,
        }
    }
}

impl Schedule {
    fn steps(&self, kind: MapKind) -> usize {
        match kind.spec().domain {
            Domain::Box => self.color_steps,
            Domain::Hemisphere => self.normal_steps,
        }
    }

    fn options(&self, kind: MapKind, effort: Effort, damping: f32) -> StepOptions {
        let membrane = match kind.spec().domain {
            Domain::Box => self.color_membrane,
            Domain::Hemisphere => self.normal_membrane,
        };
        StepOptions { membrane, effort, damping }
    }
}

/// What moved in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// Nothing: the projected start.
    Start,
    /// One map.
    Map(MapKind),
    /// All maps, to eight bits.
    Rounding,
}

/// The loss after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LossPoint {
    /// What moved.
    pub moved: Move,
    /// Seconds since the fit began.
    pub seconds: f64,
    /// Mean squared display difference over all samples and channels.
    pub mean_square: f64,
}

/// Fitted maps, and how they came about.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// Each map as a file holds it, in the order of [`MapKind::ALL`].
    pub images: Vec<(MapKind, Image)>,
    /// Loss of the start and after each step.
    pub losses: Vec<LossPoint>,
    /// Texels on the surface.
    pub covered: usize,
    /// Those among them that no view saw.
    pub unseen: usize,
    /// True when it was asked to stop early.
    pub stopped: bool,
}

struct Log {
    begin: Instant,
    terms: f64,
    losses: Vec<LossPoint>,
    best: Option<(f64, MapSet)>,
}

impl Log {
    fn new<S: Fetched>(samples: &SampleSet<S>) -> Self {
        let weight: f64 = samples.iter().map(|s| f64::from(s.weight())).sum();
        Self { begin: Instant::now(), terms: (3.0 * weight).max(1e-9), losses: Vec::new(), best: None }
    }

    /// Notes the loss of this state, and the state itself if it is the best so far.
    fn note(&mut self, moved: Move, loss: Loss, maps: &MapSet) {
        let seconds = self.begin.elapsed().as_secs_f64();
        self.losses.push(LossPoint { moved, seconds, mean_square: loss.square / self.terms });
        if self.best.as_ref().is_none_or(|b| loss.minimised < b.0) {
            self.best = Some((loss.minimised, maps.clone()));
        }
    }
}

/// The maps during the solve.
struct Descent<'a, K> {
    backend: &'a K,
    maps: MapSet,
    /// The projected maps: texels that nothing says more of stay there.
    start: &'a MapSet,
    workspace: Workspace,
    /// Of the normals; adapted from step to step.
    damping: f32,
    /// What moved last; its loss is known at the next step.
    last: Move,
    log: Log,
    watcher: &'a dyn Watcher,
    /// Steps that were taken, and all there are.
    steps: [usize; 2],
    stopped: bool,
}

impl<K: Backend> Descent<'_, K> {
    /// Counts a step; false where it shall not be taken.
    fn advance(&mut self) -> bool {
        if !self.stopped {
            self.watcher.progress(Stage::Solve, self.steps[0], self.steps[1]);
            self.steps[0] += 1;
            self.stopped = self.watcher.stopped();
        }
        !self.stopped
    }

    /// Tells the loss of the state before a step, and shows the one after it.
    fn tell(&self, loss: Loss) {
        let (value, is_first) = (loss.minimised / self.log.terms, self.log.losses.is_empty());
        self.watcher.message(Message::Loss { stage: Stage::Solve, value, is_first });
        if self.watcher.wants_snapshot() {
            let maps = all_at_most(&self.maps, MOST_TEXELS);
            self.watcher.snapshot(Snapshot::Maps { maps, parallax: None });
        }
    }

    /// Takes this many steps of one map.
    fn take<P: Problem>(
        &mut self,
        kind: MapKind,
        problem: &P,
        schedule: &Schedule,
        effort: Effort,
        count: usize,
    ) {
        let Some(start) = self.start.get(kind) else { return };
        let is_damped = kind.spec().domain == Domain::Hemisphere;
        let mut previous: Option<(f64, FloatImage<Vec4>)> = None;
        for _ in 0..count {
            if !self.advance() {
                return;
            }
            let before = self.maps.clone();
            let options = schedule.options(kind, effort, self.damping);
            let (maps, workspace) = (&mut self.maps, &mut self.workspace);
            let (loss, _) = fit_step(self.backend, kind, problem, &options, maps, start, workspace);
            self.tell(loss);
            self.log.note(self.last, loss, &before);
            self.last = Move::Map(kind);
            if !is_damped {
                continue;
            }
            match &previous {
                // The step before made it worse: take it back and tread more carefully.
                Some((was, kept)) if loss.minimised > *was => {
                    self.maps.insert(kind, kept.clone());
                    self.damping *= 8.0;
                }
                _ => {
                    self.damping *= 0.5;
                    previous = before.get(kind).map(|map| (loss.minimised, map.clone()));
                }
            }
        }
    }

    /// Measures where the last step led, also when there is no time left, and goes back to the best.
    fn settle<P: Problem>(&mut self, problem: &P, nothing_moved: Move) {
        if !problem.samples().is_empty() && self.last != nothing_moved {
            self.log.note(self.last, problem.loss(&self.maps), &self.maps);
        }
        if let Some((_, maps)) = self.log.best.take() {
            self.maps = maps;
        }
    }
}

/// What is fitted, and how it is compared.
#[derive(Clone, Copy)]
pub struct Comparison<'a, B, K> {
    /// What computes.
    pub backend: &'a K,
    /// How maps become light.
    pub brdf: &'a B,
    /// How light is shown.
    pub display: Display,
    /// Whether files hold sRGB of colours.
    pub srgb: bool,
}

/// Fits all maps that the start has to the light that views show, beginning there.
pub fn fit_textures<B: Brdf, K: Backend>(
    samples: &SampleSet,
    atlas: &Atlas,
    start: &MapSet,
    comparison: &Comparison<B, K>,
    schedule: &Schedule,
    watcher: &dyn Watcher,
) -> Fitted {
    let Comparison { backend, brdf, display, srgb } = *comparison;
    let display = &DisplayTable::new(&display);
    let problem = ShadedProblem { samples, atlas, display, brdf, robust: Cauchy::new(schedule.robust_scale) };
    fit_maps(&problem, start, backend, srgb, schedule, watcher)
}

/// Fits all maps that the start has and the problem reads, beginning there. `srgb` tells whether files
/// hold sRGB of colours.
pub fn fit_maps<P: Problem, K: Backend>(
    problem: &P,
    start: &MapSet,
    backend: &K,
    srgb: bool,
    schedule: &Schedule,
    watcher: &dyn Watcher,
) -> Fitted {
    let (samples, atlas) = (problem.samples(), problem.atlas());
    let kinds: Vec<MapKind> = start.kinds().filter(|kind| problem.reads(*kind)).collect();
    let (normals, boxed): (Vec<MapKind>, Vec<MapKind>) =
        kinds.iter().partition(|kind| kind.spec().domain == Domain::Hemisphere);
    let total = schedule.rounds * kinds.iter().map(|kind| schedule.steps(*kind)).sum::<usize>()
        + schedule.final_steps * boxed.len();
    let mut descent = Descent {
        backend,
        maps: start.clone(),
        start,
        workspace: Workspace::default(),
        damping: schedule.damping,
        last: Move::Start,
        log: Log::new(samples),
        watcher,
        steps: [0, total],
        stopped: false,
    };
    for _ in 0..schedule.rounds {
        for &kind in &kinds {
            descent.take(kind, problem, schedule, schedule.effort, schedule.steps(kind));
        }
    }
    descent.settle(problem, Move::Start);

    let seen = seen(samples);
    let known: Vec<bool> =
        atlas.label.iter().zip(&seen).map(|(&label, &seen)| label != NO_CHART || seen).collect();
    let mut images = Vec::with_capacity(kinds.len());
    let mut round = |kind: MapKind, maps: &mut MapSet| {
        if let Some(map) = maps.get_mut(kind) {
            gutter::fill(map, &known);
            let image = to_image(kind, map, srgb);
            *map = from_image(kind, &image, srgb);
            images.push((kind, image));
        }
    };
    for &kind in &normals {
        round(kind, &mut descent.maps);
    }
    descent.last = Move::Rounding;
    if !samples.is_empty() {
        for &kind in &boxed {
            descent.take(kind, problem, schedule, schedule.final_effort, schedule.final_steps);
        }
    }
    descent.settle(problem, Move::Rounding);
    let Descent { mut maps, mut log, stopped, .. } = descent;
    for &kind in &boxed {
        round(kind, &mut maps);
    }
    if !samples.is_empty() {
        log.note(Move::Rounding, problem.loss(&maps), &maps);
    }
    watcher.progress(Stage::Solve, total, total);
    images.sort_by_key(|(kind, _)| *kind);
    Fitted {
        images,
        losses: log.losses,
        covered: atlas.covered.iter().filter(|&&c| c).count(),
        unseen: atlas.covered.iter().zip(&seen).filter(|(c, s)| **c && !**s).count(),
        stopped,
    }
}

/// Texels that at least one sample reads.
fn seen<S: Fetched>(samples: &SampleSet<S>) -> Vec<bool> {
    let mut seen = vec![false; samples.size * samples.size];
    for sample in samples.iter() {
        for texel in block(sample.texel(), samples.size) {
            seen[texel] = true;
        }
    }
    seen
}
