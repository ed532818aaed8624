//! A level that is the smallest file of a PSNR: bakes for the search (`levels/search.rs`), and what their maps can do without
//! (`levels/maps.rs`).
//!
//! ```text
//! search ─ plan ─ triangles, bake ─ maps reduced one by one, pictures ─ reductions together, file, pictures ─ search
//! ```
//!
//! Contract: every figure of a trial is that of the file's own content, read back where its formats lose anything.

use super::chain::Chain;
use super::maker::{Draft, Maker};
use super::options::LodOptions;
use super::written::{AsWritten, as_written};
use crate::error::BakeError;
use parbake_evaluate::screen_size::{Pictures, ScreenComparison};
use parbake_files::NormalY;
use parbake_files::{TextureFormat, WriteOptions};
use parbake_levels::face_frames::with_face_tangents;
use parbake_levels::maps::{LevelMap, Reduction, level_maps, size_of, with_reductions};
use parbake_levels::screen::distance_of_pixels;
use parbake_levels::search::{Baking, Choice, Measured, Plan, Search, Step, Verdict, error_of};
use parbake_model::Model;
use parbake_simplify::start::triangles_within;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Decibels of a level whose surface is off by a quarter of a pixel, about; twice as far costs 6 dB.
const USUAL: f64 = 42.0;
/// Pixels that a level's surface may be off where more triangles show nothing.
const NOTHING: f64 = 0.05;
/// Texels along a side for each that a level has as a rule, about one a pixel, beyond which more show nothing.
const MORE_TEXELS: usize = 4;
/// Reductions that miss the target by so many decibels are not followed further.
const HOPELESS: f64 = 8.0;
/// Qualities of lossy textures that are tried below the one that was asked for.
const QUALITIES: [u8; 4] = [80, 65, 50, 35];

/// What became of a target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetReport {
    /// PSNR in dB that was asked for.
    pub psnr: f64,
    /// How the search ended.
    pub verdict: Verdict,
    /// Bakes that it took.
    pub bakes: usize,
    /// Most triangles that it might have used: all, those of the level before, or as many as show.
    pub most_triangles: usize,
    /// All files that were measured, in the order in which they were.
    pub trials: Vec<Trial>,
}

/// A file that was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Of which bake, from 0 on.
    pub bake: usize,
    /// Triangles.
    pub triangles: usize,
    /// Its maps.
    pub maps: Vec<TrialMap>,
    /// Quality of lossy textures; none where textures are lossless.
    pub texture_quality: Option<u8>,
    /// Bytes of the file.
    pub bytes: u64,
    /// PSNR in dB against the original at the level's size.
    pub psnr: f64,
    /// Whether that is the target at least.
    pub reached: bool,
    /// Whether it is the level.
    pub chosen: bool,
}

/// A map of a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialMap {
    /// Its image's name.
    pub name: String,
    /// Texels along a side; 0 where its mean stands for it as a factor.
    pub size: usize,
}

/// A level that was found.
pub(crate) struct Found {
    pub draft: Draft,
    pub write: WriteOptions,
    pub report: TargetReport,
}

/// Looks for the smallest file of a level; none where the watcher said stop before there was one to keep.
pub(crate) fn find(
    maker: &Maker,
    chain: &mut Chain,
    level: usize,
    finer: Option<&Model>,
    target: f64,
) -> Result<Option<Found>, BakeError> {
    let options = maker.options;
    let pixels = options.screen_size[level];
    let (first, most) = bounds(maker, level, finer, target);
    let mut search = Search::new(target, first, maker.least, most);
    let original = maker.screens.pictures(&maker.original, pixels)?;
    let until = chain.level_until(level);
    let mut tried: Vec<Tried> = Vec::new();
    let (mut stopped, mut longest, mut spent) = (false, 0f64, [0.0; 3]);
    while let Some(plan) = search.next() {
        let begin = Instant::now();
        let left = until.map_or(f64::INFINITY, |until| until.saturating_duration_since(begin).as_secs_f64());
        if !tried.is_empty() && left < longest {
            stopped = true;
            break;
        }
        let draft = maker.draft(
            chain,
            (level, tried.len()),
            finer,
            (plan.triangles, Some(plan.texture_size)),
            until,
        )?;
        // What a signal cut short is no trial.
        let Some(draft) = draft.filter(|_| !chain.stopped()) else {
            stopped = true;
            break;
        };
        let spent_now = draft.seconds;
        (0..2).for_each(|k| spent[k] += spent_now[k]);
        let own = Tried::new(draft, options);
        let (baking, measured) = own.measure(&maker.screens, &original, target, plan)?;
        search.note(baking, measured);
        tried.push(own);
        let all = begin.elapsed().as_secs_f64();
        spent[2] += all - spent_now[0] - spent_now[1];
        longest = longest.max(all);
    }
    let (verdict, best) = (search.verdict(stopped), search.best());
    let Some(best) = best.filter(|_| verdict != Verdict::Stopped || !chain.stopped()) else {
        return Ok(None);
    };
    let trials = (0..).zip(&search.outcomes);
    let trials = trials.map(|(k, found)| Trial {
        bake: found.bake,
        bytes: found.bytes,
        psnr: found.psnr,
        reached: found.psnr >= target,
        chosen: k == best,
        ..tried[found.bake].trial(&found.choice)
    });
    let report = TargetReport {
        psnr: target,
        verdict,
        bakes: search.bakes(),
        most_triangles: most.triangles,
        trials: trials.collect(),
    };
    let outcome = &search.outcomes[best];
    let Tried { mut draft, maps, qualities, write, .. } = tried.swap_remove(outcome.bake);
    draft.seconds = spent;
    draft.baked.model = with_reductions(&draft.baked.model, &maps, &reductions(&maps, &outcome.choice));
    let texture_quality = qualities[outcome.choice.get(maps.len()).copied().unwrap_or(0)];
    Ok(Some(Found { draft, write: WriteOptions { texture_quality, ..write }, report }))
}

/// What to bake first, and the most that there may be.
fn bounds(maker: &Maker, level: usize, finer: Option<&Model>, target: f64) -> (Plan, Plan) {
    let (high, options) = (&maker.high, maker.options);
    let pixels = options.screen_size[level];
    let within = |error: f64| triangles_within(high.scene.mesh(), distance_of_pixels(error, pixels) as f32);
    let all = finer.map_or(high.triangles, |low| low.mesh.triangles.len());
    let most = within(NOTHING).clamp(maker.least.min(all), all);
    let first = within(0.25 * 10f64.powf((USUAL - target) / 20.0)).min(most);
    let texture_size = maker.texture_size(maker.model, pixels);
    let most =
        Plan { triangles: most, texture_size: (MORE_TEXELS * texture_size).min(options.max_texture_size) };
    (Plan { triangles: first, texture_size }, most)
}

/// A bake whose maps may be reduced.
struct Tried {
    draft: Draft,
    maps: Vec<LevelMap>,
    /// The quality that was asked for, and lower ones if the format has any.
    qualities: Vec<u8>,
    write: WriteOptions,
    normal_y: NormalY,
}

impl Tried {
    fn new(draft: Draft, options: &LodOptions) -> Self {
        let maps = level_maps(&draft.baked.model);
        let write = options.write;
        let has_quality = matches!(
            write.texture_format,
            TextureFormat::Jpeg | TextureFormat::Webp | TextureFormat::Ktx2Etc1s
        );
        let lower = QUALITIES.into_iter().filter(|&quality| has_quality && quality < write.texture_quality);
        let qualities = std::iter::once(write.texture_quality).chain(lower).collect();
        Self { draft, maps, qualities, write, normal_y: options.normal_y }
    }

    /// What a choice is, without its figures.
    fn trial(&self, choice: &[usize]) -> Trial {
        let model = &self.draft.baked.model;
        let map = |(map, reduction): (&LevelMap, Reduction)| TrialMap {
            name: model.images[map.image].name.clone(),
            size: size_of(model, map, reduction),
        };
        let quality = self.qualities[choice.get(self.maps.len()).copied().unwrap_or(0)];
        Trial {
            bake: 0,
            triangles: model.mesh.triangles.len(),
            maps: self.maps.iter().zip(reductions(&self.maps, choice)).map(map).collect(),
            texture_quality: (!self.write.texture_format.is_lossless()).then_some(quality),
            bytes: 0,
            psnr: 0.0,
            reached: false,
            chosen: false,
        }
    }

    /// Measures each reduction by itself, then some together.
    fn measure(
        &self,
        screens: &ScreenComparison,
        original: &Pictures,
        target: f64,
        plan: Plan,
    ) -> Result<(Baking, Vec<Measured>), BakeError> {
        let model = &self.draft.baked.model;
        let psnr = |model: &Model| -> Result<f64, BakeError> {
            Ok(screens.psnr(original, &screens.place(&with_face_tangents(model))?))
        };
        let whole = error_of(psnr(model)?);
        let all = as_written(model, &self.write, self.normal_y)?.bytes;
        let bytes = self.bytes_of_maps(all)?;
        let mut maps: Vec<Vec<Step>> = Vec::new();
        for (place, map) in self.maps.iter().enumerate() {
            let mut steps: Vec<Step> = Vec::new();
            for (step, &reduction) in map.reductions.iter().enumerate() {
                let last = steps.last().map_or(0.0, |last| last.error);
                let error = if step == 0 {
                    0.0
                } else if whole + last > error_of(target - HOPELESS) {
                    2.0 * last
                } else {
                    let mut choice = vec![0; self.maps.len()];
                    choice[place] = step;
                    let reduced = with_reductions(model, &self.maps, &reductions(&self.maps, &choice));
                    (error_of(psnr(&reduced)?) - whole).max(0.0)
                };
                steps.push(Step { size: size_of(model, map, reduction), bytes: bytes[place][step], error });
            }
            maps.push(steps);
        }
        let mesh_bytes = all - bytes.iter().map(|steps| steps[0]).sum::<u64>().min(all);
        let triangles = model.mesh.triangles.len();
        let came = Plan { triangles, texture_size: self.draft.baked.report.options.texture_size };
        let baking = Baking { asked: plan, plan: came, mesh_bytes, error: whole, maps };
        let file = |choice: &Choice, quality: usize| -> Result<(u64, f64), BakeError> {
            let reduced = with_reductions(model, &self.maps, &reductions(&self.maps, choice));
            let write = WriteOptions { texture_quality: self.qualities[quality], ..self.write };
            let AsWritten { model, bytes } = as_written(&reduced, &write, self.normal_y)?;
            Ok((bytes, psnr(&model)?))
        };
        let mut measured = baking.measured(target, |choice| file(choice, 0))?;
        let reached = measured.iter().filter(|own| own.psnr >= target);
        if let Some(choice) = reached.min_by_key(|own| own.bytes).map(|own| own.choice.clone()) {
            for quality in 1..self.qualities.len() {
                let (bytes, psnr) = file(&choice, quality)?;
                measured.push(Measured { choice: [&choice[..], &[quality]].concat(), bytes, psnr });
                if psnr < target {
                    break;
                }
            }
        }
        Ok((baking, measured))
    }

    /// Bytes of each map after each of its reductions; `all` is the file's with none. What goes with a map, as tangents
    /// with normals, counts with it.
    fn bytes_of_maps(&self, all: u64) -> Result<Vec<Vec<u64>>, BakeError> {
        let model = &self.draft.baked.model;
        let mut bytes: Vec<Vec<u64>> = vec![Vec::new(); self.maps.len()];
        let halvings = |map: &LevelMap| map.reductions.iter().filter(|r| **r != Reduction::Factor).count();
        for times in 0..self.maps.iter().map(halvings).max().unwrap_or(0) {
            let all: Vec<Reduction> =
                self.maps.iter().map(|map| Reduction::Halved([times.min(halvings(map) - 1); 2])).collect();
            let reduced = with_reductions(model, &self.maps, &all);
            let (_, written) = parbake_files::glb_bytes_with(&reduced, &self.write)?;
            for (own, map) in bytes.iter_mut().zip(&self.maps).filter(|(_, map)| times < halvings(map)) {
                let name = &model.images[map.image].name;
                own.push(written.textures.iter().find(|t| t.name == *name).map_or(0, |t| t.bytes));
            }
        }
        for (place, map) in self.maps.iter().enumerate() {
            if let Some(step) = map.reductions.iter().position(|r| *r == Reduction::Factor) {
                let mut choice = vec![0; self.maps.len()];
                choice[place] = step;
                let without = with_reductions(model, &self.maps, &reductions(&self.maps, &choice));
                let without = parbake_files::glb_bytes_with(&without, &self.write)?.1.bytes;
                let besides = all.saturating_sub(without).saturating_sub(bytes[place][0]);
                bytes[place].iter_mut().for_each(|own| *own += besides);
            }
            bytes[place].resize(map.reductions.len(), 0);
        }
        Ok(bytes)
    }
}

fn reductions(maps: &[LevelMap], choice: &[usize]) -> Vec<Reduction> {
    maps.iter().zip(choice).map(|(map, &step)| map.reductions[step]).collect()
}
