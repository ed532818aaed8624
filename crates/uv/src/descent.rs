//! Preconditioned L-BFGS that never leaves the feasible set (Nocedal 1980; line search
//! with the first Wolfe condition, bounded by the largest feasible step as in Smith and
//! Schaefer 2015 and Li et al. 2020).
//!
//! Contract: beginning at a feasible layout, every accepted one is feasible **as numbers
//! of a file**: candidates are rounded to `f32` first and judged then. The value never
//! rises. Points move only along free coordinates.
//!
//! Where many points may move, the one that may move least bounds the step of all; [`Reach`] can
//! have such points slowed down alone instead.
//!
//! [`descend`] is the whole way for one objective; [`Place::step`] is one step, for
//! objectives that change in between.

pub use crate::lbfgs::Preconditioner;

use crate::lbfgs::{Lbfgs, dot, mask};
use glam::DVec2;

/// What is minimised.
pub trait Objective {
    /// The value at these points; `gradient` is overwritten. Infinite where it is not
    /// defined.
    fn evaluate(&mut self, points: &[DVec2], gradient: &mut [DVec2]) -> f64;
}

/// Where points may be.
pub trait Region {
    /// 1 where a coordinate may move and 0 where it may not, for each point.
    fn free(&self) -> &[DVec2];
    /// The largest step in [0, `limit`] along `direction` up to which all is feasible.
    fn max_step(&self, points: &[DVec2], direction: &[DVec2], limit: f64) -> f64;
    /// Slows those points down along `direction` that alone would end the step before `limit`, where
    /// that can be told point by point; [`Region::max_step`] bounds what is left.
    fn slow_down(&self, _points: &[DVec2], _direction: &mut [DVec2], _limit: f64) {}
    /// Whether this very layout is feasible, decided exactly.
    fn is_feasible(&self, points: &[DVec2]) -> bool;
}

/// How far to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DescentOptions {
    /// At most so many steps.
    pub steps: usize,
    /// Pairs of changes that L-BFGS remembers; none for Newton's method, whose preconditioner knows
    /// the curvature.
    pub memory: usize,
    /// Ends once a step improves the value by less than this share…
    pub tolerance: f64,
    /// …so many times in a row.
    pub patience: usize,
    /// How far a step may go.
    pub reach: Reach,
    /// Steps after which the preconditioner is made anew where the descent is; 0 keeps the first.
    pub renewal: usize,
}

impl Default for DescentOptions {
    fn default() -> Self {
        Self { steps: 60, memory: 8, tolerance: 1e-4, patience: 3, reach: Reach::default(), renewal: 0 }
    }
}

/// How far a step may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// No point moves farther than this, in units of the square.
    pub longest_move: f64,
    /// Points are slowed down ([`Region::slow_down`]) that alone would go farther than this share of
    /// their way to the region's border; without it the nearest of them bounds the step of all.
    pub share_by_point: Option<f64>,
}

impl Reach {
    /// The step along `direction` that is wanted: 1, or less where a point would move too far.
    fn wanted(&self, direction: &[DVec2]) -> f64 {
        let longest = direction.iter().map(|d| d.length()).fold(0.0, f64::max);
        (self.longest_move / longest).min(1.0)
    }
}

impl Default for Reach {
    fn default() -> Self {
        Self { longest_move: 0.1, share_by_point: None }
    }
}

/// Share of the largest feasible step that is tried at most.
const FEASIBLE_SHARE: f64 = 0.8;
/// First Wolfe condition: a step must bring this share of what the slope promises.
const SUFFICIENT: f64 = 1e-4;
/// Halvings before a direction is given up: to the rounding of coordinates, since a first step
/// next to a nearly closed triangle may have to be that short.
const HALVINGS: usize = 26;

/// What a descent did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Descent {
    /// The value at the start and after each step.
    pub values: Vec<f64>,
    /// Evaluations of the objective.
    pub evaluations: usize,
}

/// Descends from `points`; `preconditioner` makes one for a layout. `step` sees every accepted layout
/// and its value, and may end the descent by returning false.
pub fn descend<P: Preconditioner>(
    points: &mut Vec<DVec2>,
    objective: &mut impl Objective,
    region: &impl Region,
    preconditioner: impl Fn(&[DVec2]) -> P,
    options: &DescentOptions,
    mut step: impl FnMut(&[DVec2], f64) -> bool,
) -> Descent {
    let mut place = Place::new(std::mem::take(points), objective, region);
    let mut memory = Lbfgs::new(options.memory);
    let mut values = vec![place.value];
    let mut idle = 0;
    let mut current = preconditioner(&place.points);
    for done in 0..options.steps {
        if options.renewal > 0 && done > 0 && done % options.renewal == 0 {
            current = preconditioner(&place.points);
        }
        let before = place.value;
        match place.step(&mut memory, objective, region, &current, &options.reach) {
            Step::Stuck => break,
            Step::Forgot => continue,
            Step::Moved => values.push(place.value),
        }
        idle = if before - place.value < options.tolerance * before.abs() { idle + 1 } else { 0 };
        if !step(&place.points, place.value) || idle >= options.patience {
            break;
        }
    }
    *points = place.points;
    Descent { values, evaluations: place.evaluations }
}

/// Where a descent is. An objective that changes between steps is evaluated anew by
/// [`Place::refresh`]; what L-BFGS remembers may stay.
#[derive(Clone, Debug)]
pub struct Place {
    /// The layout.
    pub points: Vec<DVec2>,
    /// The objective there.
    pub value: f64,
    /// Its derivative for free coordinates, 0 for the others.
    pub gradient: Vec<DVec2>,
    /// Evaluations of the objective so far.
    pub evaluations: usize,
    /// Room for the next layout and its gradient.
    candidate: Vec<DVec2>,
    next: Vec<DVec2>,
}

/// What a step came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The value fell.
    Moved,
    /// It did not, and the memory was cleared, since old curvature may mislead: the next
    /// step will try the preconditioned gradient alone.
    Forgot,
    /// That did not help either.
    Stuck,
}

impl Place {
    /// Evaluates the objective at these points.
    pub fn new(points: Vec<DVec2>, objective: &mut impl Objective, region: &impl Region) -> Self {
        let zero = vec![DVec2::ZERO; points.len()];
        let candidate = points.clone();
        let mut place =
            Self { points, value: 0.0, gradient: zero.clone(), evaluations: 0, candidate, next: zero };
        place.refresh(objective, region);
        place
    }

    /// Evaluates an objective that has changed.
    pub fn refresh(&mut self, objective: &mut impl Objective, region: &impl Region) {
        self.value = objective.evaluate(&self.points, &mut self.gradient);
        self.evaluations += 1;
        mask(&mut self.gradient, region.free());
    }

    /// One step of L-BFGS with its line search.
    pub fn step(
        &mut self,
        memory: &mut Lbfgs,
        objective: &mut impl Objective,
        region: &impl Region,
        preconditioner: &impl Preconditioner,
        reach: &Reach,
    ) -> Step {
        let free = region.free();
        let mut direction = memory.direction(&self.gradient, preconditioner, free);
        let mut slope = dot(&direction, &self.gradient);
        if slope >= 0.0 || !slope.is_finite() {
            memory.clear();
            direction = memory.direction(&self.gradient, preconditioner, free);
            slope = dot(&direction, &self.gradient);
        }
        if slope >= 0.0 || !slope.is_finite() {
            return Step::Stuck;
        }
        if let Some(slowed) = self.slowed(&direction, slope, region, reach) {
            direction = slowed;
            slope = dot(&direction, &self.gradient);
        }
        let Some(found) = self.search(&direction, slope, objective, region, reach) else {
            if memory.is_empty() {
                return Step::Stuck;
            }
            memory.clear();
            return Step::Forgot;
        };
        mask(&mut self.next, free);
        memory.remember(&self.points, &self.candidate, &self.gradient, &self.next);
        std::mem::swap(&mut self.points, &mut self.candidate);
        std::mem::swap(&mut self.gradient, &mut self.next);
        self.value = found;
        Step::Moved
    }

    /// The direction with points slowed down, if it still promises enough.
    fn slowed(
        &self,
        direction: &[DVec2],
        slope: f64,
        region: &impl Region,
        reach: &Reach,
    ) -> Option<Vec<DVec2>> {
        const ENOUGH: f64 = 0.1;
        let share = reach.share_by_point?;
        let mut slowed = direction.to_vec();
        region.slow_down(&self.points, &mut slowed, reach.wanted(direction) / share);
        (dot(&slowed, &self.gradient) < ENOUGH * slope).then_some(slowed)
    }

    /// The line search: leaves what it accepts in `candidate` and `next`, and gives its value.
    fn search(
        &mut self,
        direction: &[DVec2],
        slope: f64,
        objective: &mut impl Objective,
        region: &impl Region,
        reach: &Reach,
    ) -> Option<f64> {
        let wanted = reach.wanted(direction);
        let limit = region.max_step(&self.points, direction, wanted / FEASIBLE_SHARE);
        let mut length = wanted.min(FEASIBLE_SHARE * limit);
        for _ in 0..HALVINGS {
            for ((c, p), d) in self.candidate.iter_mut().zip(&self.points).zip(direction) {
                *c = (*p + *d * length).as_vec2().as_dvec2();
            }
            if region.is_feasible(&self.candidate) {
                let found = objective.evaluate(&self.candidate, &mut self.next);
                self.evaluations += 1;
                if found <= self.value + SUFFICIENT * length * slope {
                    return Some(found);
                }
            }
            length *= 0.5;
        }
        None
    }
}
