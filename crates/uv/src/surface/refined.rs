//! Coordinates refined by variable projection (`crate::optimise::refine`), in turns:
//!
//! ```text
//! turn ─ more triangles where errors are largest ─ turn ─ turn
//! ```
//!
//! After each turn scales are weighted anew. A low-poly's turns end where they gain little. A model's own coordinates go from coarse to fine:
//! where triangles are many from the beginning, moves of whole regions take too many steps, and
//! end up to 0.6 dB lower.
//!
//! Contract: of the turns' layouts the best one that shows the surface better than the start.

use super::finer::Finer;
use super::layout_score::LayoutScore;
use super::steps::Steps;
use super::{Moved, mapped, runs};
use crate::least_squares_texture::Solve;
use crate::optimise::{Balance, Problem, UvOptions, refine};
use crate::residual::residual_by_triangle;
use glam::Vec4;
use parbake_atlas::Layout;
use parbake_image::FloatImage;
use parbake_model::glam::{DVec2, Vec2};

/// Turns at most; in between scales are weighted anew.
const TURNS: usize = 3;
/// Steps of a low-poly's turn, where there are no more turns to share them.
const STEPS_OF_TURN: usize = 10;
/// What a low-poly's turn must leave at most of the errors for another one to follow: on twenty layouts of 512² the first took
/// 0 to 2 % off, and those after it hardly anything.
const WORTH_A_TURN: f64 = 0.99;
/// The turn before which a model gets more triangles: with one more turn before it ends 0.02 dB higher,
/// with none 0.1 dB lower.
const FINER_AFTER: usize = 1;
/// Minified, a low-poly's must be better by this much: with a texture that is finer than what views
/// see, a better picture at full size is worth nothing, and coordinates that were drawn out for it cost
/// parallax maps 0.2 to 0.3 dB. A model's own smaller texture need only not be worse.
const MINIFIED: f64 = 0.95;
/// Minified errors that are above that by more than this after a turn stay so: further turns bring them
/// a hundredth nearer.
const HOPELESS: f64 = 0.05;
/// The same before the first turn. All turns together took at most 0.02 off errors that were this near the limit.
const HOPELESS_START: f64 = 0.03;
/// Samples that a texel needs before coordinates are refined for what a model's own texture leaves:
/// with fewer, a texture can please each of them wherever it falls.
const SAMPLES_PER_TEXEL: usize = 2;
/// A moved layout must be better than the one before by this much.
const WORTH_IT: f64 = 0.98;
/// One with more triangles must be better by this much than the one that they were made for, or they
/// are not worth their bytes.
const WORTH_TRIANGLES: f64 = 0.97;

/// What the turns begin with.
pub struct Begun {
    /// The layout.
    pub layout: Layout,
    /// Its errors by scale, as shares of those of the delivered layout.
    pub errors: Vec<f64>,
    /// The way there.
    pub way: Vec<Vec<Vec2>>,
}

/// The best of the turns' layouts with the way there, and its errors as shares of
/// those of the delivered layout; None where none is better at each size. A model's own gets at most
/// `more_triangles`.
pub fn refined(
    score: &LayoutScore,
    begun: Begun,
    options: &UvOptions,
    more_triangles: usize,
    steps: &Steps,
) -> Option<(Moved, Vec<f64>)> {
    let Begun { mut layout, errors, way: mut frames } = begun;
    let coarse = score.problem;
    let limits = Limits::new(score.own);
    if limits.is_lost_from_the_start(&errors) {
        return None;
    }
    let few_samples = SAMPLES_PER_TEXEL * coarse.texture_size.pow(2);
    let stays = match score.own {
        true => coarse.signal_scales[0].samples.len() < few_samples,
        false => options.refine_steps == 0,
    };
    if stays {
        let is_better = limits.are_kept(&errors) && score.is_sound(&layout);
        return is_better.then_some((Moved { layout, frames, bisected: None }, errors));
    }
    // A bake's last thousandths lie in parallax and outlines, not in coordinates.
    let (tolerance, solve) =
        if score.own { (options.tolerance, options.solve) } else { (1e-3, Solve::ROUGH) };
    let turns = if score.own { TURNS } else { options.refine_steps.div_ceil(STEPS_OF_TURN).clamp(1, TURNS) };
    let most = options.refine_steps.div_ceil(turns);
    let (mut balance, mut texture) = Balance::new(coarse, score.start);
    // Views see a surface under all angles: half of it is minified.
    balance.weights.fill(1.0);
    let (mut finer, mut fine_frames) = (None::<Finer>, Vec::new());
    let mut before = errors.iter().sum::<f64>();
    let is_good = !score.own && limits.are_kept(&errors) && score.is_sound(&layout);
    let mut best =
        is_good.then(|| Best { layout: layout.clone(), errors, is_finer: false, way: [frames.len(), 0] });
    for count in 0..turns {
        let refine_steps = most.min(options.refine_steps.saturating_sub(count * most));
        if refine_steps == 0 {
            break;
        }
        if count == FINER_AFTER && more_triangles > 0 {
            let errors = by_triangle(coarse, &layout, &texture);
            finer = Finer::new(score.mesh, &layout, coarse, &errors, more_triangles);
            layout = finer.as_ref().map_or(layout, |finer| finer.layout.clone());
        }
        let problem = &finer.as_ref().map_or(*coarse, |finer| finer.problem(coarse));
        let way = if finer.is_some() { &mut fine_frames } else { &mut frames };
        let turn = UvOptions { refine_steps, tolerance, solve, ..*options };
        let mut descent = steps.descent(true);
        let step = |points: &[DVec2], loss| descent.step(way, points, loss);
        texture = refine(problem, &balance, &mut layout, texture, &turn, step).texture;
        let errors = score.relative(problem, &layout);
        // By what the texture that will be solved for leaves.
        balance.update(&errors);
        let left: f64 = errors.iter().sum();
        let is_idle = !score.own && left > WORTH_A_TURN * before;
        before = left;
        let is_over = limits.is_lost(&errors) || is_idle;
        if limits.are_kept(&errors)
            && best.as_ref().is_none_or(|best| best.is_beaten(&errors, finer.is_some()))
            && score.is_sound(&layout)
        {
            let way = [frames.len(), fine_frames.len()];
            best = Some(Best { layout: layout.clone(), errors, is_finer: finer.is_some(), way });
        }
        if steps.watcher.stopped() || is_over {
            break;
        }
    }
    let Best { layout, errors, is_finer, way } = best?;
    // What came after the best one led nowhere.
    frames.truncate(way[0]);
    fine_frames.truncate(way[1]);
    let finer = finer.filter(|_| is_finer);
    if let Some(finer) = &finer {
        frames = frames.iter().map(|points| finer.points(points)).chain(fine_frames).collect();
    }
    Some((Moved { layout, frames, bisected: finer.map(|finer| finer.bisected) }, errors))
}

/// The best turn so far.
struct Best {
    layout: Layout,
    errors: Vec<f64>,
    is_finer: bool,
    /// Steps that led there, before triangles were halved and after.
    way: [usize; 2],
}

impl Best {
    fn is_beaten(&self, errors: &[f64], is_finer: bool) -> bool {
        let worth = if is_finer && !self.is_finer { WORTH_TRIANGLES } else { 1.0 };
        errors.iter().sum::<f64>() < worth * self.errors.iter().sum::<f64>()
    }
}

/// What errors as shares of those of the start may be.
pub struct Limits {
    /// Those of minified scales.
    minified: f64,
    /// Those after which there is no hope, before the first turn and after one.
    hopeless: [f64; 2],
}

impl Limits {
    /// Those of a model's own layout, or of a low-poly's.
    pub fn new(own: bool) -> Self {
        if own {
            Self { minified: 1.0, hopeless: [f64::INFINITY; 2] }
        } else {
            Self { minified: MINIFIED, hopeless: [HOPELESS_START, HOPELESS].map(|above| MINIFIED + above) }
        }
    }

    fn are_kept(&self, errors: &[f64]) -> bool {
        errors[0] < WORTH_IT && errors[1..].iter().all(|error| *error < self.minified)
    }

    /// Whether no turn would make up for what is minified.
    pub fn is_lost_from_the_start(&self, errors: &[f64]) -> bool {
        errors[1..].iter().any(|error| *error > self.hopeless[0])
    }

    fn is_lost(&self, errors: &[f64]) -> bool {
        errors[1..].iter().any(|error| *error > self.hopeless[1])
    }
}

/// What a texture leaves on each triangle at full size.
fn by_triangle(problem: &Problem, layout: &Layout, texture: &FloatImage<Vec4>) -> Vec<f64> {
    let signal_scales = &problem.signal_scales[..1];
    residual_by_triangle(&mapped(layout, signal_scales, &runs(layout, signal_scales)), texture)
}
