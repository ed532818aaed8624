//! Figures 11 and 12: every kind of parallax mapping on the built-in brick wall over its plain cube,
//! with heights that are fitted, and with the wall's own depth.

use super::drawn::Drawn;
use crate::error::ReproduceError;
use crate::experiment::{Experiment, Recipe, Subject};
use crate::perform::variant_file;
use crate::results::Results;
use crate::scope::Scope;
use crate::table::{Cell, Table};
use crate::variants::VariantsOptions;
use parbake::{Limits, read_image};
use parbake_report::page::embed;
use parbake_report::page::text::{decimal, escape};

/// How to read Figure 12.
pub const LEAD_MEASURED: &str = "The same wall; heights are its own depth, measured along the normals, and only \
textures are fitted to them. SH and network, which have no such truth, are fitted as in Figure 11.";
/// How to read Figure 11.
pub const LEAD_FITTED: &str = "A cube of brick walls made by formula, and the plain cube with each kind of map, fitted alike. \
Places are coordinates at which a pixel has to fetch from its map, one after the other. Heights are held to 0 … 1, as \
files hold them.";

/// The comparison on the wall.
pub fn run(scope: &Scope, measured_heights: bool) -> Experiment {
    let evaluate = scope.options.evaluate();
    let options = VariantsOptions {
        texture_size: scope.shown_size(),
        measured_heights,
        held_out: evaluate.views,
        resolution: evaluate.resolution,
        ..VariantsOptions::default()
    };
    let recipe = Recipe::Variants { options };
    Experiment {
        subject: Subject::Wall,
        recipe,
        label: format!("parallax variants, heights {}", if measured_heights { "measured" } else { "fitted" }),
    }
}

/// Draws its pictures and its table.
///
/// # Errors
/// Where a picture cannot be read again.
pub fn draw(scope: &Scope, results: &Results, measured: bool) -> Result<Drawn, ReproduceError> {
    let experiment = run(scope, measured);
    let (Some(outcome), Some(place)) = (results.of(&experiment), results.place(&experiment)) else {
        return Ok(Drawn::default());
    };
    let columns = ["map", "PSNR / MS-SSIM", "gain", "places", "fetches", "bytes"];
    let heights = if measured { "measured" } else { "fitted" };
    let mut table = Table::new(&format!("The brick wall, heights {heights}"), &columns);
    let plain = outcome.variants.first().map_or(f64::NAN, |v| v.psnr);
    let mut html = String::from(r#"<div class="plates">"#);
    for index in 0..=outcome.variants.len() {
        let variant = index.checked_sub(1).and_then(|k| outcome.variants.get(k));
        let name = variant.map_or("high-poly", |v| v.name.as_str());
        let score = variant.map_or(String::new(), |v| format!("{} dB", decimal(v.psnr, 2)));
        html += "<figure>";
        for side in 0..2 {
            let image = read_image(&place.join(variant_file(index, side)), &Limits::default())?;
            let data = embed(&image)?;
            html += &format!(
                r#"<div class="frame"><img src="{}" width="{}" height="{}" alt="{}"></div>"#,
                data.address,
                data.width,
                data.height,
                escape(name)
            );
        }
        html += &format!("<figcaption>{} <b>{score}</b></figcaption></figure>", escape(name));
        if let Some(v) = variant {
            let counts = [v.places, v.fetches, v.bytes].map(|n| Cell::Number(n as f64, 0));
            let row = [Cell::Score(v.psnr, v.ms_ssim), Cell::Gain(v.psnr - plain)].into_iter().chain(counts);
            table.push(name, row.collect());
        }
    }
    html += "</div>";
    Ok(Drawn { tables: vec![table], html, ..Drawn::default() })
}
