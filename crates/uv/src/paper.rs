//! The paper's own method, as a reference: Algorithm 1 for colours and texture coordinates.
//!
//! ```text
//! grey texture
//! k₀ steps of Adam on the texture
//! k₁ rounds of   f steps of Adam on the texture
//!                1 step of L-BFGS with line search on the texture coordinates
//! k₂ steps of Adam on the texture
//! ```
//!
//! What the paper leaves open is settled so: Adam sees all samples in each step; texels
//! stay in [0, 1]; its rate is constant but in the last k₂ steps, where it falls along a
//! cosine; L-BFGS remembers pairs over all rounds, each pair measured within one round's
//! energy (`paper/energy.rs`). The alternation swings, since a step of the coordinates knows
//! nothing of the texture that has to follow: the best round is kept.
//!
//! Contract: a feasible start gives a feasible result, and so is every layout that `watch`
//! sees. The result does not depend on the number of threads.

mod energy;
pub mod texture_loss;

use crate::contact::Contact;
use crate::descent::{Place, Reach, Region, Step};
use crate::lbfgs::{Identity, Lbfgs};
use crate::least_squares_texture::ParameterizedSignal;
use crate::signal::{Pixels, Signal};
use parbake_image::FloatImage;
use parbake_solve::adam::{Adam, AdamOptions};

use energy::Problem;
use glam::{DMat2, DVec2, Vec4};
use texture_loss::TextureLoss;

/// Parameters, named after what they do, with the paper's values as defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperOptions {
    /// k₀ = 500: steps of Adam before texture coordinates move.
    pub first_steps: usize,
    /// k₁ = 800: rounds of the alternation at most.
    pub rounds: usize,
    /// f = 5: steps of Adam in a round.
    pub steps_in_round: usize,
    /// k₂ = 500: steps of Adam at the end at most.
    pub last_steps: usize,
    /// ε₁ = 1e-6: the alternation ends when in a round neither the texture (root of the
    /// mean squared change) nor any point (in units of the square) changes more; the
    /// steps at the end likewise.
    pub threshold: f64,
    /// What moves the texture coordinates.
    pub guide: Guide,
    /// λ_I = 1: weight of the content-aware term.
    pub content_weight: f64,
    /// λ_uv: weight of distortion; 1e-2 for models, 1e-5 for pictures on a plane.
    pub distortion_weight: f64,
    /// λ_IPC = 1: weight of the contact barrier as the paper has it, with distances in units
    /// of the square…
    pub contact_weight: f64,
    /// …and its width d₀ = 5 in texels: the activation that the contact was made with.
    pub contact_texels: f64,
    /// s > 0, the scale between rest shapes and the texture: the energy is least where a
    /// triangle is 1 / s times its rest shape. Texels over pixels of what is shown makes
    /// triangles want more than they can have, so that the erroneous ones get it. With s = 1
    /// and rest shapes in units of the square little moves.
    pub scale: f64,
    /// Adam's; the paper names none.
    pub adam: AdamOptions,
    /// Channels in which the signal has colours: what the error is a mean over.
    pub channels: u32,
    /// Pairs that L-BFGS remembers.
    pub memory: usize,
    /// No point moves farther in a round, in units of the square.
    pub longest_move: f64,
}

impl Default for PaperOptions {
    fn default() -> Self {
        Self {
            first_steps: 500,
            rounds: 800,
            steps_in_round: 5,
            last_steps: 500,
            threshold: 1e-6,
            guide: Guide::ContentAware,
            content_weight: 1.0,
            distortion_weight: 1e-2,
            contact_weight: 1.0,
            contact_texels: 5.0,
            scale: 1.0,
            adam: AdamOptions::default(),
            channels: 3,
            memory: 8,
            longest_move: 0.1,
        }
    }
}

/// What moves the texture coordinates, beside distortion and contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guide {
    /// The content-aware term, with both parts of the gradient that section 4.4 prints.
    ContentAware,
    /// The image loss alone, as in the paper's Table 3.
    ImageLoss,
}

/// How far the method is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperProgress<'a> {
    /// Rounds done so far.
    pub round: usize,
    /// Mean squared error of this round's texture, before the points moved.
    pub error: f64,
    /// The layout after the round.
    pub points: &'a [DVec2],
}

/// A point of the way (Fig. 15).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperPoint {
    /// Steps of Adam so far.
    pub iteration: usize,
    /// L_diff: mean squared error.
    pub loss: f64,
    /// L_I∘UV: the sum of `Aₜ eₜ Dₜ` over triangles.
    pub content: f64,
}

/// The way through the three stages.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PaperHistory {
    /// Each round, and some of the steps before and after.
    pub points: Vec<PaperPoint>,
    /// Iterations at which coordinates began to move and ended.
    pub moved: [usize; 2],
}

/// Steps of Adam between two points of the history where coordinates stand.
const RECORDED: usize = 20;

/// What the method found.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperResult {
    /// P points.
    pub points: Vec<DVec2>,
    /// Values in [0, 1], not rounded.
    pub texture: FloatImage<Vec4>,
    /// Mean squared error of points and texture together.
    pub error: f64,
    /// Rounds done.
    pub rounds: usize,
    /// How it went.
    pub history: PaperHistory,
}

/// Runs Algorithm 1 from `mapped.points` for a texture of `size`² texels (at least 2²),
/// shown without mip levels: of `mapped.signal_scales` the first one counts. `rest` are the F rest
/// shapes. `watch` sees every round and may end the alternation by returning false.
pub fn paper_method(
    mapped: &ParameterizedSignal,
    rest: &[DMat2],
    size: usize,
    region: &impl Region,
    contact: Option<&Contact>,
    options: &PaperOptions,
    mut watcher: impl FnMut(&PaperProgress) -> bool,
) -> PaperResult {
    let signal = match mapped.signal_scales.first() {
        Some(signal) => Signal { pixels: Pixels::Sizeless, ..signal.clone() },
        None => Signal::new(mapped.triangles.len(), &[]),
    };
    let mapped = ParameterizedSignal { signal_scales: std::slice::from_ref(&signal), ..*mapped };
    let size = size.max(2);
    let problem = Problem::new(mapped, &signal, rest, contact, size, options);
    let mut texture = FloatImage::solid(size, Vec4::splat(0.5));
    let mut painter = Painter::new(&texture, options);
    let mut errors = vec![0.0; mapped.triangles.len()];
    let mut history = PaperHistory::default();
    let loss = problem.loss(mapped.points, size);
    painter.steps(&mut texture, &loss, options.first_steps, Rate::Constant, |step, texture| {
        if step % RECORDED == 0 {
            history.points.push(problem.point(step, mapped.points, texture, &mut errors));
        }
    });
    history.moved = [options.first_steps; 2];
    problem.errors(mapped.points, &texture, &mut errors);

    let mut place =
        Place::new(mapped.points.to_vec(), &mut problem.energy(mapped.points, &texture, &errors), region);
    let mut memory = Lbfgs::new(options.memory);
    let mut best: Option<(f64, Vec<DVec2>, FloatImage<Vec4>)> = None;
    let (mut rounds, mut stopped) = (0, false);
    while rounds < options.rounds {
        let loss = problem.loss(&place.points, size);
        let changed = painter.steps(&mut texture, &loss, options.steps_in_round, Rate::Constant, |_, _| {});
        history.moved[1] += options.steps_in_round;
        let now = problem.point(history.moved[1], &place.points, &texture, &mut errors);
        let error = now.loss;
        history.points.push(now);
        if best.as_ref().is_none_or(|(least, ..)| error < *least) {
            best = Some((error, place.points.clone(), texture.clone()));
        }
        let mut energy = problem.energy(&place.points, &texture, &errors);
        let reach = Reach { longest_move: options.longest_move, ..Reach::default() };
        place.refresh(&mut energy, region);
        let from = place.points.clone();
        let step = place.step(&mut memory, &mut energy, region, &Identity, &reach);
        rounds += 1;
        let still = step != Step::Forgot && longest(&from, &place.points) < options.threshold;
        stopped = !watcher(&PaperProgress { round: rounds, error, points: &place.points });
        if stopped || (still && changed < options.threshold) {
            break;
        }
    }

    let mut points = place.points;
    if let Some((_, best_points, least_squares_texture)) = best {
        (points, texture) = (best_points, least_squares_texture);
    }
    let mut painter = Painter::new(&texture, options);
    painter.steps(
        &mut texture,
        &problem.loss(&points, size),
        if stopped { 0 } else { options.last_steps },
        Rate::Falling,
        |step, texture| {
            if step % RECORDED == 0 {
                history.points.push(problem.point(history.moved[1] + step, &points, texture, &mut errors));
            }
        },
    );
    let error = problem.errors(&points, &texture, &mut errors);
    PaperResult { points, texture, error, rounds, history }
}

/// How Adam's rate goes on.
#[derive(Clone, Copy, PartialEq)]
enum Rate {
    /// As it is, and to the end.
    Constant,
    /// Along a cosine to 1 / 500 of it, or until the texture stands still.
    Falling,
}

/// Adam on a texture.
struct Painter {
    adam: Adam,
    gradient: Vec<Vec4>,
    threshold: f64,
}

impl Painter {
    fn new(texture: &FloatImage<Vec4>, options: &PaperOptions) -> Self {
        let count = texture.texels.len();
        let adam = Adam::new(count, options.adam);
        Self { adam, gradient: vec![Vec4::ZERO; count], threshold: options.threshold }
    }

    /// Returns how much the texture has changed: the root of the mean square. `watch` sees the
    /// texture before each step, and how many were done.
    fn steps(
        &mut self,
        texture: &mut FloatImage<Vec4>,
        loss: &TextureLoss,
        steps: usize,
        rate: Rate,
        mut watcher: impl FnMut(usize, &FloatImage<Vec4>),
    ) -> f64 {
        let start = texture.texels.clone();
        let mut before = Vec::new();
        for step in 0..steps {
            watcher(step, texture);
            let mut share = 1.0;
            if rate == Rate::Falling {
                let angle = std::f32::consts::PI * step as f32 / steps as f32;
                share = 0.002 + 0.998 * (0.5 + 0.5 * angle.cos());
                before.clone_from(&texture.texels);
            }
            loss.gradient(&texture.texels, &mut self.gradient);
            self.adam.step(&mut texture.texels, &self.gradient, share);
            for texel in &mut texture.texels {
                *texel = texel.clamp(Vec4::ZERO, Vec4::ONE);
            }
            if rate == Rate::Falling && change(&before, &texture.texels) < self.threshold {
                break;
            }
        }
        change(&start, &texture.texels)
    }
}

/// Root of the mean squared difference, over texels and channels.
fn change(from: &[Vec4], to: &[Vec4]) -> f64 {
    let sum: f64 = from.iter().zip(to).map(|(a, b)| f64::from((*a - *b).length_squared())).sum();
    (0.25 * sum / from.len().max(1) as f64).sqrt()
}

/// The longest way of a point.
fn longest(from: &[DVec2], to: &[DVec2]) -> f64 {
    from.iter().zip(to).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
}
