//! Figures 10 and 18: texture coordinates over pictures with what is left of the error, and
//! layouts from other starts.

use super::drawn::Drawn;
use super::scores::{gain, score};
use crate::catalogue::{Level, ModelFolder};
use crate::error::ReproduceError;
use crate::experiment::{Experiment, Recipe, Subject, stem};
use crate::outcome::Outcome;
use crate::perform::MODEL;
use crate::plane::{as_shown, wanted};
use crate::results::Results;
use crate::scope::Scope;
use crate::table::{Cell, Table};
use parbake::{BakeOptions, ImageOptions, Limits, PictureUv, UvMode, read_image, read_model};
use parbake_model::Model;
use parbake_report::page::text::{decimal, escape};
use parbake_report::page::{amplified_difference, embed, embed_rgb, uv_layout};
use std::path::Path;

/// How to read Figure 10.
pub const LEAD_PICTURES: &str = "Pictures on a plane of 50 × 50 cells. Textures are shown as they are stored, with the \
cells' lines: where cells are large, the picture has many texels. Differences are four times as strong.";
/// How to read Figure 18.
pub const LEAD_STARTS: &str = "The coarse model at LOD-1 with a small texture, its coordinates as delivered, unwrapped \
anew, or as Tutte's embedding in the middle of the square; textures fitted as they are, and after the coordinates were \
moved.";

/// Cells of Figure 10: few enough for their lines to be seen.
const CELLS: usize = 50;
/// Differences are shown so many times as strong.
const AMPLIFIED: f32 = 4.0;
/// Texels of Figure 18: few, so that coordinates matter.
const STARTS_SIZE: usize = 128;

/// Starts of Figure 18.
const STARTS: [(UvMode, &str); 3] =
    [(UvMode::Keep, "delivered"), (UvMode::Unwrap, "unwrapped"), (UvMode::Tutte, "Tutte")];

fn on_plane(scope: &Scope, picture: &Path, uv: PictureUv) -> Experiment {
    let size = if scope.options.quick { 64 } else { 128 };
    let options = ImageOptions { uv, grid: Some(CELLS), ..scope.picture(size) };
    let label = if uv == PictureUv::Keep { "fixed UV" } else { "UV" };
    let recipe = Recipe::Picture { options };
    Experiment { subject: Subject::picture(picture), recipe, label: format!("{label}, {CELLS} cells") }
}

/// Both of each picture.
pub fn picture_experiments(scope: &Scope) -> Vec<Experiment> {
    let both = |picture| [PictureUv::Keep, PictureUv::Optimize].map(|uv| on_plane(scope, picture, uv));
    scope.catalogue.pictures.iter().flat_map(|picture| both(picture)).collect()
}

fn level(model: &ModelFolder) -> Level {
    if model.low(Level::One).is_some() { Level::One } else { Level::Three }
}

fn from_start(scope: &Scope, model: &ModelFolder, start: UvMode, uv: UvMode) -> Option<Experiment> {
    let subject = Subject::pair(model, level(model))?;
    let options = Box::new(BakeOptions { uv, ..scope.fixed(STARTS_SIZE) });
    let name = STARTS.iter().find(|(mode, _)| *mode == start).map_or("", |(_, name)| name);
    let label = format!("{name}, {}", if uv == UvMode::Keep { "fixed" } else { "moved" });
    let start = (start != UvMode::Keep).then_some(start);
    Some(Experiment { subject, recipe: Recipe::Bake { options, start, subdivided: false }, label })
}

/// Every start of every model, moved and not.
pub fn start_experiments(scope: &Scope) -> Vec<Experiment> {
    let of_model = |model| {
        let both = move |(start, _): (UvMode, &str)| {
            [UvMode::Keep, UvMode::Optimize].map(|uv| from_start(scope, model, start, uv))
        };
        STARTS.into_iter().flat_map(both).flatten().collect::<Vec<_>>()
    };
    scope.catalogue.models.iter().flat_map(of_model).collect()
}

/// Figure 10.
///
/// # Errors
/// Where a file cannot be read again.
pub fn draw_pictures(scope: &Scope, results: &Results) -> Result<Drawn, ReproduceError> {
    let mut html = String::new();
    for path in &scope.catalogue.pictures {
        let experiments = [PictureUv::Keep, PictureUv::Optimize].map(|uv| on_plane(scope, path, uv));
        let picture = read_image(path, &Limits::default())?;
        html += &format!(r#"<h3>{}</h3><div class="plates">"#, escape(&stem(path)));
        html += &framed("the picture", &embed(&picture)?.address, "");
        for (k, experiment) in experiments.iter().enumerate() {
            let (Some(outcome), Some(place)) = (results.of(experiment), results.place(experiment)) else {
                continue;
            };
            let plane = read_model(&place.join(MODEL), &Limits::default())?.model;
            let shown = as_shown(&plane, &picture)?;
            let what = if k == 0 { "fixed UV" } else { "UV moved" };
            let caption = format!("{what} <b>{} dB</b>", decimal(outcome.psnr(), 2));
            html += &framed(&caption, &embed_rgb("shown", &shown)?.address, "");
            let left = amplified_difference(&wanted(&picture), &shown, AMPLIFIED);
            html += &framed(&format!("difference, {what}"), &embed_rgb("difference", &left)?.address, "");
            if k == 1 {
                html += &textured(&plane, "texture and cells", &format!("picture-{}", escape(&stem(path))))?;
            }
        }
        html += "</div>";
    }
    Ok(Drawn { html, ..Drawn::default() })
}

/// Figure 18: a table of all models, layouts of the first.
///
/// # Errors
/// Where a file cannot be read again.
pub fn draw_starts(scope: &Scope, results: &Results) -> Result<Drawn, ReproduceError> {
    let columns = ["model, start", "fixed", "moved", "gain", "over delivered, fixed"];
    let mut table = Table::new(&format!("Starts of texture coordinates, {STARTS_SIZE}²"), &columns);
    let mut html = String::new();
    for (index, model) in scope.catalogue.models.iter().enumerate() {
        let made = |start, uv| from_start(scope, model, start, uv).and_then(|e| results.of(&e));
        let delivered = made(UvMode::Keep, UvMode::Keep);
        for (start, name) in STARTS {
            let [fixed, moved] = [UvMode::Keep, UvMode::Optimize].map(|uv| made(start, uv));
            let over = |base| Cell::or_missing(gain(Outcome::psnr, moved, base).map(Cell::Gain));
            let row = vec![score(fixed), score(moved), over(fixed), over(delivered)];
            table.push(&format!("{}, {name}", model.name), row);
        }
        if index > 0 {
            continue;
        }
        html += &format!(r#"<h3>{}</h3><div class="plates">"#, escape(&model.name));
        for (start, name) in STARTS {
            for uv in [UvMode::Keep, UvMode::Optimize] {
                let place = from_start(scope, model, start, uv).and_then(|e| results.place(&e));
                if let Some(place) = place {
                    let low = read_model(&place.join(MODEL), &Limits::default())?.model;
                    let what = if uv == UvMode::Keep { "as it is" } else { "moved" };
                    html += &textured(&low, &format!("{name}, {what}"), &format!("start-{name}-{what}"))?;
                }
            }
        }
        html += "</div>";
    }
    Ok(Drawn { tables: vec![table], html, ..Drawn::default() })
}

/// A picture with its caption; `over` is drawn on it.
fn framed(caption: &str, address: &str, over: &str) -> String {
    format!(
        r#"<figure><div class="frame"><img src="{address}" alt="">{over}</div><figcaption>{caption}</figcaption></figure>"#
    )
}

/// A model's texture with its layout.
fn textured(model: &Model, caption: &str, id: &str) -> Result<String, ReproduceError> {
    let Some(texture) = model.images.first() else { return Ok(String::new()) };
    let id = id.replace(|c: char| !c.is_ascii_alphanumeric(), "-");
    let lines = uv_layout(&model.mesh, &id).map_or(String::new(), |layout| layout.svg);
    Ok(framed(caption, &embed(texture)?.address, &lines))
}
