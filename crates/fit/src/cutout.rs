//! The fit of a cutout (`parbake_render::cutout`): from where each point of the low-poly
//! is to be left out, because the high-poly is not there.
//!
//! Every pixel of the training views gives examples: where the high-poly fills it, the
//! low-poly's nearest layer shall be opaque; where it does not, all of its layers shall be
//! left out. With y = ±1 and the opacity o, the squared hinge `max(0, 1 − y o)²` is convex in
//! the coefficients, and so are a membrane and a thin plate (`thin_plate.rs`) through
//! neighbouring texels; Adam walks down all in small groups of views. Texels that no view wants
//! left out stay opaque from everywhere, and only examples near the others are looked at.
//!
//! Contract: examples are summed in their order, so the result does not depend on the number
//! of threads.

use parbake_image::pyramid::taps;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_model::{Basis, Wrap};
use parbake_progress::{Stage, Watcher};
use parbake_render::cutout::CutoutCoefficients;
use parbake_solve::adam::{Adam, AdamOptions};
use parbake_solve::thin_plate::ThinPlate;
use parbake_views::reference::Reference;
use parbake_views::view_sampler::ViewSampler;
use rayon::prelude::*;

/// How a cutout is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutoutOptions {
    /// The functions whose coefficients are fitted: harmonics, or [`Basis::TangentCutout`].
    pub basis: Basis,
    /// Texels along a side of the map.
    pub size: usize,
    /// Steps of Adam.
    pub steps: usize,
    /// Views that a step looks at.
    pub views_per_step: usize,
    /// About how far a coefficient moves in a step; an opaque texel's first one is 1, of harmonics 3.5.
    pub rate: f32,
    /// How much neighbouring texels are alike, as a share of the mean pull on a texel of those
    /// examples that are wrong to begin with: a little makes outlines smooth that many maps
    /// would fit alike, and where little is wrong a little less does.
    pub stiffness: f32,
    /// How much texels resist to bend away from a ramp through their neighbours, as such a
    /// share too: it keeps outlines from fraying, texel by texel, where the surface is seen at
    /// a grazing angle.
    pub bending: f32,
}

impl Default for CutoutOptions {
    fn default() -> Self {
        Self {
            basis: Basis::TangentCutout,
            size: 64,
            steps: 200,
            views_per_step: 24,
            rate: 0.4,
            stiffness: 0.01,
            bending: 0.01,
        }
    }
}

/// One layer of one pixel: seen from where, and whether it shall be there.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    uv: Vec2,
    direction: [i16; 3],
    opaque: bool,
}

impl Example {
    #[inline]
    fn direction(&self) -> Vec3 {
        Vec3::from(self.direction.map(|v| f32::from(v) * (1.0 / 32767.0)))
    }
}

/// The high-poly fills a pixel from this coverage on.
const FILLED: f32 = 0.5;

/// The examples of each of these views, for a map of `size`² texels: those whose fetch
/// touches a texel that some view wants left out.
pub fn examples(sampler: &ViewSampler, references: &[Reference], size: usize) -> Vec<Vec<Example>> {
    let mut views: Vec<Vec<Example>> = (references.par_iter())
        .map(|reference| {
            let mut out = Vec::new();
            sampler.fragment_layers(reference, |coverage, layer, uv, direction| {
                let opaque = coverage >= FILLED;
                if layer == 0 || !opaque {
                    let direction = direction.to_array().map(|x| (x * 32767.0).round_ties_even() as i16);
                    out.push(Example { uv, direction, opaque });
                }
            });
            out
        })
        .collect();
    let wanted = wanted(&views, size);
    views.par_iter_mut().for_each(|view| {
        view.retain(|e| texels(e, size).into_iter().any(|texel| wanted[texel as usize]));
    });
    views
}

/// The texels that an example's fetch reads.
fn texels(example: &Example, size: usize) -> [u32; 4] {
    taps(example.uv, size, size, [Wrap::Clamp; 2]).index
}

/// Which texels some view wants left out.
fn wanted(views: &[Vec<Example>], size: usize) -> Vec<bool> {
    let mut wanted = vec![false; size * size];
    for example in views.iter().flatten().filter(|e| !e.opaque) {
        texels(example, size).into_iter().for_each(|texel| wanted[texel as usize] = true);
    }
    wanted
}

/// Adds half the gradient of the examples' loss.
fn add_view(examples: &[Example], map: &CutoutCoefficients, into: &mut [f32]) {
    for example in examples {
        let direction = example.direction();
        let side = if example.opaque { 1.0 } else { -1.0 };
        let short = 1.0 - side * map.opacity(example.uv, direction);
        if short > 0.0 {
            map.adjoint(example.uv, direction, -side * short, into);
        }
    }
}

/// Adds the gradient of `½ stiffness Σ |Oᵢ − Oⱼ|²` over side neighbours that both have a say.
fn add_membrane(map: &CutoutCoefficients, wanted: &[bool], stiffness: f32, gradient: &mut [f32]) {
    let (width, count) = (map.width, map.coefficients.len() / wanted.len());
    let of = |texel: usize| &map.coefficients[texel * count..(texel + 1) * count];
    gradient.par_chunks_mut(count).enumerate().filter(|(i, _)| wanted[*i]).for_each(|(i, into)| {
        let (x, y) = (i % width, i / width);
        let sides = [
            (x > 0).then(|| i - 1),
            (x + 1 < width).then(|| i + 1),
            (y > 0).then(|| i - width),
            (y + 1 < map.height).then(|| i + width),
        ];
        for j in sides.into_iter().flatten().filter(|&j| wanted[j]) {
            for (to, (a, b)) in into.iter_mut().zip(of(i).iter().zip(of(j))) {
                *to += stiffness * (a - b);
            }
        }
    });
}

/// Sums that a step's views are added to, at most, and so the threads that a step keeps busy; their
/// number alone decides the order of sums.
const PARTS: usize = 8;
/// Numbers of one task.
const BAND: usize = 4096;

/// Fits the map; returns it with the share of examples that it gets wrong, before and after.
pub fn fit_cutout(
    views: &[Vec<Example>],
    options: &CutoutOptions,
    watcher: &dyn Watcher,
) -> (CutoutCoefficients, [f64; 2]) {
    let mut map = CutoutCoefficients::opaque(options.basis, options.size);
    let before = wrong(views, &map);
    let lanes = |values: &[f32]| -> Vec<Vec4> {
        let four = |c: &[f32]| Vec4::from(std::array::from_fn(|k| c.get(k).copied().unwrap_or(0.0)));
        values.chunks(4).map(four).collect()
    };
    let mut moving = lanes(&map.coefficients);
    let rate = AdamOptions { rate: options.rate, ..AdamOptions::default() };
    let mut adam = Adam::new(moving.len(), rate);
    let wanted = wanted(views, options.size);
    let plate = ThinPlate::new(options.size, wanted.clone());
    let together = options.views_per_step.div_ceil(PARTS).max(1);
    let mut gradient = vec![0.0; map.coefficients.len()];
    let mut parts = vec![gradient.clone(); options.views_per_step.div_ceil(together)];
    for step in 0..options.steps {
        watcher.progress(Stage::Cutout, step, options.steps);
        if views.iter().all(Vec::is_empty) || watcher.stopped() {
            break;
        }
        let chosen: Vec<&[Example]> = (0..options.views_per_step)
            .map(|i| views[(step * options.views_per_step + i) % views.len()].as_slice())
            .collect();
        parts.par_iter_mut().zip(chosen.par_chunks(together)).for_each(|(part, views)| {
            part.fill(0.0);
            views.iter().for_each(|view| add_view(view, &map, part));
        });
        gradient.par_chunks_mut(BAND).enumerate().for_each(|(band, into)| {
            into.fill(0.0);
            for part in &parts {
                into.iter_mut().zip(&part[band * BAND..]).for_each(|(into, from)| *into += from);
            }
        });
        let asked: usize = chosen.iter().map(|view| view.len()).sum();
        let mean_pull = before as f32 * asked as f32 / wanted.len() as f32;
        add_membrane(&map, &wanted, options.stiffness * mean_pull, &mut gradient);
        plate.add_gradient(&map.coefficients, options.bending * mean_pull, &mut gradient);
        let left = 1.0 - step as f32 / options.steps as f32;
        adam.step(&mut moving, &lanes(&gradient), left);
        for (four, moved) in map.coefficients.chunks_mut(4).zip(&moving) {
            four.copy_from_slice(&moved.to_array()[..four.len()]);
        }
    }
    watcher.progress(Stage::Cutout, options.steps, options.steps);
    let after = wrong(views, &map);
    (map, [before, after])
}

/// Share of the examples whose opacity has the wrong sign.
fn wrong(views: &[Vec<Example>], map: &CutoutCoefficients) -> f64 {
    let count = |view: &Vec<Example>| {
        view.iter().filter(|e| (map.opacity(e.uv, e.direction()) >= 0.0) != e.opaque).count()
    };
    let all: usize = views.iter().map(Vec::len).sum();
    views.par_iter().map(count).sum::<usize>() as f64 / all.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the method: a point that is beside the model for half of the directions is
    /// left out for those, and others stay opaque.
    #[test]
    fn a_half_space_of_directions_is_learnt() {
        let border = Vec3::new(0.6, 0.0, 0.8);
        let view = |i: usize| {
            let directions = parbake_render::camera::fibonacci_sphere(200, i as f64);
            let example = |d: Vec3| Example {
                uv: Vec2::splat(0.25),
                direction: d.to_array().map(|x| (x * 32767.0) as i16),
                opaque: d.dot(border) > 0.2,
            };
            directions.into_iter().map(example).collect::<Vec<_>>()
        };
        let views: Vec<_> = (0..8).map(view).collect();
        let options = CutoutOptions { size: 4, views_per_step: 4, ..CutoutOptions::default() };
        let (map, [before, after]) = fit_cutout(&views, &options, &());
        assert!(before > 0.3 && after < 0.03, "{before} {after}");
        assert!((map.opacity(Vec2::splat(0.875), -border) - 1.0).abs() < 1e-5);
    }

    /// Protects the membrane's gradient by central differences of its energy, and texels without a
    /// say, which it must not move.
    #[test]
    fn the_membranes_gradient_is_its_energys() {
        let mut map = CutoutCoefficients::opaque(Basis::Harmonics(1), 3);
        map.coefficients.iter_mut().enumerate().for_each(|(i, c)| *c += ((7 * i) % 11) as f32 * 0.1);
        let wanted: Vec<bool> = (0..9).map(|i| i != 4).collect();
        let energy = |map: &CutoutCoefficients| {
            let square = |i: usize, j: usize| -> f32 {
                (0..4).map(|k| (map.coefficients[4 * i + k] - map.coefficients[4 * j + k]).powi(2)).sum()
            };
            let pairs = (0..9).flat_map(|i| [(i % 3 < 2, i, i + 1), (i < 6, i, i + 3)]);
            let sum: f32 = pairs
                .filter(|&(side, i, j)| side && wanted[i] && wanted[j])
                .map(|(_, i, j)| square(i, j))
                .sum();
            0.5 * 0.3 * sum
        };
        let mut gradient = vec![0.0; map.coefficients.len()];
        add_membrane(&map, &wanted, 0.3, &mut gradient);
        for (i, &slope) in gradient.iter().enumerate() {
            let at = |step: f32| {
                let mut moved = map.clone();
                moved.coefficients[i] += step;
                energy(&moved)
            };
            let difference = (at(0.05) - at(-0.05)) / 0.1;
            assert!((slope - difference).abs() < 1e-3, "{i}: {slope} {difference}");
        }
        assert!(gradient[16..20].iter().all(|&g| g == 0.0));
    }
}
