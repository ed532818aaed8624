//! A level's part of the page: its looks, how its triangles were found, its textures.

use super::overview::kilobytes;
use super::pictures::Looks;
use super::search::search;
use crate::html::textures::textures;
use crate::page::text::{NOTHING, count, decimal, duration, escape};
use parbake::lod::document::{LodDocument, LodEntry};
use parbake::{BakeError, LayerReport, LevelReport, Start, StartReport, Way};
use parbake_metric::psnr_from_mse;
use parbake_model::Model;
use std::fmt::Write;

/// The whole part.
pub fn level(
    chain: &LodDocument,
    entry: &LodEntry,
    model: &Model,
    looks: &Looks,
) -> Result<String, BakeError> {
    let report = &entry.report;
    let [chosen, baked, compared] = report.seconds.map(duration);
    let mut out = format!(
        concat!(
            r#"<section class="level" id="section{level}"><h2>Level {level}</h2>"#,
            r#"<p class="lead">{triangles} of {all} triangles, {size}, in <code>{file}</code>. Choosing triangles took {chosen}, "#,
            r#"the bake {baked}, pictures {compared}.</p>"#
        ),
        level = report.level,
        triangles = count(report.triangles),
        all = count(chain.source_triangles),
        size = kilobytes(entry.bytes),
        file = escape(&entry.file),
        chosen = chosen,
        baked = baked,
        compared = compared
    );
    let _ = write!(
        out,
        concat!(
            "<h3>At its size: {} pixels</h3>{}<h3>From close by</h3>",
            r#"<p class="note">Nobody is meant to see it from here. Decibels below pictures are of these very pictures, on dark grey. Point at the level, or tap it, to see the original in its place.</p>{}"#
        ),
        decimal(report.screen_size, 0),
        looks.own,
        looks.close
    );
    if let Some(target) = &report.target {
        out += &search(target);
    }
    out += &ways(report);
    if !report.low_poly.is_empty() {
        out += &triangles(report);
    }
    let _ = write!(out, "<h3>Textures</h3>{}</section>", maps(model, report.level)?);
    Ok(out)
}

fn maps(model: &Model, level: usize) -> Result<String, BakeError> {
    if model.images.is_empty() {
        return Ok(r#"<p class="note">It has none: factors of the material say all.</p>"#.into());
    }
    textures(model, &format!("borders{level}"))
}

/// Which way won, and by how much.
fn ways(report: &LevelReport) -> String {
    if report.candidates.len() < 2 {
        return String::new();
    }
    let mut out = String::from(concat!(
        "<h3>How it was made</h3>",
        r#"<p class="note">Each row was finished and rendered: at the level’s size and, if that is small, at twice that; <em>close up</em> the model spans 300 pixels. A new layout stays unless another way gains at least 0.3 dB at the level’s size. Finer maps stay if they gain at least 0.5 dB in one of both columns.</p>"#,
        r#"<div class="wide"><table class="numbers-table"><thead><tr><th scope="col">way</th><th scope="col">triangles</th>"#,
        r#"<th scope="col">largest texture</th><th scope="col">PSNR</th><th scope="col">close up</th></tr></thead><tbody>"#
    ));
    for candidate in &report.candidates {
        let is_taken = candidate.way == report.way && candidate.texture_size == report.texture_size;
        let side = match candidate.texture_size {
            0 => "none".into(),
            size => format!("{size} texels wide"),
        };
        let taken = if is_taken { ", taken" } else { "" };
        let close_up =
            candidate.close_up.map_or("–".into(), |psnr| format!("{}\u{202f}dB", decimal(psnr, 1)));
        let _ = write!(
            out,
            "<tr><th scope=\"row\">{}{taken}</th><td>{}</td><td>{side}</td><td>{}\u{202f}dB</td><td>{close_up}</td></tr>",
            way_name(candidate.way),
            count(candidate.triangles),
            decimal(candidate.psnr, 1)
        );
    }
    out + "</tbody></table></div>"
}

fn way_name(way: Way) -> &'static str {
    match way {
        Way::New => "triangles chosen by pictures, new layout",
        Way::Delivered => "the model's own vertices and layout, baked",
        Way::Scaled => "the model's own vertices, layout and maps",
    }
}

/// Which start won in each layer, by how much, and what polishing gained.
fn triangles(report: &LevelReport) -> String {
    let mut out = String::from(concat!(
        "<h3>How its triangles were found</h3>",
        r#"<p class="note">Surfaces to start from were collapsed to the wanted number; the one whose pictures came closest to the original's, "#,
        r#"as far as that can be told without textures, was taken and polished.</p>"#,
        r#"<div class="wide"><table class="numbers-table"><thead><tr><th scope="col">layer</th><th scope="col">triangles</th>"#,
        r#"<th scope="col">start that won</th><th scope="col">its pictures</th><th scope="col">the other start</th>"#,
        r#"<th scope="col">before polishing</th><th scope="col">after</th></tr></thead><tbody>"#
    ));
    for (place, layer) in report.low_poly.iter().enumerate() {
        let LayerReport { triangles, starts, error } = layer;
        let start = |start: Option<&StartReport>| start.map_or(NOTHING.into(), |s| decibels(s.error));
        // Later attempts begin with the same kinds again.
        let is_other = |other: &&StartReport| starts.first().is_some_and(|won| won.start != other.start);
        let other = match starts.iter().find(is_other) {
            Some(other) => format!("{} ({})", decibels(other.error), name(other.start)),
            None => NOTHING.into(),
        };
        let _ = write!(
            out,
            r#"<tr><th scope="row">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{other}</td><td>{}</td><td>{}</td></tr>"#,
            place + 1,
            count(*triangles),
            starts.first().map_or(NOTHING, |won| name(won.start)),
            start(starts.first()),
            decibels(error[0]),
            decibels(error[1])
        );
    }
    out + r#"</tbody></table></div><p class="note">Decibels of a start and of polishing are weighed differently, and compare within their own columns only.</p>"#
}

fn decibels(error: f64) -> String {
    format!("{}\u{202f}dB", decimal(psnr_from_mse(error), 1))
}

fn name(start: Start) -> &'static str {
    match start {
        Start::Quadrics => "edge collapses of the original",
        Start::Level => "the level before",
    }
}
