//! Pictures of a chain: original and level at the level's own size, pixel for pixel and enlarged, and from close by.
//!
//! Contract: display-referred, on the grey of a bake's report; pictures of a level and of the original are taken by one
//! camera.

use crate::html::pictures::{AMPLIFIED, BACKGROUND, PIXELS, SUPERSAMPLE, front, front_direction};
use crate::page::text::escape;
use crate::page::{amplified_difference, embed_rgb};
use parbake::{BakeError, EvaluateOptions, LodOptions, PlacedModel, Renderer};
use parbake_metric::{Rgb, mean_squared_error, psnr_from_mse};
use parbake_model::Model;
use parbake_render::camera::Camera;

/// Pixels of a picture for each that the model spans, as cameras stand.
const PICTURE: f64 = 1.4;
/// Samples along a side of a pixel of a small picture, where thin parts flicker with fewer.
const SMALL_SAMPLES: usize = 4;
/// Pixels along a side of an own-size picture that needs no enlargement.
const LARGE: usize = 200;

/// All models in front of one camera.
pub struct Gallery {
    renderer: Renderer,
    original: PlacedModel,
    levels: Vec<PlacedModel>,
    camera: Camera,
}

/// What a level looks like, as HTML.
pub struct Looks {
    /// Its close-up, for the overview.
    pub thumbnail: String,
    /// Pictures at its own size.
    pub own: String,
    /// Pictures from close by.
    pub close: String,
}

impl Gallery {
    /// Makes all models ready.
    pub fn new(original: &Model, levels: &[Model], options: &LodOptions) -> Result<Self, BakeError> {
        let renderer =
            Renderer::new(original, &EvaluateOptions { shading: options.shading, ..Default::default() })?;
        let original = renderer.place(original);
        let levels: Vec<PlacedModel> = levels.iter().map(|level| renderer.place(level)).collect();
        let all: Vec<&PlacedModel> = std::iter::once(&original).chain(&levels).collect();
        let camera = front(&all);
        Ok(Self { renderer, original, levels, camera })
    }

    fn close(&self, model: &PlacedModel) -> Rgb {
        let view = self.renderer.render_from(model, &self.camera, (PIXELS, SUPERSAMPLE), false);
        self.renderer.tonemap(&view, BACKGROUND)
    }

    fn small(&self, model: &PlacedModel, pixels: f64) -> Rgb {
        let options = EvaluateOptions::default();
        let camera = Camera::towards_origin(front_direction(), options.radius, options.projection());
        let size = (PICTURE * pixels).round().max(8.0) as usize;
        let samples = if size > LARGE { SUPERSAMPLE } else { SMALL_SAMPLES };
        self.renderer.tonemap(&self.renderer.render_from(model, &camera, (size, samples), false), BACKGROUND)
    }

    /// The close-up of the original, which other pictures show again by its name `original`.
    pub fn original(&self) -> Result<String, BakeError> {
        let address = embed_rgb("original", &self.close(&self.original))?.address;
        Ok(format!(
            concat!(
                r#"<svg viewBox="0 0 {pixels} {pixels}" role="img" aria-label="the original">"#,
                r#"<image id="original" width="{pixels}" height="{pixels}" href="{address}"/></svg>"#
            ),
            pixels = PIXELS,
            address = address
        ))
    }

    /// A level's pictures; `pixels` is the size that it was made for.
    pub fn looks(&self, level: usize, pixels: f64) -> Result<Looks, BakeError> {
        let placed = &self.levels[level];
        let (original, own) = (self.close(&self.original), self.close(placed));
        let name = format!("level {level}");
        let id = format!("level{level}");
        let thumbnail = format!(
            r##"<svg viewBox="0 0 {PIXELS} {PIXELS}" role="img" aria-label="{name}"><use href="#{id}"/></svg>"##
        );
        let address = embed_rgb(&name, &own)?.address;
        let level_again = format!(
            concat!(
                r#"<figure class="flicker" tabindex="0"><div class="frame"><svg class="own-picture" viewBox="0 0 {pixels} {pixels}" "#,
                r#"role="img" aria-label="{name} from close by"><image id="{id}" width="{pixels}" height="{pixels}" href="{address}"/></svg>"#,
                r##"<svg viewBox="0 0 {pixels} {pixels}" aria-hidden="true"><use href="#original"/></svg></div>"##,
                r#"<figcaption>{name} <b>{psnr} dB</b></figcaption></figure>"#
            ),
            pixels = PIXELS,
            name = name,
            id = id,
            address = address,
            psnr = decibels(&original, &own)
        );
        let original_again = format!(
            concat!(
                r#"<figure><div class="frame"><svg viewBox="0 0 {pixels} {pixels}" role="img" "#,
                r##"aria-label="the original from close by"><use href="#original"/></svg></div>"##,
                r#"<figcaption>original</figcaption></figure>"#
            ),
            pixels = PIXELS
        );
        let difference = amplified_difference(&original, &own, AMPLIFIED);
        let close = format!(
            r#"<div class="pictures channel">{original_again}{level_again}{}</div>"#,
            figure(
                &difference,
                &format!("difference of {name} and original from close by"),
                &difference_caption(),
                None
            )?
        );
        Ok(Looks { thumbnail, own: self.own(&name, placed, pixels)?, close })
    }

    /// Pixel for pixel, and enlarged where that is small.
    fn own(&self, name: &str, model: &PlacedModel, pixels: f64) -> Result<String, BakeError> {
        let (original, own) = (self.small(&self.original, pixels), self.small(model, pixels));
        let difference = amplified_difference(&original, &own, AMPLIFIED);
        let size = own.width;
        let caption = format!("{name} <b>{} dB</b>", decibels(&original, &own));
        let all = [
            (&original, "the original".to_string(), "original".to_string()),
            (&own, name.to_string(), caption),
            (&difference, format!("difference of {name} and original"), difference_caption()),
        ];
        let row = |enlarged: bool| -> Result<String, BakeError> {
            let how = if enlarged { "enlarged" } else { "pixel for pixel" };
            let shown = |(picture, alt, caption): &(&Rgb, String, String)| {
                figure(picture, &format!("{alt}, {how}"), caption, (!enlarged).then_some(size))
            };
            Ok(all.iter().map(shown).collect::<Result<Vec<_>, _>>()?.concat())
        };
        let mut out = format!(r#"<div class="own">{}</div>"#, row(false)?);
        if size <= LARGE {
            out += &format!(r#"<div class="pictures channel pixels">{}</div>"#, row(true)?);
        }
        Ok(out)
    }
}

fn decibels(a: &Rgb, b: &Rgb) -> String {
    crate::page::text::decimal(psnr_from_mse(mean_squared_error(a, b).unwrap_or(f64::NAN)), 1)
}

fn difference_caption() -> String {
    format!("level − original, ×{AMPLIFIED}")
}

/// A picture with its caption, which is HTML; shown at `size` pixels, or as wide as there is room.
fn figure(picture: &Rgb, alt: &str, caption: &str, size: Option<usize>) -> Result<String, BakeError> {
    let embedded = embed_rgb(alt, picture)?;
    let size = size.unwrap_or(PIXELS);
    Ok(format!(
        concat!(
            r#"<figure><div class="frame"><img src="{}" width="{}" height="{}" alt="{}"></div>"#,
            "<figcaption>{}</figcaption></figure>"
        ),
        embedded.address,
        size,
        size,
        escape(alt),
        caption
    ))
}
