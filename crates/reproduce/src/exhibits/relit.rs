//! Figure 14: metal and roughness as further maps, under random lights.

use super::drawn::Drawn;
use crate::error::ReproduceError;
use crate::experiment::{Experiment, Recipe, Subject};
use crate::perform::{MODEL, variant_file};
use crate::relighting::SHOWN;
use crate::results::Results;
use crate::scope::Scope;
use crate::table::{Cell, Table};
use parbake::{BakeOptions, Convention, Limits, Shading, read_image, read_model};
use parbake_report::page::embed;
use parbake_report::page::text::{decimal, escape};

/// How to read it.
pub const LEAD: &str = "Models whose roughness and metal are textures, cut to 1,000 triangles (or half of their own) and \
baked with all of their maps. Each view is lit by a lamp far away and a soft lamp, both in random directions, and shaded \
by glTF's BRDF. \"Without\" is the same bake of colours and normals alone. The paper shows a wall console and gives no figures.";

/// Triangles of the low-polys.
const TRIANGLES: usize = 1000;

/// A bake of each model.
pub fn experiments(scope: &Scope) -> Vec<Experiment> {
    let most = if scope.options.quick { 1 } else { usize::MAX };
    let of = |folder: &crate::catalogue::ModelFolder| {
        let options = BakeOptions {
            convention: Convention::Gltf,
            shading: Shading::Pbr,
            ..scope.bake(scope.shown_size())
        };
        let recipe = Recipe::Relit { options: Box::new(options), triangles: TRIANGLES };
        Experiment { subject: Subject::model(folder), recipe, label: "random lights".into() }
    };
    scope.catalogue.mapped.iter().take(most).map(of).collect()
}

/// Draws pictures, maps and the table.
///
/// # Errors
/// Where a file cannot be read again.
pub fn draw(scope: &Scope, results: &Results) -> Result<Drawn, ReproduceError> {
    let columns = ["model", "ray-cast", "without", "all maps", "over ray-cast", "over without"];
    let mut table = Table::new("PSNR / MS-SSIM under random lights", &columns);
    let mut html = String::new();
    for experiment in experiments(scope) {
        let (Some(outcome), Some(place)) = (results.of(&experiment), results.place(&experiment)) else {
            continue;
        };
        let [ray_cast, without, all] = outcome.relit.as_slice() else { continue };
        let score = |of: &crate::relighting::Relit| Cell::Score(of.psnr, of.ms_ssim);
        let gain = |over: &crate::relighting::Relit| Cell::Gain(all.psnr - over.psnr);
        let row = vec![score(ray_cast), score(without), score(all), gain(ray_cast), gain(without)];
        table.push(&experiment.subject.name(), row);
        html += &format!(r#"<h3>{}</h3><div class="plates">"#, escape(&experiment.title()));
        for index in 0..=outcome.relit.len() {
            let of = index.checked_sub(1).map(|k| &outcome.relit[k]);
            let name = of.map_or("high-poly", |of| of.name.as_str());
            let score = of.map_or(String::new(), |of| format!("{} dB", decimal(of.psnr, 2)));
            html += "<figure>";
            // There are fewer where there are fewer views.
            let files = (0..SHOWN).map(|side| place.join(variant_file(index, side)));
            for file in files.filter(|file| file.is_file()) {
                html += &frame(&read_image(&file, &Limits::default())?, name)?;
            }
            html += &format!("<figcaption>{} <b>{score}</b></figcaption></figure>", escape(name));
        }
        html += r#"</div><div class="plates">"#;
        for image in &read_model(&place.join(MODEL), &Limits::default())?.model.images {
            let name = escape(&image.name);
            html +=
                &format!("<figure>{}<figcaption>{name}</figcaption></figure>", frame(image, &image.name)?);
        }
        html += "</div>";
    }
    Ok(Drawn { tables: vec![table], html, ..Drawn::default() })
}

fn frame(image: &parbake::Picture, name: &str) -> Result<String, ReproduceError> {
    let data = embed(image)?;
    Ok(format!(
        r#"<div class="frame"><img src="{}" width="{}" height="{}" alt="{}"></div>"#,
        data.address,
        data.width,
        data.height,
        escape(name)
    ))
}
