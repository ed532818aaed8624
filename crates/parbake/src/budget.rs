//! How a time budget is shared out, what it cannot buy, and what stages take without one.
//!
//! What no budget shortens grows with the texture: projecting (twice, where vertices or coordinates moved),
//! gutters, rounding to 8 bits, and encoding the files. With T texels it takes about [`FIXED`]·T seconds.

use crate::error::BakeError;
use crate::options::{BakeOptions, Convention, Method, Parallax, Shading, ShapeMode, UvMode};
use crate::work::Work;
use parbake_progress::Stage;

/// Seconds a texel that no budget shortens. Measured with the built-in pair and `--time-budget 0` on two
/// cores: 1.1 s at 1024² and 4.2 s at 2048², writing included, hence 1.0 µs a texel; with the share for the
/// comparison's own projection and a margin.
const FIXED: f64 = 1.4e-6;

/// Those among them that come after the last stage that can be stopped: encoding takes 0.6 µs a texel
/// (2.5 s at 2048²), rounding 0.1, projecting 0.25.
const AT_THE_END: f64 = 1.0e-6;

/// Seconds a texel below which moving vertices and coordinates leaves no time for textures: at 2048² one pass
/// over coordinates took 7.6 s, and its share is a seventh.
const MOVING: f64 = 8e-6;

/// Seconds below which a time budget is better spent on textures alone.
const LEAST_FOR_MOVING: f64 = 8.0;

/// Fixed work that nobody notices is no reason to refuse a budget, in seconds.
const UNNOTICED: f64 = 1.0;

/// Texels along a side that can be asked for.
const SIZES: [usize; 2] = [16, 8192];

fn texels(texture_size: usize) -> f64 {
    (texture_size as f64).powi(2)
}

/// Refuses a time budget that a texture of this size cannot keep, and says what is possible. [`crate::bake`] and
/// [`crate::compress`] do so themselves; front ends ask before they read files.
///
/// # Errors
/// [`BakeError::Budget`].
pub fn check_budget(options: &BakeOptions) -> Result<(), BakeError> {
    let size = options.texture_size;
    let Some(budget) = options.time_budget else { return Ok(()) };
    let least = FIXED * texels(size);
    if least <= budget.max(UNNOTICED) {
        return Ok(());
    }
    let largest = (budget.max(UNNOTICED) / FIXED).sqrt() as usize;
    // A power of two, as textures are.
    let largest = (1usize << largest.max(1).ilog2()).clamp(SIZES[0], SIZES[1]);
    Err(BakeError::Budget { budget, size, least: least.ceil(), largest })
}

/// Seconds that a budget needs for vertices and texture coordinates to move.
fn least_for_moving(texture_size: usize) -> f64 {
    LEAST_FOR_MOVING.max(MOVING * texels(texture_size))
}

/// Whether there is only time for textures.
pub(crate) fn is_hurried(options: &BakeOptions) -> bool {
    options.time_budget.is_some_and(|seconds| seconds < least_for_moving(options.texture_size))
}

/// A word about what a budget leaves out, if it is something that the options ask for. `is_whole` is whether whole materials
/// are fitted.
pub(crate) fn left_out(options: &BakeOptions, work: Work, is_whole: bool) -> Option<String> {
    let budget = options.time_budget.filter(|_| is_hurried(options))?;
    let is_paper = options.method == Method::Paper || options.convention == Convention::Paper;
    let has_own_surface = work == Work::Compress;
    let vertices = options.method == Method::Fit && options.shape != ShapeMode::Keep && !has_own_surface;
    let normals = !is_whole && !is_paper && options.shading != Shading::Lambert && !has_own_surface;
    let left = [
        (vertices, "vertices stay"),
        (options.uv == UvMode::Optimize, "texture coordinates are at most repaired"),
        (normals && !options.keep_normals, "normals are fitted to a headlight alone"),
    ];
    let left: Vec<&str> = left.into_iter().filter(|(is_left, _)| *is_left).map(|(_, text)| text).collect();
    let least = least_for_moving(options.texture_size).ceil();
    (!left.is_empty()).then(|| {
        format!(
            "--time-budget {budget} is too short for every stage: {}; with this texture size all stages run from {least} s on",
            left.join(", ")
        )
    })
}

/// Seconds to keep back for what cannot be stopped at the end of a bake.
pub(crate) fn at_the_end(texture_size: usize) -> f64 {
    AT_THE_END * texels(texture_size)
}

/// The stages of a bake with what each takes as a rule, for estimates of the time left: seconds of the built-in
/// pair with the default options on two cores, scaled by what the options ask for.
pub(crate) fn stage_weights(options: &BakeOptions) -> Vec<(Stage, f64)> {
    let plan = options.plan();
    let million = texels(options.texture_size) / 1e6;
    let pixels = (plan.views * plan.reference.size * plan.reference.size) as f64 / 1e6;
    let parallax = options.parallax_plan();
    let algorithm = options.paper_joint_plan().is_some();
    let mut stages = Vec::new();
    if let Some(shape) = options.shape_plan() {
        let pixels = (shape.views * shape.view_size * shape.view_size) as f64 / 1e6;
        let growth = options.growth_plan(None).map_or(0, |plan| plan.fit.steps);
        stages.push((Stage::Shape, 0.003 * (shape.fit.steps + growth) as f64 * pixels.max(0.1)));
    } else if algorithm && options.uv == UvMode::Keep {
        stages.push((Stage::Shape, 60.0));
    }
    if options.uv == UvMode::Optimize && !is_hurried(options) {
        stages.push((Stage::Uv, 1.0 + 1.8 * million));
    }
    stages.push((Stage::Reference, 0.08 * pixels));
    if options.parallax != Parallax::None {
        let steps: usize = parallax.iter().flat_map(|plan| &plan.passes).map(|pass| pass.steps).sum();
        stages.extend([(Stage::Cutout, 6.0), (Stage::Parallax, 0.03 * steps as f64)]);
    }
    stages.push((Stage::Sampling, 0.02 * pixels));
    let fits = 1.0 / solving_share(options);
    stages.push((Stage::Solve, fits * plan.schedule.rounds as f64 * (0.5 * million + 0.03 * pixels)));
    stages.push((Stage::Evaluate, 2.0));
    stages
}

/// Share of the time for solving that the maps themselves take; textures of viewers without parallax maps take the rest.
pub(crate) fn solving_share(options: &BakeOptions) -> f64 {
    if options.has_fallback() { 0.5 } else { 1.0 }
}

/// The shares of stages in the time that a budget leaves them: textures are worth most, and
/// what reference pictures show must be solved for.
pub(crate) mod shares {
    /// Of moving vertices.
    pub const SHAPE: f64 = 0.2;
    /// Of vertices that reach further, for a cutout.
    pub const GROWTH: f64 = 0.1;
    /// Of optimising texture coordinates.
    pub const UV: f64 = 0.15;
    /// Of rendering the high-poly.
    pub const REFERENCE: f64 = 0.25;
    /// Of fitting parallax map and cutout.
    pub const PARALLAX: f64 = 0.35;
    /// Of the textures, where others for viewers without parallax maps follow.
    pub const SHIFTED_TEXTURES: f64 = 0.75;
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn with(texture_size: usize, budget: f64) -> BakeOptions {
        BakeOptions { texture_size, time_budget: Some(budget), ..BakeOptions::default() }
    }

    /// Protects deadlines: a budget that a texture's size cannot keep is refused, with the least that is
    /// possible at this size and a size that is possible with this budget; both are then taken.
    #[test]
    fn budgets_that_cannot_hold_are_refused_with_what_can() {
        for (size, budget) in [(8192, 10.0), (4096, 5.0), (2048, 0.0)] {
            let Err(BakeError::Budget { least, largest, .. }) = check_budget(&with(size, budget)) else {
                panic!("{budget} s at {size}² was taken");
            };
            assert!(least > budget && largest < size);
            assert!(check_budget(&with(size, least)).is_ok() && check_budget(&with(largest, budget)).is_ok());
        }
        assert!(check_budget(&with(512, 0.0)).is_ok() && check_budget(&with(4096, 60.0)).is_ok());
    }

    /// Protects textures from stages before them: where moving coordinates would take all the time, they stay.
    #[test]
    fn large_textures_are_hurried_for_longer() {
        assert!(!is_hurried(&with(512, 8.0)) && is_hurried(&with(512, 7.0)));
        assert!(is_hurried(&with(4096, 60.0)) && !is_hurried(&with(4096, 600.0)));
    }

    /// Protects who asks for vertices and coordinates that a budget has no time for: they are told, with a budget that has.
    #[test]
    fn what_a_budget_leaves_out_is_told() {
        let told = |options: &BakeOptions| left_out(options, Work::Bake, true).unwrap_or_default();
        let all = told(&with(512, 3.0));
        assert!(all.contains("--time-budget 3 ") && all.ends_with("from 8 s on"), "{all}");
        assert!(told(&with(2048, 20.0)).ends_with("from 34 s on"));
        assert_eq!([told(&with(512, 8.0)), told(&BakeOptions::default())], ["", ""]);
        let kept = BakeOptions { shape: ShapeMode::Keep, uv: UvMode::Repair, ..with(512, 3.0) };
        assert_eq!(told(&kept), "");
        assert!(left_out(&kept, Work::Bake, false).is_some_and(|text| text.contains("headlight")));
        assert!(!told(&BakeOptions { method: Method::Paper, ..with(512, 3.0) }).contains("vertices"));
        let compressed = left_out(&with(512, 3.0), Work::Compress, false).unwrap();
        assert!(compressed.contains(": texture coordinates are at most repaired;"), "{compressed}");
    }

    /// Protects the time that is shown: every stage that reports has a weight, and none weighs nothing.
    #[test]
    fn stages_have_weights() {
        let stages = stage_weights(&BakeOptions { parallax: Parallax::Sh, ..BakeOptions::default() });
        assert!(stages.iter().all(|(_, weight)| *weight > 0.0), "{stages:?}");
        for stage in [Stage::Shape, Stage::Uv, Stage::Reference, Stage::Parallax, Stage::Solve] {
            assert!(stages.iter().any(|(own, _)| *own == stage), "{stage:?}");
        }
    }
}
