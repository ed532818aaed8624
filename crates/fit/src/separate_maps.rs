//! Maps of which none depends on another: each is fitted by itself, one after the other, so that only one
//! of them and its matrix are in memory, and none is solved for longer than it needs.
//!
//! Metal, roughness, occlusion and normals are linear in what they are compared by
//! (`material_problem.rs`), so one matrix says all that the samples say of them, and one long solve finds what
//! many rounds of short ones would. Colours and emission are compared as sRGB, whose slope changes on the
//! way: they take a few Gauss–Newton steps. Rounding one map to eight bits leaves the others alone, so nothing
//! is solved again after it. Roughness alone waits for another map: what the fitted normals do not show of the
//! high-poly's makes highlights wider (`normal_spread.rs`).

use crate::backend::Backend;
use crate::material_problem::MaterialProblem;
use crate::membrane::Membrane;
use crate::normal_spread::widen_highlights;
use crate::schedule::{Fitted, LossPoint, Move, Schedule, fit_maps};
use parbake_image::quantise::from_image;
use parbake_image::{MapKind, MapSet};
use parbake_progress::{Portion, Watcher};
use parbake_solve::conjugate_gradient::Effort;
use parbake_views::chart_labels::Atlas;
use parbake_views::material_sample::MaterialSample;
use parbake_views::samples::SampleSet;

/// How much work each map gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeparateSchedule {
    /// Whether maps are fitted at all; else the projected ones are kept.
    pub is_fitted: bool,
    /// Gauss–Newton steps of base colour and emission, which are compared as sRGB.
    pub color_steps: usize,
    /// Steps of the normals, each put back onto their hemisphere; 0 keeps the projected ones.
    pub normal_steps: usize,
    /// Limits of a linear solve.
    pub effort: Effort,
    /// What holds texels that few views see.
    pub membrane: Membrane,
}

/// Least stiffness of the membrane. With two samples a texel some show another part of the model, and each alone would
/// decide what its texel is: bright specks on metal. With ten samples a texel or more it counts little, except for white colours
/// and for the metallic channel of black ones, whose samples pull less. Four times as much costs up to 0.15 dB; a stiffness in
/// proportion to the mean pull of a map's samples costs 0.2 to 0.3 dB (docs/figures.md).
const LEAST_STIFFNESS: f32 = 0.5;

impl Default for SeparateSchedule {
    /// Measured on a barrel of 250,000 texels: a third step of colours, a sixth of normals and more than a
    /// dozen steps of the linear solver change less than 0.005 dB.
    fn default() -> Self {
        Self {
            is_fitted: true,
            color_steps: 2,
            normal_steps: 5,
            effort: Effort { steps: 12, tolerance: 1e-3 },
            membrane: Membrane { stiffness: 1e-2, least: LEAST_STIFFNESS, tether: 1e-5 },
        }
    }
}

impl SeparateSchedule {
    /// One map's own.
    fn of(&self, kind: MapKind) -> Schedule {
        let color_steps = match kind {
            MapKind::BaseColor | MapKind::Emissive => self.color_steps,
            MapKind::Normal | MapKind::MetallicRoughness | MapKind::Occlusion => 1,
        };
        Schedule {
            rounds: usize::from(self.is_fitted),
            color_steps,
            normal_steps: self.normal_steps,
            final_steps: 0,
            effort: self.effort,
            color_membrane: self.membrane,
            normal_membrane: self.membrane,
            damping: 0.0,
            ..Schedule::default()
        }
    }
}

/// Fits all maps that the start has to what the samples saw of the high-poly's, beginning there; all are
/// `samples.size`² texels. `srgb` tells whether files hold sRGB of colours. A watcher that stops it leaves the maps
/// that were not reached as they are in the start. The samples' roughness is widened.
pub fn fit_separate_maps<K: Backend>(
    samples: &mut SampleSet<MaterialSample>,
    atlas: &Atlas,
    start: &MapSet,
    backend: &K,
    srgb: bool,
    schedule: &SeparateSchedule,
    watcher: &dyn Watcher,
) -> Fitted {
    let kinds: Vec<MapKind> = start.kinds().collect();
    let mut fits = Vec::with_capacity(kinds.len());
    for (place, &kind) in kinds.iter().enumerate() {
        let problem = MaterialProblem::new(samples, atlas, [kind].into_iter());
        let share = |maps: usize| maps as f64 / kinds.len() as f64;
        let own = Portion::new(watcher, share(place)..share(place + 1));
        let fitted = fit_maps(&problem, &start.only(kind), backend, srgb, &schedule.of(kind), &own);
        // Roughness comes after normals.
        let own = fitted.images.iter().find(|(own, _)| *own == MapKind::Normal);
        if let Some((_, image)) = own.filter(|_| start.get(MapKind::MetallicRoughness).is_some()) {
            widen_highlights(samples, &from_image(MapKind::Normal, image, srgb));
        }
        fits.push(fitted);
    }
    Fitted {
        losses: joined(&fits),
        covered: fits.first().map_or(0, |fit| fit.covered),
        unseen: fits.first().map_or(0, |fit| fit.unseen),
        stopped: fits.iter().any(|fit| fit.stopped),
        images: fits.into_iter().flat_map(|fit| fit.images).collect(),
    }
}

/// The loss of all maps while one after the other moved: the sum of what each had last.
fn joined(fits: &[Fitted]) -> Vec<LossPoint> {
    let mut own: Vec<f64> =
        fits.iter().map(|fit| fit.losses.first().map_or(0.0, |loss| loss.mean_square)).collect();
    let point = |moved, seconds, own: &[f64]| LossPoint { moved, seconds, mean_square: own.iter().sum() };
    let mut points = vec![point(Move::Start, 0.0, &own)];
    let (mut since, mut rounded) = (0.0, own.clone());
    for (place, fit) in fits.iter().enumerate() {
        for loss in &fit.losses {
            rounded[place] = loss.mean_square;
            if let Move::Map(_) = loss.moved {
                own[place] = loss.mean_square;
                points.push(point(loss.moved, since + loss.seconds, &own));
            }
        }
        since += fit.losses.last().map_or(0.0, |loss| loss.seconds);
    }
    points.push(point(Move::Rounding, since, &rounded));
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::Cpu;
    use parbake_image::{FloatImage, MapValues};
    use parbake_model::glam::{Vec4, vec2};
    use parbake_progress::Message;
    use std::sync::Mutex;

    const SIZE: usize = 8;

    /// Every texel seen once from above, with this colour, roughness and normal.
    fn scene(color: f32, roughness: f32, normal: Vec4) -> (SampleSet<MaterialSample>, Atlas, MapSet) {
        let mut values = MapValues::NEUTRAL;
        values[MapKind::BaseColor] = Vec4::new(color, color, color, 1.0);
        values[MapKind::MetallicRoughness] = Vec4::new(0.0, roughness, 0.0, 0.0);
        values[MapKind::Normal] = normal;
        let at = |texel: usize| vec2((texel % SIZE) as f32 + 0.5, (texel / SIZE) as f32 + 0.5) / SIZE as f32;
        let band = (0..SIZE * SIZE).map(|i| MaterialSample::new(at(i), SIZE, &values, [1.0, 0.0])).collect();
        let atlas = Atlas { size: SIZE, label: vec![0; SIZE * SIZE], covered: vec![true; SIZE * SIZE] };
        let mut start =
            MapSet::of(FloatImage::solid(SIZE, Vec4::splat(0.5)), FloatImage::solid(SIZE, Vec4::Z));
        start.insert(MapKind::MetallicRoughness, FloatImage::solid(SIZE, Vec4::splat(0.5)));
        (SampleSet::new(SIZE, &[band]), atlas, start)
    }

    #[derive(Default)]
    struct Log(Mutex<Vec<(usize, usize)>>);

    impl Watcher for Log {
        fn message(&self, message: Message) {
            if let (Message::Progress { done, total, .. }, Ok(mut log)) = (message, self.0.lock()) {
                log.push((done, total));
            }
        }
    }

    /// Protects each map, the normals that turn by more than one step may, and the account of it: the loss
    /// never rises, begins with that of all maps, and ends near none; progress is that of all maps together.
    #[test]
    fn each_map_is_found_and_the_losses_add_up() {
        let normal = Vec4::new(0.8, 0.0, 0.6, 0.0);
        let (mut samples, atlas, start) = scene(0.25, 0.3, normal);
        let log = Log::default();
        let fitted =
            fit_separate_maps(&mut samples, &atlas, &start, &Cpu, true, &SeparateSchedule::default(), &log);
        let texel =
            |kind| fitted.images.iter().find(|(own, _)| *own == kind).map(|(_, image)| image.pixels[27]);
        let [red, ..] = texel(MapKind::BaseColor).expect("it was fitted");
        let [_, roughness, ..] = texel(MapKind::MetallicRoughness).expect("it was fitted");
        let [x, _, z, _] = texel(MapKind::Normal).expect("it was fitted");
        assert!(red.abs_diff(137) <= 1 && roughness.abs_diff(77) <= 1, "{red} {roughness}");
        assert!(x.abs_diff(230) <= 2 && z.abs_diff(204) <= 2, "{x} {z}");
        let losses: Vec<f64> = fitted.losses.iter().map(|loss| loss.mean_square).collect();
        // Of the three maps, over three channels of each sample.
        let srgb = parbake_image::display::encode_srgb;
        let color = (srgb(0.5) - srgb(0.25)).powi(2);
        let rough = (0.2f32.powi(2) + 0.5f32.powi(2) * srgb(0.25)) / 3.0;
        let turn = (Vec4::Z - normal).length_squared() / 3.0;
        assert!((losses[0] - f64::from(color + turn + rough)).abs() < 2e-3, "{losses:?}");
        assert!(losses[..losses.len() - 1].windows(2).all(|pair| pair[1] <= pair[0] + 1e-9), "{losses:?}");
        assert!(losses[losses.len() - 1] < 1e-4, "{losses:?}");
        let progress = log.0.into_inner().expect("no thread failed");
        assert!(progress.windows(2).all(|pair| share(pair[0]) <= share(pair[1])));
        assert_eq!(progress.last().map(|&last| share(last)), Some(1.0));
    }

    /// Protects smooth metal from specks: where each texel has one sample, one that shows another part of the model turns its
    /// texel less than half as far; where each has many, and all of a texel say so, it does turn.
    #[test]
    fn a_stray_sample_is_outvoted_where_there_are_few() {
        for (count, is_kept) in [(1, false), (40, true)] {
            let (_, atlas, start) = scene(0.25, 0.3, Vec4::Z);
            let stray = 3 * SIZE + 3;
            let mut values = MapValues::NEUTRAL;
            values[MapKind::BaseColor] = Vec4::new(0.25, 0.25, 0.25, 1.0);
            let band: Vec<MaterialSample> = (0..SIZE * SIZE)
                .flat_map(|texel| {
                    let at = vec2((texel % SIZE) as f32 + 0.5, (texel / SIZE) as f32 + 0.5) / SIZE as f32;
                    let mut own = values;
                    own[MapKind::Normal] =
                        if texel == stray { Vec4::new(0.8, 0.0, 0.6, 0.0) } else { Vec4::Z };
                    std::iter::repeat_n(MaterialSample::new(at, SIZE, &own, [1.0, 0.0]), count)
                })
                .collect();
            let mut samples = SampleSet::new(SIZE, &[band]);
            let schedule = SeparateSchedule::default();
            let fitted = fit_separate_maps(&mut samples, &atlas, &start, &Cpu, true, &schedule, &());
            let normals = fitted.images.iter().find(|(kind, _)| *kind == MapKind::Normal);
            let x = f32::from(normals.expect("it was fitted").1.pixels[stray][0]) / 127.5 - 1.0;
            assert!(if is_kept { x > 0.7 } else { x < 0.4 }, "{count}: {x}");
        }
    }

    fn share((done, total): (usize, usize)) -> f64 {
        done as f64 / total as f64
    }
}
