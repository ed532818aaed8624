//! Makes an experiment: reads its files, runs the product as its command would, writes the result,
//! reads it back, and compares what the file shows.
//!
//! Contract: seconds run from reading to writing and leave the comparison out. Asked to stop, it
//! returns nothing rather than half a result.

use crate::error::ReproduceError;
use crate::experiment::{Experiment, Recipe, Subject};
use crate::observer::Observer;
use crate::outcome::{BACKGROUNDS, Outcome, Point, Score};
use crate::plane::{as_shown, wanted};
use crate::relighting::relight;
use crate::variants::{VariantsOptions, compare_variants};
use image::imageops::FilterType;
use parbake::{
    BakeError, BakeOptions, BakeReport, EvaluateOptions, ImageOptions, Limits, PictureUv, Shading, UvMode,
    Watcher, bake, bake_image, compress, encode_png, evaluate_on, laid_out, read_image, read_model,
    simplified, subdivided, wall_pair, write_file, write_glb,
};
use parbake_metric::{Rgb, mean_squared_error, ms_ssim, psnr_from_mse};
use parbake_model::{Image, Model};
use std::path::Path;
use std::time::Instant;

/// Passes the wish to stop on to the product.
struct Stop<'a, O: Observer>(&'a O);

impl<O: Observer> Watcher for Stop<'_, O> {
    fn stopped(&self) -> bool {
        self.0.stopped()
    }
}

/// The file that holds a result's model in its place.
pub const MODEL: &str = "model.glb";

/// Makes an experiment in its place; none where it was asked to stop.
///
/// # Errors
/// Where a file cannot be read or written, or a model cannot be baked.
pub fn perform(
    experiment: &Experiment,
    place: &Path,
    evaluate: &EvaluateOptions,
    observer: &impl Observer,
) -> Result<Option<Outcome>, ReproduceError> {
    std::fs::create_dir_all(place).map_err(ReproduceError::disk(place))?;
    let run = Run { place, evaluate, stop: Stop(observer), begin: Instant::now() };
    let made = match (&experiment.recipe, &experiment.subject) {
        (Recipe::Bake { options, start, subdivided }, Subject::Pair { high, low, .. }) => {
            run.bake(high, low, options, *start, *subdivided)
        }
        (Recipe::Compress { options }, Subject::Model { path, .. }) => run.compress(path, options),
        (Recipe::Relit { options, triangles }, Subject::Model { path, .. }) => {
            run.relit(path, options, *triangles)
        }
        (Recipe::Picture { options }, Subject::Picture { path }) => run.picture(path, options),
        (Recipe::Downsample { texture_size }, Subject::Picture { path }) => {
            run.downsample(path, *texture_size)
        }
        (Recipe::Variants { options }, Subject::Pair { high, low, .. }) => {
            run.models(high, low).and_then(|(high, low)| run.variants(&high, &low, options))
        }
        (Recipe::Variants { options }, Subject::Wall) => {
            let (high, low) = wall_pair();
            run.variants(&high, &low, options)
        }
        // No exhibit pairs others.
        _ => Ok(Outcome::default()),
    };
    if observer.stopped() {
        return Ok(None);
    }
    let title = experiment.title();
    let failed = |source| ReproduceError::Run { experiment: title.clone(), source: Box::new(source) };
    let mut outcome = made.map_err(failed)?;
    outcome.title = title;
    outcome.seconds_in_all = run.begin.elapsed().as_secs_f64();
    Ok(Some(outcome))
}

/// Where and how an experiment is made.
struct Run<'a, O: Observer> {
    place: &'a Path,
    evaluate: &'a EvaluateOptions,
    stop: Stop<'a, O>,
    begin: Instant,
}

fn model(path: &Path) -> Result<Model, BakeError> {
    Ok(read_model(path, &Limits::default())?.model)
}

impl<O: Observer> Run<'_, O> {
    fn models(&self, high: &Path, low: &Path) -> Result<(Model, Model), BakeError> {
        Ok((model(high)?, model(low)?))
    }

    fn bake(
        &self,
        high: &Path,
        low: &Path,
        options: &BakeOptions,
        start: Option<UvMode>,
        split: bool,
    ) -> Result<Outcome, BakeError> {
        let (high, mut low) = self.models(high, low)?;
        if split {
            low = subdivided(&low);
        }
        if let Some(mode) = start {
            low = laid_out(&low, mode, options.texture_size)?;
        }
        let baked = bake(&high, &low, options, &self.stop)?;
        let outcome = self.written(&baked.model, &baked.report)?;
        self.compared(&high, outcome)
    }

    fn compress(&self, path: &Path, options: &BakeOptions) -> Result<Outcome, BakeError> {
        let high = model(path)?;
        let baked = compress(&high, options, &self.stop)?;
        let outcome = self.written(&baked.model, &baked.report)?;
        self.compared(&high, outcome)
    }

    fn relit(&self, path: &Path, options: &BakeOptions, triangles: usize) -> Result<Outcome, BakeError> {
        let high = model(path)?;
        let low = simplified(&high, triangles.min(high.mesh.triangles.len() / 2));
        let baked = bake(&high, &low, options, &self.stop)?;
        let mut outcome = self.written(&baked.model, &baked.report)?;
        let plain = BakeOptions { shading: Shading::Lambert, ..options.clone() };
        let without = bake(&high, &low, &plain, &self.stop)?.model;
        let all = model(&self.place.join(MODEL))?;
        let models = [("ray-cast", &baked.ray_cast), ("without", &without), ("all maps", &all)];
        let found = relight(&high, &models, self.evaluate)?;
        for (variant, pictures) in found.pictures.iter().enumerate() {
            for (side, picture) in pictures.iter().enumerate() {
                let png = encode_png(&as_image(picture))?;
                write_file(&self.place.join(variant_file(variant, side)), &png)?;
            }
        }
        outcome.relit = found.figures;
        Ok(outcome)
    }

    /// Writes a model and takes down what its bake saw.
    fn written(&self, model: &Model, report: &BakeReport) -> Result<Outcome, BakeError> {
        let path = self.place.join(MODEL);
        write_glb(&path, model)?;
        let sound = &report.uv.orientations;
        let history = report.uv_stage.as_ref().and_then(|uv_stage| uv_stage.convergence.as_ref());
        Ok(Outcome {
            seconds: self.begin.elapsed().as_secs_f64(),
            bytes: std::fs::metadata(&path).map_or(0, |data| data.len()),
            unsound: sound.flipped.count + sound.degenerate.count + report.uv.overlaps.pairs,
            iterations: history.map_or(0, |h| h.points.last().map_or(0, |p| p.0))
                + report.shape.as_ref().map_or(0, |shape| shape.steps),
            convergence: history.map(points).unwrap_or_default(),
            warnings: report.warnings.clone(),
            ..Outcome::default()
        })
    }

    /// Compares the file that was written.
    fn compared(&self, high: &Model, mut outcome: Outcome) -> Result<Outcome, BakeError> {
        let low = model(&self.place.join(MODEL))?;
        let found = evaluate_on(high, &low, self.evaluate, &BACKGROUNDS, &self.stop)?;
        outcome.scores = (found.iter())
            .map(|e| Score { seen: e.options.background.clone(), psnr: e.mean.psnr, ms_ssim: e.mean.ms_ssim })
            .collect();
        Ok(outcome)
    }

    fn picture(&self, path: &Path, options: &ImageOptions) -> Result<Outcome, BakeError> {
        let picture = read_image(path, &Limits::default())?;
        let baked = bake_image(&picture, options, &self.stop)?;
        let file = self.place.join(MODEL);
        write_glb(&file, &baked.model)?;
        let (report, seconds) = (baked.report, self.begin.elapsed().as_secs_f64());
        let mut scores: Vec<Score> = ["full", "half", "quarter"]
            .iter()
            .zip(&report.written)
            .map(|(seen, psnr)| Score { seen: (*seen).into(), psnr: *psnr, ms_ssim: None })
            .collect();
        let shown = as_shown(&model(&file)?, &picture)?;
        if let Some(score) = scores.first_mut() {
            score.ms_ssim = ms_ssim(&wanted(&picture), &shown).ok().flatten();
        }
        let sound = &report.uv.orientations;
        Ok(Outcome {
            scores,
            seconds,
            bytes: std::fs::metadata(&file).map_or(0, |data| data.len()),
            unsound: sound.flipped.count + sound.degenerate.count + report.uv.overlaps.pairs,
            iterations: report.convergence.as_ref().map_or(0, |h| h.points.last().map_or(0, |p| p.0)),
            convergence: report.convergence.as_ref().map(points).unwrap_or_default(),
            ..Outcome::default()
        })
    }

    /// The paper's baseline: the picture scaled down, shown with bilinear filtering.
    fn downsample(&self, path: &Path, size: usize) -> Result<Outcome, BakeError> {
        let picture = read_image(path, &Limits::default())?;
        let plain = ImageOptions { texture_size: size, uv: PictureUv::Keep, ..ImageOptions::default() };
        let mut plane = bake_image(&picture, &plain, &self.stop)?.model;
        for image in &mut plane.images {
            *image = scaled(&picture, size);
        }
        let file = self.place.join(MODEL);
        write_glb(&file, &plane)?;
        let seconds = self.begin.elapsed().as_secs_f64();
        let (wanted, shown) = (wanted(&picture), as_shown(&model(&file)?, &picture)?);
        let psnr = psnr_from_mse(mean_squared_error(&wanted, &shown).unwrap_or(f64::NAN));
        let score = Score { seen: "full".into(), psnr, ms_ssim: ms_ssim(&wanted, &shown).ok().flatten() };
        Ok(Outcome { scores: vec![score], seconds, ..Outcome::default() })
    }

    fn variants(&self, high: &Model, low: &Model, options: &VariantsOptions) -> Result<Outcome, BakeError> {
        let compared = compare_variants(high, low, options, &self.stop)?;
        let seconds = self.begin.elapsed().as_secs_f64();
        let all = std::iter::once(&compared.high).chain(&compared.pictures);
        for (variant, sides) in all.enumerate() {
            for (side, picture) in sides.iter().enumerate() {
                let png = encode_png(&as_image(picture))?;
                write_file(&self.place.join(variant_file(variant, side)), &png)?;
            }
        }
        Ok(Outcome { seconds, variants: compared.report.variants, ..Outcome::default() })
    }
}

/// The file of a variant's picture; variant 0 is the high-poly.
pub fn variant_file(variant: usize, side: usize) -> String {
    format!("{variant}-{side}.png")
}

fn points(history: &parbake::Convergence) -> Vec<Point> {
    let moves = |iteration| iteration > history.moved[0] && iteration <= history.moved[1];
    let point = |&(iteration, loss, content): &(usize, f64, f64)| Point {
        iteration,
        loss,
        content,
        moving: moves(iteration),
    };
    history.points.iter().map(point).collect()
}

fn as_image(picture: &Rgb) -> Image {
    let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    let pixels = picture.pixels.iter().map(|&[r, g, b]| [byte(r), byte(g), byte(b), 255]).collect();
    Image { name: "picture".into(), width: picture.width, height: picture.height, pixels }
}

/// The picture at another size.
fn scaled(picture: &Image, size: usize) -> Image {
    let bytes: Vec<u8> = picture.pixels.iter().flatten().copied().collect();
    let side = size as u32;
    let pixels = image::RgbaImage::from_raw(picture.width as u32, picture.height as u32, bytes)
        .map(|whole| image::imageops::resize(&whole, side, side, FilterType::Triangle))
        .map(|small| small.pixels().map(|p| p.0).collect())
        .unwrap_or_else(|| vec![[0, 0, 0, 255]; size * size]);
    Image { name: "downsampled".into(), width: size, height: size, pixels }
}
