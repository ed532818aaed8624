//! The order of the fit: colours and normals in turn, each with the other held, then
//! the normals rounded to what a file holds and the colours solved once more against
//! those, so that rounding costs as little as it can.
//!
//! Every step first measures the loss of the state that it found; the best state is
//! kept, so a run that is stopped, or a step that goes wrong, never ends worse. Best is by
//! the loss that is minimised (`outliers.rs`); plain squares are what is reported.

use crate::atlas::{Atlas, NO_CHART};
use crate::canvas::{Canvas, block};
use crate::color::{Problem, color_step, loss};
use crate::conjugate_gradient::Effort;
use crate::gutter;
use crate::membrane::Membrane;
use crate::normal::normal_step;
use crate::outliers::{Cauchy, Loss};
use crate::quantise::{color_canvas, color_image, normal_canvas, normal_image};
use crate::samples::SampleSet;
use crate::start::Start;
use crate::stencil::{Diagonal, Row, Symmetric};
use crate::watch::{Stage, Watch};
use parbake_model::Image;
use parbake_render::display::Display;
use parbake_render::display_table::DisplayTable;
use std::time::Instant;

/// How much work the fit does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Times that colours and normals take turns.
    pub rounds: usize,
    /// Gauss–Newton steps of the colours in each round.
    pub color_steps: usize,
    /// Levenberg–Marquardt steps of the normals in each round; 0 keeps the start's.
    pub normal_steps: usize,
    /// Steps of the colours after the normals were rounded.
    pub final_steps: usize,
    /// Limits of the linear solver: few steps, since the next linearisation asks
    /// for something else anyway, and stopping early regularises.
    pub effort: Effort,
    /// Its limits in the final steps.
    pub final_effort: Effort,
    /// What holds colours that few views see.
    pub color_membrane: Membrane,
    /// What holds normals that few views see.
    pub normal_membrane: Membrane,
    /// First damping of the normals, a share of the samples' mean pull.
    pub damping: f32,
    /// Length of a pixel's display differences at which it counts half where it is too bright
    /// ([`Cauchy`]), more than 0; infinity for least squares.
    pub outlier: f32,
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
            color_membrane: Membrane { stiffness: 1e-2, tether: 1e-5 },
            normal_membrane: Membrane { stiffness: 0.2, tether: 1e-3 },
            damping: 6.0,
            outlier: f32::INFINITY,
        }
    }
}

/// What moved in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// Nothing: the projected start.
    Start,
    /// Colours.
    Color,
    /// Normals.
    Normal,
    /// Both textures, to eight bits.
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

/// Fitted textures, and how they came about.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// Base colour.
    pub color: Image,
    /// Tangent-space normals.
    pub normal: Image,
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
    best: Option<(f64, Canvas, Canvas)>,
}

impl Log {
    fn new(samples: &SampleSet) -> Self {
        let weight: f64 = samples.bands.iter().flatten().map(|s| f64::from(s.weight())).sum();
        Self { begin: Instant::now(), terms: (3.0 * weight).max(1e-9), losses: Vec::new(), best: None }
    }

    /// Notes the loss of this state, and the state itself if it is the best so far.
    fn note(&mut self, moved: Move, loss: Loss, color: &Canvas, normal: &Canvas) {
        let seconds = self.begin.elapsed().as_secs_f64();
        self.losses.push(LossPoint { moved, seconds, mean_square: loss.square / self.terms });
        if self.best.as_ref().is_none_or(|b| loss.minimised < b.0) {
            self.best = Some((loss.minimised, color.clone(), normal.clone()));
        }
    }
}

/// Both textures on their way.
struct Descent<'a, W> {
    color: Canvas,
    normal: Canvas,
    /// What the projection showed: texels that nothing says more of stay there.
    start: &'a Start,
    color_rows: Vec<Row<Diagonal>>,
    normal_rows: Vec<Row<Symmetric>>,
    damping: f32,
    /// What moved last; its loss is known at the next step.
    last: Move,
    log: Log,
    watch: &'a W,
    /// Steps that were taken, and all there are.
    steps: [usize; 2],
    stopped: bool,
}

impl<W: Watch> Descent<'_, W> {
    /// Counts a step; false where it shall not be taken.
    fn advance(&mut self) -> bool {
        if !self.stopped {
            self.watch.progress(Stage::Solve, self.steps[0], self.steps[1]);
            self.steps[0] += 1;
            self.stopped = self.watch.should_stop();
        }
        !self.stopped
    }

    fn color_steps(&mut self, problem: &Problem, count: usize) {
        for _ in 0..count {
            if !self.advance() {
                return;
            }
            let (before, start) = (self.color.clone(), &self.start.color);
            let (loss, _) = color_step(problem, &mut self.color, &self.normal, start, &mut self.color_rows);
            self.log.note(self.last, loss, &before, &self.normal);
            self.last = Move::Color;
        }
    }

    fn normal_steps(&mut self, problem: &Problem, count: usize) {
        let mut previous: Option<(f64, Canvas)> = None;
        for _ in 0..count {
            if !self.advance() {
                return;
            }
            let (before, start) = (self.normal.clone(), &self.start.normal);
            let rows = &mut self.normal_rows;
            let (loss, _) = normal_step(problem, &self.color, &mut self.normal, start, self.damping, rows);
            self.log.note(self.last, loss, &self.color, &before);
            self.last = Move::Normal;
            match &previous {
                // The step before made it worse: take it back and tread more carefully.
                Some((was, kept)) if loss.minimised > *was => {
                    self.normal.clone_from(kept);
                    self.damping *= 8.0;
                }
                _ => {
                    self.damping *= 0.5;
                    previous = Some((loss.minimised, before));
                }
            }
        }
    }

    /// Measures where the last step led, also when there is no time left, and goes back to the best.
    fn settle(&mut self, problem: &Problem, nothing_moved: Move) {
        if !problem.samples.is_empty() && self.last != nothing_moved {
            self.log.note(self.last, loss(problem, &self.color, &self.normal), &self.color, &self.normal);
        }
        if let Some((_, color, normal)) = self.log.best.take() {
            (self.color, self.normal) = (color, normal);
        }
    }
}

/// Fits both textures. `srgb` tells whether the colour file holds sRGB of the albedo.
pub fn fit_textures(
    samples: &SampleSet,
    atlas: &Atlas,
    start: &Start,
    display: Display,
    srgb: bool,
    schedule: &Schedule,
    watch: &impl Watch,
) -> Fitted {
    let display = &DisplayTable::new(&display);
    let outliers = Cauchy::new(schedule.outlier);
    let problem = |membrane, effort| Problem { samples, atlas, display, membrane, effort, outliers };
    let color_problem = problem(schedule.color_membrane, schedule.effort);
    let normal_problem = problem(schedule.normal_membrane, schedule.effort);
    let total = schedule.rounds * (schedule.color_steps + schedule.normal_steps) + schedule.final_steps;
    let mut descent = Descent {
        color: start.color.clone(),
        normal: start.normal.clone(),
        start,
        color_rows: Vec::new(),
        normal_rows: Vec::new(),
        damping: schedule.damping,
        last: Move::Start,
        log: Log::new(samples),
        watch,
        steps: [0, total],
        stopped: false,
    };
    for _ in 0..schedule.rounds {
        descent.color_steps(&color_problem, schedule.color_steps);
        descent.normal_steps(&normal_problem, schedule.normal_steps);
    }
    descent.settle(&color_problem, Move::Start);

    let seen = seen(samples);
    let known: Vec<bool> =
        atlas.label.iter().zip(&seen).map(|(&label, &seen)| label != NO_CHART || seen).collect();
    gutter::fill(&mut descent.normal, &known);
    let normal_picture = normal_image("normal", &descent.normal);
    descent.normal = normal_canvas(&normal_picture);
    descent.last = Move::Rounding;
    if !samples.is_empty() {
        let final_problem = problem(schedule.color_membrane, schedule.final_effort);
        descent.color_steps(&final_problem, schedule.final_steps);
    }
    descent.settle(&color_problem, Move::Rounding);
    let Descent { mut color, normal, mut log, stopped, .. } = descent;
    gutter::fill(&mut color, &known);
    let color_picture = color_image("base color", &color, srgb);
    if !samples.is_empty() {
        let written = color_canvas(&color_picture, srgb);
        log.note(Move::Rounding, loss(&color_problem, &written, &normal), &written, &normal);
    }
    watch.progress(Stage::Solve, total, total);
    Fitted {
        color: color_picture,
        normal: normal_picture,
        losses: log.losses,
        covered: atlas.covered.iter().filter(|&&c| c).count(),
        unseen: atlas.covered.iter().zip(&seen).filter(|(c, s)| **c && !**s).count(),
        stopped,
    }
}

/// Texels that at least one sample reads.
fn seen(samples: &SampleSet) -> Vec<bool> {
    let mut seen = vec![false; samples.size * samples.size];
    for sample in samples.bands.iter().flatten() {
        for texel in block(sample.texel as usize, samples.size) {
            seen[texel] = true;
        }
    }
    seen
}
