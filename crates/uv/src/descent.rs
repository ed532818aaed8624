//! Preconditioned L-BFGS that never leaves the feasible set (Nocedal 1980; line search
//! with the first Wolfe condition, bounded by the largest feasible step as in Smith and
//! Schaefer 2015 and Li et al. 2020).
//!
//! Contract: beginning at a feasible layout, every accepted one is feasible **as numbers
//! of a file**: candidates are rounded to `f32` first and judged then. The value never
//! rises. Points move only along free coordinates.

use glam::DVec2;
use std::collections::VecDeque;

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
    /// Whether this very layout is feasible, decided exactly.
    fn is_feasible(&self, points: &[DVec2]) -> bool;
}

/// An approximation of the inverse Hessian that is symmetric and positive definite.
pub trait Preconditioner {
    /// Applies it in place.
    fn apply(&self, vector: &mut [DVec2]);
}

/// How far to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DescentOptions {
    /// At most so many steps.
    pub steps: usize,
    /// Pairs of changes that L-BFGS remembers.
    pub memory: usize,
    /// Ends once a step improves the value by less than this share…
    pub tolerance: f64,
    /// …so many times in a row.
    pub patience: usize,
    /// No point moves farther than this in a step, in units of the square.
    pub longest_move: f64,
}

impl Default for DescentOptions {
    fn default() -> Self {
        Self { steps: 60, memory: 8, tolerance: 1e-4, patience: 3, longest_move: 0.1 }
    }
}

/// Share of the largest feasible step that is tried at most.
const FEASIBLE_SHARE: f64 = 0.8;
/// First Wolfe condition: a step must bring this share of what the slope promises.
const SUFFICIENT: f64 = 1e-4;
/// Halvings before a direction is given up.
const HALVINGS: usize = 14;

/// What a descent did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Descent {
    /// The value at the start and after each step.
    pub values: Vec<f64>,
    /// Evaluations of the objective.
    pub evaluations: usize,
}

/// Descends from `points`. `step` sees every accepted layout and its value, and may end
/// the descent by returning false.
pub fn descend(
    points: &mut Vec<DVec2>,
    objective: &mut impl Objective,
    region: &impl Region,
    preconditioner: &impl Preconditioner,
    options: &DescentOptions,
    mut step: impl FnMut(&[DVec2], f64) -> bool,
) -> Descent {
    let free = region.free();
    let count = points.len();
    let mut gradient = vec![DVec2::ZERO; count];
    let mut value = objective.evaluate(points, &mut gradient);
    mask(&mut gradient, free);
    let mut descent = Descent { values: vec![value], evaluations: 1 };
    let mut memory: VecDeque<Change> = VecDeque::new();
    let (mut candidate, mut next) = (points.clone(), gradient.clone());
    let mut idle = 0;
    for _ in 0..options.steps {
        let mut direction = two_loop(&memory, &gradient, preconditioner, free);
        let mut slope = dot(&direction, &gradient);
        if slope >= 0.0 || !slope.is_finite() {
            memory.clear();
            direction = two_loop(&memory, &gradient, preconditioner, free);
            slope = dot(&direction, &gradient);
        }
        if slope >= 0.0 || !slope.is_finite() {
            break;
        }
        let longest = direction.iter().map(|d| d.length()).fold(0.0, f64::max);
        let wanted = (options.longest_move / longest).min(1.0);
        let limit = region.max_step(points, &direction, wanted / FEASIBLE_SHARE);
        let mut length = wanted.min(FEASIBLE_SHARE * limit);
        let mut accepted = None;
        for _ in 0..HALVINGS {
            for ((c, p), d) in candidate.iter_mut().zip(points.iter()).zip(&direction) {
                *c = (*p + *d * length).as_vec2().as_dvec2();
            }
            if region.is_feasible(&candidate) {
                let found = objective.evaluate(&candidate, &mut next);
                descent.evaluations += 1;
                if found <= value + SUFFICIENT * length * slope {
                    accepted = Some(found);
                    break;
                }
            }
            length *= 0.5;
        }
        let Some(found) = accepted else {
            // Old curvature may mislead; try once from the preconditioned gradient alone.
            if memory.is_empty() {
                break;
            }
            memory.clear();
            continue;
        };
        mask(&mut next, free);
        memory.extend(Change::between(points, &candidate, &gradient, &next));
        if memory.len() > options.memory {
            memory.pop_front();
        }
        std::mem::swap(points, &mut candidate);
        std::mem::swap(&mut gradient, &mut next);
        idle = if value - found < options.tolerance * value.abs() { idle + 1 } else { 0 };
        value = found;
        descent.values.push(value);
        if !step(points, value) || idle >= options.patience {
            break;
        }
    }
    descent
}

/// A step and what it did to the gradient.
struct Change {
    points: Vec<DVec2>,
    gradient: Vec<DVec2>,
    /// 1 / (sᵀ y).
    scale: f64,
}

impl Change {
    /// None where the curvature along the step is not positive.
    fn between(from: &[DVec2], to: &[DVec2], old: &[DVec2], new: &[DVec2]) -> Option<Self> {
        let points: Vec<DVec2> = to.iter().zip(from).map(|(a, b)| *a - *b).collect();
        let gradient: Vec<DVec2> = new.iter().zip(old).map(|(a, b)| *a - *b).collect();
        let curvature = dot(&points, &gradient);
        let noise = 1e-10 * (dot(&points, &points) * dot(&gradient, &gradient)).sqrt();
        (curvature > noise).then(|| Self { points, gradient, scale: 1.0 / curvature })
    }
}

/// Minus the gradient times the approximate inverse Hessian.
fn two_loop(
    memory: &VecDeque<Change>,
    gradient: &[DVec2],
    preconditioner: &impl Preconditioner,
    free: &[DVec2],
) -> Vec<DVec2> {
    let mut q: Vec<DVec2> = gradient.iter().map(|g| -*g).collect();
    let mut factors = vec![0.0; memory.len()];
    for (change, factor) in memory.iter().zip(&mut factors).rev() {
        *factor = change.scale * dot(&change.points, &q);
        add(&mut q, &change.gradient, -*factor);
    }
    preconditioner.apply(&mut q);
    mask(&mut q, free);
    if let Some(last) = memory.back() {
        // The preconditioner's own scale, from the last step.
        let mut y = last.gradient.clone();
        preconditioner.apply(&mut y);
        mask(&mut y, free);
        let gamma = 1.0 / (last.scale * dot(&last.gradient, &y)).max(f64::MIN_POSITIVE);
        for q in &mut q {
            *q *= gamma;
        }
    }
    for (change, factor) in memory.iter().zip(&factors) {
        let back = change.scale * dot(&change.gradient, &q);
        add(&mut q, &change.points, factor - back);
    }
    q
}

fn mask(vector: &mut [DVec2], free: &[DVec2]) {
    for (v, f) in vector.iter_mut().zip(free) {
        *v *= *f;
    }
}

fn add(to: &mut [DVec2], what: &[DVec2], scale: f64) {
    for (a, b) in to.iter_mut().zip(what) {
        *a += *b * scale;
    }
}

fn dot(a: &[DVec2], b: &[DVec2]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}
