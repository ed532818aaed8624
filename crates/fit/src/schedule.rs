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
    /// Notes the loss of this state, and the state itself if it is the best so far.
    fn note(&mut self, moved: Move, loss: Loss, color: &Canvas, normal: &Canvas) {
        let seconds = self.begin.elapsed().as_secs_f64();
        self.losses.push(LossPoint { moved, seconds, mean_square: loss.square / self.terms });
        if self.best.as_ref().is_none_or(|b| loss.minimised < b.0) {
            self.best = Some((loss.minimised, color.clone(), normal.clone()));
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
    let weight: f64 = samples.bands.iter().flatten().map(|s| f64::from(s.weight())).sum();
    let mut log =
        Log { begin: Instant::now(), terms: (3.0 * weight).max(1e-9), losses: Vec::new(), best: None };
    let display = &DisplayTable::new(&display);
    let outliers = Cauchy::new(schedule.outlier);
    let problem = |membrane| Problem { samples, atlas, display, membrane, effort: schedule.effort, outliers };
    let color_problem = problem(schedule.color_membrane);
    let normal_problem = problem(schedule.normal_membrane);
    let final_problem = Problem { effort: schedule.final_effort, ..problem(schedule.color_membrane) };
    let (mut color, mut normal) = (start.color.clone(), start.normal.clone());
    let (mut color_rows, mut normal_rows) = (Vec::new(), Vec::new());
    let total = schedule.rounds * (schedule.color_steps + schedule.normal_steps) + schedule.final_steps;
    let (mut done, mut last, mut damping, mut stopped) = (0, Move::Start, schedule.damping, false);
    let mut advance = |stopped: &mut bool| {
        watch.progress(Stage::Solve, done, total);
        done += 1;
        *stopped = *stopped || watch.should_stop();
        !*stopped
    };
    for _ in 0..schedule.rounds {
        if stopped {
            break;
        }
        for _ in 0..schedule.color_steps {
            if !advance(&mut stopped) {
                break;
            }
            let before = color.clone();
            let (loss, _) = color_step(&color_problem, &mut color, &normal, &start.color, &mut color_rows);
            log.note(last, loss, &before, &normal);
            last = Move::Color;
        }
        let mut previous: Option<(f64, Canvas)> = None;
        for _ in 0..schedule.normal_steps {
            if stopped || !advance(&mut stopped) {
                break;
            }
            let before = normal.clone();
            let (loss, _) =
                normal_step(&normal_problem, &color, &mut normal, &start.normal, damping, &mut normal_rows);
            log.note(last, loss, &color, &before);
            last = Move::Normal;
            match previous {
                // The step before made it worse: take it back and tread more carefully.
                Some((was, ref kept)) if loss.minimised > was => {
                    normal = kept.clone();
                    damping *= 8.0;
                }
                _ => {
                    damping *= 0.5;
                    previous = Some((loss.minimised, before));
                }
            }
        }
    }
    // Also when there is no time left: what the last step brought would be lost.
    if !samples.is_empty() && last != Move::Start {
        log.note(last, loss(&color_problem, &color, &normal), &color, &normal);
    }
    if let Some((_, c, n)) = log.best.take() {
        (color, normal) = (c, n);
    }

    let seen = seen(samples);
    let known: Vec<bool> =
        atlas.label.iter().zip(&seen).map(|(&label, &seen)| label != NO_CHART || seen).collect();
    gutter::fill(&mut normal, &known);
    let normal_picture = normal_image("normal", &normal);
    let rounded = normal_canvas(&normal_picture);
    last = Move::Rounding;
    for _ in 0..schedule.final_steps {
        if samples.is_empty() || stopped || !advance(&mut stopped) {
            break;
        }
        let before = color.clone();
        let (loss, _) = color_step(&final_problem, &mut color, &rounded, &start.color, &mut color_rows);
        log.note(last, loss, &before, &rounded);
        last = Move::Color;
    }
    if last == Move::Color {
        log.note(last, loss(&color_problem, &color, &rounded), &color, &rounded);
    }
    if let Some((_, best, _)) = log.best.take() {
        color = best;
    }
    gutter::fill(&mut color, &known);
    let color_picture = color_image("base color", &color, srgb);
    if !samples.is_empty() {
        let written = color_canvas(&color_picture, srgb);
        log.note(Move::Rounding, loss(&color_problem, &written, &rounded), &written, &rounded);
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
