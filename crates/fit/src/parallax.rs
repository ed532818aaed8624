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

use crate::canvas::Canvas;
use crate::color::respond;
use crate::reference::Reference;
use crate::samples::{packed, unpacked};
use crate::view_walk::Walker;
use crate::watch::{Stage, Watch};
use parbake_adam::{Adam, AdamOptions, rate_at};
use parbake_model::Wrap;
use parbake_model::glam::{Vec2, Vec3, Vec4};
use parbake_render::display_table::DisplayTable;
use parbake_render::parallax::{ShParallax, Sight};
use parbake_render::parallax_variants::shift_map::{ShiftMap, Vantage};
use parbake_render::shade::cosine_with_derivative;
use parbake_render::texture::{Taps, taps};
use plate::MapPlate;
use rayon::prelude::*;

/// How the map is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallaxOptions {
    /// Highest order of the functions, 0 to 7.
    pub order: usize,
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
    pub indifference: f32,
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
            order: 2,
            size: 64,
            steps: 240,
            views_per_step: 12,
            rate: 5e-4,
            indifference: 3e-4,
            bending: 400.0,
            texture_rate: 0.01,
        }
    }
}

/// One pixel of a training view before its coordinate is shifted, as in `Sample`.
#[derive(Clone, Copy, Debug)]
pub struct Sighted {
    uv: Vec2,
    /// Direction to the viewer and cosine, in 32767ths.
    sight: [i16; 4],
    light: [i16; 9],
    target: [u16; 3],
    weight: u16,
}

const STEP: f32 = 1.0 / 32767.0;

impl Sighted {
    #[inline]
    fn sight(&self) -> Sight {
        let [x, y, z, cosine] = self.sight.map(|v| f32::from(v) * STEP);
        Sight { direction: Vec3::new(x, y, z), cosine }
    }
}

/// The pixels of each of these views.
pub fn sighted_views(walker: &Walker, references: &[Reference]) -> Vec<Vec<Sighted>> {
    let rounded = |x: f32| (x.clamp(-1.0, 1.0) * 32767.0).round_ties_even() as i16;
    (references.par_iter())
        .map(|reference| {
            let mut out = Vec::with_capacity(reference.pixels.len() / 3);
            walker.walk(reference, |seen| {
                let [x, y, z] = seen.sight.direction.to_array();
                out.push(Sighted {
                    uv: seen.uv,
                    sight: [x, y, z, seen.sight.cosine].map(rounded),
                    light: packed(&seen.light),
                    target: seen.target,
                    weight: seen.weight,
                });
            });
            out
        })
        .collect()
}

/// What moves together.
#[derive(Clone, Debug)]
pub struct State<M = ShParallax> {
    /// The map.
    pub map: M,
    /// Albedo, 0 … 1.
    pub color: Canvas,
    /// Unit tangent-space normals.
    pub normal: Canvas,
}

/// Loss and gradients of some views; textures' lie in buffers that are used again in every step.
struct Part<M> {
    loss: f64,
    map: M,
    color: Vec<Vec4>,
    normal: Vec<Vec4>,
}

/// Texels of one task.
const BAND: usize = 4096;

impl<M: ShiftMap> Part<M> {
    fn zeros(state: &State<M>) -> Self {
        let texels = vec![Vec4::ZERO; state.color.texels.len()];
        Self { loss: 0.0, map: state.map.zeros_like(), color: texels.clone(), normal: texels }
    }

    fn clear(&mut self, state: &State<M>) {
        self.loss = 0.0;
        self.map = state.map.zeros_like();
        self.color.fill(Vec4::ZERO);
        self.normal.fill(Vec4::ZERO);
    }

    /// Adds the textures' gradients of other parts, one after the other.
    fn gather_textures(&mut self, others: &[Self]) {
        let add = |into: &mut [Vec4], of: fn(&Self) -> &[Vec4]| {
            into.par_chunks_mut(BAND).enumerate().for_each(|(band, into)| {
                for other in others {
                    let from = of(other).get(band * BAND..).unwrap_or_default();
                    into.iter_mut().zip(from).for_each(|(into, from)| *into += *from);
                }
            });
        };
        add(&mut self.color, |part| &part.color);
        add(&mut self.normal, |part| &part.normal);
    }
}

/// Bytes of gradients beyond which views share buffers: more do not stay in a cache, and then
/// clearing and summing them costs more than the views do.
const BUFFERS: usize = 16 << 20;
/// Buffers at least, however large: as many tasks as there are.
const LEAST_BUFFERS: usize = 4;

/// How many views share a buffer. It depends on sizes alone, and so does the order of sums.
fn views_in_part(texels: usize, views: usize) -> usize {
    let parts = (BUFFERS / (texels * size_of::<[Vec4; 2]>()).max(1)).max(LEAST_BUFFERS);
    views.div_ceil(parts).max(1)
}

/// The gradient of a bilinear fetch by its coordinate.
#[inline]
fn by_coordinate(canvas: &Canvas, at: &Taps, gradient: Vec4) -> Vec2 {
    let [a, b, c, d] = at.index.map(|i| canvas.texels[i as usize].dot(gradient));
    let size = canvas.size as f32;
    Vec2::new((b - a) * (1.0 - at.fy) + (d - c) * at.fy, (c - a) * (1.0 - at.fx) + (d - b) * at.fx) * size
}

/// Adds half the gradient of the squared differences of one view.
fn add_view<M: ShiftMap>(samples: &[Sighted], state: &State<M>, display: &DisplayTable, part: &mut Part<M>) {
    let State { map, color, normal } = state;
    let size = color.size;
    for sample in samples {
        let light = unpacked(sample.light);
        let from = Vantage::under_headlight(sample.sight(), &light);
        let uv = sample.uv + map.shift(sample.uv, &from);
        let at = taps(uv, size, size, [Wrap::Repeat; 2]);
        let (places, weights) = (at.index.map(|i| i as usize), at.weights());
        let albedo = color.fetch(places, weights);
        let (k, per_normal) = cosine_with_derivative(&light, normal.fetch(places, weights).truncate());
        let [r, g, b] = sample.target.map(|t| f32::from(t) * (1.0 / 65535.0));
        let response = respond(display, albedo * k.max(0.0), Vec4::new(r, g, b, 0.0));
        let weight = f32::from(sample.weight) * (1.0 / 65535.0);
        part.loss += f64::from(response.residual.length_squared() * weight);
        let to_light = response.residual * response.slope * weight;
        let to_k = to_light.dot(albedo);
        // Turned away from the light: only asked to turn back, see `normal.rs`.
        let to_color = if k > 0.0 { to_light * k } else { Vec4::ZERO };
        let to_normal = if k > 0.0 || to_k < 0.0 { (per_normal * to_k).extend(0.0) } else { Vec4::ZERO };
        for (place, weight) in places.into_iter().zip(weights) {
            part.color[place] += to_color * weight;
            part.normal[place] += to_normal * weight;
        }
        let to_shift = by_coordinate(color, &at, to_color) + by_coordinate(normal, &at, to_normal);
        map.adjoint_of_maps(sample.uv, &from, to_shift, &mut part.map);
    }
}

/// The mean squared difference of these views as they are.
pub fn mean_square<M: ShiftMap>(views: &[Vec<Sighted>], state: &State<M>, display: &DisplayTable) -> f64 {
    let loss_of = |samples: &Vec<Sighted>| {
        let mut part = Part::zeros(state);
        add_view(samples, state, display, &mut part);
        part.loss
    };
    let losses: Vec<f64> = views.par_iter().map(loss_of).collect();
    let count: usize = views.iter().map(Vec::len).sum();
    losses.iter().sum::<f64>() / (3 * count.max(1)) as f64
}

/// Moves all three; returns the mean squared difference of each step's views.
pub fn fit_parallax<M: ShiftMap>(
    views: &[Vec<Sighted>],
    state: &mut State<M>,
    display: &DisplayTable,
    options: &ParallaxOptions,
    watch: &impl Watch,
) -> Vec<f64> {
    let texels = state.color.texels.len();
    let at_rate = |rate| AdamOptions { rate, ..AdamOptions::default() };
    // Adam sees parameters in units of their strides, and moves all of those alike.
    let strides = state.map.strides();
    let in_strides = |mut lanes: Vec<Vec4>| {
        lanes.iter_mut().zip(&strides).for_each(|(lane, stride)| *lane /= *stride);
        lanes
    };
    let mut moving = in_strides(state.map.parameters());
    let mean_size = views.iter().map(Vec::len).sum::<usize>() as f32 / views.len().max(1) as f32;
    let map_options = AdamOptions {
        epsilon: options.indifference * mean_size * options.views_per_step as f32,
        ..at_rate(options.rate * state.map.pace())
    };
    let mut adam_map = Adam::new(moving.len(), map_options);
    let mut adam_color = Adam::new(texels, at_rate(options.texture_rate));
    let mut adam_normal = Adam::new(texels, at_rate(options.texture_rate));
    let plate = MapPlate::new(views, &state.map);
    let mut losses = Vec::with_capacity(options.steps);
    let together = views_in_part(texels, options.views_per_step);
    let mut parts: Vec<Part<M>> = Vec::new();
    parts.resize_with(options.views_per_step.div_ceil(together), || Part::zeros(state));
    for step in 0..options.steps {
        watch.progress(Stage::Parallax, step, options.steps);
        if mean_size == 0.0 || watch.should_stop() {
            break;
        }
        // The pool's every prefix is well spread, and so is every run of it.
        let chosen: Vec<&[Sighted]> = (0..options.views_per_step)
            .map(|i| views[(step * options.views_per_step + i) % views.len()].as_slice())
            .collect();
        parts.par_iter_mut().zip(chosen.par_chunks(together)).for_each(|(part, views)| {
            part.clear(state);
            views.iter().for_each(|samples| add_view(samples, state, display, part));
        });
        let count: usize = chosen.iter().map(|samples| samples.len()).sum();
        losses.push(parts.iter().map(|p| p.loss).sum::<f64>() / (3 * count.max(1)) as f64);
        let share = rate_at(step, options.steps);
        if let [first, others @ ..] = parts.as_mut_slice() {
            first.gather_textures(others);
            adam_color.step(&mut state.color.texels, &first.color, share);
            adam_normal.step(&mut state.normal.texels, &first.normal, share);
        }
        state.color.texels.par_iter_mut().with_min_len(BAND).for_each(|texel| {
            *texel = texel.clamp(Vec4::ZERO, Vec4::ONE);
        });
        state.normal.texels.par_iter_mut().with_min_len(BAND).for_each(|texel| {
            let [x, y, z, _] = texel.to_array();
            *texel = Vec3::new(x, y, z.max(0.02)).normalize().extend(0.0);
        });
        let bending = options.bending * losses.first().copied().unwrap_or(0.0) as f32;
        let mut to_maps: Vec<Vec<Vec4>> = parts.iter().map(|p| p.map.parameters()).collect();
        to_maps.extend(plate.as_ref().map(|plate| plate.pull(&state.map, bending * count as f32)));
        let stride = |i: usize| strides.get(i).copied().unwrap_or(Vec4::ONE);
        let to_map: Vec<Vec4> = (0..moving.len())
            .into_par_iter()
            .map(|i| stride(i) * to_maps.iter().map(|m| m[i]).sum::<Vec4>())
            .collect();
        adam_map.step(&mut moving, &to_map, share);
        let moved: Vec<Vec4> = moving.iter().enumerate().map(|(i, x)| *x * stride(i)).collect();
        state.map.set_parameters(&moved);
        // Those that were held in their range must not wander on beyond it.
        moving = in_strides(state.map.parameters());
    }
    watch.progress(Stage::Parallax, options.steps, options.steps);
    losses
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake_render::parallax_variants::shift_map::Unshifted;

    fn part(texels: usize, value: f32) -> Part<Unshifted> {
        let (color, normal) = (vec![Vec4::splat(value); texels], vec![Vec4::splat(-value); texels]);
        Part { loss: 0.0, map: Unshifted, color, normal }
    }

    /// Protects gradients: none is lost at the seams of bands, and no view is left without a buffer.
    #[test]
    fn parts_add_up_and_hold_all_views() {
        let texels = 2 * BAND + 7;
        let mut first = part(texels, 1.0);
        first.gather_textures(&[part(texels, 2.0), part(texels, 4.0)]);
        assert!(first.color.iter().all(|g| *g == Vec4::splat(7.0)));
        assert!(first.normal.iter().all(|g| *g == Vec4::splat(-7.0)));
        for (size, together) in [(16, 1), (128, 1), (512, 3), (4096, 3)] {
            assert_eq!(views_in_part(size * size, 12), together, "{size}²");
        }
    }
}
