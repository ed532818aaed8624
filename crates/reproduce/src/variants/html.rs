//! The page of a comparison of parallax variants: a table, and each variant's picture beside
//! the high-poly's. Pointing at a picture shows the high-poly in its place.

use super::{ComparedVariants, VariantFigures, VariantsOptions, VariantsReport};
use parbake::BakeError;
use parbake_metric::Rgb;
use parbake_model::Model;
use parbake_report::flags;
use parbake_report::page::embed_rgb;
use parbake_report::page::text::{NOTHING, change, count, decimal, duration, escape, verdict};
use parbake_report::page::{document, section};
use rayon::prelude::*;
use std::fmt::Write;

/// Names of the sides, in the order of the pictures.
const SIDES: [&str; 2] = ["front", "a corner, closer"];

/// Draws a self-contained page about a comparison of maps fitted to `high`.
///
/// # Errors
/// Where a picture cannot be encoded.
pub fn variants_html(high: &Model, compared: &ComparedVariants) -> Result<String, BakeError> {
    let report = &compared.report;
    let name = match high.name.trim() {
        "" => "a model without a name".into(),
        name => escape(name),
    };
    let mut out =
        format!(r#"<header><p class="kicker">Parbake: ways of parallax</p><h1>{name}</h1></header>"#);
    if report.stopped_early {
        out += r#"<ul class="notes"><li>The run was stopped early; variants that were left are not here.</li></ul>"#;
    }
    section(&mut out, "figures", "Figures", "", &table(report));
    let sides: Result<Vec<String>, BakeError> =
        (0..SIDES.len()).into_par_iter().map(|index| side(compared, index)).collect();
    section(
        &mut out,
        "looks",
        "Side by side",
        "Point at a picture, or tap it, to see the high-poly in its place. The decibels are means over the held-out \
         views, not of these pictures.",
        &sides?.concat(),
    );
    Ok(document(&format!("{name} – parallax variants"), &out))
}

fn table(report: &VariantsReport) -> String {
    let mut out = String::from(r#"<table class="figures"><thead><tr><th scope="col">variant</th>"#);
    out += concat!(
        r#"<th scope="col"></th><th scope="col">PSNR ↑</th><th scope="col">gain</th><th scope="col">MS-SSIM ↑</th>"#,
        r#"<th scope="col">places</th><th scope="col">fetches</th><th scope="col">bytes</th>"#,
        r#"<th scope="col">time</th></tr></thead><tbody>"#
    );
    let plain = report.variants.first().map_or(f64::NAN, |v| v.psnr);
    for VariantFigures { name, psnr, ms_ssim, places, fetches, bytes, seconds, .. } in &report.variants {
        let gain = psnr - plain;
        let _ = write!(
            out,
            concat!(
                r#"<tr><th scope="row">{}</th><td></td><td>{}</td><td class="{}">{}</td><td>{}</td>"#,
                "<td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>"
            ),
            escape(name),
            decimal(*psnr, 2),
            verdict(gain, 2, true),
            change(gain, 2),
            ms_ssim.map_or(NOTHING.into(), |x| decimal(x, 4)),
            count(*places),
            count(*fetches),
            count(*bytes),
            duration(*seconds)
        );
    }
    let _ = write!(
        out,
        concat!(
            r#"</tbody></table><p class="note">Means over {} views that no fit has seen, {} pixels wide, on black; PSNR in "#,
            "decibels. All variants have the same vertices, texture coordinates, training views and steps, and textures of ",
            "{size} × {size} that were solved for after the map was fitted. Places are the coordinates, one after the other, at ",
            "which a pixel fetches from its map, at most; fetches are the images that it reads there, of three channels for ",
            "spherical harmonics and of one for heights. Bytes are those of the map, uncompressed. The network is no map: it ",
            "has some 2{thin}000 multiplications a pixel instead.</p>",
            r#"<p class="note">Again: <code>parbake variants HIGH LOW{}</code></p>"#
        ),
        report.views,
        report.options.resolution,
        flags(&report.options, &VariantsOptions::default()),
        size = report.options.texture_size,
        thin = '\u{202f}'
    );
    out
}

fn side(compared: &ComparedVariants, index: usize) -> Result<String, BakeError> {
    let name = SIDES[index];
    let wanted = &compared.high[index];
    let high = format!(
        concat!(
            r#"<figure class="high"><div class="frame"><svg viewBox="0 0 {w} {h}" role="img" aria-label="high-poly, {name}">"#,
            r#"<image id="high{index}" width="{w}" height="{h}" href="{data}"/></svg></div>"#,
            "<figcaption>high-poly</figcaption></figure>"
        ),
        w = wanted.width,
        h = wanted.height,
        name = name,
        index = index,
        data = embed_rgb("high-poly", wanted)?.address
    );
    let low = |(figures, pictures): (&VariantFigures, &Vec<Rgb>)| -> Result<String, BakeError> {
        let embedded = embed_rgb(&figures.name, &pictures[index])?;
        Ok(format!(
            concat!(
                r#"<figure class="flicker" tabindex="0"><div class="frame"><img src="{}" width="{w}" height="{h}" alt="{what}, {name}">"#,
                r##"<svg viewBox="0 0 {w} {h}" aria-hidden="true"><use href="#high{index}"/></svg></div>"##,
                "<figcaption>{what} <b>{} dB</b></figcaption></figure>"
            ),
            embedded.address,
            decimal(figures.psnr, 2),
            w = embedded.width,
            h = embedded.height,
            what = escape(&figures.name),
            name = name,
            index = index
        ))
    };
    let lows: Result<Vec<String>, BakeError> =
        compared.report.variants.iter().zip(&compared.pictures).map(low).collect();
    Ok(format!(
        r#"<section class="side"><h3>{name}</h3><div class="pictures">{high}{}</div></section>"#,
        lows?.concat()
    ))
}
