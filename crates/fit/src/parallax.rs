//! The fit of a parallax map (Knodt et al. 2023, section 4.2), shape and texture
//! coordinates held: the map's parameters, colours and normals follow the gradient together.
//! Which formula the map follows does not matter here (`parallax_variants`).
//!
//! A texture that was solved for without parallax is blurred where views disagree, and one
//! that is solved again after every small shift would be exact but slow; so all three move
//! at once by Adam, in small groups of views, and the textures are solved for afterwards
//! with the shifts that came out (`schedule.rs`). A map of zeros has a gradient already:
//! that of the colours beside the one that is fetched.
//!
//! Contract: what is minimised is what the solvers minimise: squared differences of display
//! values, weighted by sample. Views of a step are summed in their order, so the result does
//! not depend on the number of threads.

mod plate;

use crate::backend::Backend;
use crate::texels::{BAND, Texels, gather};
use crate::view_gradient::Sums;
use parbake_image::MapSet;
use parbake_image::display_table::DisplayTable;
use parbake_image::reduced::all_at_most;
use parbake_model::Basis;
use parbake_model::glam::Vec4;
use parbake_progress::{MOST_TEXELS, Message, PackedParallax, Snapshot, Stage, Watcher};
use parbake_render::parallax::ParallaxCoefficients;
use parbake_render::parallax_variants::shift_map::ShiftMap;
use parbake_render::shade::Brdf;
use parbake_solve::adam::{Adam, AdamOptions, rate_at};
use parbake_views::view_sample::ViewSample;
use plate::MapPlate;
use rayon::prelude::*;

/// How the map is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallaxOptions {
    /// The functions whose coefficients are fitted: harmonics, or [`Basis::TangentShift`].
    pub basis: Basis,
    /// Texels along a side of the coefficient map.
    pub size: usize,
    /// Steps of Adam.
    pub steps: usize,
    /// Views that a step looks at.
    pub views_per_step: usize,
    /// About how far a shift moves in a step, in texture widths.
    pub rate: f32,
    /// Adam's ε for coefficients, as a gradient a pixel: where a shift would better so little,
    /// nothing moves. Without it a map that nobody needs would wander about as far as any.
    pub epsilon: f32,
    /// How much coefficients resist to bend away from a ramp through their neighbouring texels: a
    /// bend by one texture width weighs as much as this many times the mean squared difference to
    /// begin with. It keeps lines whole where shifts are far, and gives way to details where
    /// pictures hardly differ.
    pub bending: f32,
    /// About how far texels move in a step, whose values go from 0 to 1.
    pub texture_rate: f32,
}

impl Default for ParallaxOptions {
    fn default() -> Self {
        Self {
            basis: Basis::TangentShift,
            size: 64,
            steps: 240,
            views_per_step: 12,
            rate: 5e-4,
            epsilon: 3e-4,
            bending: 400.0,
            texture_rate: 0.01,
        }
    }
}

/// What moves together.
#[derive(Clone, Debug)]
pub struct State<M = ParallaxCoefficients> {
    /// The parallax map.
    pub map: M,
    /// The material's maps, at least one.
    pub maps: MapSet,
}

/// Bytes of gradients beyond which views share buffers: more do not stay in a cache, and then
/// clearing and summing them costs more than the views do.
const BUFFERS: usize = 16 << 20;
/// Buffers at least, however large: as many tasks as there are.
const LEAST_BUFFERS: usize = 4;

/// How many of a step's views share a buffer. It depends on sizes alone, and so does the order of sums.
fn views_together(texels: usize, maps: usize, views: usize) -> usize {
    let parts = (BUFFERS / (texels * maps * size_of::<Vec4>()).max(1)).max(LEAST_BUFFERS);
    views.div_ceil(parts).max(1)
}

/// Calls a function with the number of maps as a constant, for which its loops are unrolled.
macro_rules! for_each_count {
    ($maps:expr, $function:ident($($argument:expr),*)) => {
        match $maps.kinds().count() {
            0 | 1 => $function::<_, _, _, 1>($($argument),*),
            2 => $function::<_, _, _, 2>($($argument),*),
            3 => $function::<_, _, _, 3>($($argument),*),
            4 => $function::<_, _, _, 4>($($argument),*),
            _ => $function::<_, _, _, 5>($($argument),*),
        }
    };
}

/// The mean squared difference of these views as they are.
pub fn mean_square<B: Brdf, M: ShiftMap, K: Backend>(
    backend: &K,
    views: &[Vec<ViewSample>],
    state: &State<M>,
    brdf: &B,
    display: &DisplayTable,
) -> f64 {
    for_each_count!(state.maps, mean_square_of(backend, views, state, brdf, display))
}

fn mean_square_of<B: Brdf, M: ShiftMap, K: Backend, const N: usize>(
    backend: &K,
    views: &[Vec<ViewSample>],
    state: &State<M>,
    brdf: &B,
    display: &DisplayTable,
) -> f64 {
    let texels = Texels::<N>::new(&state.maps);
    let loss_of = |pixels: &Vec<ViewSample>| {
        let mut sums = Sums::zeros(&state.map, &texels);
        backend.view_gradient(pixels, &state.map, &texels, brdf, display, &mut sums);
        sums.loss
    };
    let losses: Vec<f64> = views.par_iter().map(loss_of).collect();
    let count: usize = views.iter().map(Vec::len).sum();
    losses.iter().sum::<f64>() / (3 * count.max(1)) as f64
}

/// Moves parallax map and maps; returns the mean squared difference of each step's views.
pub fn fit_parallax<B: Brdf, M: ShiftMap, K: Backend>(
    backend: &K,
    views: &[Vec<ViewSample>],
    state: &mut State<M>,
    brdf: &B,
    display: &DisplayTable,
    options: &ParallaxOptions,
    watcher: &dyn Watcher,
) -> Vec<f64> {
    for_each_count!(state.maps, fit_parallax_of(backend, views, state, brdf, display, options, watcher))
}

/// As [`fit_parallax`] for the first N maps; the others stay. For callers that know how many there are: this one
/// number alone is compiled.
pub fn fit_parallax_of<B: Brdf, M: ShiftMap, K: Backend, const N: usize>(
    backend: &K,
    views: &[Vec<ViewSample>],
    state: &mut State<M>,
    brdf: &B,
    display: &DisplayTable,
    options: &ParallaxOptions,
    watcher: &dyn Watcher,
) -> Vec<f64> {
    let State { map, maps } = state;
    let mut texels = Texels::<N>::new(maps);
    let at_rate = |rate| AdamOptions { rate, ..AdamOptions::default() };
    // Adam sees parameters in units of their strides, and moves all of those alike.
    let parameter_scales = map.parameter_scales();
    let in_strides = |mut lanes: Vec<Vec4>| {
        lanes.iter_mut().zip(&parameter_scales).for_each(|(lane, stride)| *lane /= *stride);
        lanes
    };
    let mut moving = in_strides(map.parameters());
    let mean_size = views.iter().map(Vec::len).sum::<usize>() as f32 / views.len().max(1) as f32;
    let map_options = AdamOptions {
        epsilon: options.epsilon * mean_size * options.views_per_step as f32,
        ..at_rate(options.rate * map.rate_scale())
    };
    let mut adam_map = Adam::new(moving.len(), map_options);
    let mut adam_texels = Adam::new(N * texels.texels.len(), at_rate(options.texture_rate));
    let plate = MapPlate::new(views, map);
    let mut losses = Vec::with_capacity(options.steps);
    let together = views_together(texels.texels.len(), N, options.views_per_step);
    let mut sums: Vec<Sums<M, N>> = Vec::new();
    sums.resize_with(options.views_per_step.div_ceil(together), || Sums::zeros(map, &texels));
    for step in 0..options.steps {
        watcher.progress(Stage::Parallax, step, options.steps);
        if mean_size == 0.0 || watcher.stopped() {
            break;
        }
        // The pool's every prefix is well spread, and so is every run of it.
        let chosen: Vec<&[ViewSample]> = (0..options.views_per_step)
            .map(|i| views[(step * options.views_per_step + i) % views.len()].as_slice())
            .collect();
        sums.par_iter_mut().zip(chosen.par_chunks(together)).for_each(|(sums, views)| {
            (sums.loss, sums.map) = (0.0, map.zeros_like());
            views.iter().for_each(|pixels| backend.view_gradient(pixels, map, &texels, brdf, display, sums));
        });
        let count: usize = chosen.iter().map(|pixels| pixels.len()).sum();
        let value = sums.iter().map(|s| s.loss).sum::<f64>() / (3 * count.max(1)) as f64;
        watcher.message(Message::Loss { stage: Stage::Parallax, value, is_first: losses.is_empty() });
        losses.push(value);
        let share = rate_at(step, options.steps);
        // Texels' sums are left as zeros for the next step.
        if let [first, others @ ..] = sums.as_mut_slice() {
            gather(&mut first.texels, others.iter_mut().map(|s| s.texels.as_mut_slice()));
            adam_texels.step(texels.texels.as_flattened_mut(), first.texels.as_flattened(), share);
            first.texels.par_chunks_mut(BAND).for_each(|band| band.fill([Vec4::ZERO; N]));
        }
        texels.bring_back();
        let bending = options.bending * losses.first().copied().unwrap_or(0.0) as f32;
        let mut to_maps: Vec<Vec<Vec4>> = sums.iter().map(|s| s.map.parameters()).collect();
        to_maps.extend(plate.as_ref().map(|plate| plate.pull(map, bending * count as f32)));
        let stride = |i: usize| parameter_scales.get(i).copied().unwrap_or(Vec4::ONE);
        let to_map: Vec<Vec4> = (0..moving.len())
            .into_par_iter()
            .map(|i| stride(i) * to_maps.iter().map(|m| m[i]).sum::<Vec4>())
            .collect();
        adam_map.step(&mut moving, &to_map, share);
        let moved: Vec<Vec4> = moving.iter().enumerate().map(|(i, x)| *x * stride(i)).collect();
        map.set_parameters(&moved);
        // Those that were held in their range must not wander on beyond it.
        moving = in_strides(map.parameters());
        if let Some(coefficients) = map.coefficients().filter(|_| watcher.wants_snapshot()) {
            texels.write(maps);
            let parallax = Some(PackedParallax::new(|images| coefficients.pack(images)));
            watcher.snapshot(Snapshot::Maps { maps: all_at_most(maps, MOST_TEXELS), parallax });
        }
    }
    texels.write(maps);
    watcher.progress(Stage::Parallax, options.steps, options.steps);
    losses
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects views: none is left without a buffer, and large textures share theirs.
    #[test]
    fn buffers_hold_all_views() {
        for (size, together) in [(16, 1), (128, 1), (512, 3), (4096, 3)] {
            assert_eq!(views_together(size * size, 2, 12), together, "{size}²");
        }
    }
}
