//! Models side by side with insets, for the page.
//!
//! Contract: all pictures of a row are taken from the same place in the same light; the inset is
//! where the last result is most ahead of the first, by squared error, so it is chosen by what is
//! there and not by hand.

use crate::error::ReproduceError;
use crate::outcome::Outcome;
use parbake::{EvaluateOptions, Limits, Renderer, read_model};
use parbake_metric::Rgb;
use parbake_model::Model;
use parbake_model::glam::Vec3;
use parbake_report::page::embed_rgb;
use parbake_report::page::text::{decimal, escape};
use std::fmt::Write;
use std::path::Path;

/// Side of a picture in pixels, and of its inset.
const PICTURE: usize = 384;
const INSET: usize = 96;
/// Insets have so many times the pixels.
const FINER: usize = 3;
/// How much more a later side has to show to be taken.
const PREFERENCE: f32 = 1.5;
/// How much larger the picture is than the model.
const ROOM: f32 = 1.06;
/// Dark grey, which neither swallows outlines nor outshines models. Linear light.
const BACKGROUND: [f32; 3] = [0.04; 3];

/// A result to be shown.
pub struct Plate<'a> {
    /// What it is.
    pub name: String,
    /// The folder of its model.
    pub place: &'a Path,
    /// Its figures.
    pub outcome: &'a Outcome,
}

/// The high-poly and all results in a row, each with its inset below.
///
/// # Errors
/// Where a file cannot be read again.
pub fn row(title: &str, high: &Path, plates: &[Plate]) -> Result<String, ReproduceError> {
    if plates.is_empty() {
        return Ok(String::new());
    }
    let limits = Limits::default();
    let high = read_model(high, &limits)?.model;
    let (direction, fov) = framing(&high)?;
    let renderer =
        |resolution| Renderer::new(&high, &EvaluateOptions { resolution, fov, ..EvaluateOptions::paper() });
    let (whole, fine) = (renderer(PICTURE)?, renderer(FINER * PICTURE)?);
    let taken = |model: &Model| {
        let taken = [&whole, &fine].map(|renderer| {
            let placed = renderer.place(model);
            renderer.tonemap(&renderer.render(&placed, direction), BACKGROUND)
        });
        let [picture, detail] = taken;
        Pictures { picture, detail }
    };
    let wanted = taken(&high);
    let mut shown = Vec::new();
    for plate in plates {
        shown.push(taken(&read_model(&plate.place.join(crate::perform::MODEL), &limits)?.model));
    }
    let at = inset(&wanted.picture, &shown[0].picture, &shown[shown.len() - 1].picture);
    let mut out = format!(r#"<h3>{}</h3><div class="plates">"#, escape(title));
    out += &figure("high-poly", "", &wanted, at)?;
    for (plate, picture) in plates.iter().zip(&shown) {
        let score = match plate.outcome.ms_ssim() {
            Some(ssim) => format!("{} dB / {}", decimal(plate.outcome.psnr(), 2), decimal(ssim, 3)),
            None => format!("{} dB", decimal(plate.outcome.psnr(), 2)),
        };
        out += &figure(&plate.name, &score, picture, at)?;
    }
    Ok(out + "</div>")
}

/// A view of a model, and the same with more pixels, of which the inset is cut.
struct Pictures {
    picture: Rgb,
    detail: Rgb,
}

/// Where to take pictures from, and the field of view in degrees, as near as the model fits: the
/// usual front, as a photographer would take it, unless another side shows much more.
fn framing(high: &Model) -> Result<(Vec3, f32), ReproduceError> {
    let options = EvaluateOptions { resolution: 96, supersample: 1, ..EvaluateOptions::paper() };
    let renderer = Renderer::new(high, &options)?;
    let placed = renderer.place(high);
    let sides = [[0.413, 0.208, 0.887], [-0.54, 0.45, 0.71], [0.35, 0.8, 0.49], [0.3, -0.45, -0.84]];
    let mut best = (0, Vec3::Z, options.fov);
    for direction in sides.map(|side| Vec3::from(side).normalize()) {
        let view = renderer.render(&placed, direction);
        let [black, white] = [[0.0; 3], [1.0; 3]].map(|background| renderer.tonemap(&view, background));
        let size = black.width;
        // What a background does not change is the model.
        let covered: Vec<usize> = (0..size * size).filter(|&i| black.pixels[i] == white.pixels[i]).collect();
        let middle = 0.5 * size as f32;
        let away = |i: usize| (i as f32 + 0.5 - middle).abs() + 0.5;
        let reach = covered.iter().map(|&i| away(i % size).max(away(i / size))).fold(1.0, f32::max);
        if covered.len() as f32 > PREFERENCE * best.0 as f32 {
            let tangent = (0.5 * options.fov.to_radians()).tan() * (reach / middle) * ROOM;
            best = (covered.len(), direction, 2.0 * tangent.atan().to_degrees());
        }
    }
    Ok((best.1, best.2.clamp(1.0, 120.0)))
}

fn figure(name: &str, score: &str, taken: &Pictures, at: [usize; 2]) -> Result<String, ReproduceError> {
    let name = escape(name);
    let mut out = String::from("<figure>");
    for (what, picture) in [("", &taken.picture), (", inset", &cut(&taken.detail, at))] {
        let data = embed_rgb(&name, picture)?;
        let class = if what.is_empty() { "frame" } else { "frame inset" };
        let _ = write!(
            out,
            r#"<div class="{class}"><img src="{}" width="{}" height="{}" alt="{name}{what}"></div>"#,
            data.address, data.width, data.height
        );
    }
    Ok(out + &format!("<figcaption>{name} <b>{score}</b></figcaption></figure>"))
}

/// Upper left corner of the square in which `best` is most ahead of `first`.
fn inset(wanted: &Rgb, first: &Rgb, best: &Rgb) -> [usize; 2] {
    let (width, height) = (wanted.width, wanted.height);
    let error = |picture: &Rgb, i: usize| -> f64 {
        (0..3).map(|k| f64::from(picture.pixels[i][k] - wanted.pixels[i][k]).powi(2)).sum()
    };
    // Sums over all pixels above and to the left, so that a square's sum is four of them.
    let mut sums = vec![0.0; (width + 1) * (height + 1)];
    for y in 0..height {
        for x in 0..width {
            let i = y * width + x;
            let ahead = error(first, i) - error(best, i);
            let at = |x: usize, y: usize| y * (width + 1) + x;
            sums[at(x + 1, y + 1)] = ahead + sums[at(x, y + 1)] + sums[at(x + 1, y)] - sums[at(x, y)];
        }
    }
    let at = |x: usize, y: usize| sums[y * (width + 1) + x];
    let square =
        |x: usize, y: usize| at(x + INSET, y + INSET) - at(x, y + INSET) - at(x + INSET, y) + at(x, y);
    let mut best_at = ([0, 0], f64::NEG_INFINITY);
    for y in (0..=height.saturating_sub(INSET)).step_by(8) {
        for x in (0..=width.saturating_sub(INSET)).step_by(8) {
            if square(x, y) > best_at.1 {
                best_at = ([x, y], square(x, y));
            }
        }
    }
    best_at.0
}

/// The inset at `at` of the picture with more pixels.
fn cut(detail: &Rgb, at: [usize; 2]) -> Rgb {
    let side = FINER * INSET;
    let [left, top] = at.map(|x| FINER * x);
    let pixels = (top..top + side)
        .flat_map(|y| detail.pixels[y * detail.width + left..][..side].iter().copied())
        .collect();
    Rgb { width: side, height: side, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the choice of insets: where the result is ahead, wherever that is.
    #[test]
    fn insets_lie_where_the_gain_is() {
        let plain =
            |value| Rgb { width: PICTURE, height: PICTURE, pixels: vec![[value; 3]; PICTURE * PICTURE] };
        let (wanted, best, mut first) = (plain(0.5), plain(0.5), plain(0.5));
        for y in 200..220 {
            for x in 300..310 {
                first.pixels[y * PICTURE + x] = [0.0; 3];
            }
        }
        let [left, top] = inset(&wanted, &first, &best);
        assert!(left <= 300 && left + INSET >= 310 && top <= 200 && top + INSET >= 220, "{left} {top}");
        let side = FINER * PICTURE;
        let detail = Rgb { width: side, height: side, pixels: vec![[0.5; 3]; side * side] };
        assert_eq!(cut(&detail, [PICTURE - INSET; 2]).pixels.len(), (FINER * INSET).pow(2));
    }
}
